#ifndef ACQUIRE_PICTURE_H
#define ACQUIRE_PICTURE_H
/* Pictures of a panorama for people: PNG, one pixel a cell. */
#include "acquire/panorama.h"

enum picture {
	PICTURE_RANGE, /* false colour over the logarithm of range: near is warm, far is cold; no
			  return black */
	PICTURE_INTENSITY, /* grey, stretched to what the panorama holds; corrected for range */
	PICTURE_COLOUR,    /* as photographed; needs p->rgb */
	PICTURE_CELLS,     /* measured white, filled orange, no return blue, empty black */
	PICTURES
};
extern const char *const picture_names[]; /* "range", "intensity", ... */

/* Replaces the file as a whole. false: cannot be written, or no colour. */
bool picture_save(const panorama *p, enum picture kind, const char *path, GError **error);
/* The same in memory: 3 bytes a cell; caller frees. PICTURE_COLOUR needs p->rgb. */
uint8_t *picture_pixels(const panorama *p, enum picture kind);
/* Any picture, likewise: 3 bytes a pixel, sRGB, row by row. */
bool picture_write(
	const char *path, const uint8_t *rgb, uint32_t width, uint32_t height, GError **error);
/* The same file as bytes in memory; caller unrefs. NULL: memory did not suffice. */
GBytes *picture_png(const uint8_t *rgb, uint32_t width, uint32_t height);

#endif
