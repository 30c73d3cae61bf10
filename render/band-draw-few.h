#ifndef RENDER_BAND_DRAW_FEW_H
#define RENDER_BAND_DRAW_FEW_H
/* Textures of few texels under a stroke, in whole numbers of 16 bits: the same from every kind of vectors, and where a processor looks
 * bytes up in registers, a row of sixteen pixels in little more time than eight take elsewhere. Internal to band-draw-lanes.c; all is
 * inlined. */
#include "process/lanes.h"
#include "render/frame.h"
#include <math.h>

/* A texel is so many places wide: all that there are are below 2^16, where reckoning begins again at 0. */
#define FEW_BITS 10
/* Between two texels there are so many. */
#define FEW_PARTS 127
/* What weights make of a texel that is opaque, which is 1. */
#define FEW_UNIT (128.f / (255 * FEW_PARTS * FEW_PARTS))

/* Where pixels are in the texture, along it and across: at the pixel ref at first; then for each pixel to the right, and down. */
struct few {
	int32_t ref[2], first[2], right[2], down[2], end[2];
	int32_t pitch;
#if defined __AVX512VBMI__
	__m512i texel[FRAME_FEW_TEXELS / 64]; /* frame_pack_few_texels() */
#endif
};

/* right, down: texels to a pixel. */
INLINE struct few few_of(const stroke_texture *t, const uint8_t *texel, const float middle_px[2],
	const float right[2], const float down[2])
{
	struct few f = { .pitch = (int32_t)t->length + 2,
		.end = { (int32_t)(t->length + 1) << FEW_BITS, (int32_t)(t->width + 1)
								       << FEW_BITS } };
	float off[2];
	for (int k = 0; k < 2; k++) {
		f.ref[k] = (int32_t)floorf(middle_px[k]);
		off[k] = (float)f.ref[k] + 0.5f - middle_px[k];
	}
	for (int k = 0; k < 2; k++) {
		f.right[k] = (int32_t)lrintf(right[k] * (1 << FEW_BITS));
		f.down[k] = (int32_t)lrintf(down[k] * (1 << FEW_BITS));
		f.first[k] = f.end[k] / 2 + (int32_t)lrintf((off[0] * right[k] + off[1] * down[k]) *
							    (1 << FEW_BITS));
	}
#if defined __AVX512VBMI__
	for (size_t n = 0; n < G_N_ELEMENTS(f.texel); n++)
		f.texel[n] = _mm512_loadu_si512(texel + 64 * n);
#else
	(void)texel;
#endif
	return f;
}

/* What is beyond 2^16 does not matter. */
INLINE int32_t few_place(const struct few *f, int k, int x, int y)
{
	uint32_t aside = (uint32_t)(x - f->ref[0]) * (uint32_t)f->right[k],
		 deep = (uint32_t)(y - f->ref[1]) * (uint32_t)f->down[k];
	return (int32_t)((uint32_t)f->first[k] + aside + deep);
}

#if defined __AVX512VBMI__

#define FEW_WIDE 16

typedef float wf __attribute__((vector_size(64)));
typedef float wf_loose __attribute__((vector_size(64), aligned(4), may_alias));

static const wf wide_number = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };

INLINE __m256i wide_place(const struct few *f, int k, int x, int y)
{
	const __m256i lane =
		_mm256_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
	__m256i place = _mm256_add_epi16(_mm256_set1_epi16((int16_t)few_place(f, k, x, y)),
		_mm256_mullo_epi16(lane, _mm256_set1_epi16((int16_t)f->right[k])));
	return _mm256_min_epu16(place, _mm256_set1_epi16((int16_t)f->end[k]));
}

INLINE __m256i wide_part(__m256i place)
{
	return _mm256_and_si256(
		_mm256_srli_epi16(place, FEW_BITS - 7), _mm256_set1_epi16(FEW_PARTS));
}

