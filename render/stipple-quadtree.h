#ifndef RENDER_STIPPLE_QUADTREE_H
#define RENDER_STIPPLE_QUADTREE_H
/* The diffuse reflection texture (Awano et al. 2010, section 2.2): a full quadtree of least keys, levels 0 to n, in one texture of
 * 2^(n+1) x 2^n texels. Level n is at its left edge, 2^n a side; level l begins at the column that is the sum of 2^k over k from
 * l + 1 to n. */
#include "render/stipple-plane.h"

#define STIPPLE_LEVELS_MOST 10 /* n of the paper's */

struct stipple_quadtree {
	uint32_t levels; /* n */
	int32_t *key;    /* rows of 2^(n+1) */
};
/* All of it empty; the memory of as many levels is used again. Zero at first. */
void stipple_quadtree_begin(struct stipple_quadtree *q, uint32_t levels, bool single_thread);
/* All levels from n, which is full. */
void stipple_quadtree_fill(struct stipple_quadtree *q, bool single_thread);
void stipple_quadtree_clear(struct stipple_quadtree *q);

/* Formula (2): where level l has what column and row of level n are in. */
static inline size_t stipple_quadtree_place(
	uint32_t levels, uint32_t level, uint32_t column, uint32_t row)
{
	uint32_t begin = (2u << levels) - (2u << level), up = levels - level;
	return ((size_t)(row >> up) << (levels + 1)) + begin + (column >> up);
}

#endif
