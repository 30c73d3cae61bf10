#include "render/stroke-rows.h"
#include "render/surface-lanes.h"
#include <math.h>
#include <string.h>

/* Strokes that come towards the camera are shorter, down to this part. */
#define SHORTEST_SEEN 0.25f
/* What has turned away already is less and less on the line, to this cosine; what is hinted at begins as far before. And what is bent as
 * little as is asked for has no line yet; a whole one where it is bent so many times as much. */
#define BEYOND    0.08f
#define BENT_SURE 1.5f
/* Lines that are hinted at glide over what hardly is bent as soon as the eye moves: they are as wide there as it takes the eye to move by
 * so many radians, and as much fainter. */
#define GLIDES 0.06f

/* What is seen beside lies behind from this part of the depth on, and surely at the second. */
#define STEP_LEAST 0.03f
#define STEP_SURE  0.08f
/* It is looked for within so many pixels, and more (CONTOURS_REACH). */
#define REACH_LEAST_PX 2.f
/* What share of what is around makes a line whole: beyond a straight border through the point there is a half. And how far aside that must
 * be, on average of all that is around and in reaches, for a line to know where it runs: beyond such a border it is 0.156. */
#define STEP_SHARE 0.5f
#define STEP_ASIDE 0.104f

/* How near points are to a line, 0..1, and along what it runs, unit, as the camera sees it. */
struct contour_lanes {
	vf weight, way[3];
};

/* In even steps over the band, so that lines that glide over a surface come and go on its points by and by. */
INLINE vf strength(const struct brush *b, vf away_px)
{
	float band_px = b->layer->step->contours.band_px * b->f->ink_px;
	return clamp01(1 - away_px * (1 / band_px));
}

/* What a point sees of the eye: the cosine to it, the way to it in its plane, and the surface's turn along that (S w, shape operator) and
 * its part of it, the radial curvature. */
struct eye_lanes {
	vf cosine, sine, way[3], turn[3], radial, fold[3];
};

/* S = k1 a a' + k2 c c', a being the principal direction and c the one across. */
INLINE struct eye_lanes look_at_eye(
	const struct brush *b, const struct lane_candidates *c, const vf axis[3], const vf k[2])
{
	struct eye_lanes e;
	vf ray[2], across[3];
	rays_of(b, c, ray);
	vf unit = -1 / root(ray[0] * ray[0] + ray[1] * ray[1] + 1);
	for (int n = 0; n < 3; n++)
		e.way[n] = (n < 2 ? ray[n] : all(1)) * unit;
	e.cosine = dot_lanes(e.way, c->normal);
	e.sine = lay_flat(c->normal, e.way);
	cross_lanes(c->normal, axis, across);
	vf first = k[0] * dot_lanes(axis, e.way), second = k[1] * dot_lanes(across, e.way);
	vi second_is_less = magnitude(k[1]) <= magnitude(k[0]);
	for (int n = 0; n < 3; n++) {
		e.turn[n] = first * axis[n] + second * across[n];
		e.fold[n] = choose(second_is_less, across[n], axis[n]);
	}
	e.radial = dot_lanes(e.turn, e.way);
	return e;
}

/* 0..1 */
INLINE vf bent_enough(const struct brush *b, vf bent)
{
	float least = fmaxf(b->layer->step->contours.bent_least_per_m, 1e-3f);
	return clamp01((bent - least) * (1 / ((BENT_SURE - 1) * least)));
}

/* The cosine falls to nothing, and does so within few pixels: c^2 / 2 k of a metre on the screen. */
INLINE vf outline_weight(const struct brush *b, const struct eye_lanes *e, vf px_per_m)
{
	const struct contours_step *step = &b->layer->step->contours;
	vf away_px = e->cosine * e->cosine * px_per_m / (2 * most(e->radial, all(1e-3f)));
	vf turned = clamp01(1 + e->cosine * (1 / BEYOND));
	return step->outlines * strength(b, away_px) * turned * bent_enough(b, e->radial);
}

/* The radial curvature goes through nothing, where surface is a saddle: so far away as it takes to change by the curvature itself within a
 * radius of it. That it comes towards the eye, and not from it, is not known of single points; but where it does, surface is seen at a
 * slant, while the others (suggestive highlights) are seen from the front (DeCarlo & Rusinkiewicz 2007). */
