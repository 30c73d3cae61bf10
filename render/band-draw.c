#include "render/band-draw-lanes.h"

enum kernel band_kernel_of(const struct frame_layer *l)
{
	if (l->texture || l->paint)
		return KERNEL_TEXTURE;
	return step_is_dots(l->step) ? KERNEL_SPRITE : KERNEL_LINE;
}

enum band_blend band_blend_of(const struct frame_layer *l)
{
	if (l->paint)
		return BAND_LAID;
	if (l->is_profile)
		return l->ink.blend == BLEND_PAINT ? BAND_COVERING : BAND_STRONGEST;
	if (l->ink.blend == BLEND_PAINT)
		return BAND_PAINTED;
	return l->ink.colour == COLOUR_POINT ? BAND_COLOURED : BAND_INKED;
}

void band_draw(const struct band *b, const frame *f, const struct frame_layer *l,
	const struct band_strokes *strokes, const visibility_mask *m, const struct band_ink *ink)
{
	LANES_OF(f->lanes, band_draw)
	(b, l, strokes, m, ink, band_kernel_of(l), band_blend_of(l));
}
