#ifndef PROCESS_BOARD_LIDAR_H
#define PROCESS_BOARD_LIDAR_H
/* Boards that photos and lidar see: part of board-camera.h. */
#include "process/board-camera.h"

/* What the lidar saw of one board, in the scanner's frame. */
struct board_plane {
	double beams;                       /* 0: none */
	double mean_m[3], along[3];         /* of the beams' ends, and of their directions */
	double across[2][3], spread2_m2[2]; /* along its longer sides: sums of squares */
};

/* Finds how the boards (poses, board to scanner) have to be turned about the axis and shifted along it to lie where the lidar's
 * beams end, and by how much these are too short; turns and shifts ret->camera likewise, and the boards; planes (of struct board_plane) gets one a board. Where the lidar does not see enough of
 * them ret->met stays false. */
void board_lidar_meet(const struct faces *f, const struct board_desc *desc, GArray *boards,
	const struct two_face_result *lidar, struct board_result *ret, GArray *planes);

#endif
