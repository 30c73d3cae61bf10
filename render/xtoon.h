#ifndef RENDER_XTOON_H
#define RENDER_XTOON_H
/* An X-Toon texture (Barla, Thollot & Markosian 2006; Wagner et al. 2022, section 3.1): what a surface is drawn like by how light it is,
 * across, and by how far away, down. Its alpha is the chance that strokes have to be drawn.
 *
 * It is made of stops, or read from a PNG, whose columns go from dark to light and whose rows from near to far. Stops are a JSON list of
 *
 *     { "brightness": 0..1, "depth": 0..1, "colour": "#rrggbb", "chance": 0..1 }
 *
 * Without a depth a stop is of all depths, without a colour it is of ink, without a chance it is 1. Between stops of one depth, and
 * between depths, values go in even steps; beyond the outermost they stay.
 *
 * Const once made; then any thread may read it. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define XTOON_COLUMNS   256u
#define XTOON_ROWS_MOST 64u
#define XTOON_STOPS_MAX 64u

typedef struct xtoon xtoon;
struct xtoon {
	uint32_t rows;      /* 1: depth does not matter */
	uint8_t (*rgba)[4]; /* [rows * XTOON_COLUMNS], sRGB */
};
/* source: a JSON list of stops that was checked when it was read (style-parameter.c), or the path of a PNG. ink: of stops without a
 * colour. Errors are of texels_read_png_rgba. */
xtoon *xtoon_new(const char *source, const uint8_t ink[3], GError **error);
void xtoon_free(xtoon *x); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(xtoon, xtoon_free)

#endif
