#ifndef RENDER_VECTOR_COATS_H
#define RENDER_VECTOR_COATS_H
/* Which strokes of a layer may be one path: of shapes in a path those that overlap leave ink once, so strokes that do lie on each other
 * go to different coats. Each stroke takes the first coat that is bare all over its place.
 *
 * One thread. */
#include "render/vector-shape.h"

#define VECTOR_COATS 16u /* what lies on more than so many others goes to the last */

typedef struct vector_coats vector_coats;
/* For a picture so large, in cells of so many pixels. */
vector_coats *vector_coats_new(uint32_t width, uint32_t height, float cell_px);
void vector_coats_free(vector_coats *c); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(vector_coats, vector_coats_free)
void vector_coats_clear(vector_coats *c); /* all is bare again */
/* 0 to VECTOR_COATS - 1; it is taken from then on. Of dots width_px is the diameter. */
uint32_t vector_coats_take(
	vector_coats *c, const struct stroke *s, enum vector_form form, float width_px);

#endif
