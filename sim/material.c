#include "sim/material.h"
#include "sim/noise.h"

enum world_optics material_optics(const struct material *m)
{
	return m->kind == MATERIAL_GLASS   ? WORLD_GLASS
	       : m->kind == MATERIAL_WATER ? WORLD_WATER_SURFACE
					   : WORLD_DIFFUSE;
}

/* How much of x-w/2..x+w/2 lies in the joints, which are the first `joint` of every `cell`. */
static float joint_share(float x, float cell, float joint, float w)
{
	float a = (x - 0.5f * w) / cell, b = (x + 0.5f * w) / cell, share = joint / cell;
	int ia = floor_int(a), ib = floor_int(b);
	float ra = a - (float)ia, rb = b - (float)ib;
	float sum =
		(float)(ib - ia) * share + (rb < share ? rb : share) - (ra < share ? ra : share);
	return clamp_unit(sum / (b - a));
}

/* 1 where features are well wider than the footprint, 0 where they are below it. */
static float visible(float features_per_m, float footprint_m)
{
	return clamp_unit(1.6f - 1.3f * features_per_m * footprint_m);
}

/* Brighter or darker, and warmer or cooler, by two hashes. */
static vec vary(vec colour, uint32_t h, float variety, float warmth)
{
	float light = 1 + variety * (2 * hash_unit(h) - 1);
	float warm = warmth * (2 * hash_unit(hash_u32(h)) - 1);
	return colour * light * (vec){ 1 + warm, 1, 1 - warm };
}

static vec lay_cells(const struct material *m, vec colour, float u, float v, float footprint)
{
	float row = v / m->cell_v_m;
	int j = floor_int(row);
	float shifted = u + (float)(j & 1) * m->bond * m->cell_u_m;
	uint32_t h = hash_cell(floor_int(shifted / m->cell_u_m), j, 0, m->seed);
	float seen = visible(0.7f / MIN(m->cell_u_m, m->cell_v_m), footprint);
	colour = vary(colour, h, m->variety * seen, m->warmth * seen);
	if (m->joint_m <= 0)
		return colour;
	float w = MAX(footprint, 0.002f);
	float along = joint_share(shifted, m->cell_u_m, m->joint_m, w);
	float across = joint_share(v, m->cell_v_m, m->joint_m, w);
	return mix(colour, m->joint_colour, 1 - (1 - along) * (1 - across));
}

/* Coordinates on a surface: u level, v up the slope; on level ground east and north. */
static void lay_out(vec place, vec normal, float *ret_u, float *ret_v)
{
	float level = normal[0] * normal[0] + normal[1] * normal[1];
	*ret_u = place[0];
	*ret_v = place[1];
	if (level < 0.05f)
		return;
	vec t = (vec){ -normal[1], normal[0], 0 } / sqrtf(level);
	*ret_u = dot(place, t);
	*ret_v = dot(place, cross(normal, t));
	if (normal[2] < 0.3f && normal[2] > -0.3f)
		*ret_v = place[2];
}

vec material_albedo(
	const struct material *m, vec place, vec normal, float footprint_m, uint32_t face)
{
	vec colour = m->colour;
	if (m->kind == MATERIAL_LEAF)
		colour = vary(colour, hash_u32(face ^ m->seed), m->variety, m->warmth);
	if (m->cell_u_m > 0) {
		float u, v;
		lay_out(place, normal, &u, &v);
		colour = lay_cells(m, colour, u, v, footprint_m);
	}
	float light = 1, seen = m->grain > 0 ? visible(m->grain_per_m, footprint_m) : 0;
	if (seen > 0) {
		vec p = place * m->grain_per_m;
		float stretch = m->grain_stretch > 0 ? m->grain_stretch : 1;
		light += m->grain * seen * noise_3d(p[0], p[1], p[2] / stretch, m->seed);
	}
	if (m->stain > 0) {
		vec p = place * m->stain_per_m;
		light += m->stain * noise_3d(p[0], p[1], p[2], m->seed + 1);
		light += m->stain * 0.5f *
			 noise_3d(p[0] * 2.7f, p[1] * 2.7f, p[2] * 2.7f, m->seed + 2);
	}
	colour *= light;
	for (int i = 0; i < 3; i++)
		colour[i] = colour[i] < 0.01f ? 0.01f : colour[i] > 0.95f ? 0.95f : colour[i];
	return colour;
}
