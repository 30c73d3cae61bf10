#ifndef RENDER_MASK_H
#define RENDER_MASK_H
/* The visibility mask (Xu & Chen 2004, sections 6.1 and 7.1): how deep each pixel is covered, by all points as discs of their own
 * projected size, pushed back along the ray a little. Where points are denser than pixels, a part of each chunk's points stands for
 * all, by the same rank test as strokes have (7.4), as larger discs.
 *
 * A pixel's key has the bits of its depth, a float of metres along the optical axis, but for the last MASK_PIPELINE_BITS, which
 * say the pipeline of the point. So the least key is the nearest point, and the same one in whatever order they come. */
#include "render/chunk-view.h"

#define MASK_PIPELINE_BITS 8
#define MASK_EMPTY         0x7f7fff00 /* nothing there */
#define MASK_MARGIN        16         /* pixels around, so that vectors may reach over the edge */
/* Discs of less than this are the one pixel that their middle is in: they stand closer than pixels do. */
#define MASK_DOT_RADIUS 0.8f
/* What lies deeper than its neighbours on both sides, by more than this factor, is seen through a hole of a pixel or two, and is
 * filled. */
#define MASK_HOLE 1.05f

typedef struct visibility_mask visibility_mask;
struct visibility_mask {
	uint32_t width, height, pitch;
	int32_t *key; /* of pixel 0 0, in the first part */
	void *memory; /* of the parts */
	/* How deep the deepest pixel of each tile is: what is behind that everywhere needs not be looked at. */
	uint32_t tiles_across, tiles_down;
	float *deepest_m;
	/* A picture of keys for each thread that draws. */
	uint32_t threads;
	int32_t **part;
	struct plane_views *planes; /* plane-view.h: those in it; NULL: none */
	uint32_t chunks_hidden;     /* that were not drawn, because what was there hid them */
};
/* Draws it: the nearer half of the points, then of the other half those chunks that are not hidden by it. Uses a picture of keys for
 * each thread. views: from near to far. The same with and without what is left out. */
visibility_mask *visibility_mask_new(
	const frame *f, const struct chunk_view *views, uint32_t count);
/* The same in the memory of m, which is another frame's or NULL, where its size is right; returns that or a new one. */
visibility_mask *visibility_mask_renew(
	visibility_mask *m, const frame *f, const struct chunk_view *views, uint32_t count);
void visibility_mask_free(visibility_mask *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(visibility_mask, visibility_mask_free)

/* Makes into, or a new one where it is NULL or of another size, the mask of both: what is nearer in either. add NULL: nothing, which a
 * mask is made of. */
visibility_mask *visibility_mask_join(
	visibility_mask *into, const frame *f, const visibility_mask *add);

#define MASK_TILE 16 /* pixels a side */
/* Whether all of the chunk is farther behind what is seen than this part of the depth: conservative. */
bool mask_hides(const visibility_mask *m, const struct chunk_view *v, float behind);
/* Whether any disc of it may reach into rows from .. end and show there. */
bool mask_may_show(
	const visibility_mask *m, const struct chunk_view *v, uint32_t from, uint32_t end);

static inline int32_t mask_key(const visibility_mask *m, int32_t x, int32_t y)
{
	return m->key[(ptrdiff_t)y * m->pitch + x];
}

static inline float mask_depth(int32_t key)
{
	union {
		int32_t bits;
		float depth_m;
	} u = { key & ~((1 << MASK_PIPELINE_BITS) - 1) };
	return u.depth_m;
}

#endif
