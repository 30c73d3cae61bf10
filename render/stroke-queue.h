#ifndef RENDER_STROKE_QUEUE_H
#define RENDER_STROKE_QUEUE_H
/* Points of a chunk that may become strokes, as they wait to be looked at closely. Internal to stroke-lanes.c and paint-lanes.c; all is
 * inlined.
 *
 * Most points of a chunk are soon told to be no strokes. The others wait until there are some, so that all lanes have work, and what is
 * known of them is on its way meanwhile. */
#include "render/stroke-shows.h"

#define QUEUE      64
#define QUEUE_MOST (QUEUE + 2 * LANES)
/* Points that are looked at together, however many lanes there are, so that strokes come in the same order. */
#define GROUP   16
#define VECTORS (GROUP / LANES)

/* Zero at first: lanes behind the last one are of some point, too. */
struct queue {
	uint32_t count;
	int32_t point[QUEUE_MOST];
	float rank[QUEUE_MOST], spacing_m[QUEUE_MOST];
	float x_px[QUEUE_MOST], y_px[QUEUE_MOST], depth_m[QUEUE_MOST];
};

/* Those that are left. */
INLINE void put_in_queue(const struct brush *b, const struct lane_candidates *c, struct queue *q)
{
	const scene *s = b->f->scene;
	vi order = order_of(c->left);
	store((float *)q->point + q->count, put_in_order((vf)c->point, order));
	store(q->rank + q->count, put_in_order(c->rank, order));
	store(q->spacing_m + q->count, put_in_order(c->spacing_m, order));
	store(q->x_px + q->count, put_in_order(c->x_px, order));
	store(q->y_px + q->count, put_in_order(c->y_px, order));
	store(q->depth_m + q->count, put_in_order(c->depth_m, order));
	q->count += (uint32_t)__builtin_popcount(c->left);
	fetch(b, c);
	for (unsigned left = c->left; left; left &= left - 1) {
		int32_t point = c->point[__builtin_ctz(left)];
		__builtin_prefetch(&s->normal[point]);
		__builtin_prefetch(&s->rgba[point]);
		__builtin_prefetch(&s->degree[point]);
	}
}

/* So many as there are lanes, or the last ones before end. */
INLINE struct lane_candidates from_queue(const struct queue *q, uint32_t at, uint32_t end)
{
	uint32_t left = end > at ? end - at : 0;
	struct lane_candidates c = { .point = load_mask(q->point + at),
		.rank = load(q->rank + at),
		.spacing_m = load(q->spacing_m + at),
		.x_px = load(q->x_px + at),
		.y_px = load(q->y_px + at),
		.depth_m = load(q->depth_m + at),
		.left = left < LANES ? (1u << left) - 1 : LANES_ALL };
	return c;
}

/* From at on. */
INLINE void find_group(const struct brush *b, const struct queue *q, uint32_t at, uint32_t end,
	struct lane_candidates ret[VECTORS])
{
	for (uint32_t n = 0; n < VECTORS; n++) {
		ret[n] = from_queue(q, at + n * LANES, end);
		find_ids(b, &ret[n]);
	}
}

/* On to the next strokes of the group's points; false: none may give one. */
INLINE bool group_next_copy(struct lane_candidates c[VECTORS], const vf copies[VECTORS])
{
	unsigned left = 0;
	for (int n = 0; n < VECTORS; n++) {
		next_copy(&c[n], copies[n]);
		left |= c[n].left;
	}
	return left;
}

/* Those before end were looked at; those behind them move up. */
INLINE void queue_move_up(struct queue *q, uint32_t end)
{
	q->count -= end;
	store((float *)q->point, load((const float *)q->point + end));
	store(q->rank, load(q->rank + end));
	store(q->spacing_m, load(q->spacing_m + end));
	store(q->x_px, load(q->x_px + end));
	store(q->y_px, load(q->y_px + end));
	store(q->depth_m, load(q->depth_m + end));
}

#endif
