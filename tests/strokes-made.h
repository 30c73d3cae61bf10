#ifndef TESTS_STROKES_MADE_H
#define TESTS_STROKES_MADE_H
/* The strokes of small made scenes (scene-made.h). */
#include "tests/scene-made.h"

/* Pictures are 300 high, so a pixel is four of a style's. */
#define HEIGHT 300u
#define STEADY                                                                                     \
	"\"opacity\":1,\"opacity_variation\":0,\"length_variation\":0,\"degree\":0,\"tooth\":0"

/* Free with stroke_lists_free. masked: without what others hide. */
static inline stroke_list *strokes_of(const frame *f, bool masked)
{
	uint32_t count;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	g_autoptr(visibility_mask) m = masked ? visibility_mask_new(f, views, count) : NULL;
	return stroke_lists_new(f, m, views, count);
}

#endif