INLINE vf suggested_weight(
	const struct brush *b, const struct eye_lanes *e, const vf k[2], vf px_per_m)
{
	const struct contours_step *step = &b->layer->step->contours;
	vf most_bent = most(magnitude(k[0]), all(1e-3f));
	float band_px = b->layer->step->contours.band_px * b->f->ink_px;
	vf wider = most(GLIDES * e->cosine * px_per_m / (most_bent * band_px), all(1));
	vf away_px = magnitude(e->radial) / (most_bent * most_bent) * e->cosine * px_per_m;
	vf slanted =
		clamp01((step->slant_least - e->cosine) * (4 / fmaxf(step->slant_least, 1e-3f)));
	vf faces = clamp01(e->cosine * (1 / BEYOND));
	return where(k[0] * k[1] < 0, step->suggestive * slanted * strength(b, away_px / wider) /
					      wider * faces * bent_enough(b, most_bent));
}

/* Those of smooth surface that may be on a line, by what is quickly told: nothing is bent along the ray more than along its principal
 * direction, or the one across. along: the normal along the ray. */
INLINE unsigned may_be_on_line(
	const struct brush *b, const struct lane_candidates *c, const vf k[2], vf along)
{
	const struct contours_step *step = &b->layer->step->contours;
	const float band_px = step->band_px * b->f->ink_px, more = 1 + 1e-4f;
	vf px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, c->depth_m),
	   bent = most(magnitude(k[0]), magnitude(k[1])), cosine = along * (-1 / b->ray_most);
	vi turns = cosine * cosine * px_per_m < most(bent, all(1e-3f)) * (2 * more * band_px),
	   hints = (k[0] * k[1] < 0) & (cosine < more * step->slant_least),
	   is_bent = (k[0] != 0) & (bent * more > fmaxf(step->bent_least_per_m, 1e-3f));
	return bits(is_bent & ((step->outlines > 0 ? turns : (vi){ 0 }) |
				      (step->suggestive > 0 ? hints : (vi){ 0 })));
}

/* Of smooth surface. */
INLINE void find_smooth(const struct brush *b, uint32_t at, const vf k[2],
	const struct lane_candidates *c, struct contour_lanes *h)
{
	const scene *s = b->f->scene;
	vf site[3], axis[3];
	vf px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, c->depth_m);
	vi some = unit_lanes(*(const vi_loose *)(const void *)s->direction[at], site);
	some &= c->is_flat & (k[0] != 0) & (load_u8_whole(s->kind + at) < FEATURE_UNDIRECTED);
	for (int n = 0; n < 3; n++)
		axis[n] = turn_lanes(b, n, site);
	lay_flat(c->normal, axis);
	struct eye_lanes e = look_at_eye(b, c, axis, k);
	vf outline = outline_weight(b, &e, px_per_m), hinted = suggested_weight(b, &e, k, px_per_m);
	h->weight = where(some, most(outline, hinted));
	cross_lanes(c->normal, e.turn, h->way);
	lay_flat(c->normal, h->way);
	for (int n = 0; n < 3; n++)
		h->way[n] = choose(outline >= hinted, h->way[n], e.fold[n]);
}

/* Pixels of the mask around a point, all of them, so that what one of them shows by chance, or a border that moves by less than one, does
 * not matter. Of windows that are wider than the vectors every second one, or third, and so on. */
#define WINDOW_VECTORS 4

struct window {
	float reach, unit; /* in pixels, and its inverse */
	int stride, first[2], count[2];
	vf weight[WINDOW_VECTORS]; /* of columns */
	vf aside[WINDOW_VECTORS];  /* the same by how far to the right, in reaches */
	float sum;                 /* of weights */
};

/* Least of all at the rim, and in even steps, so that nothing comes or goes at once. */
INLINE vf window_weight(vf away)
{
	vf left = most(1 - away * away, all(0));
	return left * left;
}

/* From a pixel on, of so many to a picture. */
INLINE void window_side(struct window *w, int n, float middle)
{
	int half = (int)(w->reach / (float)w->stride);
	w->first[n] = (int)floorf(middle) - half * w->stride;
	w->count[n] = 2 * half + 2;
}

INLINE struct window window_of(float reach_px, float x, float y, uint32_t width)
{
	struct window w = { .reach = reach_px, .unit = 1 / reach_px };
	w.stride = 1 + (int)(2 * reach_px / (WINDOW_VECTORS * LANES - 2));
	window_side(&w, 0, x);
	window_side(&w, 1, y);
	vf sum = all(0);
	for (int n = 0; n * LANES < w.count[0]; n++) {
		vf column =
			   (float)w.first[0] + (lane_number + (float)(n * LANES)) * (float)w.stride,
		   away = (column - x) * w.unit;
		vi inside = (column >= 0) & (column < (float)width);
		w.weight[n] = where(inside, window_weight(away));
		w.aside[n] = w.weight[n] * away;
		sum += w.weight[n];
	}
	for (int k = 0; k < LANES; k++)
		w.sum += sum[k];
	return w;
}

