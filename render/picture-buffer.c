#include "acquire/picture.h"
#include "render/draw.h"
#include "render/light.h"

struct picture_buffer picture_buffer_new(uint32_t width, uint32_t height)
{
	return (struct picture_buffer){ width, height, g_malloc_n((size_t)width * height, 4) };
}

void picture_buffer_clear(struct picture_buffer *p)
{
	g_clear_pointer(&p->rgba, g_free);
}

struct picture_buffer picture_buffer_reduced(const struct picture_buffer *p, uint32_t factor)
{
	struct picture_buffer r = picture_buffer_new(p->width / factor, p->height / factor);
	const float *light = light_of_bytes();
	const uint8_t *srgb = light_srgb_bytes();
#pragma omp parallel for
	for (uint32_t y = 0; y < r.height; y++)
		for (uint32_t x = 0; x < r.width; x++)
			for (int k = 0; k < 4; k++) {
				float sum = 0;
				for (uint32_t n = 0; n < factor * factor; n++)
					sum += light[p->rgba[(size_t)(y * factor + n / factor) *
								     p->width +
							     x * factor + n % factor][k]];
				sum /= (float)(factor * factor);
				r.rgba[(size_t)y * r.width + x][k] =
					srgb[(int)(sum * (LIGHT_STEPS - 1) + 0.5f)];
			}
	return r;
}

static uint8_t *rgb_of(const struct picture_buffer *p)
{
	uint8_t *rgb = g_malloc_n((size_t)p->width * p->height, 3);
	for (size_t i = 0; i < (size_t)p->width * p->height; i++)
		for (int k = 0; k < 3; k++)
			rgb[3 * i + (size_t)k] = p->rgba[i][k];
	return rgb;
}

bool picture_buffer_save(const struct picture_buffer *p, const char *path, GError **error)
{
	g_autofree uint8_t *rgb = rgb_of(p);
	return picture_write(path, rgb, p->width, p->height, error);
}
