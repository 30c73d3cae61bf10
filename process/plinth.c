#include "process/plinth.h"
#include "process/segment-class.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FOOT_M 0.8f /* what begins higher up has no foot */
#define WAYS   16
#define NEAR_M                                                                                     \
	0.7 /* from here on there is floor; where surfels are not much finer, as from the air, no foot is seen */
#define RING_M     0.3
#define RINGS      3
#define SEEN_LEAST 8u
#define FLOOR_RANK 0.7 /* of the levels around: beside a kerb, half of them are lower */

void plinths_clear(struct plinths *p)
{
	g_clear_pointer(&p->voxel, g_free);
	g_clear_pointer(&p->floor_m, g_free);
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Where the ground at a place would be at another, going on as it slopes. */
static double level_from(const ground *g, const double from_m[3], const double to_m[3])
{
	const struct voxel *s = &ground_surfels(g)->voxel[ground_surfel(g, from_m)];
	double level = from_m[2] - ground_height_m(g, from_m);
	return level -
	       (s->normal[0] * (to_m[0] - from_m[0]) + s->normal[1] * (to_m[1] - from_m[1])) /
		       s->normal[2];
}

/* NAN: too little of it was seen. */
static float floor_around(const ground *g, uint32_t surfel)
{
	double at[3], level[WAYS * RINGS];
	unsigned seen = 0;
	voxel_point_m(ground_surfels(g), surfel, at);
	for (int k = 0; k < WAYS * RINGS; k++) {
		double angle = 2 * G_PI * k / WAYS, far = NEAR_M + RING_M * (k / WAYS);
		double from[3] = { at[0] + far * cos(angle), at[1] + far * sin(angle), at[2] };
		if (ground_is_seen(g, from))
			level[seen++] = level_from(g, from, at);
	}
	if (seen < SEEN_LEAST)
		return NAN;
	qsort(level, seen, sizeof *level, by_value);
	return (float)level[(unsigned)(FLOOR_RANK * seen)];
}

struct plinths plinths_find(const ground *g, const voxels *v, const uint8_t *class,
	const uint8_t *ground_class, const float *height_m)
{
	const voxels *surfels = ground_surfels(g);
	struct plinths p = { g_new(uint32_t, surfels->count + 1),
		g_new0(float, surfels->count + 1) };
	memset(p.voxel, 0xFF, surfels->count * sizeof *p.voxel);
	for (uint32_t i = 0; surfels->size_m <= NEAR_M / 2 && i < v->count; i++) {
		double at[3];
		voxel_point_m(v, i, at);
		for (int k = 0; class[i] == CLASS_STRUCTURE && height_m[i] < FOOT_M && k < 9; k++) {
			double beside[3] = { at[0] + surfels->size_m * (k % 3 - 1),
				at[1] + surfels->size_m * (k / 3 - 1), at[2] };
			uint32_t s =
				ground_is_seen(g, beside) ? ground_surfel(g, beside) : VOXEL_NONE;
			if (s != VOXEL_NONE && ground_class[s] == CLASS_TERRAIN &&
				p.voxel[s] == VOXEL_NONE) {
				p.floor_m[s] = floor_around(g, s);
				p.voxel[s] = isnan(p.floor_m[s]) ? VOXEL_NONE : i;
			}
		}
	}
	return p;
}
