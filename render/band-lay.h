#ifndef RENDER_BAND_LAY_H
#define RENDER_BAND_LAY_H
/* Textures under strokes, and paint that they leave: of eight pixels of a row at once, and of sixteen with the same numbers where vectors
 * are that wide. Internal to band-draw-lanes.c; all is inlined. */
#include "render/band-draw-two.h"
#include "render/project-lanes.h"

/* Of four bytes each with as many weights, which are 127 together. */
INLINE vi weighted(vi bytes, vi weights)
{
	vi pairs = bytes_product(bytes, weights);
#if defined __AVX2__
	return (vi)_mm256_madd_epi16((__m256i)pairs, _mm256_set1_epi16(1));
#else
	return (pairs & 65535) + (pairs >> 16);
#endif
}

/* Between four texels, by whole numbers: the weights are within 1/127 of what they should be. 1 is TEXTURE_UNIT. */
INLINE vf texture_sum(const struct pen *p, vf dx, float dy)
{
	vi at[2], part[2];
	for (int k = 0; k < 2; k++) {
		vf place = dx * p->texel_x[k] + (dy * p->texel_y[k] + p->texel_middle[k]);
		vi whole = __builtin_convertvector(
			least(most(place, all(0)), all(p->texel_end[k])), vi);
		at[k] = whole >> TEXEL_BITS;
		part[k] = whole & ((1 << TEXEL_BITS) - 1);
	}
	vi four = gather(p->texels, (at[1] << (int32_t)p->texel_shift) + at[0], 4);
	vi last = (halves_product(part[0], part[1]) + ((1 << TEXEL_BITS) - 1)) >> TEXEL_BITS;
	vi weights = (((1 << TEXEL_BITS) - 1) - part[0] - part[1] + last) | (part[0] - last) << 8 |
		     (part[1] - last) << 16 | last << 24;
	return __builtin_convertvector(weighted(four, weights), vf);
}

/* ---- eight pixels ---- */

INLINE vi is_reached(const struct pen *p, vf q, vf depth)
{
	return (q * depth >= p->deep.from) & (q * depth <= p->deep.to);
}

/* The mask beside eight pixels of a row, from left on; what is outside of it is empty. */
INLINE vf depth_beside(const visibility_mask *m, int left, int y)
{
	vf ret;
	for (int k = 0; k < LANES; k++)
		ret[k] = left + k >= 0 && left + k < (int)m->width && y >= 0 && y < (int)m->height
				 ? mask_depth(mask_key(m, left + k, y))
				 : mask_depth(MASK_EMPTY);
	return ret;
}

/* At half the way to beyond a hole, or at all of it. */
INLINE vi is_reached_beside(
	const struct pen *p, const visibility_mask *m, vf q, int left, int y, int right, int down)
{
	int far = p->hole_px, half = (far + 1) / 2;
	return is_reached(p, q, depth_beside(m, left + right * half, y + down * half)) |
	       is_reached(p, q, depth_beside(m, left + right * far, y + down * far));
}

/* Where paint may be, of pixels that it covers: on what it reaches, and on small holes in that. */
INLINE vi takes_paint(
	const struct pen *p, const visibility_mask *m, int left, int y, vf q, vi covered)
{
	vi key = *(const vi_loose *)(m->key + (ptrdiff_t)y * m->pitch + left);
	vi ret = is_reached(p, q, (vf)key), empty = (key >= MASK_EMPTY) & covered;
	if (!any(empty & ~ret))
		return ret;
	vi across = is_reached_beside(p, m, q, left, y, -1, 0) &
		    is_reached_beside(p, m, q, left, y, 1, 0),
	   down = is_reached_beside(p, m, q, left, y, 0, -1) &
		  is_reached_beside(p, m, q, left, y, 0, 1);
	return ret | (empty & (across | down));
}

/* 2^x, and what is between whole powers on straight lines. */
INLINE vf power_of_two(vf x)
{
	return (vf) __builtin_convertvector((x + 127) * (float)(1 << 23), vi);
}

/* Paint of eight pixels of row y. */
INLINE void lay_eight(const struct pen *p, const struct band_ink *ink, const visibility_mask *m,
	ptrdiff_t at, int y, float dy, int left)
{
	vf dx = (float)left + 0.5f - p->x_px + lane_number;
	vf thick = texture_sum(p, dx, dy) * TEXTURE_UNIT,
	   cover = clamp01((thick - p->dry) * (1 / PAINT_COVERS));
	if (!any(cover > 0))
		return;
	if (m) {
		vf q = p->q + dx * p->slope[0] + dy * p->slope[1];
		cover = where(takes_paint(p, m, left, y, q, cover > 0), cover);
		if (!any(cover > 0))
			return;
	}
	vf weight = cover * power_of_two(p->lay + p->octaves * thick);
	at += left;
	store(ink->bare + at, load(ink->bare + at) * (1 - cover));
	for (int k = 0; k < 3; k++)
		store(ink->channel[k] + at, load(ink->channel[k] + at) + weight * p->colour[k]);
	store(ink->weight + at, load(ink->weight + at) + weight);
	store(ink->height + at, load(ink->height + at) + weight * thick);
}

/* ---- eight and eight ---- */

#if defined __AVX512VBMI__

/* Eight pixels of a row that begin here. */
struct eight {
	int y, left;
};

/* Sixteen of one number, and of another. */
INLINE wf one_and_other(float one, float other)
{
	return _mm512_insertf32x8(_mm512_set1_ps(one), _mm256_set1_ps(other), 1);
}

