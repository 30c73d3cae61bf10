#define LANES_MAY_BE_WIDE
#include "render/scene-list.h"
#include "render/stroke-pack-lanes.h"
#include "render/stroke-queue.h"
#include "render/surface-lanes.h"
#include <string.h>

/* Strokes along an edge that comes towards the camera are shorter, down to this part. */
#define FORESHORTENED 0.25f

/* ---- along what ---- */

INLINE bool goes_along(const struct brush *b)
{
	int32_t direction = b->layer->ink.direction;
	return (direction == DIRECTION_LINE && b->kind >= FEATURE_UNDIRECTED) ||
	       (direction == DIRECTION_EDGE && b->kind == FEATURE_DIRECTED);
}

/* Strokes that go along lines; the others lie at the layer's own angle. */
struct line_lanes {
	vi are_there;
	vf along[2], shorter, slope;
};

INLINE void put_line(const struct brush *b, const struct candidate *c, const struct line *line,
	int k, struct line_lanes *to)
{
	float whole = b->lens.focal_px / LENS_SCALE_M(&b->lens, c->depth_m);
	to->are_there[k] = -1;
	to->shorter[k] = CLAMP(2 * line->px_per_m / whole, FORESHORTENED, 1);
	to->slope[k] = line->slope;
	for (int n = 0; n < 2; n++)
		to->along[n][k] = line->along[n];
}

/* ---- the strokes ---- */

struct pen_lanes {
	vf along[2], half_length_px, half_width_px, q, slope[2];
	vi rgb; /* 0 above */
};

INLINE vi byte_of(vf level, int place)
{
	return __builtin_convertvector(least(most(level, all(0)), all(255)), vi) << 8 * place;
}

INLINE vi colours_of(const struct brush *b, const struct lane_candidates *c)
{
	const struct ink_step *ink = &b->layer->ink;
	vi own = (vi)all(0) + (ink->ink[0] | ink->ink[1] << 8 | ink->ink[2] << 16),
	   ret = (vi)all(0);
	if (ink->colour != COLOUR_POINT)
		return own;
	vi rgba = gather(b->f->scene->rgba, c->point, 4);
	vf grey = __builtin_convertvector(lightness_of(rgba), vf), lit = all(1);
	if (b->layer->lit == LIT_COLOUR)
		lit = 1 - b->f->light.amount * (1 - diffuse_of(b, c));
	for (int k = 0; k < 3; k++) {
		vf level = __builtin_convertvector(rgba >> 8 * k & 255, vf);
		ret |= byte_of(lit * (grey + ink->saturation * (level - grey)) + 0.5f, k);
	}
	return (vi)choose((rgba >> 24 & 255) != 0, (vf)ret, (vf)own);
}

/* lines NULL: none has one. */
INLINE struct pen_lanes pens_of(const struct brush *b, const struct lane_candidates *c, vf growth,
	const struct line_lanes *lines)
{
	const struct ink_step *ink = &b->layer->ink;
	struct pen_lanes p = { .half_width_px = growth * ink->width_px * 0.5f,
		.q = 1 / c->depth_m,
		.rgb = colours_of(b, c) };
	vf vary = 1 + ink->length_variation *
			      lanes_around_zero(c->id, stroke_salt(c->copy, SALT_LENGTH));
	vf along[2] = { all(b->layer->own_way[0]), all(b->layer->own_way[1]) };
	p.half_length_px = growth * ink->length_px * 0.5f * vary;
	plane_slopes(b, c, p.half_length_px, p.slope);
	if (lines) {
		for (int k = 0; k < 2; k++) {
			vf slope = lines->slope * lines->along[k];
			p.slope[k] = choose(lines->are_there, slope, p.slope[k]);
			along[k] = choose(lines->are_there, lines->along[k], along[k]);
		}
		p.half_length_px *= choose(lines->are_there, lines->shorter, all(1));
	}
	vi n = __builtin_convertvector(
		lanes_chance(c->id, stroke_salt(c->copy, SALT_ANGLE)) * 256, vi);
	vf cosine = (vf)gather(b->layer->turn, 2 * n, 4),
	   sine = (vf)gather(&b->layer->turn[0][1], 2 * n, 4);
	p.along[0] = along[0] * cosine - along[1] * sine;
	p.along[1] = along[0] * sine + along[1] * cosine;
	return p;
}

