#ifndef RENDER_BAND_DRAW_LANES_H
#define RENDER_BAND_DRAW_LANES_H
/* Strokes of a band, eight pixels at a time. Internal to band-draw.c. */
#include "render/bands.h"

LANES_DECLARE(void, band_draw,
	(const struct band *b, const struct frame_layer *l, const struct band_strokes *strokes,
		const visibility_mask *m, const struct band_ink *ink, enum kernel kernel,
		enum band_blend blend));

#endif
