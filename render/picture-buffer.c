#include "acquire/picture.h"
#include "firmware-io/files.h"
#include "render/draw.h"
#include "render/light.h"
#include <math.h>
#include <png.h>
#include <string.h>
#include <zlib.h>

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

/* ---- for paper ---- */

/* Behind a PNG's signature and its first chunk, IHDR. */
#define PNG_AFTER_HEADER 33

static void put_big_endian(uint8_t *to, uint32_t value)
{
	for (int n = 0; n < 4; n++)
		to[n] = (uint8_t)(value >> (24 - 8 * n));
}

/* pHYs (PNG, section 11.3.4.3): pixels a metre, either way. */
static void put_density(GByteArray *png, double dpi)
{
	uint8_t chunk[21] = { 0, 0, 0, 9, 'p', 'H', 'Y', 's' };
	uint32_t per_m = (uint32_t)lround(dpi / 0.0254);
	guint behind = png->len - PNG_AFTER_HEADER;
	put_big_endian(chunk + 8, per_m);
	put_big_endian(chunk + 12, per_m);
	chunk[16] = 1;
	put_big_endian(chunk + 17, (uint32_t)crc32(0, chunk + 4, 13));
	g_byte_array_set_size(png, png->len + sizeof chunk);
	memmove(png->data + PNG_AFTER_HEADER + sizeof chunk, png->data + PNG_AFTER_HEADER, behind);
	memcpy(png->data + PNG_AFTER_HEADER, chunk, sizeof chunk);
}

bool picture_buffer_save_print(
	const struct picture_buffer *p, double dpi, const char *path, GError **error)
{
	png_image image = { .version = PNG_IMAGE_VERSION,
		.width = p->width,
		.height = p->height,
		.format = PNG_FORMAT_RGB,
		.flags = PNG_IMAGE_FLAG_FAST };
	g_autofree uint8_t *rgb = rgb_of(p);
	g_autoptr(GByteArray) png = g_byte_array_new();
	png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
	g_byte_array_set_size(png, (guint)size);
	if (!png_image_write_to_memory(&image, png->data, &size, 0, rgb, 0, NULL)) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "%s: cannot be written: %s",
			path, image.message);
		return false;
	}
	g_byte_array_set_size(png, (guint)size);
	put_density(png, dpi);
	return files_write(path, png->data, png->len, error);
}
