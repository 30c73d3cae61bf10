#include "render/scene-list.h"
#include "render/stroke-shows.h"
#include <string.h>

/* Strokes along an edge that comes towards the camera are shorter, down to this part. */
#define FORESHORTENED 0.25f

/* ---- the stroke ---- */

INLINE void colour_of(const struct brush *b, const struct candidate *c, uint8_t ret[3])
{
	const struct frame_light *light = &b->f->light;
	const struct ink_step *ink = &b->layer->ink;
	const uint8_t *rgba = b->f->scene->rgba[c->point];
	memcpy(ret, ink->ink, 3);
	if (ink->colour != COLOUR_POINT || !rgba[3])
		return;
	float grey = scene_lightness(rgba), lit = 1;
	if (b->layer->lit == LIT_COLOUR)
		lit = 1 - light->amount * (1 - frame_diffuse(light, c->normal));
	for (int k = 0; k < 3; k++)
		ret[k] = (uint8_t)CLAMP(
			lit * (grey + ink->saturation * (rgba[k] - grey)) + 0.5f, 0, 255);
}

INLINE void turn_along(const struct brush *b, struct stroke *s, const float along[2])
{
	const float *turn = b->layer->turn[(
		int)(stroke_chance(s->point, stroke_salt(s->copy, SALT_ANGLE)) * 256)];
	s->along[0] = along[0] * turn[0] - along[1] * turn[1];
	s->along[1] = along[0] * turn[1] + along[1] * turn[0];
}

/* line NULL: at the layer's own angle; not flat: of one depth. Part by part, where it is to be: a whole that is made elsewhere is waited for
 * when it is copied. */
INLINE void put_stroke(const struct brush *b, const struct candidate *c, float alpha, float growth,
	const struct line *line, bool is_flat, struct stroke *s)
{
	const struct ink_step *ink = &b->layer->ink;
	s->x_px = c->x_px;
	s->y_px = c->y_px;
	s->alpha = alpha;
	s->point = c->id;
	s->copy = (uint8_t)c->copy;
	s->lay = s->aslant = 0;
	s->slope[0] = s->slope[1] = 0;
	float half_px =
		growth * ink->length_px / 2 *
		(1 + ink->length_variation * around_zero(c->id, stroke_salt(c->copy, SALT_LENGTH)));
	s->half_width_px = growth * ink->width_px / 2;
	s->q = 1 / c->depth_m;
	if (line) {
		float whole = b->lens.focal_px / LENS_SCALE_M(&b->lens, c->depth_m);
		half_px *= CLAMP(2 * line->px_per_m / whole, FORESHORTENED, 1);
		turn_along(b, s, line->along);
		for (int k = 0; k < 2; k++)
			s->slope[k] = line->slope * line->along[k];
	} else {
		turn_along(b, s, b->layer->own_way);
		if (is_flat)
			plane_slope(b, c, half_px, s->slope);
	}
	s->half_length_px = half_px;
	colour_of(b, c, s->rgb);
}

INLINE bool goes_along(const struct brush *b)
{
	int32_t direction = b->layer->ink.direction;
	return (direction == DIRECTION_LINE && b->kind >= FEATURE_UNDIRECTED) ||
	       (direction == DIRECTION_EDGE && b->kind == FEATURE_DIRECTED);
}

INLINE void try_on_edges(const struct brush *b, struct lane_candidates *l, struct stroke_chain *to)
{
	find_normals(b, gather(b->f->scene->normal, l->point, 4), l);
	l->away = away_of(b, l);
	vf whole = opacity_of(b, l), larger = enlarged(b, l);
	struct stroke_block *block = block_of(to, LANES);
	for (unsigned left = l->left & bits(whole >= ALPHA_LEAST); left; left &= left - 1) {
		int k = __builtin_ctz(left);
		struct candidate c = candidate_of(l, k);
		struct line line;
		if (!line_of(b, &c, &line))
			continue;
		float octaves = stroke_fade_octaves(c.depth_m),
		      need = need_along(b, &c, &line) * STROKE_FADE_MORE(octaves) / larger[k];
		float alpha = whole[k] * stroke_fade(c.rank, need, octaves);
		if (alpha < ALPHA_LEAST)
			continue;
		put_stroke(b, &c, alpha, larger[k], goes_along(b) ? &line : NULL, true,
			&block->stroke[block->count++]);
	}
}

INLINE void try_on_surface(
	const struct brush *b, struct lane_candidates *l, struct stroke_chain *to)
{
	find_need(b, hides_backs(b), l);
	if (!l->left)
		return;
	vf need = l->need * STROKE_FADE_MORE(l->octaves);
	vf alpha = opacity_of(b, l) * fade_of(l->rank, need, l->octaves);
	vf larger = enlarged(b, l);
	vf short_of = l->need / (l->last * copies_of(b, l));
	struct stroke_block *block = block_of(to, LANES);
	for (unsigned left = l->left & bits(alpha >= ALPHA_LEAST); left; left &= left - 1) {
		int k = __builtin_ctz(left);
		struct candidate c = candidate_of(l, k);
		struct line line;
		bool has_line = goes_along(b) && line_of(b, &c, &line);
		put_stroke(b, &c, alpha[k],
			MIN(stroke_growth(short_of[k]), b->layer->ink.grow) * larger[k],
			has_line ? &line : NULL, l->is_flat[k], &block->stroke[block->count++]);
	}
}

/* ---- a chunk's points ---- */

