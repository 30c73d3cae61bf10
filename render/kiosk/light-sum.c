#include "render/kiosk/light-sum.h"
#include "render/light.h"

void light_sum_restart(struct light_sum *s, uint32_t width, uint32_t height)
{
	size_t n = (size_t)width * height;
	if (!s->rgb || s->width != width || s->height != height) {
		g_free(s->rgb);
		s->rgb = g_malloc_n(n, sizeof *s->rgb);
	}
	s->width = width;
	s->height = height;
	s->pictures = 0;
}

void light_sum_add(struct light_sum *s, const struct picture_buffer *p)
{
	const float *light = light_of_bytes();
	float keep = s->pictures ? 1 : 0;
#pragma omp parallel for
	for (size_t i = 0; i < (size_t)s->width * s->height; i++)
		for (int k = 0; k < 3; k++)
			s->rgb[i][k] = (keep > 0 ? s->rgb[i][k] : 0) + light[p->rgba[i][k]];
	s->pictures++;
}

void light_sum_mean(const struct light_sum *s, uint8_t (*ret_bgrx)[4])
{
	const uint8_t *srgb = light_srgb_bytes();
	float part = (LIGHT_STEPS - 1) / (float)MAX(s->pictures, 1);
#pragma omp parallel for
	for (size_t i = 0; i < (size_t)s->width * s->height; i++) {
		for (int k = 0; k < 3; k++)
			ret_bgrx[i][2 - k] = srgb[(int)(s->rgb[i][k] * part + 0.5f)];
		ret_bgrx[i][3] = 255;
	}
}

void light_sum_clear(struct light_sum *s)
{
	g_clear_pointer(&s->rgb, g_free);
}

static double halton(uint32_t n, uint32_t base)
{
	double value = 0, part = 1;
	for (; n; n /= base) {
		part /= base;
		value += part * (n % base);
	}
	return value;
}

void light_sum_shift(uint32_t n, double ret_px[2])
{
	ret_px[0] = n ? halton(n, 2) - 0.5 : 0;
	ret_px[1] = n ? halton(n, 3) - 0.5 : 0;
}
