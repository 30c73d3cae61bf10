#include "render/hatch-need.h"
#include "render/stroke-rows.h"
#include <string.h>

/* Strokes that come towards the camera are shorter, down to this part. */
#define SHORTEST_SEEN 0.12f

/* ---- colours ---- */

/* sRGB 0..1 of the point, as full and as exposed as the style has it; what has no colour takes the other. */
INLINE void own_colour(
	const struct brush *b, const uint8_t rgba[4], const uint8_t other[3], float ret[3])
{
	float grey = scene_lightness(rgba);
	for (int k = 0; k < 3; k++) {
		float own = rgba[3] ? grey + b->layer->ink.saturation * (rgba[k] - grey) : other[k];
		ret[k] = fminf(fmaxf(own * (1 / 255.f), 0), 1);
		if (rgba[3])
			ret[k] = scene_exposed(b->layer->hatch->exposure, ret[k]);
	}
}

INLINE void hatch_colour(
	const struct brush *b, uint32_t point, uint32_t id, uint32_t shade, uint8_t ret[3])
{
	const struct frame_hatch *h = b->layer->hatch;
	const struct hatching_step *step = &h->step;
	float rgb[3], hue_shift_deg = 0;
	if (step->colouring <= COLOURING_XTOON && !h->pencils.count) {
		memcpy(ret, h->rgba[shade], 3);
		return;
	}
	if (step->colouring > COLOURING_XTOON) {
		float mix = step->colouring == COLOURING_BLEND ? step->mix : 0;
		own_colour(b, b->f->scene->rgba[point], h->rgba[shade], rgb);
		for (int k = 0; k < 3; k++)
			rgb[k] += mix * ((float)h->rgba[shade][k] * (1 / 255.f) - rgb[k]);
		hue_shift_deg = step->hue_shift_deg;
	} else
		for (int k = 0; k < 3; k++)
			rgb[k] = (float)h->rgba[shade][k] * (1 / 255.f);
	pencil_box_draw(&h->pencils, hue_shift_deg, stroke_chance(id, SALT_PENCIL), rgb);
	for (int k = 0; k < 3; k++)
		ret[k] = (uint8_t)(255 * rgb[k] + 0.5f);
}

/* ---- strokes ---- */

/* Those of one of the two ways. */
struct pen_lanes {
	struct way_lanes way;
	vf half_px, alpha, slope[2];
	uint32_t copy; /* struct stroke */
};

/* Turned in the plane by the layer's angle and by chance. */
INLINE void turn_ways(const struct brush *b, const struct lane_candidates *c,
	const struct hatch_lanes *h, vf ret[2][3])
{
	const float own = b->layer->hatch->step.line_angle_deg * (float)(G_PI / 180);
	vi n = __builtin_convertvector(
		lanes_chance(c->id, stroke_salt(2 * c->copy, SALT_ANGLE)) * 256, vi);
	vf cosine = (vf)gather(b->layer->turn, 2 * n, 4),
	   sine = (vf)gather(&b->layer->turn[0][1], 2 * n, 4);
	vf across = cosine * cosf(own) - sine * sinf(own),
	   up = sine * cosf(own) + cosine * sinf(own);
	for (int k = 0; k < 3; k++) {
		ret[0][k] = across * h->way[0][k] + up * h->way[1][k];
		ret[1][k] = across * h->way[1][k] - up * h->way[0][k];
	}
}

INLINE struct pen_lanes pen_of(const struct brush *b, const struct lane_candidates *c,
	const struct hatch_lanes *h, const vf way[3], int which, vf growth)
{
	const struct ink_step *ink = &b->layer->ink;
	struct pen_lanes p = { .way = way_on_screen(b, c, way),
		.copy = 2 * c->copy + (uint32_t)which };
	vf length_px = growth * ink->length_px;
	vf varied = 1 + ink->length_variation *
				lanes_around_zero(c->id, stroke_salt(p.copy, SALT_LENGTH));
	p.half_px = 0.5f * length_px * varied *
		    straight_part(b, h->bent[which], length_px, c->depth_m) *
		    least(most(p.way.part, all(SHORTEST_SEEN)), all(1));
	plane_slopes(b, c, p.half_px, p.slope);
	return p;
}