/* stroke_pack() */
INLINE void pack_lanes(
	const struct lane_candidates *c, const struct pen_lanes *p, vf alpha, vi ret[STROKE_WORDS])
{
	ret[STROKE_X] = (vi)c->x_px;
	ret[STROKE_Y] = (vi)c->y_px;
	ret[STROKE_ALONG_BOTH] = packed_along(p->along[0]) | packed_along(p->along[1]) << 16;
	ret[STROKE_HALVES] = packed_length(p->half_length_px) | packed_length(p->half_width_px)
									<< 16;
	ret[STROKE_Q] = (vi)p->q;
	ret[STROKE_SLOPES] = packed_slope(p->slope[0]) | packed_slope(p->slope[1]) << 16;
	ret[STROKE_RGB_COPY] = p->rgb | (int32_t)(c->copy << 24);
	ret[STROKE_ALPHA_LAY_ASLANT] = __builtin_convertvector(alpha * STROKE_ALPHA + 0.5f, vi);
	ret[STROKE_POINT] = c->id;
}

INLINE void put_strokes(const struct brush *b, const struct lane_candidates *c, unsigned which,
	vf alpha, vf growth, const struct line_lanes *lines, struct stroke_chain *to)
{
	struct stroke_block *block = block_of(to, (uint32_t)__builtin_popcount(which));
	struct pen_lanes p = pens_of(b, c, growth, lines);
	vi packed[STROKE_WORDS];
	pack_lanes(c, &p, alpha, packed);
	for (; which; which &= which - 1) {
		const uint32_t *from =
			(const uint32_t *)(const void *)packed + __builtin_ctz(which);
		struct stroke_packed *s = &block->stroke[block->count++];
		for (int n = 0; n < STROKE_WORDS; n++)
			s->word[n] = from[n * LANES];
	}
}

/* ---- which of them ---- */

INLINE void try_on_edges(const struct brush *b, struct lane_candidates *l, struct stroke_chain *to)
{
	find_normals(b, gather(b->f->scene->normal, l->point, 4), l);
	l->is_flat = ~has_no_normal(l);
	l->away = away_of(b, l);
	vf whole = opacity_of(b, l), larger = enlarged(b, l), alpha = all(0);
	struct line_lanes lines = { .are_there = (vi)all(0) };
	for (unsigned left = l->left & bits(whole >= ALPHA_LEAST); left; left &= left - 1) {
		int k = __builtin_ctz(left);
		struct candidate c = candidate_of(l, k);
		struct line line;
		if (!line_of(b, &c, &line))
			continue;
		float octaves = stroke_fade_octaves(c.depth_m),
		      need = need_along(b, &c, &line) * STROKE_FADE_MORE(octaves) / larger[k];
		alpha[k] = whole[k] * stroke_fade(c.rank, need, octaves);
		put_line(b, &c, &line, k, &lines);
	}
	unsigned which = bits(alpha >= ALPHA_LEAST);
	if (which)
		put_strokes(b, l, which, alpha, larger, goes_along(b) ? &lines : NULL, to);
}

INLINE void try_on_surface(
	const struct brush *b, struct lane_candidates *l, struct stroke_chain *to)
{
	find_need(b, hides_backs(b), l);
	if (!l->left)
		return;
	vf need = l->need * STROKE_FADE_MORE(l->octaves);
	vf alpha = opacity_of(b, l) * fade_of(l->rank, need, l->octaves);
	unsigned which = l->left & bits(alpha >= ALPHA_LEAST);
	if (!which)
		return;
	struct line_lanes lines = { .are_there = (vi)all(0) };
	for (unsigned left = goes_along(b) ? which : 0; left; left &= left - 1) {
		int k = __builtin_ctz(left);
		struct candidate c = candidate_of(l, k);
		struct line line;
		if (line_of(b, &c, &line))
			put_line(b, &c, &line, k, &lines);
	}
	put_strokes(b, l, which, alpha, growth_of(b, l) * enlarged(b, l),
		goes_along(b) ? &lines : NULL, to);
}

