#ifndef PROCESS_BOARD_CAMERA_H
#define PROCESS_BOARD_CAMERA_H
/* The camera and its place on the head, from checkerboards that stand still while the head turns: all views at once, each board one
 * pose in the scanner's frame, the camera one pose on the head, the stage's angles known. Levenberg and Marquardt's method over what
 * the photos show of the corners.
 *
 * A turn of everything about the axis, and a shift along it, change no photo: the camera's azimuth and height against the lidar
 * come from boards that the lidar sees too (board_camera_meet_lidar), whose planes must lie where its beams end; then all is solved once more, since a camera's pitch, the middle of its picture and its
 * height differ little in what it sees, but not in where its boards stand. The boards have a
 * known size, so the same tells the range offset, which the lidar's faces cannot. */
#include "process/boards.h"
#include "process/two-face.h"

enum board_unknown {
	BOARD_FX,
	BOARD_FY,
	BOARD_CX,
	BOARD_CY, /* px */
	BOARD_K1,
	BOARD_K2,
	BOARD_P1,
	BOARD_P2,
	BOARD_K3,
	BOARD_TURN_X,
	BOARD_TURN_Y,
	BOARD_TURN_Z, /* rad, about the head's axes; Z by the lidar */
	BOARD_X,
	BOARD_Y,
	BOARD_Z,     /* m; Z by the lidar */
	BOARD_RANGE, /* m: the lidar's range offset, by the lidar */
	BOARD_UNKNOWNS
};

struct board_result {
	struct camera_calibration camera;
	double deviation[BOARD_UNKNOWNS];
	uint32_t boards, views, photos; /* photos: with a board in them */
	double first_rms_px,
		rms_px; /* through the camera as the certificate has it; as it was found */
	bool met; /* the lidar saw boards: the next are known, and the camera's azimuth and height */
	uint32_t beams;
	double range_offset_m, range_deviation_m;
	double plane_rms_m;
};

/* Photos with boards at fewer angles tell too little. */
#define BOARD_ANGLES_MIN 6u

/* Searches all photos; progress may be NULL. No error and boards 0: there is no board to be seen. Errors say in one sentence what
 * is missing. */
bool board_camera_solve(const struct faces *f, const struct board_desc *desc,
	const struct two_face_result *lidar, faces_progress progress, gpointer user_data,
	struct board_result *ret, GError **error);

#endif
