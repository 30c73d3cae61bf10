#include "render/surface-lanes.h"
#include <string.h>

/* Lines where the camera's near plane cuts through surfaces.
 *
 *       | cut          A point p of a surface with normal n lies depth behind the plane. In its own plane the shortest way
 *       |   p          onto the cut is -depth v / v.v, v being the axis laid into the plane: v = z - (n.z) n, v.v = 1 - (n.z)^2.
 *     --+--/----> z    On the picture that is depth (n.z) (n.x, n.y) / v.v, and the line runs at right angles to (n.x, n.y).
 *       | /
 */

/* Of the slab, by the camera, the style, or the points. */
INLINE vf thickness_of(const struct brush *b, vf spacing_m)
{
	float given_m =
		b->f->camera.cut_m > 0 ? (float)b->f->camera.cut_m : b->layer->step->cut.thick_m;
	if (given_m > 0)
		return all(given_m);
	return least(most(spacing_m * CUT_SPACINGS, all(CUT_LEAST_M)), all(CUT_MOST_M));
}

struct cut_lanes {
	vf along[2], half_px, alpha;
};

INLINE struct cut_lanes cut_of(const struct brush *b, struct lane_candidates *c, vf px_per_m)
{
	const struct ink_step *ink = &b->layer->ink;
	const vf *n = c->normal;
	vf aside2 = n[0] * n[0] + n[1] * n[1], sine = root(aside2),
	   unit = 1 / most(sine, all(1e-3f));
	vf back = (c->depth_m - b->lens.near_m) * n[2] * unit * unit * px_per_m;
	struct cut_lanes w = { .along = { -n[1] * unit, n[0] * unit } };
	c->x_px += back * n[0];
	c->y_px += back * n[1];
	w.alpha = clamp01((sine - CUT_SLANT_LEAST) * (1 / (CUT_SLANT_SURE - CUT_SLANT_LEAST))) *
		  ink->opacity *
		  (1 - ink->opacity_variation * lanes_chance(c->point, SALT_OPACITY));
	vf varied = 1 + ink->length_variation * lanes_around_zero(c->point, SALT_LENGTH);
	/* At least as long as points are apart, so that the line has no gaps. */
	w.half_px = most(ink->length_px / 2 * varied, c->spacing_m * px_per_m * (CUT_SPACINGS / 2));
	return w;
}

INLINE struct stroke stroke_of(
	const struct brush *b, const struct lane_candidates *c, const struct cut_lanes *w, int k)
{
	const struct ink_step *ink = &b->layer->ink;
	uint32_t point = (uint32_t)c->point[k];
	const float *turn = b->layer->turn[(int)(stroke_chance(point, SALT_ANGLE) * 256)];
	float x = w->along[0][k], y = w->along[1][k];
	struct stroke s = { .x_px = c->x_px[k],
		.y_px = c->y_px[k],
		.along = { x * turn[0] - y * turn[1], x * turn[1] + y * turn[0] },
		.half_length_px = w->half_px[k],
		.half_width_px = ink->width_px / 2,
		.alpha = w->alpha[k],
		.q = CUT_BEFORE / b->lens.near_m,
		.point = point };
	memcpy(s.rgb, ink->ink, 3);
	return s;
}

/* Those from i on, in the slab and about in the picture. */
INLINE vf find_in_slab(const struct brush *b, uint32_t i, uint32_t end, struct lane_candidates *c)
{
	const scene *s = b->f->scene;
	uint32_t at = b->view->chunk->first + i;
	struct lane_places p = load_places(s->place + at);
	struct lane_points l = project_lanes(b->view, p.q, &b->lens);
	c->point = (int32_t)at + (vi){ 0, 1, 2, 3, 4, 5, 6, 7 };
	c->x_px = l.x_px;
	c->y_px = l.y_px;
	c->depth_m = l.depth_m;
	c->spacing_m = p.spacing * s->unit_m;
	vf thick_m = thickness_of(b, c->spacing_m);
	vf reach = b->layer->ink.length_px + 4 * thick_m * l.px_per_m;
	c->left = bits((l.depth_m >= b->lens.near_m) & (l.depth_m <= b->lens.near_m + thick_m) &
		       (l.x_px >= -reach) & (l.y_px >= -reach) & (l.x_px < b->lens.width + reach) &
		       (l.y_px < b->lens.height + reach));
	c->left &= end - i < LANES ? (1u << (end - i)) - 1 : 0xff;
	if (c->left) /* leaves have normals, but are no surface */
		c->left &= bits(load_u8_whole(s->kind + at) != FEATURE_UNDIRECTED);
	return l.px_per_m;
}

void LANES_NAME(stroke_cut)(const struct brush *b, struct stroke_chain *to)
{
	const struct scene_chunk *chunk = b->view->chunk;
	float slab_m = thickness_of(b, all(chunk->spacing_most_m))[0];
	if (!b->f->camera.is_cut || b->view->near_m > b->lens.near_m + slab_m)
		return;
	for (uint32_t i = 0; i < chunk->count; i += LANES) {
		struct lane_candidates c = { .copy = 0 };
		vf px_per_m = find_in_slab(b, i, chunk->count, &c);
		if (!c.left)
			continue;
		find_normals(b,
			*(const vi_loose *)(const void *)b->f->scene->normal[chunk->first + i], &c);
		struct cut_lanes w = cut_of(b, &c, px_per_m);
		for (unsigned left = c.left & bits(w.alpha >= ALPHA_LEAST); left;
			left &= left - 1) {
			struct stroke s = stroke_of(b, &c, &w, __builtin_ctz(left));
			stroke_chain_add(to, &s);
		}
	}
}
