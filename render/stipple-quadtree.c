#include "render/stipple-quadtree.h"
#include "render/large.h"

void stipple_quadtree_begin(struct stipple_quadtree *q, uint32_t levels, bool single_thread)
{
	ptrdiff_t texels = (ptrdiff_t)2 << (2 * levels);
	if (!q->key || q->levels != levels) {
		stipple_quadtree_clear(q);
		q->key = large_new((size_t)texels * sizeof *q->key);
		q->levels = levels;
	}
#pragma omp parallel for schedule(static) if (!single_thread)
	for (ptrdiff_t n = 0; n < texels; n++)
		q->key[n] = STIPPLE_EMPTY;
}

/* Formula (1): a texel of level l - 1 is the least of four of level l. */
static void fill_row(struct stipple_quadtree *q, uint32_t level, uint32_t row)
{
	int32_t *to = q->key + stipple_quadtree_place(q->levels, level - 1, 0, 0) +
		      ((size_t)row << (q->levels + 1));
	const int32_t *from = q->key + stipple_quadtree_place(q->levels, level, 0, 0) +
			      ((size_t)(2 * row) << (q->levels + 1)),
		      *below = from + ((size_t)2 << q->levels);
	for (uint32_t x = 0; x < 1u << (level - 1); x++)
		to[x] = MIN(MIN(from[2 * x], from[2 * x + 1]), MIN(below[2 * x], below[2 * x + 1]));
}

void stipple_quadtree_fill(struct stipple_quadtree *q, bool single_thread)
{
	for (uint32_t level = q->levels; level > 0; level--) {
#pragma omp parallel for schedule(static) if (!single_thread && level > 6)
		for (uint32_t row = 0; row < 1u << (level - 1); row++)
			fill_row(q, level, row);
	}
}

void stipple_quadtree_clear(struct stipple_quadtree *q)
{
	large_free(q->key);
	*q = (struct stipple_quadtree){ 0 };
}
