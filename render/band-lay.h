#ifndef RENDER_BAND_LAY_H
#define RENDER_BAND_LAY_H
/* Textures under strokes, and paint that they leave: of eight pixels of a row at once, and of sixteen with the same numbers where vectors
 * are that wide. Internal to band-draw-lanes.c; all is inlined. */
#include "render/band-draw-two.h"
#include "render/project-lanes.h"
#include <string.h>

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
	if (left >= 0 && left + LANES <= (int)m->width && y >= 0 && y < (int)m->height)
		return (vf)(load_mask(m->key + (ptrdiff_t)y * m->pitch + left) &
			    ~((1 << MASK_PIPELINE_BITS) - 1));
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

/* Eights of pixels of one stroke, of whatever rows: y and left are those of their first pixels. The first of them lie two and two side by
 * side; odd ones, of which a row has one at most, come behind. What is found of them next: how far their first pixels are from the stroke's
 * middle, where that is in the texture, by how much 1/depth differs for their row; where they are in planes and mask. */
#define EIGHTS_ROOM 256
struct eights {
	uint32_t count, odd;
	int32_t odd_y[EIGHTS_ROOM], odd_left[EIGHTS_ROOM];
	int32_t y[EIGHTS_ROOM + LANES], left[EIGHTS_ROOM + LANES];
	float dx[EIGHTS_ROOM + LANES], texel[2][EIGHTS_ROOM + LANES], deeper[EIGHTS_ROOM + LANES];
	int32_t to[EIGHTS_ROOM + LANES], key[EIGHTS_ROOM + LANES];
	wf thick[EIGHTS_ROOM / 2];
};

INLINE void eights_find(
	struct eights *e, const struct pen *p, const struct band *b, const visibility_mask *m)
{
	/* The last one again, for all lanes. */
	store_mask(e->y + e->count, e->y[e->count - 1] + (vi){ 0 });
	store_mask(e->left + e->count, e->left[e->count - 1] + (vi){ 0 });
	int32_t pitch = m ? (int32_t)m->pitch : 0;
	for (uint32_t n = 0; n <= e->count; n += LANES) {
		vi y = *(const vi_loose *)(e->y + n), left = *(const vi_loose *)(e->left + n);
		vf dy = __builtin_convertvector(y, vf) + 0.5f - p->y_px;
		store(e->dx + n, __builtin_convertvector(left, vf) + 0.5f - p->x_px);
		for (int k = 0; k < 2; k++)
			store(e->texel[k] + n, dy * p->texel_y[k] + p->texel_middle[k]);
		store(e->deeper + n, dy * p->slope[1]);
		store_mask(
			e->to + n, (y - (int32_t)b->from) * (int32_t)b->pitch + left + BAND_MARGIN);
		store_mask(e->key + n, y * pitch + left);
	}
}

/* Of eight the first number, and of eight the second. */
INLINE wf one_and_other(const float *both)
{
	const __m512i halves = _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
	double two;
	memcpy(&two, both, sizeof two);
	return _mm512_permutexvar_ps(halves, _mm512_castpd_ps(_mm512_set1_pd(two)));
}

INLINE wf two_dx(const struct eights *e, uint32_t n)
{
	return one_and_other(e->dx + n) + two_numbers;
}

/* texture_sum() of eights n and n + 1 */
INLINE wf two_texture_sum(const struct pen *p, const struct eights *e, uint32_t n)
{
	const __m512i parts = _mm512_set1_epi32((1 << TEXEL_BITS) - 1);
	__m512i at[2], part[2];
	wf dx = two_dx(e, n);
	for (int k = 0; k < 2; k++) {
		wf place = dx * p->texel_x[k] + one_and_other(e->texel[k] + n);
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
	const struct eights *e, uint32_t n, bool apart, __mmask16 covered)
{
	wf q = p->q + two_dx(e, n) * p->slope[0] + one_and_other(e->deeper + n);
	wf depth = sixteen_load((const float *)(const void *)m->key,
		(ptrdiff_t[]){ e->key[n], e->key[n + 1] }, apart);
	__mmask16 ret = two_reached(p, q, depth);
	__mmask16 empty = _mm512_mask_cmpge_epi32_mask(
		covered, _mm512_castps_si512(depth), _mm512_set1_epi32(MASK_EMPTY));
	if (!(empty & (__mmask16)~ret))
		return ret;
	const vi all_of_it = { -1, -1, -1, -1, -1, -1, -1, -1 };
	unsigned low = bits(takes_paint(
			 p, m, e->left[n], e->y[n], _mm512_castps512_ps256(q), all_of_it)),
		 high = bits(takes_paint(p, m, e->left[n + 1], e->y[n + 1],
			 _mm512_extractf32x8_ps(q, 1), all_of_it));
	return (__mmask16)(low | high << LANES);
}

/* lay_eight() of eights n and n + 1, which lie side by side, or apart, and then may be the same. */
INLINE void lay_two(const struct pen *p, const struct band_ink *ink, const visibility_mask *m,
	const struct eights *e, uint32_t n, bool apart)
{
	wf thick = e->thick[n / 2], cover = two_clamp01((thick - p->dry) * (1 / PAINT_COVERS));
	__mmask16 laid = _mm512_cmp_ps_mask(cover, _mm512_setzero_ps(), _CMP_GT_OQ);
	if (m)
		laid &= two_take_paint(p, m, e, n, apart, laid);
	if (!laid)
		return;
	const ptrdiff_t to[] = { e->to[n], e->to[n + 1] };
	cover = _mm512_maskz_mov_ps(laid, cover);
	wf weight = cover * two_power_of_two(p->lay + p->octaves * thick);
	sixteen_store(ink->bare, to, apart, sixteen_load(ink->bare, to, apart) * (1 - cover));
	for (int k = 0; k < 3; k++)
		sixteen_store(ink->channel[k], to, apart,
			sixteen_load(ink->channel[k], to, apart) + weight * p->colour[k]);
	sixteen_store(ink->weight, to, apart, sixteen_load(ink->weight, to, apart) + weight);
	sixteen_store(
		ink->height, to, apart, sixteen_load(ink->height, to, apart) + weight * thick);
}

/* All of them. First their textures: what waits for these are no branches that are hard to foresee. */
INLINE void lay_eights(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink, struct eights *e)
{
	uint32_t side_by_side = e->count;
	memcpy(e->y + e->count, e->odd_y, e->odd * sizeof *e->y);
	memcpy(e->left + e->count, e->odd_left, e->odd * sizeof *e->left);
	e->count += e->odd;
	if (!e->count)
		return;
	eights_find(e, p, b, m);
	for (uint32_t n = 0; n < e->count; n += 2)
		e->thick[n / 2] = two_texture_sum(p, e, n) * TEXTURE_UNIT;
	for (uint32_t n = 0; n < side_by_side; n += 2)
		lay_two(p, ink, m, e, n, false);
	for (uint32_t n = side_by_side; n < e->count; n += 2)
		lay_two(p, ink, m, e, n, true);
	e->count = e->odd = 0;
}

#endif

#endif
