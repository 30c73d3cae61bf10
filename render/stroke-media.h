#ifndef RENDER_STROKE_MEDIA_H
#define RENDER_STROKE_MEDIA_H
/* The alpha of each kind of stroke at a place; private to stroke-texture.c. Pure functions.
 *
 * Dry media (pencil, charcoal, chalk; stroke-media-dry.c) leave pigment on the heights of a
 * paper's tooth: where pressure is p, the highest share p of the paper takes some. Wet ones (ink,
 * brush; stroke-media-wet.c) have an outline. */
#include "render/grain.h"
#include "render/stroke-texture.h"

float stroke_gaussian(const struct stroke_place *at, uint32_t seed);
float stroke_line(const struct stroke_place *at, uint32_t seed);
float stroke_dot(const struct stroke_place *at, uint32_t seed);
float stroke_pencil(const struct stroke_place *at, uint32_t seed);
float stroke_ink_pen(const struct stroke_place *at, uint32_t seed);
float stroke_charcoal(const struct stroke_place *at, uint32_t seed);
float stroke_brush(const struct stroke_place *at, uint32_t seed);
float stroke_chalk(const struct stroke_place *at, uint32_t seed);
float stroke_bristles(const struct stroke_place *at, uint32_t seed);
float stroke_dab(const struct stroke_place *at, uint32_t seed);

/* Noise with features of so many texels along and across: -1..1, mean 0. */
static inline float media_noise(
	const struct stroke_place *at, float along, float across, uint32_t seed)
{
	enum { ENDLESS = 1 << 20 };
	return grain_noise(at->x / along, at->y / across, ENDLESS, ENDLESS, seed);
}

#endif
