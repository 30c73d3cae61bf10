#include "acquire/picture.h"
#include <errno.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const picture_names[] = { "range", "intensity", "colour", "cells", NULL };

#define PERCENTILE_LOW  0.01
#define PERCENTILE_HIGH 0.99

struct stretch {
	float low, high;
};

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* Percentiles of a sample of the cells that have a range. */
static struct stretch find_stretch(const panorama *p, float (*value)(const panorama *, size_t))
{
	size_t n = (size_t)p->desc.columns * p->desc.rows, step = MAX(n / 100000, 1) | 1, kept = 0;
	g_autofree float *sample = g_new(float, n / step + 1);
	for (size_t i = 0; i < n; i += step)
		if (p->range_m[i] > 0)
			sample[kept++] = value(p, i);
	if (kept == 0)
		return (struct stretch){ 0, 1 };
	qsort(sample, kept, sizeof *sample, by_value);
	struct stretch s = { sample[(size_t)(PERCENTILE_LOW * (kept - 1))],
		sample[(size_t)(PERCENTILE_HIGH * (kept - 1))] };
	/* A thousandth is nothing beside a great number: then the next one that a float can hold.
	 */
	s.high = fmaxf(s.high, fmaxf(s.low + 1e-3f, nextafterf(s.low, INFINITY)));
	return s;
}

static float log_range(const panorama *p, size_t i)
{
	return logf(p->range_m[i]);
}

/* What falls with the square of the range says little of the surface: half of that is taken back.
 */
static float levelled_intensity(const panorama *p, size_t i)
{
	return p->intensity[i] * (1 + p->range_m[i] / 10);
}

/* Turbo-like ramp by cosines: warm near, cold far, no two neighbours alike, lightness rising to the
 * middle. */
static void ramp(float t, uint8_t rgb[3])
{
	static const float stops[][3] = { { 122, 4, 3 }, { 221, 61, 8 }, { 251, 154, 44 },
		{ 225, 221, 55 }, { 150, 250, 80 }, { 49, 242, 153 }, { 40, 187, 236 },
		{ 70, 107, 227 }, { 48, 18, 59 } };
	int last = G_N_ELEMENTS(stops) - 1;
	float x = CLAMP(t, 0.0f, 1.0f) * last;
	int k = MIN((int)x, last - 1);
	for (int c = 0; c < 3; c++)
		rgb[c] = (uint8_t)lrintf(stops[k][c] + (stops[k + 1][c] - stops[k][c]) * (x - k));
}

static void colour_range(const panorama *p, size_t i, const struct stretch *s, uint8_t rgb[3])
{
	if (p->range_m[i] > 0)
		ramp((log_range(p, i) - s->low) / (s->high - s->low), rgb);
}

static void colour_intensity(const panorama *p, size_t i, const struct stretch *s, uint8_t rgb[3])
{
	float t = CLAMP((levelled_intensity(p, i) - s->low) / (s->high - s->low), 0.0f, 1.0f);
	if (p->range_m[i] > 0)
		memset(rgb, (int)lrintf(255 * powf(t, 1 / 1.8f)), 3);
}

static void colour_photo(const panorama *p, size_t i, const struct stretch *s, uint8_t rgb[3])
{
	(void)s;
	memcpy(rgb, p->rgb + 3 * i, 3);
}

static void colour_cell(const panorama *p, size_t i, const struct stretch *s, uint8_t rgb[3])
{
	static const uint8_t palette[][3] = { { 0, 0, 0 }, { 255, 255, 255 }, { 240, 140, 30 },
		{ 60, 100, 200 } };
	(void)s;
	memcpy(rgb, palette[p->cell[i] & 3], 3);
}

static const struct {
	void (*colour)(const panorama *, size_t, const struct stretch *, uint8_t *rgb);
	float (*value)(const panorama *, size_t);
} painters[PICTURES] = {
	[PICTURE_RANGE] = { colour_range, log_range },
	[PICTURE_INTENSITY] = { colour_intensity, levelled_intensity },
	[PICTURE_COLOUR] = { colour_photo, NULL },
	[PICTURE_CELLS] = { colour_cell, NULL },
};

bool picture_write(
	const char *path, const uint8_t *rgb, uint32_t width, uint32_t height, GError **error)
{
	png_image image = { .version = PNG_IMAGE_VERSION,
		.width = width,
		.height = height,
		.format = PNG_FORMAT_RGB };
	image.flags = PNG_IMAGE_FLAG_FAST;
	g_autofree char *beside = g_strconcat(path, ".new", NULL);
	if (!png_image_write_to_file(&image, beside, 0, rgb, 0, NULL)) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "%s: cannot be written: %s",
			path, image.message);
		remove(beside);
		return false;
	}
	if (rename(beside, path) == 0)
		return true;
	g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", path,
		g_strerror(errno));
	remove(beside);
	return false;
}

GBytes *picture_png(const uint8_t *rgb, uint32_t width, uint32_t height)
{
	png_image image = { .version = PNG_IMAGE_VERSION,
		.width = width,
		.height = height,
		.format = PNG_FORMAT_RGB,
		.flags = PNG_IMAGE_FLAG_FAST };
	/* What it will take is not known before: as much as it can be. */
	png_alloc_size_t length = PNG_IMAGE_PNG_SIZE_MAX(image);
	uint8_t *bytes = g_try_malloc(length);
	if (!bytes || !png_image_write_to_memory(&image, bytes, &length, 0, rgb, 0, NULL)) {
		g_free(bytes);
		return NULL;
	}
	return g_bytes_new_take(g_realloc(bytes, length), length);
}

uint8_t *picture_pixels(const panorama *p, enum picture kind)
{
	size_t n = (size_t)p->desc.columns * p->desc.rows;
	struct stretch s = painters[kind].value ? find_stretch(p, painters[kind].value)
						: (struct stretch){ 0, 1 };
	uint8_t *rgb = g_malloc0(3 * n);
#pragma omp parallel for
	for (size_t i = 0; i < n; i++)
		painters[kind].colour(p, i, &s, rgb + 3 * i);
	return rgb;
}

bool picture_save(const panorama *p, enum picture kind, const char *path, GError **error)
{
	if (kind == PICTURE_COLOUR && !p->rgb) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL, "%s: this scan has no colour",
			path);
		return false;
	}
	g_autofree uint8_t *rgb = picture_pixels(p, kind);
	return picture_write(path, rgb, p->desc.columns, p->desc.rows, error);
}
