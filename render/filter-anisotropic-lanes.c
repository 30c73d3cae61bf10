#include "process/lanes.h"
#include "render/filter-anisotropic.h"
#include "render/filter-lanes.h"
#include <math.h>

typedef float v4 __attribute__((vector_size(16)));

void LANES_NAME(filter_anisotropic_widen)(const void *data, uint32_t from, uint32_t end)
{
	const struct anisotropic_pass *p = data;
	const struct filter_image *i = p->image;
	int32_t reach = (int32_t)p->reach;
	for (uint32_t y = from; y < end; y++) {
		int32_t at = CLAMP((int32_t)y - reach, 0, (int32_t)i->height - 1);
		const uint8_t(*row)[4] = i->rgba + (size_t)at * i->width;
		v4 *to = (v4 *)(void *)(p->wide + (size_t)y * p->pitch);
		for (int32_t x = 0; x < (int32_t)p->pitch; x++) {
			const uint8_t *rgb = row[CLAMP(x - reach, 0, (int32_t)i->width - 1)];
			v4 c = { rgb[0], rgb[1], rgb[2], 0 };
			c *= 1.f / 255;
			c[3] = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
			to[x] = c;
		}
	}
}

/* 1 / (1 + (1000 v)^(sharpness / 2)), v: the variance. */
INLINE vf weights_of(vf variance, float half_sharpness)
{
	return 1 / (1 + exp2_of(half_sharpness * log2_of(1000 * variance + 1e-12f)));
}

INLINE float sum_of(vf x)
{
	x += __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3);
	x += __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5);
	return x[0] + x[1];
}

/* From the means of the eight sectors: red, green, blue, squares. */
INLINE void put(const struct anisotropic_pass *p, float mean[4][LANES], uint8_t to[4])
{
	vf c[3], variance = load(mean[3]);
	for (int n = 0; n < 3; n++) {
		c[n] = load(mean[n]);
		variance -= c[n] * c[n];
	}
	vf weight = weights_of(magnitude(variance), p->sharpness / 2);
	float by = 255 / sum_of(weight);
	for (int n = 0; n < 3; n++)
		to[n] = (uint8_t)(sum_of(c[n] * weight) * by + 0.5f);
	to[3] = 255;
}

/* Two pixels side by side, whose ellipse is the same; count: how many of them there are. */
INLINE void paint(const struct anisotropic_pass *p, const float *middle, uint32_t ellipse,
	uint8_t (*to)[4], uint32_t count)
{
	float mean[2][4][LANES];
	const uint32_t *first = &p->first[ellipse * ANISOTROPIC_SECTORS];
	for (int k = 0; k < ANISOTROPIC_SECTORS; k++) {
		vf one = { 0 }, other = { 0 };
		const struct anisotropic_tap *tap = p->tap + first[k], *end = p->tap + first[k + 1];
		for (; tap < end; tap++) {
			one += load(middle + 4 * (ptrdiff_t)tap->offset) * tap->weight;
			other += load(middle - 4 * (ptrdiff_t)tap->offset) * tap->weight;
		}
		for (int n = 0; n < 2; n++)
			for (int c = 0; c < 4; c++) {
				mean[n][c][k] = one[4 * n + c];
				mean[n][c][k + ANISOTROPIC_SECTORS] = other[4 * n + c];
			}
	}
	for (uint32_t n = 0; n < count; n++)
		put(p, mean[n], to[n]);
}

void LANES_NAME(filter_anisotropic_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct anisotropic_pass *p = data;
	const struct filter_image *i = p->image;
	for (uint32_t y = from; y < end; y++) {
		const float *row = p->wide[(size_t)(y + p->reach) * p->pitch + p->reach];
		const uint16_t *ellipse = p->ellipse + (size_t)(y / 2) * p->flow.width;
		for (uint32_t x = 0; x < i->width; x += 2)
			paint(p, row + 4 * (size_t)x, ellipse[x / 2],
				i->spare + (size_t)y * i->width + x, MIN(2, i->width - x));
	}
}
