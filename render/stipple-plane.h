#ifndef RENDER_STIPPLE_PLANE_H
#define RENDER_STIPPLE_PLANE_H
/* The planes that stippling (stipple.h) puts points on: one the eye sees, one the light sees. A point there is a texel and a key.
 *
 * A key has the point's depth in its upper bits, so that the least one is the nearest, and below it some that depend on the point
 * alone: of points as deep one is the least, the same whatever comes first, and a texel tells whose key it holds. A depth is
 * counted in steps of the bits of a float, which are about as large a part of it everywhere.
 *
 * Around what is to be seen there is a border: points outside still hide and are seen, so that nothing begins at the edge. */
#include "render/chunk-view.h"

#define STIPPLE_TIE_BITS   12
#define STIPPLE_DEPTH_MOST ((1 << 17) - 1) /* of points; what is spread is deeper */
#define STIPPLE_EMPTY      0x40000000      /* above all keys */
#define STIPPLE_BORDER     8
/* Points come no nearer to the outer edge: what is read around them is there. */
#define STIPPLE_RINGS_MOST 2

struct stipple_plane {
	int32_t columns, rows, pitch; /* with the border */
	bool is_parallel;             /* or all rays come from one place */
	float scale;                  /* texels to a metre; or at a depth of 1 */
	float middle[2];              /* of the axis, in texels */
	float near_m, far_m;          /* nothing nearer is seen, or farther */
	int32_t low, shift;           /* of a depth's bits */
	int32_t step;                 /* what a pass adds to a key */
	uint32_t passes;
};

/* Texels that are as wide at the depth of 1 as scale says, or everywhere; all depths of points that are seen are from near_m to far_m. */
void stipple_plane_set_depths(struct stipple_plane *p, float near_m, float far_m, float behind_px);
/* So many columns and rows of it are to be seen. */
void stipple_plane_set_size(struct stipple_plane *p, int32_t columns, int32_t rows);

/* A chunk as a camera sees it that need not have it in view; only where its points are, and how deep. */
void stipple_plane_view(const struct camera *c, const scene *s, const struct scene_chunk *chunk,
	struct chunk_view *ret);

/* The first points of a chunk, count of them: the texel, row by row, or -1 where it is outside; and the key. Writes whole vectors. */
LANES_DECLARE(void, stipple_project,
	(const struct stipple_plane *p, const scene *s, const struct chunk_view *v, uint32_t count,
		int32_t *ret_place, int32_t *ret_key));

#endif
