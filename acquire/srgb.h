#ifndef ACQUIRE_SRGB_H
#define ACQUIRE_SRGB_H
/* The curve of sRGB (IEC 61966-2-1) and back, both 0..1. */
#include <math.h>

static inline double srgb_of(double linear)
{
	return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

static inline double srgb_to_linear(double v)
{
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

#endif
