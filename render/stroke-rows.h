#ifndef RENDER_STROKE_ROWS_H
#define RENDER_STROKE_ROWS_H
/* The points of a chunk as they stand, in the order of their ranks, eight in a row: for layers that take all kinds of points as surface.
 * Internal to hatch-lanes.c, contour-lanes.c and paint-lanes.c; all is inlined. */
#include "render/stroke-shows.h"

/* No rank above it is drawn. */
INLINE float row_need_most(const struct brush *b)
{
	const struct scene_chunk *c = b->view->chunk;
	float nearest_m = fmaxf(b->view->near_m - b->moved_m, b->lens.near_m);
	float scale = b->lens.focal_px / LENS_SCALE_M(&b->lens, nearest_m) * c->spacing_most_m;
	return STROKE_FADE_MORE(stroke_fade_octaves(nearest_m)) * b->wanted_most * scale * scale;
}

INLINE unsigned row_kinds(const struct brush *b, uint32_t at)
{
	unsigned ret = 0;
	for (unsigned k = 0; k < LANES; k++)
		ret |= (b->layer->kinds >> b->f->scene->kind[at + k] & 1) << k;
	return ret;
}

/* Those from i on, in the order of ranks. */
INLINE void row_candidates(
	const struct brush *b, uint32_t i, uint32_t end, struct lane_candidates *c)
{
	const scene *s = b->f->scene;
	uint32_t at = b->view->chunk->first + i;
	struct lane_places p = load_places(s->place + at);
	struct lane_points l = project_lanes(b->view, p.q, &b->lens);
	c->point = (int32_t)at + __builtin_convertvector(lane_number, vi);
	c->copy = 0;
	c->x_px = l.x_px;
	c->y_px = l.y_px;
	c->depth_m = l.depth_m;
	c->rank = ((float)i + 0.5f + lane_number) * (1.f / (float)b->list_count);
	c->spacing_m = p.spacing * s->unit_m;
	c->left = end - i < LANES ? (1u << (end - i)) - 1 : LANES_ALL;
	c->left &= promising(b, &l, c);
	if (c->left && b->layer->ink.points != INK_ALL)
		c->left &= row_kinds(b, at);
}

/* Where a walk through the rows is: at is the place in the scene of the row that it came to, what comes is in the chunk. */
struct row_walk {
	uint32_t at, next, end;
};

INLINE struct row_walk row_walk_of(const struct brush *b)
{
	float count = (float)b->list_count;
	return (struct row_walk){ .end = (uint32_t)MIN(row_need_most(b) * count + 1, count) };
}

/* The next ones side by side that may give strokes; false: there are no more. */
INLINE bool row_next(const struct brush *b, struct row_walk *w, struct lane_candidates *c)
{
	while (w->next < w->end) {
		w->at = b->view->chunk->first + w->next;
		row_candidates(b, w->next, w->end, c);
		w->next += LANES;
		if (c->left)
			return true;
	}
	return false;
}

#endif
