#ifndef RENDER_KIOSK_LIGHT_SUM_H
#define RENDER_KIOSK_LIGHT_SUM_H
/* The mean of pictures of one size, in linear light. */
#include "render/draw.h"

struct light_sum {
	uint32_t width, height, pictures;
	float (*rgb)[3];
};
/* Forgets what was added; the size may change. */
void light_sum_restart(struct light_sum *s, uint32_t width, uint32_t height);
void light_sum_add(struct light_sum *s, const struct picture_buffer *p);
/* Rows of blue, green, red, 255. */
void light_sum_mean(const struct light_sum *s, uint8_t (*ret_bgrx)[4]);
void light_sum_clear(struct light_sum *s);

/* Where the n-th picture's view lies, in parts of a pixel, -0.5..0.5: points that fill the pixel evenly however many there are
 * (Halton 1964, bases 2 and 3); the first is in the middle. */
void light_sum_shift(uint32_t n, double ret_px[2]);

#endif
