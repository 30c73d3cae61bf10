#define LANES_MAY_BE_WIDE
#include "render/paint-need.h"
#include "render/stroke-queue.h"
#include <math.h>
#include <string.h>

/* In what light warmth is neutral; how much of each channel it moves at most, of 255. */
#define WARMTH_MIDDLE 0.5f
static const float warm[3] = { 34, 8, -40 };
/* How much chance there is in warmth. */
#define WARMTH_CHANCE 0.35f
/* From as large as a cell strokes have the colour of what is around their points, from as large as so many cells that of the chunk. */
#define CELLS_AROUND 1.5f
#define CELLS_CHUNK  12.f
/* Details keep so much of their own colours. */
#define OWN_DETAIL 0.75f

/* ---- colours ---- */

/* 0..255 of the point, evened out over what its stroke covers. */
INLINE void evened(
	const struct brush *b, uint32_t point, uint32_t rgb_detail, float width_m, float ret[3])
{
	const struct frame_paint *paint = b->layer->paint;
	const uint8_t *rgba = b->f->scene->rgba[point];
	const struct scene_paint_chunk *chunk =
		scene_paint_chunk_of(paint->seen, b->f->scene, b->view->chunk);
	float detail = (float)(rgb_detail >> 24) * (1 / 255.f), cells = width_m / chunk->cell_m;
	float even = paint->step.even * (1 - OWN_DETAIL * detail);
	float around = even * CLAMP(2 * cells / CELLS_AROUND - 1, 0, 1),
	      chunks = even *
		       CLAMP((cells - CELLS_AROUND) * (1 / (CELLS_CHUNK - CELLS_AROUND)), 0, 1);
	for (int k = 0; k < 3; k++) {
		float near = (float)(rgb_detail >> 8 * k & 255);
		ret[k] = rgba[k] + around * (near - rgba[k]);
		ret[k] += chunks * (chunk->rgba[k] - ret[k]);
	}
}

/* Light is 0..1 where shade falls on it. */
INLINE void paint_colour(const struct brush *b, uint32_t point, const struct stroke *s,
	uint32_t rgb_detail, float width_m, float lit, uint8_t ret[3])
{
	const struct frame_paint *paint = b->layer->paint;
	const struct paint_step *step = &paint->step;
	float rgb[3];
	evened(b, point, rgb_detail, width_m, rgb);
	for (int k = 0; k < 3; k++)
		rgb[k] = 255 * scene_exposed(paint->exposure, rgb[k] * (1 / 255.f));
	float grey = 0.299f * rgb[0] + 0.587f * rgb[1] + 0.114f * rgb[2];
	float warmth = step->warmth * (2 * (grey * (1 / 255.f) - WARMTH_MIDDLE) +
					      WARMTH_CHANCE * around_zero(s->point, SALT_WARMTH));
	lit *= 1 + step->light_variation * around_zero(s->point, stroke_salt(s->copy, SALT_SHADE));
	for (int k = 0; k < 3; k++) {
		float full = grey + step->ink.saturation * (rgb[k] - grey);
		full = 127.5f + step->contrast * (full - 127.5f);
		full = lit * (full + warmth * warm[k]) * (1 / 255.f);
		rgb[k] = CLAMP(full, 0, 1);
	}
	float turn_deg = step->hue_variation_deg * around_zero(s->point, SALT_HUE);
	pencil_box_draw(&paint->palette, turn_deg, stroke_chance(s->point, SALT_PENCIL), rgb);
	for (int k = 0; k < 3; k++)
		ret[k] = (uint8_t)(255 * rgb[k] + 0.5f);
}

/* ---- strokes ---- */

/* Turned in the plane by the layer's angle, as all around are, and a little by chance; leaves by chance alone. */
INLINE struct way_lanes turned_way(
	const struct brush *b, const struct lane_candidates *c, const struct paint_lanes *p)
{
	vf chance = lanes_around_zero(c->id, stroke_salt(c->copy, SALT_ANGLE));
	vf by = choose(c->is_flat, 0.7f * p->wave + 0.3f * chance, chance);
	vi n = __builtin_convertvector(127.5f + 127.5f * by, vi);
	vf cosine = (vf)gather(b->layer->turn, 2 * n, 4),
	   sine = (vf)gather(&b->layer->turn[0][1], 2 * n, 4), way[3];
	for (int k = 0; k < 3; k++)
		way[k] = cosine * p->along[k] + sine * p->up[k];
	return way_on_screen(b, c, way);
}

/* How high it lies. */
INLINE uint8_t lay_of(const struct brush *b, const struct stroke *s, float size)
{
	float fine = b->layer->paint->step.fine;
	float part = fine < 1 ? (1 - size) / (1 - fine) : 0;
	float chance = stroke_chance(s->point, stroke_salt(s->copy, SALT_LAY));
	return (uint8_t)((PAINT_LAYS - 0.01f) *
			 (PAINT_LAY_RISE * s->alpha +
				 (1 - PAINT_LAY_RISE) *
					 (PAINT_LAY_FINE * part + (1 - PAINT_LAY_FINE) * chance)));
}

