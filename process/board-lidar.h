#ifndef PROCESS_BOARD_LIDAR_H
#define PROCESS_BOARD_LIDAR_H
/* Boards that photos and lidar see: part of board-camera.h. */
#include "process/board-camera.h"

/* Finds how the boards (poses, board to scanner) have to be turned about the axis and shifted along it to lie where the lidar's
 * beams end, and by how much these are too short; turns and shifts ret->camera likewise. Where the lidar does not see enough of
 * them ret->met stays false. */
void board_lidar_meet(const struct faces *f, const struct board_desc *desc, const GArray *boards,
	const struct two_face_result *lidar, struct board_result *ret);

#endif
