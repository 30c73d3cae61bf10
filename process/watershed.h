#ifndef PROCESS_WATERSHED_H
#define PROCESS_WATERSHED_H
/* Marker-controlled watershed of an image of heights: water rises at the markers, each cell belongs to the marker whose water
 * reaches it first, and where waters meet there is no line between them (Meyer's flooding by priority, as Kornilov and Safonov
 * 2018 review it). Heights may stand in the cells, between cells side by side, or both: water passes from a cell to the next at
 * the highest of what is under way, so that each cell is labelled along a path whose highest point is as low as possible. With
 * heights between cells alone this is the cut by a minimum spanning forest (Cousty et al. 2009), which also divides things
 * that are a single cell wide.
 *
 * Ties go by order of arrival, so the same image gives the same labels; markers come in the order of their cells. Heights are
 * told apart in 65,536 equal steps between the lowest and the highest that is finite, hence time and memory are linear: 12
 * bytes a cell and half a megabyte. One thread; images of at most 2^31 cells.
 *
 * Not cv::watershed, because that floods an 8-bit colour image by the differences of its colours instead of a height, has no
 * seam that wraps, and leaves a line of -1 between regions, which is all there is of a lamp post three cells wide. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct watershed_image {
	uint32_t columns, rows;
	bool wraps;     /* the last column is beside the first */
	bool diagonals; /* a cell has 8 neighbours instead of 4 */
	/* Planes of rows * columns, row by row. What is not finite, water never enters or passes. */
	const float *level; /* NULL: all alike, below any step */
	/* Between a cell and the next one of its row (of the last column: the first one), and the one below it; NULL: none. Steps
	 * to diagonal neighbours are not kept: these are passed at the higher of the two steps on the lower way around. */
	const float *step_right, *step_down;
};

/* label: in, markers > 0, cells to be flooded 0, cells that stay outside < 0; out, all that water reached is labelled. Cells
 * that no water reached, for walls or what stays outside is around them, keep their 0. Returns how many were newly labelled. */
size_t watershed_flood(const struct watershed_image *image, int32_t *label);

#endif
