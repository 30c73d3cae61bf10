#ifndef RENDER_SURFACE_LANES_H
#define RENDER_SURFACE_LANES_H
/* Directions on surfaces, of eight points at a time: in their planes, on the screen, and how they are bent. Internal to stroke-lanes.c,
 * hatch-lanes.c, contour-lanes.c and paint-lanes.c; all is inlined. */
#include "render/scene-bend.h"
#include "render/stroke-shows.h"

INLINE void cross_lanes(const vf a[3], const vf b[3], vf ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

INLINE vf dot_lanes(const vf a[3], const vf b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Into the plane of the unit normal; what is left of its length is returned. */
INLINE vf lay_flat(const vf normal[3], vf v[3])
{
	vf up = dot_lanes(normal, v);
	for (int k = 0; k < 3; k++)
		v[k] -= up * normal[k];
	vf length = root(dot_lanes(v, v));
	vf unit = 1 / most(length, all(1e-6f));
	for (int k = 0; k < 3; k++)
		v[k] *= unit;
	return length;
}

/* Curvatures k1 and k2 of points that stand in a row. */
INLINE void bends_of(const uint8_t (*bend)[2], uint32_t at, vf ret[2])
{
	vi both = load_u16_whole((const uint16_t *)(const void *)bend[at]);
	const float *table = scene_bend_table();
	ret[0] = (vf)gather(table, both & 255, 4);
	ret[1] = (vf)gather(table, both >> 8 & 255, 4);
}

/* A way on the screen: what is left of its length there, and how 1/depth goes along it. */
struct way_lanes {
	vf along[2], part, slope;
};

INLINE struct way_lanes way_on_screen(
	const struct brush *b, const struct lane_candidates *c, const vf way[3])
{
	vf ray[2];
	rays_of(b, c, ray);
	vf x = way[0] - ray[0] * way[2], y = way[1] - ray[1] * way[2];
	vf part = root(x * x + y * y), unit = 1 / most(part, all(1e-3f));
	struct way_lanes w = { { x * unit, y * unit }, part };
	w.slope = -way[2] / (c->depth_m * b->lens.focal_px * most(part, all(1e-3f)) *
				    LENS_STRETCH(&b->lens, c->depth_m));
	return w;
}

/* 1/depth over the screen, of the planes through what is flat. */
INLINE void plane_slopes(
	const struct brush *b, const struct lane_candidates *c, vf reach_px, vf ret[2])
{
	vf away = along_of(b, c) * c->depth_m * b->lens.focal_px *
		  LENS_STRETCH(&b->lens, c->depth_m),
	   steepest = 0.5f / (c->depth_m * most(reach_px, all(1)));
	vi some = c->is_flat & (magnitude(away) > 1e-6f);
	for (int n = 0; n < 2; n++)
		ret[n] = where(some, least(most(c->normal[n] / away, -steepest), steepest));
}

#endif