/* No point with a key above it (scene-list.h) is drawn. */
static float key_most(const struct brush *b)
{
	const struct scene_chunk *c = b->view->chunk;
	float nearest_m = fmaxf(b->view->near_m - b->moved_m, b->lens.near_m);
	float more = STROKE_FADE_MORE(stroke_fade_octaves(nearest_m));
	float px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, nearest_m);
	if (is_on_edge(b))
		return more * px_per_m * b->ray_most /
		       (b->layer->ink.spacing_px * STROKE_FADE_MEAN);
	/* Those that are drawn by the spacing of all points, or as dithering points alone, have no higher keys by their own. */
	float ret = more * b->wanted_most * px_per_m * px_per_m;
	return b->kind == FEATURE_DIRECTED ? ret * c->spacing_most_m / scene_list_along(c) : ret;
}

/* Places in the list from which on points are fetched, before they are looked at. */
#define AHEAD (3 * LANES)

INLINE void fetch_places(const struct brush *b, uint32_t i, uint32_t end)
{
	const scene *s = b->f->scene;
	uint32_t first = b->view->chunk->first, at = first + b->list_from + i;
	for (uint32_t k = 0; k < LANES && i + LANES <= end; k++)
		__builtin_prefetch(&s->place[first + scene_list_index(s->list[at + k])]);
}

/* scene_list_spacing_m() to a unit. */
INLINE vf farther_of(const struct brush *b, vi entry)
{
	float along = b->kind == FEATURE_DIRECTED ? scene_list_along(b->view->chunk) : 1;
	vi steps = (vi)((vu)entry >> 2 * SCENE_LIST_BITS);
	vf times = (vf)((int32_t)SCENE_LIST_NEAR + steps * (int32_t)SCENE_LIST_STEP);
	return times * (along * b->f->scene->unit_m);
}

/* Those from i on of the list. */
INLINE void find_candidates(
	const struct brush *b, uint32_t i, uint32_t end, struct lane_candidates *c)
{
	const scene *s = b->f->scene;
	const struct scene_chunk *chunk = b->view->chunk;
	uint32_t at = chunk->first + b->list_from + i;
	vi entry = load_mask((const int32_t *)s->list + at);
	const int32_t low = (1 << SCENE_LIST_BITS) - 1;
	c->point = (int32_t)chunk->first + (entry & low);
	struct lane_places p = gather_places(s->place, c->point);
	struct lane_points l = project_lanes(b->view, p.q, &b->lens);
	c->copy = 0;
	c->x_px = l.x_px;
	c->y_px = l.y_px;
	c->depth_m = l.depth_m;
	c->rank = (__builtin_convertvector(entry >> SCENE_LIST_BITS & low, vf) + 0.5f) *
		  (1.f / (float)b->list_count);
	c->spacing_m = has_own_spacing(b) ? p.spacing * farther_of(b, entry)
					  : most(p.spacing * s->unit_m, all(b->dither_m));
	c->left = end - i < LANES ? (1u << (end - i)) - 1 : LANES_ALL;
	c->left &= promising(b, &l, c);
}

/* The points themselves too. */
INLINE void try_copies(const struct brush *b, struct lane_candidates *c, struct stroke_chain *to)
{
	find_wanted(b, c);
	vf copies = copies_of(b, c);
	for (; c->left && c->copy < b->copies; c->copy++) {
		struct lane_candidates one = *c;
		try_on_surface(b, &one, to);
		c->rank += c->last;
		c->left &= bits((c->rank < c->most) & ((float)c->copy + 1 < copies));
	}
}

/* Most points of a chunk are soon told to be no strokes. The others wait until there are some, so that all lanes have work, and what is
 * known of them is on its way meanwhile. */
#define QUEUE 64
struct queue {
	uint32_t count;
	int32_t point[QUEUE + LANES];
	float rank[QUEUE + LANES], spacing_m[QUEUE + LANES];
	float x_px[QUEUE + LANES], y_px[QUEUE + LANES], depth_m[QUEUE + LANES];
};

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

/* Eight of them, or the last ones. */
INLINE struct lane_candidates from_queue(const struct queue *q, uint32_t at)
{
	uint32_t left = q->count - at;
	struct lane_candidates c = { .point = load_mask(q->point + at),
		.rank = load(q->rank + at),
		.spacing_m = load(q->spacing_m + at),
		.x_px = load(q->x_px + at),
		.y_px = load(q->y_px + at),
		.depth_m = load(q->depth_m + at),
		.left = left < LANES ? (1u << left) - 1 : LANES_ALL };
	return c;
}

INLINE void try_queue(const struct brush *b, struct queue *q, struct stroke_chain *to)
{
	for (uint32_t at = 0; at < q->count; at += LANES) {
		struct lane_candidates c = from_queue(q, at);
		find_ids(b, &c);
		if (is_on_edge(b))
			try_on_edges(b, &c, to);
		else
			try_copies(b, &c, to);
	}
	q->count = 0;
}

void LANES_NAME(stroke_choose)(const struct brush *b, struct stroke_chain *to)
{
	uint32_t end = scene_list_end(b->view->chunk, b->kind, key_most(b)) - b->list_from;
	/* Lanes behind the last one are of some point, too. */
	struct queue q = { 0 };
	for (uint32_t i = 0; i < end; i += LANES) {
		struct lane_candidates c;
		fetch_places(b, i + AHEAD, end);
		find_candidates(b, i, end, &c);
		if (c.left)
			put_in_queue(b, &c, &q);
		if (q.count >= QUEUE - LANES)
			try_queue(b, &q, to);
	}
	try_queue(b, &q, to);
}
