#ifndef RENDER_STIPPLE_PLAN_H
#define RENDER_STIPPLE_PLAN_H
/* What a layer of stippling (stipple.h) puts on which planes, the same for both backends: which points take part, where the light
 * stands and what it sees, what the eye sees. */
#include "render/stipple-plane.h"

/* Where dots may grow: so many diameters between points are just right. */
#define STIPPLE_APART 1.5f

typedef struct stipple_plan stipple_plan;
struct stipple_plan {
	uint64_t serial; /* the frame's */
	uint32_t turn;   /* the scene's */
	uint32_t layer;
	/* [chunks + 1]: the slot of each chunk's first point that takes part, a multiple of LANES; and how many do, its first ones. */
	uint32_t *slot, *part;
	float *spacing_m; /* [chunks]: of these from each other */
	float apart_m;    /* the same of a point whose spacing in the scene is 1 */
	bool *is_lit;     /* [chunks]: the light sees it, for something like this is drawn of it */
	/* A texel of the light's plane is one of level n. */
	uint32_t levels, level;
	struct camera light;
	struct stipple_plane light_plane;
	float *light_scale; /* [chunks]: texels of it to a metre */
};
/* Of all but the camera. */
stipple_plan *stipple_plan_new(const frame *f, uint32_t layer);
/* NULL: of none. */
static inline bool stipple_plan_is_of(const stipple_plan *p, const frame *f, uint32_t layer)
{
	return p && p->serial == f->serial && p->turn == f->scene->turn && p->layer == layer;
}
void stipple_plan_free(stipple_plan *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(stipple_plan, stipple_plan_free)

/* Of the picture: a texel is a pixel of a picture 1200 px high, whatever its size, so that all sizes look the same; of one that is
 * drawn coarser, more. */
struct stipple_plane stipple_plan_eye(
	const stipple_plan *p, const frame *f, const struct chunk_view *views, uint32_t count);

#endif