/* Of texel x of row y and the one to its right; and those below them. */
INLINE __m512i wide_texels(const struct few *f, __m256i x, __m256i y)
{
	const __m256i twice = _mm256_setr_epi8(0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10, 12, 12, 14, 14,
		0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10, 12, 12, 14, 14);
	__m256i at =
		_mm256_add_epi16(x, _mm256_mullo_epi16(y, _mm256_set1_epi16((int16_t)f->pitch)));
	__m256i upper = _mm256_add_epi8(_mm256_shuffle_epi8(at, twice), _mm256_set1_epi16(1 << 8)),
		lower = _mm256_add_epi8(upper, _mm256_set1_epi8((int8_t)f->pitch));
	__m512i both = _mm512_inserti64x4(_mm512_castsi256_si512(upper), lower, 1);
	return _mm512_mask_blend_epi8(_mm512_movepi8_mask(both),
		_mm512_permutex2var_epi8(f->texel[0], both, f->texel[1]),
		_mm512_permutex2var_epi8(f->texel[2], both, f->texel[3]));
}

/* Of sixteen pixels of row y, from x on, those that are in it; FEW_UNIT is 1. */
INLINE wf wide_few(const struct few *f, int x, int y)
{
	__m256i along = wide_place(f, 0, x, y), across = wide_place(f, 1, x, y);
	__m512i texels = wide_texels(
		f, _mm256_srli_epi16(along, FEW_BITS), _mm256_srli_epi16(across, FEW_BITS));
	/* 127 - part and part, byte by byte */
	__m256i beside =
		_mm256_add_epi16(_mm256_mullo_epi16(wide_part(along), _mm256_set1_epi16(255)),
			_mm256_set1_epi16(FEW_PARTS));
	__m256i below = _mm256_slli_epi16(wide_part(across), 9),
		above = _mm256_sub_epi16(_mm256_set1_epi16((int16_t)(FEW_PARTS << 9)), below);
	__m256i upper = _mm256_maddubs_epi16(_mm512_castsi512_si256(texels), beside),
		lower = _mm256_maddubs_epi16(_mm512_extracti64x4_epi64(texels, 1), beside);
	__m256i sum = _mm256_add_epi16(
		_mm256_mulhi_epu16(upper, above), _mm256_mulhi_epu16(lower, below));
	return _mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(sum));
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

typedef uint16_t vhu __attribute__((vector_size(32)));

/* Halves of the lanes each by themselves. */
INLINE vi halves_product(vi a, vi b)
{
	return (vi)((vhu)a * (vhu)b);
}

/* Bytes by bytes below 2^7, two and two together. */
INLINE vi bytes_product(vi bytes, vi weights)
{
#if defined __AVX2__
	return (vi)_mm256_maddubs_epi16((__m256i)bytes, (__m256i)weights);
#else
	vi ret = { 0 };
	for (int shift = 0; shift < 32; shift += 16)
		ret |= ((bytes >> shift & 255) * (weights >> shift & 255) +
			       (bytes >> (shift + 8) & 255) * (weights >> (shift + 8) & 255))
		       << shift;
	return ret;
#endif
}

/* The upper 16 bits of products of halves. */
INLINE vi halves_high(vi a, vi b)
{
#if defined __AVX2__
	return (vi)_mm256_mulhi_epu16((__m256i)a, (__m256i)b);
#else
	vu low = ((vu)a & 65535) * ((vu)b & 65535), high = ((vu)a >> 16) * ((vu)b >> 16);
	return (vi)(low >> 16 | (high & 0xffff0000u));
#endif
}

INLINE vi few_places(const struct few *f, int k, int x, int y)
{
	vi lane = { 0, 1, 2, 3, 4, 5, 6, 7 };
	vi place = (few_place(f, k, x, y) + halves_product(lane, f->right[k] + (vi){ 0 })) & 65535;
	return lower(place, f->end[k] + (vi){ 0 });
}

/* wide_few() of eight. texels: four neighbouring ones in one, rows of 2^shift. */
INLINE vf eight_few(const struct few *f, const uint32_t *texels, uint32_t shift, int x, int y)
{
	vi at[2], part[2];
	for (int k = 0; k < 2; k++) {
		vi place = few_places(f, k, x, y);
		at[k] = place >> FEW_BITS;
		part[k] = place >> (FEW_BITS - 7) & FEW_PARTS;
	}
	vi four = gather(texels, (at[1] << (int32_t)shift) + at[0], 4);
	vi beside = (FEW_PARTS - part[0]) | part[0] << 8;
	vi below = (FEW_PARTS - part[1]) << 9 | part[1] << 25;
	vi both = halves_high(bytes_product(four, beside | beside << 16), below);
	return __builtin_convertvector((both & 65535) + (both >> 16), vf);
}

#endif
