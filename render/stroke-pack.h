#ifndef RENDER_STROKE_PACK_H
#define RENDER_STROKE_PACK_H
/* A stroke in nine words instead of thirteen, as blocks keep them between the passes of a frame, which wait for memory more than they
 * reckon. Half a million of them are a frame of ours. */
#include <math.h>
#include <stdint.h>
#include <string.h>

struct stroke {
	float x_px, y_px;
	float along[2]; /* of length 1 */
	float half_length_px, half_width_px;
	float alpha; /* 0..1 */
	/* 1/depth at a pixel is q + (x - x_px) slope[0] + (y - y_px) slope[1]. */
	float q, slope[2];
	uint8_t rgb[3];
	uint8_t copy; /* 0: the point itself; else one of its patch's surface. Of hatching twice that, and 1 more of the stroke across */
	uint32_t point; /* its scene_id() */
	/* Of paint: how high it lies, 0 to PAINT_LAYS - 1; what is left of its area for being seen aslant, 255 all. */
	uint8_t lay, aslant;
};

/* Word by word; of two in one the first is below. Parts of the way along are whole numbers of 1/STROKE_ALONG; lengths have 5 bits of
 * exponent and 11 of mantissa, within 1/4096; slopes are the upper half of a float, within 1/256; alpha is in parts of
 * STROKE_ALPHA. */
enum stroke_word {
	STROKE_X,
	STROKE_Y,
	STROKE_ALONG_BOTH,
	STROKE_HALVES,
	STROKE_Q,
	STROKE_SLOPES,
	STROKE_RGB_COPY,
	STROKE_ALPHA_LAY_ASLANT,
	STROKE_POINT,
	STROKE_WORDS
};
struct stroke_packed {
	uint32_t word[STROKE_WORDS];
};

#define STROKE_ALONG 32767.f
#define STROKE_ALPHA 32768.f
/* Bits of the shortest length's float, 2^-10 px, and by how many bits those of all are shorter. */
#define STROKE_LENGTH_LEAST 0x3a800000
#define STROKE_LENGTH_SHIFT 12

static inline uint32_t stroke_bits(float x)
{
	uint32_t ret;
	memcpy(&ret, &x, sizeof ret);
	return ret;
}

static inline float stroke_float(uint32_t bits)
{
	float ret;
	memcpy(&ret, &bits, sizeof ret);
	return ret;
}

static inline uint32_t stroke_pack_along(float x)
{
	return (uint32_t)(int32_t)(x * STROKE_ALONG + (x < 0 ? -0.5f : 0.5f)) & 0xffff;
}

static inline uint32_t stroke_pack_length(float px)
{
	int32_t ret = ((int32_t)stroke_bits(px) - STROKE_LENGTH_LEAST +
			      (1 << (STROKE_LENGTH_SHIFT - 1))) >>
		      STROKE_LENGTH_SHIFT;
	return (uint32_t)(ret < 0 ? 0 : ret > 0xffff ? 0xffff : ret);
}

static inline float stroke_length_of(uint32_t packed)
{
	return stroke_float((packed << STROKE_LENGTH_SHIFT) + STROKE_LENGTH_LEAST);
}

static inline uint32_t stroke_pack_slope(float x)
{
	return (stroke_bits(x) + 0x8000) >> 16;
}

static inline struct stroke_packed stroke_pack(const struct stroke *s)
{
	return (struct stroke_packed){ {
		[STROKE_X] = stroke_bits(s->x_px),
		[STROKE_Y] = stroke_bits(s->y_px),
		[STROKE_ALONG_BOTH] =
			stroke_pack_along(s->along[0]) | stroke_pack_along(s->along[1]) << 16,
		[STROKE_HALVES] = stroke_pack_length(s->half_length_px) |
				  stroke_pack_length(s->half_width_px) << 16,
		[STROKE_Q] = stroke_bits(s->q),
		[STROKE_SLOPES] = stroke_pack_slope(s->slope[0]) | stroke_pack_slope(s->slope[1])
									   << 16,
		[STROKE_RGB_COPY] = (uint32_t)s->rgb[0] | (uint32_t)s->rgb[1] << 8 |
				    (uint32_t)s->rgb[2] << 16 | (uint32_t)s->copy << 24,
		[STROKE_ALPHA_LAY_ASLANT] = (uint32_t)(s->alpha * STROKE_ALPHA + 0.5f) |
					    (uint32_t)s->lay << 16 | (uint32_t)s->aslant << 24,
		[STROKE_POINT] = s->point,
	} };
}

static inline struct stroke stroke_unpack(const struct stroke_packed *p)
{
	const uint32_t *w = p->word;
	return (struct stroke){
		.x_px = stroke_float(w[STROKE_X]),
		.y_px = stroke_float(w[STROKE_Y]),
		.along = { (float)(int16_t)w[STROKE_ALONG_BOTH] * (1 / STROKE_ALONG),
			(float)((int32_t)w[STROKE_ALONG_BOTH] >> 16) * (1 / STROKE_ALONG) },
		.half_length_px = stroke_length_of(w[STROKE_HALVES] & 0xffff),
		.half_width_px = stroke_length_of(w[STROKE_HALVES] >> 16),
		.alpha = (float)(w[STROKE_ALPHA_LAY_ASLANT] & 0xffff) * (1 / STROKE_ALPHA),
		.q = stroke_float(w[STROKE_Q]),
		.slope = { stroke_float(w[STROKE_SLOPES] << 16),
			stroke_float(w[STROKE_SLOPES] & 0xffff0000) },
		.rgb = { (uint8_t)w[STROKE_RGB_COPY], (uint8_t)(w[STROKE_RGB_COPY] >> 8),
			(uint8_t)(w[STROKE_RGB_COPY] >> 16) },
		.copy = (uint8_t)(w[STROKE_RGB_COPY] >> 24),
		.point = w[STROKE_POINT],
		.lay = (uint8_t)(w[STROKE_ALPHA_LAY_ASLANT] >> 16),
		.aslant = (uint8_t)(w[STROKE_ALPHA_LAY_ASLANT] >> 24),
	};
}

#endif
