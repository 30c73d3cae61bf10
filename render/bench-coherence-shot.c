#include "render/bench-coherence-private.h"
#include "render/light.h"

static uint8_t lightness_of(const uint8_t rgba[4])
{
	return (uint8_t)((77 * rgba[0] + 150 * rgba[1] + 29 * rgba[2] + 128) >> 8);
}

/* Of as many of them as there are inside. from and to: of pixels that are step apart. */
static void mean_along(const float *from, float *to, uint32_t count, size_t step)
{
	const int half = SOFT_PX / 2;
	float sum = 0;
	int in = 0;
	for (int i = -half; i < (int)count; i++) {
		if (i + half < (int)count) {
			sum += from[(size_t)(i + half) * step];
			in++;
		}
		if (i - half > 0) {
			sum -= from[(size_t)(i - half - 1) * step];
			in--;
		}
		if (i >= 0)
			to[(size_t)i * step] = sum / (float)in;
	}
}

static float *soften(const float *plane, uint32_t width, uint32_t height)
{
	g_autofree float *rows = g_new(float, (size_t)width *height);
	float *soft = g_new(float, (size_t)width *height);
#pragma omp parallel
	{
#pragma omp for schedule(static)
		for (uint32_t y = 0; y < height; y++)
			mean_along(plane + (size_t)y * width, rows + (size_t)y * width, width, 1);
#pragma omp for schedule(static)
		for (uint32_t x = 0; x < width; x++)
			mean_along(rows + x, soft + x, height, width);
	}
	return soft;
}

static void read_picture(struct shot *s, const struct picture_buffer *p)
{
	const float *light = light_of_bytes();
	size_t pixels = (size_t)p->width * p->height;
	s->luminance = g_new(float, pixels);
	s->lightness = g_new(uint8_t, pixels);
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < pixels; i++) {
		float rgb[3];
		for (int k = 0; k < 3; k++)
			rgb[k] = light[p->rgba[i][k]];
		s->luminance[i] = light_luminance(rgb);
		s->lightness[i] = lightness_of(p->rgba[i]);
	}
	s->soft = soften(s->luminance, p->width, p->height);
}

bool shot_take(struct shot *ret, frame *f, const struct camera *c, const visibility_mask *shared,
	struct picture_buffer *picture, GError **error)
{
	if (!frame_move(f, c, error))
		return false;
	draw_frame(NULL, f, picture, NULL);
	*ret = (struct shot){ .camera = *c, .layers = f->layers };
	ret->views = chunk_views_new(f, &ret->view_count);
	if (!shared)
		ret->own_mask = visibility_mask_new(f, ret->views, ret->view_count);
	ret->mask = shared ? shared : ret->own_mask;
	ret->lists = stroke_lists_new(f, ret->mask, ret->views, ret->view_count);
	read_picture(ret, picture);
	return true;
}

void shot_clear(struct shot *s)
{
	visibility_mask_free(s->own_mask);
	stroke_lists_free(s->lists, s->layers);
	g_free(s->views);
	g_free(s->luminance);
	g_free(s->soft);
	g_free(s->lightness);
	*s = (struct shot){ 0 };
}
