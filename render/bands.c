#include "render/bands.h"
#include <math.h>

/* Rows that the stroke may touch. */
static float reach_down(const struct stroke *s)
{
	float x = s->along_px[0], y = s->along_px[1], length2 = x * x + y * y;
	float across = length2 > 0 ? fabsf(x) / sqrtf(length2) : 1;
	return fabsf(y) + across * s->half_width_px + 1;
}

static bool bands_of(
	const struct stroke *s, uint32_t height, uint32_t *ret_first, uint32_t *ret_last)
{
	float reach = reach_down(s), low = s->y_px - reach, high = s->y_px + reach;
	if (high < 0 || low >= (float)height)
		return false;
	*ret_first = (uint32_t)fmaxf(low, 0) / BAND_ROWS;
	*ret_last = (uint32_t)fminf(high, (float)(height - 1)) / BAND_ROWS;
	return true;
}

void band_lists_fill(band_lists *b, const stroke_list *strokes, uint32_t height)
{
	uint32_t first, last, total = 0;
	b->bands = (height + BAND_ROWS - 1) / BAND_ROWS;
	b->end = g_new0(uint32_t, b->bands + 1);
	for (uint32_t n = 0; n < strokes->count; n++)
		if (bands_of(&strokes->stroke[n], height, &first, &last))
			for (uint32_t k = first; k <= last; k++)
				b->end[k]++;
	for (uint32_t k = 0; k < b->bands; k++) {
		uint32_t own = b->end[k];
		b->end[k] = total; /* where it begins, for now */
		total += own;
	}
	b->which = g_new(uint32_t, total + 1);
	for (uint32_t n = 0; n < strokes->count; n++)
		if (bands_of(&strokes->stroke[n], height, &first, &last))
			for (uint32_t k = first; k <= last; k++)
				b->which[b->end[k]++] = n;
}

void band_lists_clear(band_lists *b)
{
	g_clear_pointer(&b->end, g_free);
	g_clear_pointer(&b->which, g_free);
}
