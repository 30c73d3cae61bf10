#ifndef PROCESS_BOARD_CORNERS_H
#define PROCESS_BOARD_CORNERS_H
/* Where four squares of a checkerboard meet, from the light of all pixels around: two straight edges that cross, blurred, are fitted to each corner
 * (Mallon and Whelan, "Which pattern?", Pattern Recognition Letters 28, 2007, section 4, take such a surface; theirs is cubic, ours is what a pixel
 * that gathers light over an edge sees). What OpenCV's cornerSubPix says is off by a twentieth to a tenth of a pixel where squares are small.
 * Pure. */
#include "process/boards.h"
#ifdef __cplusplus
extern "C" {
#endif

/* luma: limited range, width * height; corner: row by row, where they are to a pixel. Those that cannot be fitted stay. */
void board_corners_refine(const uint8_t *luma, uint32_t width, uint32_t height,
	const struct board_desc *desc, double (*corner)[2]);

#ifdef __cplusplus
}
#endif
#endif