/* texture_sum() */
INLINE wf two_texture_sum(const struct pen *p, wf dx, const float dy[2])
{
	const __m512i parts = _mm512_set1_epi32((1 << TEXEL_BITS) - 1);
	__m512i at[2], part[2];
	for (int k = 0; k < 2; k++) {
		wf place = dx * p->texel_x[k] +
			   one_and_other(dy[0] * p->texel_y[k] + p->texel_middle[k],
				   dy[1] * p->texel_y[k] + p->texel_middle[k]);
		place = _mm512_min_ps(
			_mm512_max_ps(place, _mm512_setzero_ps()), _mm512_set1_ps(p->texel_end[k]));
		__m512i whole = _mm512_cvttps_epi32(place);
		at[k] = _mm512_srli_epi32(whole, TEXEL_BITS);
		part[k] = _mm512_and_si512(whole, parts);
	}
	__m512i rows = _mm512_sll_epi32(at[1], _mm_cvtsi32_si128((int32_t)p->texel_shift));
	__m512i four = _mm512_i32gather_epi32(_mm512_add_epi32(rows, at[0]), p->texels, 4);
	__m512i last = _mm512_srli_epi32(
		_mm512_add_epi32(_mm512_mullo_epi16(part[0], part[1]), parts), TEXEL_BITS);
	__m512i right = _mm512_sub_epi32(part[0], last), below = _mm512_sub_epi32(part[1], last);
	__m512i first = _mm512_sub_epi32(_mm512_sub_epi32(parts, part[0]), below);
	__m512i weights = _mm512_or_si512(_mm512_or_si512(first, _mm512_slli_epi32(right, 8)),
		_mm512_or_si512(_mm512_slli_epi32(below, 16), _mm512_slli_epi32(last, 24)));
	__m512i pairs = _mm512_maddubs_epi16(four, weights);
	return _mm512_cvtepi32_ps(_mm512_madd_epi16(pairs, _mm512_set1_epi16(1)));
}

/* power_of_two() */
INLINE wf two_power_of_two(wf x)
{
	return _mm512_castsi512_ps(_mm512_cvttps_epi32((x + 127) * (float)(1 << 23)));
}

INLINE __mmask16 two_reached(const struct pen *p, wf q, wf depth)
{
	wf there = q * depth;
	return _mm512_cmp_ps_mask(there, _mm512_set1_ps(p->deep.from), _CMP_GE_OQ) &
	       _mm512_cmp_ps_mask(there, _mm512_set1_ps(p->deep.to), _CMP_LE_OQ);
}

/* takes_paint(), of which pixels beside a hole are looked at by eights. */
INLINE __mmask16 two_take_paint(const struct pen *p, const visibility_mask *m,
	const struct eight at[2], wf q, __mmask16 covered)
{
	const float *depths = (const float *)(const void *)m->key;
	wf depth = two_load(depths, (ptrdiff_t[]){ (ptrdiff_t)at[0].y * m->pitch + at[0].left,
					    (ptrdiff_t)at[1].y * m->pitch + at[1].left });
	__mmask16 ret = two_reached(p, q, depth);
	__mmask16 empty = _mm512_mask_cmpge_epi32_mask(
		covered, _mm512_castps_si512(depth), _mm512_set1_epi32(MASK_EMPTY));
	if (!(empty & (__mmask16)~ret))
		return ret;
	const vi all_of_it = { -1, -1, -1, -1, -1, -1, -1, -1 };
	unsigned low = bits(takes_paint(
			 p, m, at[0].left, at[0].y, _mm512_castps512_ps256(q), all_of_it)),
		 high = bits(takes_paint(
			 p, m, at[1].left, at[1].y, _mm512_extractf32x8_ps(q, 1), all_of_it));
	return (__mmask16)(low | high << LANES);
}

/* lay_eight() of two, which may be the same. row: of the band's first pixel in picture row 0. */
INLINE void lay_two(const struct pen *p, const struct band *b, const struct band_ink *ink,
	const visibility_mask *m, const struct eight at[2])
{
	float dy[2];
	ptrdiff_t to[2];
	for (int k = 0; k < 2; k++) {
		dy[k] = (float)at[k].y + 0.5f - p->y_px;
		to[k] = (ptrdiff_t)(at[k].y - (int)b->from) * b->pitch + BAND_MARGIN + at[k].left;
	}
	wf dx = one_and_other(
			(float)at[0].left + 0.5f - p->x_px, (float)at[1].left + 0.5f - p->x_px) +
		two_numbers;
	wf thick = two_texture_sum(p, dx, dy) * TEXTURE_UNIT,
	   cover = two_clamp01((thick - p->dry) * (1 / PAINT_COVERS));
	__mmask16 laid = _mm512_cmp_ps_mask(cover, _mm512_setzero_ps(), _CMP_GT_OQ);
	if (laid && m) {
		wf q = p->q + dx * p->slope[0] +
		       one_and_other(dy[0] * p->slope[1], dy[1] * p->slope[1]);
		laid &= two_take_paint(p, m, at, q, laid);
	}
	if (!laid)
		return;
	cover = _mm512_maskz_mov_ps(laid, cover);
	wf weight = cover * two_power_of_two(p->lay + p->octaves * thick);
	two_store(ink->bare, to, two_load(ink->bare, to) * (1 - cover));
	for (int k = 0; k < 3; k++)
		two_store(
			ink->channel[k], to, two_load(ink->channel[k], to) + weight * p->colour[k]);
	two_store(ink->weight, to, two_load(ink->weight, to) + weight);
	two_store(ink->height, to, two_load(ink->height, to) + weight * thick);
}

#endif

#endif
