#ifndef RENDER_BAND_DRAW_TWO_H
#define RENDER_BAND_DRAW_TWO_H
/* Two rows of a short line at once, eight pixels of each, where vectors are that wide. The same numbers as those of a row alone. Internal
 * to band-draw-lanes.c; all is inlined. */
#include "render/band-pen.h"

/* Of eight rows from y on: where their first pixels are along the line and across it, and 1/depth there; and which pixels those are. */
struct short_rows {
	vf along, across, q;
	int32_t left[LANES];
	int y;
};

#if defined __AVX512VBMI__

static const wf two_numbers = { 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7 };

/* Eight from each of two places on. */
INLINE wf two_load(const float *from, const ptrdiff_t at[2])
{
	return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(from + at[0])),
		_mm256_loadu_ps(from + at[1]), 1);
}

INLINE void two_store(float *to, const ptrdiff_t at[2], wf x)
{
	_mm256_storeu_ps(to + at[0], _mm512_castps512_ps256(x));
	_mm256_storeu_ps(to + at[1], _mm512_extractf32x8_ps(x, 1));
}

INLINE wf two_clamp01(wf x)
{
	return _mm512_min_ps(_mm512_max_ps(x, _mm512_setzero_ps()), _mm512_set1_ps(1));
}

/* line_alpha() */
INLINE wf two_line_alpha(const struct pen *p, wf along, wf across)
{
	return two_clamp01(p->reach_along - _mm512_abs_ps(along)) *
	       two_clamp01(p->reach_across - _mm512_abs_ps(across));
}

/* shows(); at: of their keys */
INLINE wf two_shown(
	const struct pen *p, const visibility_mask *m, const ptrdiff_t at[2], wf q, wf alpha)
{
	wf depth = two_load((const float *)(const void *)m->key, at);
	return _mm512_maskz_mov_ps(
		_mm512_cmp_ps_mask(q * depth, _mm512_set1_ps(p->shows_from), _CMP_GE_OQ), alpha);
}

/* Apart or in a row. */
INLINE wf sixteen_load(const float *from, const ptrdiff_t at[2], bool apart)
{
	return apart ? two_load(from, at) : wide_load(from + at[0]);
}

INLINE void sixteen_store(float *to, const ptrdiff_t at[2], bool apart, wf x)
{
	if (apart)
		two_store(to, at, x);
	else
		wide_store(to + at[0], x);
}

/* blend_at() */
INLINE void wide_blend(const struct pen *p, enum band_blend blend, wf alpha,
	const struct band_ink *ink, const ptrdiff_t at[2], bool apart)
{
	wf bare = blend == BAND_COLOURED ? (wf){ 0 } : sixteen_load(ink->bare, at, apart);
	if (blend == BAND_STRONGEST || blend == BAND_COVERING)
		sixteen_store(ink->bare, at, apart, _mm512_min_ps(bare, 1 - alpha));
	else if (blend != BAND_COLOURED)
		sixteen_store(ink->bare, at, apart, bare * (1 - alpha));
	for (int k = 0; k < 3 && (blend == BAND_COLOURED || blend == BAND_PAINTED); k++) {
		wf is = sixteen_load(ink->channel[k], at, apart);
		sixteen_store(ink->channel[k], at, apart,
			blend == BAND_PAINTED ? is + alpha * p->colour[k]
					      : is * (1 - alpha * (1 - p->colour[k])));
	}
	if (blend == BAND_PAINTED)
		sixteen_store(ink->weight, at, apart, sixteen_load(ink->weight, at, apart) + alpha);
}

/* Row k in the lower half, the next one in the upper. */
INLINE wf two_of_rows(vf row, int k)
{
	const __m512i both = _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
	return _mm512_permutexvar_ps(
		_mm512_add_epi32(both, _mm512_set1_epi32(k)), _mm512_castps256_ps512(row));
}

/* Row k and the next one. */
INLINE void two_of_line(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink, enum band_blend blend, const struct short_rows *r, int k)
{
	wf along = two_of_rows(r->along, k) + two_numbers * p->cosine,
	   across = two_of_rows(r->across, k) - two_numbers * p->sine;
	wf alpha = two_line_alpha(p, along, across) * p->alpha;
	ptrdiff_t row = (ptrdiff_t)(r->y + k - (int)b->from) * b->pitch + BAND_MARGIN;
	const int32_t *left = r->left + k;
	if (m) {
		ptrdiff_t keys = (ptrdiff_t)(r->y + k) * m->pitch;
		alpha = two_shown(p, m, (ptrdiff_t[]){ keys + left[0], keys + m->pitch + left[1] },
			two_of_rows(r->q, k) + two_numbers * p->slope[0], alpha);
	}
	wide_blend(p, blend, alpha, ink, (ptrdiff_t[]){ row + left[0], row + b->pitch + left[1] },
		true);
}

#endif

#endif