INLINE void write_paint(const struct brush *b, const struct lane_candidates *c,
	const struct paint_lanes *p, vf alpha, struct stroke_chain *to)
{
	const struct ink_step *ink = &b->layer->ink;
	struct way_lanes way = turned_way(b, c, p);
	vf size = paint_size(b, c, p), larger = size * paint_growth(b, c, p) * enlarged(b, c);
	vf varied = 1 + ink->length_variation *
				lanes_around_zero(c->id, stroke_salt(c->copy, SALT_LENGTH));
	vf half_length = 0.5f * ink->length_px * larger * varied * p->shorter,
	   half_width = 0.5f * ink->width_px * larger * p->aslant / p->shorter;
	half_length = most(half_length, p->shorter * paint_least(b, c, 0.5f * ink->length_px));
	half_width = most(half_width, p->aslant / p->shorter * paint_least(b, c, ink->width_px));
	vf lit = all(1), slope[2], scale_m = LENS_SCALE_M(&b->lens, c->depth_m);
	if (b->layer->lit == LIT_COLOUR)
		lit = 1 - b->f->light.amount * (1 - diffuse_of(b, c));
	plane_slopes(b, c, half_length, slope);
	for (unsigned left = c->left & bits(alpha >= ALPHA_LEAST); left; left &= left - 1) {
		int k = __builtin_ctz(left);
		struct stroke s = { .x_px = c->x_px[k],
			.y_px = c->y_px[k],
			.along = { way.along[0][k], way.along[1][k] },
			.half_length_px = half_length[k],
			.half_width_px = half_width[k],
			.alpha = alpha[k],
			.q = 1 / c->depth_m[k],
			.slope = { slope[0][k], slope[1][k] },
			.point = (uint32_t)c->id[k],
			.copy = (uint8_t)c->copy };
		s.aslant = (uint8_t)(255 * p->aslant[k] + 0.5f);
		s.lay = lay_of(b, &s, size[k]);
		float width_m = ink->width_px * larger[k] * scale_m[k] / b->lens.focal_px;
		paint_colour(b, (uint32_t)c->point[k], &s, (uint32_t)p->rgb_detail[k], width_m,
			lit[k], s.rgb);
		stroke_chain_add(to, &s);
	}
}

INLINE void try_stroke(const struct brush *b, struct lane_candidates *c,
	const struct paint_lanes *p, struct stroke_chain *to)
{
	find_need(b, hides_backs(b), c);
	if (!c->left)
		return;
	vf need = c->need * STROKE_FADE_MORE(c->octaves);
	vf alpha = opacity_of(b, c) * fade_of(c->rank, need, c->octaves);
	if (c->left & bits(alpha >= ALPHA_LEAST))
		write_paint(b, c, p, alpha, to);
}

/* ---- a chunk's points ---- */

/* The points themselves too. */
INLINE void try_copies(
	const struct brush *b, struct lane_candidates c[VECTORS], struct stroke_chain *to)
{
	struct paint_lanes p[VECTORS];
	vf copies[VECTORS];
	for (int n = 0; n < VECTORS; n++) {
		find_paint(b, &c[n], &p[n]);
		copies[n] = copies_of(b, &c[n]);
	}
	do
		for (int n = 0; n < VECTORS; n++) {
			struct lane_candidates one = c[n];
			if (one.left)
				try_stroke(b, &one, &p[n], to);
		}
	while (group_next_copy(c, copies));
}

/* As many of them as there are groups of, or all. */
INLINE void try_queue(const struct brush *b, struct queue *q, uint32_t end, struct stroke_chain *to)
{
	for (uint32_t at = 0; at < end; at += GROUP) {
		struct lane_candidates c[VECTORS];
		find_group(b, q, at, end, c);
		try_copies(b, c, to);
	}
	queue_move_up(q, end);
}

/* Where there are few details few are wanted. Of what is still left. */
INLINE unsigned wanted_by_detail(
	const struct brush *b, uint32_t at, const struct lane_candidates *c)
{
	const struct frame_paint *paint = b->layer->paint;
	vi detail = load_u8_whole(paint->seen->detail + at);
	vf nearest_m = nearest_of(b, c->depth_m),
	   px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, nearest_m),
	   scale = c->spacing_m * px_per_m;
	return bits(c->rank < (vf)gather(paint->part, detail, 4) * scale * scale * b->wanted_most *
				      STROKE_FADE_MORE(octaves_of(nearest_m)));
}

void LANES_NAME(stroke_paint)(const struct brush *b, struct stroke_chain *to)
{
	struct queue q = { 0 };
	struct lane_candidates c;
	for (struct row_walk w = row_walk_of(b); row_next(b, &w, &c);) {
		c.left &= wanted_by_detail(b, w.at, &c);
		if (c.left)
			put_in_queue(b, &c, &q);
		if (q.count >= QUEUE)
			try_queue(b, &q, QUEUE, to);
	}
	try_queue(b, &q, q.count, to);
}
