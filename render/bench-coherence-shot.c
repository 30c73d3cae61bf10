#include "render/bench-coherence-private.h"
#include "render/light.h"

static uint8_t lightness_of(const uint8_t rgba[4])
{
	return (uint8_t)((77 * rgba[0] + 150 * rgba[1] + 29 * rgba[2] + 128) >> 8);
}

static float *read_luminance(const struct picture_buffer *p)
{
	const float *light = light_of_bytes();
	size_t pixels = (size_t)p->width * p->height;
	float *ret = g_new(float, pixels);
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < pixels; i++) {
		float rgb[3];
		for (int k = 0; k < 3; k++)
			rgb[k] = light[p->rgba[i][k]];
		ret[i] = light_luminance(rgb);
	}
	return ret;
}

static uint8_t *read_lightness(const struct picture_buffer *p)
{
	size_t pixels = (size_t)p->width * p->height;
	uint8_t *ret = g_new(uint8_t, pixels);
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < pixels; i++)
		ret[i] = lightness_of(p->rgba[i]);
	return ret;
}

bool shot_take(struct shot *ret, frame *f, const struct camera *c, const visibility_mask *shared,
	bool wants_depths, struct picture_buffer *picture, GError **error)
{
	if (!frame_move(f, c, error))
		return false;
	draw_frame(NULL, f, picture, NULL);
	*ret = (struct shot){ .camera = *c, .layers = f->layers };
	ret->views = chunk_views_new(f, &ret->view_count);
	if (!shared)
		ret->own_mask = visibility_mask_new(f, ret->views, ret->view_count);
	ret->mask = shared ? shared : ret->own_mask;
	if (wants_depths)
		ret->depth_m = reproject_depths(f, ret->mask, ret->views, ret->view_count);
	ret->lists = stroke_lists_new(f, ret->mask, ret->views, ret->view_count);
	ret->luminance = read_luminance(picture);
	ret->lightness = read_lightness(picture);
	return true;
}

void shot_clear(struct shot *s)
{
	visibility_mask_free(s->own_mask);
	stroke_lists_free(s->lists, s->layers);
	g_free(s->views);
	g_free(s->depth_m);
	g_free(s->luminance);
	g_free(s->lightness);
	*s = (struct shot){ 0 };
}

static float *depths_of(frame *f)
{
	uint32_t count;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	g_autoptr(visibility_mask) m = visibility_mask_new(f, views, count);
	return reproject_depths(f, m, views, count);
}

bool fine_shot_take(struct fine_shot *ret, frame *f, const struct camera *c, bool wants_depths,
	struct picture_buffer *picture, GError **error)
{
	struct camera fine = camera_scaled(c, FINE);
	if (!frame_move(f, &fine, error))
		return false;
	draw_frame(NULL, f, picture, NULL);
	*ret = (struct fine_shot){ .camera = fine,
		.depth_m = wants_depths ? depths_of(f) : NULL,
		.luminance = read_luminance(picture) };
	return true;
}

void fine_shot_clear(struct fine_shot *s)
{
	g_free(s->depth_m);
	g_free(s->luminance);
	*s = (struct fine_shot){ 0 };
}