INLINE struct stroke stroke_of_pen(
	const struct lane_candidates *c, const struct pen_lanes *p, int k, float half_width_px)
{
	struct stroke s = { .x_px = c->x_px[k],
		.y_px = c->y_px[k],
		.along = { p->way.along[0][k], p->way.along[1][k] },
		.half_length_px = p->half_px[k],
		.half_width_px = half_width_px,
		.alpha = p->alpha[k],
		.q = 1 / c->depth_m[k],
		.point = (uint32_t)c->id[k],
		.copy = (uint8_t)p->copy };
	for (int n = 0; n < 2; n++)
		s.slope[n] = p->slope[n][k];
	return s;
}

/* How far the second strokes are drawn: in the mean of all chances exactly the part that has one, yet none comes at once. */
INLINE vf second_of(
	const struct brush *b, const struct lane_candidates *c, const struct hatch_lanes *h)
{
	const float w = HATCH_CROSS_FADE, bend = 2 * w * (1 - w), end = w / (2 * (1 - w));
	vf part = h->chance * b->layer->hatch->step.cross, left = 1 - part,
	   chance = lanes_chance(c->id, SALT_CROSS);
	vf limit = choose(part < end, root(bend * part),
		choose(left < end, 1 - root(bend * left), part * (1 - w) + w / 2));
	return clamp01((limit - chance * (1 - w)) * (1 / w));
}

INLINE void write_strokes(const struct brush *b, const struct lane_candidates *c,
	const struct hatch_lanes *h, const struct pen_lanes *p, vf growth, struct stroke_chain *to)
{
	for (unsigned left = c->left & bits(p->alpha >= ALPHA_LEAST); left; left &= left - 1) {
		int k = __builtin_ctz(left);
		struct stroke s = stroke_of_pen(c, p, k, growth[k] * b->layer->ink.width_px / 2);
		hatch_colour(b, (uint32_t)c->point[k], s.point, (uint32_t)h->shade[k], s.rgb);
		stroke_chain_add(to, &s);
	}
}

INLINE void try_strokes(const struct brush *b, struct lane_candidates *c,
	const struct hatch_lanes *h, struct stroke_chain *to)
{
	const struct hatching_step *step = &b->layer->hatch->step;
	vf way[2][3];
	find_need(b, hides_backs(b), c);
	if (!c->left)
		return;
	vf need = c->need * STROKE_FADE_MORE(c->octaves);
	vf alpha = opacity_of(b, c) * fade_of(c->rank, need, c->octaves) *
		   (1 - step->pressure * (1 - h->chance)) *
		   least(h->chance * (1 / HATCH_FOOT), all(1)); /* frame_hatch_pressure() */
	if (!(c->left & bits(alpha >= ALPHA_LEAST)))
		return;
	vf growth = growth_of(b, c) * enlarged(b, c) * h->larger;
	turn_ways(b, c, h, way);
	struct pen_lanes first = pen_of(b, c, h, way[0], 0, growth);
	first.alpha = alpha;
	write_strokes(b, c, h, &first, growth, to);
	if (step->cross <= 0)
		return;
	struct pen_lanes second = pen_of(b, c, h, way[1], 1, growth);
	second.alpha = alpha * second_of(b, c, h);
	write_strokes(b, c, h, &second, growth, to);
}

/* ---- a chunk's points ---- */

/* The points themselves too. */
INLINE void try_copies(
	const struct brush *b, uint32_t at, struct lane_candidates *c, struct stroke_chain *to)
{
	struct hatch_lanes h;
	find_hatch(b, at, c, &h);
	fetch(b, c);
	vf copies = copies_of(b, c);
	for (; c->left; next_copy(c, copies)) {
		struct lane_candidates one = *c;
		try_strokes(b, &one, &h, to);
	}
}

void LANES_NAME(stroke_hatch)(const struct brush *b, struct stroke_chain *to)
{
	struct lane_candidates c;
	for (struct row_walk w = row_walk_of(b); row_next(b, &w, &c);) {
		find_ids(b, &c);
		try_copies(b, w.at, &c, to);
	}
}
