#include "render/stroke-rows.h"
#include "render/surface-lanes.h"
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
/* Of eight places around so many make a line whole. */
#define STEP_PLACES 4.f

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

/* At whole places, or the nearest that the mask has. */
INLINE vf mask_depth_at(const struct brush *b, vf x, vf y)
{
	const visibility_mask *m = b->mask;
	vi column = __builtin_convertvector(least(most(x, all(0)), all((float)m->width - 1)), vi),
	   row = __builtin_convertvector(least(most(y, all(0)), all((float)m->height - 1)), vi);
	vi key = gather(m->key, row * (int32_t)m->pitch + column, 4);
	return (vf)(key & ~((1 << MASK_PIPELINE_BITS) - 1));
}

INLINE vf is_behind_there(const struct brush *b, vf x, vf y, vf depth_m)
{
	vf behind = (mask_depth_at(b, x, y) / depth_m - 1) * LENS_STRETCH(&b->lens, depth_m);
	return clamp01((behind - STEP_LEAST) * (1 / (STEP_SURE - STEP_LEAST)));
}

/* 0..1: how surely what the mask has around this place lies behind the points. Of four pixels, so that lines do not flicker when borders
 * move by less than one. */
INLINE vf is_behind(const struct brush *b, vf x, vf y, vf depth_m)
{
	vf x0 = floor_of(x), y0 = floor_of(y), u = x - x0, v = y - y0;
	vf upper = (1 - u) * is_behind_there(b, x0, y0, depth_m) +
		   u * is_behind_there(b, x0 + 1, y0, depth_m),
	   lower = (1 - u) * is_behind_there(b, x0, y0 + 1, depth_m) +
		   u * is_behind_there(b, x0 + 1, y0 + 1, depth_m);
	return (1 - v) * upper + v * lower;
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

/* Where the picture falls off beside points; the line runs across the way there, facing the eye. Few of them are near a border: of each
 * all eight places at once. */
INLINE void find_steps(const struct brush *b, unsigned near, const struct lane_candidates *c,
	struct contour_lanes *h)
{
	_Static_assert(LANES == 8, "as many as there are places around");
	static const float turn[2][LANES] = { { 1, 0.7071068f, 0, -0.7071068f, -1, -0.7071068f, 0,
						      0.7071068f },
		{ 0, 0.7071068f, 1, 0.7071068f, 0, -0.7071068f, -1, -0.7071068f } };
	const struct contours_step *step = &b->layer->step->contours;
	float band_px = step->band_px * b->f->ink_px;
	vf sum = all(0), x = all(0), y = all(0);
	for (; near; near &= near - 1) {
		int k = __builtin_ctz(near);
		vf part = is_behind(b, c->x_px[k] - 0.5f + band_px * load(turn[0]),
			c->y_px[k] - 0.5f + band_px * load(turn[1]), all(c->depth_m[k]));
		for (int n = 0; n < LANES; n++) {
			sum[k] += part[n];
			x[k] += part[n] * turn[0][n];
			y[k] += part[n] * turn[1][n];
		}
	}
	vf length = root(x * x + y * y), unit = 1 / most(length, all(1e-3f));
	/* What has it all around is a speck, and runs nowhere. */
	vf weight = step->steps * least(sum * (1 / STEP_PLACES), all(1)) * least(length, all(1));
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
		near = may_have_steps(b, c, step->band_px * b->f->ink_px + 2);
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
