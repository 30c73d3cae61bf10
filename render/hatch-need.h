#ifndef RENDER_HATCH_NEED_H
#define RENDER_HATCH_NEED_H
/* Hatching of eight points at a time (Wagner et al. 2022): how light they are and what the X-Toon texture says to that, what their
 * strokes lie along, how long they are. Internal to hatch-lanes.c; all is inlined. */
#include "render/surface-lanes.h"

/* Where the uniform direction and a normal are nearly the same, it says nothing of the plane; and so says a curvature that is not clearly
 * larger one way than across. */
#define WAY_LEAST      0.1f
#define BENT_BOTH_WAYS 1.1f
/* And what is bent less, by 1/m, is as good as flat: scanners see no more. */
#define BENT_LEAST 0.3f
/* A principal direction that lies in the plane no more than so is none of it. */
#define FLAT_LEAST 0.5f
/* Cosine of what is seen most aslant by strokes along the screen. */
#define SCREEN_SLANT 0.05f

/* Of a point's first stroke, before it is turned, and of the second one across it. */
struct hatch_lanes {
	vi shade;
	vf chance;    /* of the X-Toon */
	vf way[2][3]; /* as the camera sees it; unit */
	vf bent[2];   /* curvature along it, 1/m */
	vf larger;    /* for being abstracted */
};

/* ---- how light ---- */

/* Phong's, 0 where the light does not come. */
INLINE vf shine_of(const struct brush *b, const struct lane_candidates *c)
{
	const struct hatching_step *step = &b->layer->hatch->step;
	const float *from = b->f->light.from;
	vf ray[2], ret = all(0);
	rays_of(b, c, ray);
	vf lit = c->normal[0] * from[0] + c->normal[1] * from[1] + c->normal[2] * from[2];
	vf along = along_of(b, c), length = root(ray[0] * ray[0] + ray[1] * ray[1] + 1);
	vf to_light = ray[0] * from[0] + ray[1] * from[1] + from[2];
	/* The light's reflection, along the way to the eye. */
	vf towards = (to_light - 2 * lit * along) / length;
	for (unsigned left = bits((lit > 0) & (towards > 0)); left; left &= left - 1) {
		int k = __builtin_ctz(left);
		ret[k] = step->shine * powf(towards[k], step->shine_exponent);
	}
	return ret;
}

/* 0..1 */
INLINE vf brightness_of(const struct brush *b, const struct lane_candidates *c, vi rgba)
{
	const struct hatching_step *step = &b->layer->hatch->step;
	float amount = b->f->light.amount;
	const scene *s = b->f->scene;
	float levels = b->layer->ink.tone_levels;
	vf own = __builtin_convertvector(lightness_of(rgba), vf) * (1 / 255.f);
	own += levels * (clamp01((own - s->darkest) * (1 / (s->lightest - s->darkest))) - own);
	own = choose((rgba >> 24 & 255) != 0, own, all(1)); /* plaster */
	vf bright = (1 - step->own_tone * (1 - own)) * (1 - amount * (1 - diffuse_of(b, c)));
	if (step->shine > 0 && amount > 0)
		bright += amount * shine_of(b, c);
	return clamp01(bright);
}

/* Where lightness and depth are in the tables. */
INLINE vi shade_of(const struct frame_hatch *h, vf brightness, vf depth_m)
{
	vf row = clamp01((depth_m - h->near_m) * h->per_m) * (float)(h->rows - 1) + 0.5f;
	return __builtin_convertvector(row, vi) * (int32_t)XTOON_COLUMNS +
	       __builtin_convertvector(brightness * 255 + 0.5f, vi);
}

/* ---- along what ---- */

/* The plane that a point's strokes lie in; of what is not flat, as leaves, the one that faces the camera. */
INLINE void plane_of(const struct brush *b, const struct lane_candidates *c, vf ret[3])
{
	vf ray[2], none = (vf)~c->is_flat;
	rays_of(b, c, ray);
	vf unit = 1 / root(ray[0] * ray[0] + ray[1] * ray[1] + 1);
	for (int k = 0; k < 3; k++)
		ret[k] = choose((vi)none, (k < 2 ? ray[k] : all(1)) * unit, c->normal[k]);
}

