#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H
/* Light is added, and held back by ink, in linear values; files and screens have sRGB (IEC 61966-2-1). Both 0..1. */
#include <math.h>
#include <stdint.h>

static inline float light_of_srgb(float s)
{
	return s <= 0.04045f ? s / 12.92f : powf((s + 0.055f) / 1.055f, 2.4f);
}

static inline float light_to_srgb(float l)
{
	return l <= 0.0031308f ? l * 12.92f : 1.055f * powf(l, 1 / 2.4f) - 0.055f;
}

static inline float light_luminance(const float rgb[3])
{
	return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

#define LIGHT_STEPS 4096
/* So many bytes behind them may be read, too. */
#define LIGHT_BEHIND 3
/* Of n/(LIGHT_STEPS - 1), and of each byte. Made at the first call; any thread. */
const uint8_t *light_srgb_bytes(void);
const float *light_of_bytes(void);
/* sRGB of light and light of sRGB at n/(LIGHT_STEPS - 1), n to LIGHT_STEPS: straight lines between them are off by 2e-5 at most. */
const float *light_srgb_steps(void);
const float *light_of_steps(void);

#endif
