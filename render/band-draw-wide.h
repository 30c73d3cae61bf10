#ifndef RENDER_BAND_DRAW_WIDE_H
#define RENDER_BAND_DRAW_WIDE_H
/* Strokes of few texels, sixteen pixels at a time, for processors that can look bytes up in registers. A row of most strokes is one vector
 * of them, and what one waits for, the other fifteen do as well. The same sums in the same order as those of eight. Internal to
 * band-draw-lanes.c, which includes it where it is built for such a processor; all is inlined. */
#include "process/lanes.h"

#define WIDE 16

typedef float wf __attribute__((vector_size(64)));
typedef int32_t wi __attribute__((vector_size(64)));
typedef float wf_loose __attribute__((vector_size(64), aligned(4), may_alias));

static const wf wide_number = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };

/* Texels of a variant, a border of nothing around them, row by row. */
struct few_texels {
	__m512i byte[4];
	int32_t pitch;
};

INLINE struct few_texels few_texels_of(const uint8_t *texel, uint32_t pitch)
{
	struct few_texels t = { .pitch = (int32_t)pitch };
	for (size_t n = 0; n < G_N_ELEMENTS(t.byte); n++)
		t.byte[n] = _mm512_loadu_si512(texel + 64 * n);
	return t;
}

INLINE wi wide_product(wi a, wi b)
{
	return (wi)_mm512_mullo_epi16((__m512i)a, (__m512i)b);
}

/* The texel in column x of row y, and those to the right, below, and both. */
INLINE wi four_of_few(const struct few_texels *t, wi x, wi y)
{
	__m512i first = _mm512_shuffle_epi8((__m512i)(wide_product(y, t->pitch + (wi){ 0 }) + x),
		_mm512_broadcast_i32x4(
			_mm_setr_epi8(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12)));
	__m512i at = _mm512_add_epi8(
		first, _mm512_set1_epi32(1 << 8 | t->pitch << 16 | (t->pitch + 1) << 24));
	return (wi)_mm512_mask_blend_epi8(_mm512_movepi8_mask(at),
		_mm512_permutex2var_epi8(t->byte[0], at, t->byte[1]),
		_mm512_permutex2var_epi8(t->byte[2], at, t->byte[3]));
}

/* texture_sum() of band-draw-lanes.c */
INLINE wf wide_sum(const struct few_texels *t, const wf place[2], const float end[2], int bits)
{
	const int32_t one = (1 << bits) - 1;
	wi at[2], part[2];
	for (int k = 0; k < 2; k++) {
		wf inside = _mm512_min_ps(_mm512_max_ps(place[k], (wf){ 0 }), end[k] + (wf){ 0 });
		wi whole = (wi)_mm512_cvttps_epi32(inside);
		at[k] = whole >> bits;
		part[k] = whole & one;
	}
	wi last = (wide_product(part[0], part[1]) + one) >> bits;
	wi weights = (one - part[0] - part[1] + last) | (part[0] - last) << 8 |
		     (part[1] - last) << 16 | last << 24;
	__m512i pairs =
		_mm512_maddubs_epi16((__m512i)four_of_few(t, at[0], at[1]), (__m512i)weights);
	return _mm512_cvtepi32_ps(_mm512_madd_epi16(pairs, _mm512_set1_epi16(1)));
}

INLINE wf wide_load(const float *at)
{
	return *(const wf_loose *)at;
}

INLINE void wide_store(float *at, wf x)
{
	*(wf_loose *)at = x;
}

#endif