/* The projected uniform vector, and where that is next to nothing the screen's right. */
INLINE void uniform_way(const struct brush *b, const vf plane[3], vf ret[3])
{
	const float *way = b->layer->hatch->way;
	vf other[3] = { all(b->turn[0][0] + b->turn[0][1]), all(b->turn[1][0] + b->turn[1][1]),
		all(b->turn[2][0] + b->turn[2][1]) };
	for (int k = 0; k < 3; k++)
		ret[k] = all(way[k]);
	vi is_short = lay_flat(plane, ret) < WAY_LEAST;
	if (!any(is_short))
		return;
	lay_flat(plane, other);
	for (int k = 0; k < 3; k++)
		ret[k] = choose(is_short, other[k], ret[k]);
}

/* Where a feature point is, surface turns within so many of its points, but not along its line. */
#define EDGE_POINTS 4.f

/* Along the first stroke and across it (Euler): axis is the way of k1, or of an edge. */
INLINE void find_bends(
	const vf k[2], const vf axis[3], vi has_axis, vi is_edge, vf sharp, struct hatch_lanes *h)
{
	vf k1 = choose(is_edge, all(0), k[0]), k2 = choose(is_edge, sharp, k[1]);
	vf cosine = dot_lanes(axis, h->way[0]), part = least(cosine * cosine, all(1));
	vf first = k1 * part + k2 * (1 - part), second = k2 * part + k1 * (1 - part);
	vf any_way = choose(is_edge, sharp, k1);
	h->bent[0] = magnitude(choose(has_axis, first, any_way));
	h->bent[1] = magnitude(choose(has_axis, second, any_way));
}

/* What lies on surfaces and runs to the right of the picture, and down it: steps along the screen, each moved along its ray into the
 * plane; of length 1 on the screen. Planes that are seen too aslant are taken for less so. */
INLINE void screen_ways(
	const struct brush *b, const struct lane_candidates *c, const vf plane[3], vf ret[2][3])
{
	vf ray[2];
	rays_of(b, c, ray);
	vf along = plane[0] * ray[0] + plane[1] * ray[1] + plane[2];
	along = choose(along < 0, least(along, all(-SCREEN_SLANT)), most(along, all(SCREEN_SLANT)));
	for (int n = 0; n < 2; n++) {
		vf back = -plane[n] / along;
		ret[n][0] = ray[0] * back + (n == 0 ? 1.f : 0.f);
		ret[n][1] = ray[1] * back + (n == 1 ? 1.f : 0.f);
		ret[n][2] = back;
	}
}

/* 0..1: how clearly surface is bent one way. */
INLINE vf clearness(const vf k[2], vi some)
{
	vf bent = magnitude(k[0]);
	vf one_way =
		clamp01((bent - BENT_BOTH_WAYS * magnitude(k[1])) / most(0.5f * bent, all(1e-6f)));
	return where(some, one_way * clamp01((bent - BENT_LEAST) * (1 / BENT_LEAST)));
}

/* Towards the principal direction, whose sign is free. */
INLINE void bend_way(const vf principal[3], vf clear, vf way[3])
{
	vf sign = choose(dot_lanes(way, principal) < 0, all(-1), all(1));
	for (int n = 0; n < 3; n++)
		way[n] += clear * (sign * principal[n] - way[n]);
	vf unit = 1 / most(root(dot_lanes(way, way)), all(1e-3f));
	for (int n = 0; n < 3; n++)
		way[n] *= unit;
}

INLINE void find_ways(
	const struct brush *b, const struct lane_candidates *c, uint32_t at, struct hatch_lanes *h)
{
	const struct frame_hatch *hatch = b->layer->hatch;
	const scene *s = b->f->scene;
	vf plane[3], site[3], principal[3], k[2];
	plane_of(b, c, plane);
	h->bent[0] = h->bent[1] = all(0);
	if (hatch->step.follows == FOLLOWS_SCREEN) {
		screen_ways(b, c, plane, h->way);
		return;
	}
	uniform_way(b, plane, h->way[0]);
	if (b->layer->bend) {
		bends_of(b->layer->bend, at, k);
		vi some = unit_lanes(*(const vi_loose *)(const void *)s->direction[at], site);
		for (int n = 0; n < 3; n++)
			principal[n] = turn_lanes(b, n, site);
		vi is_edge = load_u8_whole(s->kind + at) >= FEATURE_UNDIRECTED;
		vf left = lay_flat(plane, principal);
		if (hatch->step.follows == FOLLOWS_CURVATURE)
			bend_way(principal, clearness(k, some & ~is_edge & (left > FLAT_LEAST)),
				h->way[0]);
		find_bends(k, principal, some, is_edge, (1 / EDGE_POINTS) / c->spacing_m, h);
	}
	cross_lanes(plane, h->way[0], h->way[1]);
}

