#ifndef RENDER_EDL_H
#define RENDER_EDL_H
/* Eye-dome lighting (Boucheny 2009): shades by depth alone. A pixel is darker the more its neighbours on a ring stand before it. */
#include "render/bands.h"

#include <math.h>

#define EDL_AROUND 8
/* Where neighbours lie, in whole pixels: a ring of at least one. */
static inline void edl_ring(float radius_px, int ret[EDL_AROUND][2])
{
	static const float ring[EDL_AROUND][2] = { { 1, 0 }, { 0.7071f, 0.7071f }, { 0, 1 },
		{ -0.7071f, 0.7071f }, { -1, 0 }, { -0.7071f, -0.7071f }, { 0, -1 },
		{ 0.7071f, -0.7071f } };
	for (int n = 0; n < EDL_AROUND; n++)
		for (int k = 0; k < 2; k++)
			ret[n][k] = (int)lrintf(fmaxf(radius_px, 1) * ring[n][k]);
}

/* What is left of the light; deeper: the sum over the ring of how much deeper it is, in octaves of depth. */
static inline float edl_light(float strength, float deeper)
{
	return expf(-300 * 0.1f * strength * deeper / EDL_AROUND);
}

/* Multiplies the canvas where a pipeline has a step "edl". */
void edl_shade(
	const struct band *b, const frame *f, const visibility_mask *m, float *const canvas[3]);

#endif