/* Of columns from the n-th vector of the window on, as many as there are lanes; beside the picture they do not matter. */
INLINE vf window_depths(const visibility_mask *m, const struct window *w, const int32_t *row, int n)
{
	int from = w->first[0] + n * LANES * w->stride;
	if (w->stride == 1 && from >= -MASK_MARGIN && from + LANES <= (int)m->width + MASK_MARGIN)
		return (vf)load_mask(row + from);
	vi column = from + w->stride * __builtin_convertvector(lane_number, vi);
	column = higher(lower(column, (vi){ 0 } + ((int32_t)m->width - 1)), (vi){ 0 });
	return (vf)gather(row, column, 4);
}

/* A part of all that is around a point, and how far to the right and down of it that is: its share of the average, in reaches. */
struct behind {
	float share, aside[2];
};

/* How much of what the mask has around a point lies behind it, and where. */
INLINE struct behind look_behind(
	const struct brush *b, float reach_px, float x, float y, float depth_m)
{
	const visibility_mask *m = b->mask;
	struct window w = window_of(reach_px, x, y, m->width);
	float by = LENS_STRETCH(&b->lens, depth_m) / (STEP_SURE - STEP_LEAST), per_m = by / depth_m,
	      from = by + STEP_LEAST / (STEP_SURE - STEP_LEAST), whole = 0;
	vf share = all(0), right = all(0), down = all(0);
	for (int k = 0; k < w.count[1]; k++) {
		int y_at = w.first[1] + k * w.stride;
		float away = ((float)y_at - y) * w.unit, left = 1 - away * away;
		if (y_at < 0 || y_at >= (int)m->height || left <= 0)
			continue;
		const int32_t *row = m->key + (ptrdiff_t)y_at * m->pitch;
		vf row_share = all(0), row_right = all(0);
		for (int n = 0; n * LANES < w.count[0]; n++) {
			vf part = clamp01(window_depths(m, &w, row, n) * per_m - from);
			row_share += w.weight[n] * part;
			row_right += w.aside[n] * part;
		}
		float weight = left * left;
		share += weight * row_share;
		right += weight * row_right;
		down += weight * away * row_share;
		whole += weight;
	}
	struct behind ret = { 0 };
	for (int k = 0; k < LANES; k++) {
		ret.share += share[k];
		ret.aside[0] += right[k];
		ret.aside[1] += down[k];
	}
	float unit = 1 / fmaxf(whole * w.sum, 1e-3f);
	ret.share *= unit;
	ret.aside[0] *= unit;
	ret.aside[1] *= unit;
	return ret;
}

INLINE float reach_of(const struct brush *b)
{
	return fmaxf(
		CONTOURS_REACH * b->layer->step->contours.band_px * b->f->ink_px, REACH_LEAST_PX);
}

/* Those that something so near to them may lie behind of, by the deepest pixels of the tiles there: far from borders nothing does. */
INLINE unsigned may_have_steps(
	const struct brush *b, const struct lane_candidates *c, float near_px)
{
	const visibility_mask *m = b->mask;
	vf deepest = all(0);
	int places = near_px < MASK_TILE / 2 ? 2 : 2 + (int)(2 * near_px / MASK_TILE);
	for (int n = 0; n < places * places; n++) {
		float right = near_px * (2 * (float)(n % places) / (float)(places - 1) - 1),
		      down = near_px * (2 * (float)(n / places) / (float)(places - 1) - 1);
		vf x = least(most(c->x_px + right, all(0)), all((float)m->width - 1)),
		   y = least(most(c->y_px + down, all(0)), all((float)m->height - 1));
		vi tile = (__builtin_convertvector(y, vi) / MASK_TILE) * (int32_t)m->tiles_across +
			  __builtin_convertvector(x, vi) / MASK_TILE;
		deepest = most(deepest, (vf)gather(m->deepest_m, tile, 4));
	}
	vf behind = (deepest / c->depth_m - 1) * LENS_STRETCH(&b->lens, c->depth_m);
	return bits(behind > STEP_LEAST) & c->left;
}

/* Where the picture falls off beside points; the line runs across the way there, facing the eye. Few of them are near a border: one at a
 * time. */
INLINE void find_steps(const struct brush *b, unsigned near, const struct lane_candidates *c,
	struct contour_lanes *h)
{
	const struct contours_step *step = &b->layer->step->contours;
	float reach_px = reach_of(b);
	vf share = all(0), x = all(0), y = all(0);
	for (; near; near &= near - 1) {
		int k = __builtin_ctz(near);
		struct behind behind = look_behind(
			b, reach_px, c->x_px[k] - 0.5f, c->y_px[k] - 0.5f, c->depth_m[k]);
		share[k] = behind.share;
		x[k] = behind.aside[0];
		y[k] = behind.aside[1];
	}
	vf length = root(x * x + y * y), unit = 1 / most(length, all(1e-6f));
	/* What has it all around is a speck, and runs nowhere. */
	vf weight = step->steps * least(share * (1 / STEP_SHARE), all(1)) *
		    least(length * (1 / STEP_ASIDE), all(1));
	vi is_more = weight > h->weight;
	h->weight = choose(is_more, weight, h->weight);
	h->way[0] = choose(is_more, -y * unit, h->way[0]);
	h->way[1] = choose(is_more, x * unit, h->way[1]);
	h->way[2] = choose(is_more, all(0), h->way[2]);
}

