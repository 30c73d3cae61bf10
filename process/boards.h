#ifndef PROCESS_BOARDS_H
#define PROCESS_BOARDS_H
/* Checkerboards in the photos of a scan, by OpenCV. The head turns, the boards stand still; a board hangs more or less upright, so
 * its first corner is the upper left one. A board's frame has its origin in the first corner, x to the right and y down along the
 * squares, z away from who looks at it. Pure but for the time it takes: a second or two a photo. */
#include "acquire/colour.h"
#include "process/pose.h"
#include <glib.h>
#ifdef __cplusplus
extern "C" {
#endif

#define BOARD_CORNERS_MAX 400

struct board_desc {
	uint32_t columns,
		rows; /* corners inside, where four squares meet; one even, one odd, or they cannot be told apart */
	double square_m;
};

struct board_view {
	double front_rad;                    /* stage angle of the photo */
	uint32_t board;                      /* which of the boards, from 0: set by who knows */
	double corner[BOARD_CORNERS_MAX][2]; /* pixels, row by row */
};

/* All boards in a photo, added to views (of struct board_view). */
bool boards_find(
	const struct photo *photo, const struct board_desc *desc, GArray *views, GError **error);
/* Board to camera, from one view through a camera that is known roughly. false: it cannot be. */
bool boards_pose(const struct camera_calibration *lens, const struct board_desc *desc,
	const struct board_view *view, struct pose *ret);
/* A camera's own numbers (focal lengths, centre, distortion) from all views, beginning with those it has; mounting stays as it
 * is. ret_rms_px: what is left. */
bool boards_intrinsics(const struct board_desc *desc, const GArray *views,
	struct camera_calibration *lens, double *ret_rms_px, GError **error);

#ifdef __cplusplus
}
#endif
#endif
