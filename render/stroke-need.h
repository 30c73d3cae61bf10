#ifndef RENDER_STROKE_NEED_H
#define RENDER_STROKE_NEED_H
/* How many strokes are wanted where a point is, and its place among the points that there are (stroke.h). Internal to stroke.c; all is
 * inlined. */
#include "render/stroke-brush.h"

/* Those of edges are as dense along them; but where a tone is shown they are surface like all other points. */
static inline bool is_on_edge(const struct brush *b)
{
	return b->kind == FEATURE_DIRECTED && !b->layer->is_queue;
}

/* Points that come after dithering points, as dense as all points are. */
static inline bool shares_queue(const struct brush *b)
{
	return b->kind != FEATURE_DITHER && b->layer->is_queue;
}

/* Strokes wanted to a square metre of its surface. */
static inline float need_on_surface(const struct brush *b, const struct candidate *c, float cosine)
{
	float px_per_m = b->focal_px / c->depth_m;
	uint8_t lightness = scene_lightness(b->f->scene->rgba[c->point]);
	return b->layer->wanted_per_px[lightness] * px_per_m * px_per_m * cosine;
}

/* Its place among the points that a layer draws there, as points to a square metre before it, and the last one's. Where a tone is
 * shown all other points come after the dithering points, in one queue with them. */
struct place {
	float rank, last;
};

static inline struct place place_of(const struct brush *b, const struct candidate *c)
{
	float per_m2 = 1 / (c->spacing_m * c->spacing_m);
	if (!b->layer->is_queue)
		return (struct place){ c->rank * per_m2, per_m2 };
	const scene *s = b->f->scene;
	float there = b->layer->dithering_per_m2[scene_lightness(s->rgba[c->point])],
	      spacing_m = s->spacing[c->point] * UNIT_M, last = there + 1 / (spacing_m * spacing_m);
	if (b->kind == FEATURE_DITHER)
		return (struct place){ c->rank * there, last };
	return (struct place){ there + c->rank * (last - there), last };
}

static inline float need_along(
	const struct brush *b, const struct candidate *c, const struct line *l)
{
	return l->px_per_m * c->spacing_m / (b->layer->ink.spacing_px * STROKE_FADE_MEAN);
}

#endif
