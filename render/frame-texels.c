#include "render/frame.h"
#include <string.h>

/* 0 outside. */
static uint32_t texel_at(const stroke_texture *t, uint32_t variant, int x, int y)
{
	if (x < 0 || y < 0 || x >= (int)t->length || y >= (int)t->width)
		return 0;
	return stroke_texture_variant(t, variant)[(uint32_t)y * t->length + (uint32_t)x];
}

uint32_t *frame_pack_texels(const stroke_texture *t, uint32_t *ret_shift)
{
	uint32_t shift = *ret_shift = g_bit_storage(t->length + 1);
	size_t texels = frame_texels(t, shift);
	uint32_t *ret = g_new0(uint32_t, texels * t->variants);
	for (uint32_t v = 0; v < t->variants; v++)
		for (int y = 0; y <= (int)t->width; y++)
			for (int x = 0; x <= (int)t->length; x++)
				ret[texels * v + ((uint32_t)y << shift) + (uint32_t)x] =
					texel_at(t, v, x - 1, y - 1) |
					texel_at(t, v, x, y - 1) << 8 |
					texel_at(t, v, x - 1, y) << 16 | texel_at(t, v, x, y) << 24;
	return ret;
}

uint8_t *frame_pack_few_texels(const stroke_texture *t)
{
	uint32_t pitch = t->length + 2;
	if (pitch * (t->width + 2) > FRAME_FEW_TEXELS)
		return NULL;
	uint8_t *ret = g_malloc0(FRAME_FEW_TEXELS * t->variants);
	for (uint32_t v = 0; v < t->variants; v++)
		for (uint32_t y = 0; y < t->width; y++)
			memcpy(ret + FRAME_FEW_TEXELS * v + pitch * (y + 1) + 1,
				stroke_texture_variant(t, v) + (size_t)y * t->length, t->length);
	return ret;
}
