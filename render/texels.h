#ifndef RENDER_TEXELS_H
#define RENDER_TEXELS_H
/* Texels are planes of 8-bit values, row by row: what stroke and paper textures have in common.
 * Functions keep no state; any thread. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define TEXELS_SIDE_MAX 4096u /* of a picture that is read, either way */

/* Resamples in (width x height) to out (to_width x to_height), all of which are at least 1: each
 * texel is the mean of the area that it covers, smaller or larger. What rounding takes from one
 * texel the next one gets, so the mean stays to within half a level of the last texel; texels of
 * an area that is all 0 stay 0. */
void texels_scale(const uint8_t *in, uint32_t width, uint32_t height, uint8_t *out,
	uint32_t to_width, uint32_t to_height);
double texels_mean(const uint8_t *texel, size_t texels); /* 0..255 */

/* Whether a texture's name means a file: it has a '/' or ends in ".png". */
bool texels_is_path(const char *name);

/* What a PNG's pixels are read as. */
enum texels_of {
	TEXELS_INK,   /* darkness times opacity: 255 is opaque black */
	TEXELS_LIGHT, /* sRGB grey over white: 255 is white */
};
/* Reads a PNG of any kind; caller frees with g_free.
 * NULL: one sentence with the path (G_FILE_ERROR): there is none, it is not a PNG or broken, or a
 * side is above TEXELS_SIDE_MAX. */
uint8_t *texels_read_png(
	const char *path, enum texels_of what, uint32_t *width, uint32_t *height, GError **error);
/* All of it, four bytes a pixel: red, green, blue in sRGB, opacity; not multiplied. The same errors. */
uint8_t *texels_read_png_rgba(const char *path, uint32_t *width, uint32_t *height, GError **error);

#endif
