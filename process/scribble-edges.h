#ifndef PROCESS_SCRIBBLE_EDGES_H
#define PROCESS_SCRIBBLE_EDGES_H
/* How much parts a cell of a panorama from the next one, as one number from what every channel says:
 *
 * - range: how far the one lies off the surface of the other. A wall seen at a grazing angle has far apart ranges and no edge: each
 *   cell's plane says where its neighbour would be; without planes, inverse range does, which is linear over a plane. The smaller
 *   of both sides counts, in terms of the range noise, on a logarithmic scale: a metre parts more than a hand's breadth.
 * - creases: the angle between the normals. Where the surface is hollow two things are likely to meet, where it bulges likely
 *   not (Stein et al. 2014). Foliage has normals at random, which say nothing: they count less the less the planes fit.
 * - intensity and colour: differences in terms of what is usual between neighbours of this very panorama.
 * - leaves of a segmentation that is there already.
 *
 * Cells without a point stand for the nearest one with a point, a few cells away, so that small holes have one edge, not two. */
#include "process/scribble.h"

struct scribble_edges {
	uint32_t *source; /* the cell whose point a cell stands for: itself; RANGE_GRID_NONE */
	/* As watershed.h has them, 0 and more; INFINITY where one of the two stands for no point. */
	float *step_right, *step_down;
};

/* Planes are the caller's to clear. options: weights as they are. */
void scribble_edges_find(const range_grid *g, const geometry *normals, const uint16_t *leaf,
	const struct scribble_options *options, struct scribble_edges *ret);
void scribble_edges_clear(struct scribble_edges *e);

#endif
