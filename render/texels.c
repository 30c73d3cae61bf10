#include "render/texels.h"
#include <math.h>
#include <png.h>
#include <string.h>

/* ---- resampling ---- */

/* The mean of a line's values over from..to, in texels; the first and the last count by the part
 * that is covered. */
static float mean_between(const float *line, size_t stride, uint32_t length, double from, double to)
{
	uint32_t first = (uint32_t)from, last = MIN((uint32_t)ceil(to), length);
	double sum = 0;
	for (uint32_t i = first; i < last; i++)
		sum += line[i * stride] * (fmin(to, i + 1.0) - fmax(from, i));
	return (float)(sum / (to - from));
}

static void scale_line(const float *in, size_t stride, uint32_t length, float *out,
	size_t to_stride, uint32_t to_length)
{
	double step = (double)length / to_length;
	for (uint32_t i = 0; i < to_length; i++)
		out[i * to_stride] = mean_between(in, stride, length, i * step, (i + 1) * step);
}

static void round_texels(const float *exact, uint8_t *out, size_t n)
{
	float carry = 0;
	for (size_t i = 0; i < n; i++) {
		float want = exact[i] > 0 ? exact[i] + carry : 0;
		out[i] = (uint8_t)CLAMP(lrintf(want), 0, 255);
		if (exact[i] > 0)
			carry = want - out[i];
	}
}

void texels_scale(const uint8_t *in, uint32_t width, uint32_t height, uint8_t *out,
	uint32_t to_width, uint32_t to_height)
{
	g_assert(width && height && to_width && to_height);
	g_autofree float *row = g_new(float, width),
			 *narrow = g_new(float, (size_t)to_width *height),
			 *scaled = g_new(float, (size_t)to_width *to_height);
	for (uint32_t y = 0; y < height; y++) {
		for (uint32_t x = 0; x < width; x++)
			row[x] = in[(size_t)y * width + x];
		scale_line(row, 1, width, narrow + (size_t)y * to_width, 1, to_width);
	}
	for (uint32_t x = 0; x < to_width; x++)
		scale_line(narrow + x, to_width, height, scaled + x, to_width, to_height);
	round_texels(scaled, out, (size_t)to_width * to_height);
}

double texels_mean(const uint8_t *texel, size_t texels)
{
	uint64_t sum = 0;
	for (size_t i = 0; i < texels; i++)
		sum += texel[i];
	return (double)sum / (double)texels;
}

/* ---- files ---- */

bool texels_is_path(const char *name)
{
	return strchr(name, '/') || g_str_has_suffix(name, ".png");
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(png_image, png_image_free)

/* Of what is no plain file only the name is looked at: a pipe would wait for ever, and a folder is
 * a poor sort of PNG. */
static bool begin_png(png_image *image, const char *path, GError **error)
{
	GFileError code = G_FILE_ERROR_INVAL;
	g_autofree char *why = NULL;
	if (!g_file_test(path, G_FILE_TEST_EXISTS)) {
		code = G_FILE_ERROR_NOENT;
		why = g_strdup("there is no such file");
	} else if (!g_file_test(path, G_FILE_TEST_IS_REGULAR)) {
		why = g_strdup("is not a file");
	} else if (!png_image_begin_read_from_file(image, path)) {
		why = g_strdup_printf("cannot be read as a PNG: %s", image->message);
	} else if (image->width > TEXELS_SIDE_MAX || image->height > TEXELS_SIDE_MAX) {
		why = g_strdup_printf("has %u x %u pixels, more than a texture may have (%u x %u)",
			image->width, image->height, TEXELS_SIDE_MAX, TEXELS_SIDE_MAX);
	} else {
		return true;
	}
	g_set_error(error, G_FILE_ERROR, code, "%s: %s", path, why);
	return false;
}

static uint8_t as_texel(const uint8_t grey_alpha[2], enum texels_of what)
{
	int ink = ((255 - grey_alpha[0]) * grey_alpha[1] + 127) / 255;
	return (uint8_t)(what == TEXELS_INK ? ink : 255 - ink);
}

/* Caller frees; of a format of libpng. */
static uint8_t *read_pixels(
	const char *path, unsigned format, uint32_t *width, uint32_t *height, GError **error)
{
	g_auto(png_image) image = { .version = PNG_IMAGE_VERSION };
	if (!begin_png(&image, path, error))
		return NULL;
	image.format = format;
	/* libpng takes 16 bits without a colour space for linear light; nobody draws so. */
	image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
	size_t n = (size_t)image.width * image.height;
	g_autofree uint8_t *pixel = g_malloc(PNG_IMAGE_PIXEL_SIZE(format) * n);
	if (!png_image_finish_read(&image, NULL, pixel, 0, NULL)) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED,
			"%s: cannot be read as a PNG: %s", path, image.message);
		return NULL;
	}
	*width = image.width;
	*height = image.height;
	return g_steal_pointer(&pixel);
}

uint8_t *texels_read_png(
	const char *path, enum texels_of what, uint32_t *width, uint32_t *height, GError **error)
{
	g_autofree uint8_t *pixel = read_pixels(path, PNG_FORMAT_GA, width, height, error);
	if (!pixel)
		return NULL;
	size_t n = (size_t)*width * *height;
	uint8_t *texel = g_malloc(n);
	for (size_t i = 0; i < n; i++)
		texel[i] = as_texel(pixel + 2 * i, what);
	return texel;
}

uint8_t *texels_read_png_rgba(const char *path, uint32_t *width, uint32_t *height, GError **error)
{
	return read_pixels(path, PNG_FORMAT_RGBA, width, height, error);
}
