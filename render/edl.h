#ifndef RENDER_EDL_H
#define RENDER_EDL_H
/* Eye-dome lighting (Boucheny 2009): shades by depth alone. A pixel is darker the more its neighbours on a ring stand before it.
 *
 * Where points are farther apart than the ring is wide, plain ground that is seen aslant becomes steps from one point's disc to the
 * next: each would get a shade, and another one as soon as the eye moves. A step that the ground's own slant makes between two points
 * is none: how slanted it is, the flatter of two opposite sides tells. */
#include "render/bands.h"

#include <math.h>

#define EDL_AROUND 8
static inline float edl_radius(float radius_px)
{
	return fmaxf(radius_px, 1);
}
/* Where neighbours lie, in whole pixels: a ring of at least one. The opposite of each is half of them on. */
static inline void edl_ring(float radius_px, int ret[EDL_AROUND][2])
{
	static const float ring[EDL_AROUND][2] = { { 1, 0 }, { 0.7071f, 0.7071f }, { 0, 1 },
		{ -0.7071f, 0.7071f }, { -1, 0 }, { -0.7071f, -0.7071f }, { 0, -1 },
		{ 0.7071f, -0.7071f } };
	for (int n = 0; n < EDL_AROUND; n++)
		for (int k = 0; k < 2; k++)
			ret[n][k] = (int)lrintf(edl_radius(radius_px) * ring[n][k]);
}

/* How much deeper a pixel is than those on the ring that stand before it, in octaves of depth. than: than each. apart: how far points are
 * from each other there, by the ring's radius. */
static inline float edl_deeper(const float than[EDL_AROUND], float apart)
{
	float slant = 0, sum = 0;
	for (int n = 0; n < EDL_AROUND / 2; n++)
		slant = fmaxf(slant, fminf(fabsf(than[n]), fabsf(than[n + EDL_AROUND / 2])));
	for (int n = 0; n < EDL_AROUND; n++)
		sum += fmaxf(than[n] - apart * slant, 0);
	return sum;
}
/* What is left of the light; deeper: edl_deeper(). */
static inline float edl_light(float strength, float deeper)
{
	return expf(-300 * 0.1f * strength * deeper / EDL_AROUND);
}

/* Multiplies the canvas where a pipeline has a step "edl". */
void edl_shade(
	const struct band *b, const frame *f, const visibility_mask *m, float *const canvas[3]);

#endif