/* ---- a chunk's points ---- */

/* No key of a point is above it that is wanted behind dithering points: of per_m2 points where it is, which are least_per_m2 or more, its place
 * is before + rank (per_m2 - before), as find_place() has it, which is to be below wanted. So rank per_m2, its key, is highest where there
 * are the fewest points. */
static float key_behind(float wanted, float before, float least_per_m2)
{
	if (least_per_m2 <= wanted)
		return wanted;
	return before < wanted ? (wanted - before) * least_per_m2 / (least_per_m2 - before) : 0;
}

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
	if (b->before_per_m2 > 0)
		ret = key_behind(
			ret, b->before_per_m2, 1 / (c->spacing_most_m * c->spacing_most_m));
	return b->kind == FEATURE_DIRECTED ? ret * c->spacing_most_m / scene_list_along(c) : ret;
}

/* Places in the list from which on points are fetched, before they are looked at. */
#define AHEAD (3 * LANES)

INLINE void fetch_places(const struct brush *b, uint32_t i, uint32_t end)
{
	const scene *s = b->f->scene;
	uint32_t first = b->view->chunk->first, at = first + i;
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
	uint32_t at = chunk->first + i;
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
INLINE void try_copies(
	const struct brush *b, struct lane_candidates c[VECTORS], struct stroke_chain *to)
{
	vf copies[VECTORS];
	for (int n = 0; n < VECTORS; n++) {
		find_wanted(b, &c[n]);
		copies[n] = copies_of(b, &c[n]);
	}
	do
		for (int n = 0; n < VECTORS; n++) {
			struct lane_candidates one = c[n];
			if (one.left)
				try_on_surface(b, &one, to);
		}
	while (group_next_copy(c, copies));
}

INLINE void try_group(const struct brush *b, const struct queue *q, uint32_t at, uint32_t end,
	struct stroke_chain *to)
{
	struct lane_candidates c[VECTORS];
	find_group(b, q, at, end, c);
	if (!is_on_edge(b)) {
		try_copies(b, c, to);
		return;
	}
	for (int n = 0; n < VECTORS; n++)
		try_on_edges(b, &c[n], to);
}

/* As many of them as there are groups of, or all. */
INLINE void try_queue(const struct brush *b, struct queue *q, uint32_t end, struct stroke_chain *to)
{
	for (uint32_t at = 0; at < end; at += GROUP)
		try_group(b, q, at, end, to);
	queue_move_up(q, end);
}

INLINE void try_tone(
	const struct brush *all, uint32_t tone, struct queue *q, struct stroke_chain *to)
{
	struct brush b = *all;
	b.wanted_most = b.layer->wanted_of_tone[b.kind][tone] * b.ray_most;
	b.before_per_m2 = b.layer->before_of_tone[b.kind][tone] * b.view->chunk->part;
	uint32_t i = scene_list_begin(b.view->chunk, b.kind, tone), end = i;
	float key = key_most(&b);
	if (key > 0)
		end = scene_list_end(b.view->chunk, b.kind, tone, key);
	for (; i < end; i += LANES) {
		struct lane_candidates c;
		fetch_places(&b, i + AHEAD, end);
		find_candidates(&b, i, end, &c);
		if (c.left)
			put_in_queue(&b, &c, q);
		if (q->count >= QUEUE)
			try_queue(&b, q, QUEUE, to);
	}
}

void LANES_NAME(stroke_choose)(const struct brush *b, struct stroke_chain *to)
{
	struct queue q = { 0 };
	for (uint32_t tone = 0; tone < SCENE_LIST_TONES; tone++)
		try_tone(b, tone, &q, to);
	try_queue(b, &q, q.count, to);
}