/* Of points on a line: how dense they are wanted, by the rank that they have. */
INLINE void find_wanted_here(const struct brush *b, struct lane_candidates *c)
{
	c->last = 1 / (c->spacing_m * c->spacing_m);
	c->rank *= c->last;
	c->wanted = all(b->layer->wanted_per_px[0]);
	find_need(b, false, c);
}

INLINE struct stroke stroke_of(const struct brush *b, const struct lane_candidates *c,
	const struct way_lanes *w, int k, float alpha, float larger)
{
	const struct ink_step *ink = &b->layer->ink;
	uint32_t point = (uint32_t)c->id[k];
	const float *turn = b->layer->turn[(int)(stroke_chance(point, SALT_ANGLE) * 256)];
	float x = w->along[0][k], y = w->along[1][k];
	struct stroke s = { .x_px = c->x_px[k],
		.y_px = c->y_px[k],
		.along = { x * turn[0] - y * turn[1], x * turn[1] + y * turn[0] },
		.half_length_px = larger * ink->length_px / 2 *
				  (1 + ink->length_variation * around_zero(point, SALT_LENGTH)) *
				  CLAMP(w->part[k], SHORTEST_SEEN, 1),
		.half_width_px = larger * ink->width_px / 2,
		.alpha = alpha,
		.q = 1 / c->depth_m[k],
		.point = point };
	for (int n = 0; n < 2; n++)
		s.slope[n] = w->slope[k] * s.along[n];
	memcpy(s.rgb, ink->ink, 3);
	return s;
}

/* Most points are on no line: it is looked for before it is asked what is wanted, and what is hidden. */
INLINE void try_points(
	const struct brush *b, uint32_t at, struct lane_candidates *c, struct stroke_chain *to)
{
	const struct contours_step *step = &b->layer->step->contours;
	struct contour_lanes h = { .weight = all(0) };
	vf bend[2] = { all(0), all(0) };
	unsigned smooth = 0, near = 0;
	find_normals(b, *(const vi_loose *)(const void *)b->f->scene->normal[at], c);
	vf along = along_of(b, c);
	if (hides_backs(b))
		c->left &= bits(along <= BEYOND * b->ray_most);
	if (b->layer->bend) {
		bends_of(b->layer->bend, at, bend);
		smooth = may_be_on_line(b, c, bend, along);
	}
	if (b->mask && step->steps > 0)
		near = may_have_steps(b, c, reach_of(b));
	c->left &= smooth | near;
	if (!c->left)
		return;
	find_wanted_here(b, c);
	if (!c->left)
		return;
	vf shown = visibility(b, c);
	c->left &= bits(shown > 0);
	if (!c->left)
		return;
	if (smooth & c->left)
		find_smooth(b, at, bend, c, &h);
	find_steps(b, near & c->left, c, &h);
	c->left &= bits(h.weight > 0);
	if (!c->left)
		return;
	const struct ink_step *ink = &b->layer->ink;
	vf need = c->need * STROKE_FADE_MORE(c->octaves);
	vf alpha = shown * h.weight * ink->opacity * fade_of(c->rank, need, c->octaves) *
		   (1 - b->f->focus.amount * c->away) *
		   (1 - ink->opacity_variation * lanes_chance(c->id, SALT_OPACITY));
	for (int k = 0; k < LANES && ink->fade_m > 0; k++)
		alpha[k] *= exp2f((b->lens.begin_m - c->depth_m[k]) / ink->fade_m);
	struct way_lanes w = way_on_screen(b, c, h.way);
	vf larger = enlarged(b, c);
	for (unsigned left = c->left & bits(alpha >= ALPHA_LEAST); left; left &= left - 1) {
		int k = __builtin_ctz(left);
		struct stroke s = stroke_of(b, c, &w, k, alpha[k], larger[k]);
		stroke_chain_add(to, &s);
	}
}

void LANES_NAME(stroke_contours)(const struct brush *b, struct stroke_chain *to)
{
	struct lane_candidates c;
	for (struct row_walk w = row_walk_of(b); row_next(b, &w, &c);) {
		find_ids(b, &c);
		try_points(b, w.at, &c, to);
	}
}