/* ---- how long ---- */

/* What is left of strokes of this length where surface is so bent. */
INLINE vf straight_part(const struct brush *b, vf bent, vf length_px, vf depth_m)
{
	return 1 / (1 + b->layer->hatch->step.curvature * bent * length_px *
				   LENS_SCALE_M(&b->lens, depth_m) * (1 / b->lens.focal_px));
}

/* Of the strokes of a point, in the mean. */
INLINE vf shortened(
	const struct brush *b, const struct lane_candidates *c, const struct hatch_lanes *h)
{
	vf part[2], second = h->chance * b->layer->hatch->step.cross;
	vf length_px = all(b->layer->ink.length_px) * h->larger;
	for (int n = 0; n < 2; n++)
		part[n] = least(way_on_screen(b, c, h->way[n]).part, all(1)) *
			  straight_part(b, h->bent[n], length_px, c->depth_m);
	return most((part[0] + second * part[1]) / (1 + second), all(HATCH_SHORTEST));
}

/* ---- all of it ---- */

/* Points to a square metre that are wanted, of one to a square pixel: no more where strokes may be moved to. Leaves those that are seen
 * from the front where backs are hidden, and whose ranks are not above all that is ever wanted there. */
INLINE vf per_px_there(const struct brush *b, struct lane_candidates *c)
{
	vf nearest_m = nearest_of(b, c->depth_m),
	   px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, nearest_m);
	vf turned = b->moved_m * b->ray_most / nearest_m, along = along_of(b, c);
	if (hides_backs(b))
		c->left &= bits(along <= turned);
	vf ret = px_per_m * px_per_m * STROKE_FADE_MORE(octaves_of(nearest_m)) *
		 least(cosine_of(b, c, magnitude(along) + turned), all(b->ray_most)) /
		 most(facing(b, c), all(HATCH_FACING));
	c->left &= bits(c->rank < ret * b->layer->wanted_most[FEATURE_NONE]);
	return ret;
}

/* What is the same for all copies of the points, which stand in a row; and how many of them may be wanted. What is quickly told comes
 * first: of closed things half is seen from behind. */
INLINE void find_hatch(
	const struct brush *b, uint32_t at, struct lane_candidates *c, struct hatch_lanes *h)
{
	const struct frame_hatch *hatch = b->layer->hatch;
	const scene *s = b->f->scene;
	find_normals(b, *(const vi_loose *)(const void *)s->normal[at], c);
	c->is_flat &= load_u8_whole(s->kind + at) != FEATURE_UNDIRECTED;
	c->last = 1 / (c->spacing_m * c->spacing_m);
	c->rank *= c->last;
	vf per_px = per_px_there(b, c);
	if (!c->left)
		return;
	vi rgba = *(const vi_loose *)(const void *)s->rgba[at];
	h->shade = shade_of(hatch, brightness_of(b, c, rgba), c->depth_m - b->lens.begin_m);
	h->shade &= c->depth_m > 0; /* beyond the camera nothing is known */
	c->wanted = (vf)gather(hatch->wanted_per_px, h->shade, 4) *
		    choose(c->is_flat, all(1), all(HATCH_LEAVES));
	c->left &= bits(c->rank * HATCH_SHORTEST < c->wanted * per_px);
	if (!c->left)
		return;
	h->chance = (vf)gather(hatch->chance, h->shade, 4);
	h->larger =
		1 + hatch->step.abstraction *
			    clamp01((c->depth_m - b->lens.begin_m - hatch->near_m) * hatch->per_m);
	find_ways(b, c, at, h);
	vf fewer = shortened(b, c, h) * h->larger * h->larger;
	c->most = c->wanted * per_px / fewer;
	c->wanted /= fewer * most(facing(b, c), all(HATCH_FACING));
	c->left &= bits(c->rank < c->most);
}

#endif
