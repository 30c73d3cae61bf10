#ifndef PROCESS_LANES_H
#define PROCESS_LANES_H
/* Eight cells side by side, or sixteen, in GCC's and clang's vectors: AVX2 in functions that are built for it, whatever the processor has
 * elsewhere. All is inlined, so that it takes on the caller's target. In files that are built for AVX2 as a whole
 * (render/lanes-path.h) some of it is the one instruction that compilers do not find. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#if defined __AVX2__
#include <immintrin.h>
#elif defined __SSE2__
#include <xmmintrin.h>
#endif

/* Files that say so before are built with sixteen lanes where vectors are that wide; nothing that has lanes may pass between them and
 * others. */
#if defined LANES_MAY_BE_WIDE && defined __AVX512VBMI__
#define LANES      16
#define LANES_WIDE 1
#else
#define LANES 8
#endif
#define LANES_BYTES (4 * LANES)

typedef float vf __attribute__((vector_size(LANES_BYTES)));
typedef int32_t vi __attribute__((vector_size(LANES_BYTES)));
typedef float vf_loose __attribute__((vector_size(LANES_BYTES), aligned(4), may_alias));
typedef int32_t vi_loose __attribute__((vector_size(LANES_BYTES), aligned(4), may_alias));
typedef uint32_t vu __attribute__((vector_size(LANES_BYTES)));
typedef int64_t vl __attribute__((vector_size(LANES_BYTES)));

/* The bits of all lanes. */
#define LANES_ALL ((1u << LANES) - 1)

#define INLINE static inline __attribute__((always_inline))

INLINE vf load(const float *at)
{
	return *(const vf_loose *)at;
}

INLINE void store(float *at, vf x)
{
	*(vf_loose *)at = x;
}

/* Two vectors in a row, apart and together again: those at even places, those at odd ones. */
INLINE vf evens(vf a, vf b)
{
#if defined LANES_WIDE
	return __builtin_shufflevector(
		a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
#else
	return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
#endif
}

INLINE vf odds(vf a, vf b)
{
#if defined LANES_WIDE
	return __builtin_shufflevector(
		a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
#else
	return __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
#endif
}

#if !defined LANES_WIDE

INLINE vf first_half(vf even, vf odd)
{
	return __builtin_shufflevector(even, odd, 0, 8, 1, 9, 2, 10, 3, 11);
}

INLINE vf second_half(vf even, vf odd)
{
	return __builtin_shufflevector(even, odd, 4, 12, 5, 13, 6, 14, 7, 15);
}
#endif

INLINE vi load_mask(const int32_t *at)
{
	return *(const vi_loose *)at;
}

INLINE void store_mask(int32_t *at, vi mask)
{
	*(vi_loose *)at = mask;
}

INLINE vf choose(vi mask, vf yes, vf no)
{
#if defined __AVX2__ && !defined LANES_WIDE
	return _mm256_blendv_ps(no, yes, (vf)mask);
#else
	return (vf)(((vi)yes & mask) | ((vi)no & ~mask));
#endif
}

INLINE vf where(vi mask, vf x)
{
	return (vf)((vi)x & mask);
}

/* b where one of them is no number. */
INLINE vf least(vf a, vf b)
{
#if defined LANES_WIDE
	return _mm512_min_ps(a, b);
#elif defined __AVX2__
	return _mm256_min_ps(a, b);
#else
	return choose(a < b, a, b);
#endif
}

INLINE vf most(vf a, vf b)
{
#if defined LANES_WIDE
	return _mm512_max_ps(a, b);
#elif defined __AVX2__
	return _mm256_max_ps(a, b);
#else
	return choose(a > b, a, b);
#endif
}

/* Lane by lane, which GCC finds the one instruction for. */
INLINE vi lower(vi a, vi b)
{
	vi ret;
	for (int k = 0; k < LANES; k++)
		ret[k] = a[k] < b[k] ? a[k] : b[k];
	return ret;
}

INLINE vi higher(vi a, vi b)
{
	vi ret;
	for (int k = 0; k < LANES; k++)
		ret[k] = a[k] > b[k] ? a[k] : b[k];
	return ret;
}

INLINE vi lower_unsigned(vi a, vi b)
{
	vu ret;
	for (int k = 0; k < LANES; k++)
		ret[k] = ((vu)a)[k] < ((vu)b)[k] ? ((vu)a)[k] : ((vu)b)[k];
	return (vi)ret;
}

INLINE vf magnitude(vf x)
{
	return (vf)((vi)x & 0x7fffffff);
}

INLINE vf root(vf x)
{
	for (int k = 0; k < LANES; k++)
		x[k] = __builtin_sqrtf(x[k]);
	return x;
}

/* The scale is part of the instruction. half: 0 or 1, of at; so many are as wide as all lanes. */
#if defined LANES_WIDE
#define LANES_GATHER(from, at, scale) ((vi)_mm512_i32gather_epi32((__m512i)(at), from, scale))
#define LANES_GATHER_TWO(from, at, half, scale)                                                    \
	((vf)_mm512_i32gather_epi64(_mm512_extracti64x4_epi64((__m512i)(at), half), from, scale))
#elif defined __AVX2__
#define LANES_GATHER(from, at, scale) ((vi)_mm256_i32gather_epi32(from, (__m256i)(at), scale))
#define LANES_GATHER_TWO(from, at, half, scale)                                                    \
	((vf)_mm256_i32gather_epi64(                                                               \
		(const long long *)(from), _mm256_extracti128_si256((__m256i)(at), half), scale))
#endif

/* Of four bytes each, which need not be aligned; bytes: from one place to the next. */
INLINE vi gather(const void *from, vi at, int bytes)
{
#if defined __AVX2__
	switch (bytes) {
	case 8: return LANES_GATHER(from, at, 8);
	case 4: return LANES_GATHER(from, at, 4);
	case 2: return LANES_GATHER(from, at, 2);
	case 1: return LANES_GATHER(from, at, 1);
	}
#endif
	vi ret;
	for (int k = 0; k < LANES; k++)
		memcpy((char *)&ret + 4 * k, (const char *)from + (ptrdiff_t)at[k] * bytes, 4);
	return ret;
}

/* Two of four bytes each that lie side by side; bytes: from one place to the next, 4 or 8. */
INLINE void gather_pairs(const void *from, vi at, int bytes, vi *ret_first, vi *ret_second)
{
#if defined __AVX2__
	vf low = bytes == 4 ? LANES_GATHER_TWO(from, at, 0, 4) : LANES_GATHER_TWO(from, at, 0, 8),
	   high = bytes == 4 ? LANES_GATHER_TWO(from, at, 1, 4) : LANES_GATHER_TWO(from, at, 1, 8);
	*ret_first = (vi)evens(low, high);
	*ret_second = (vi)odds(low, high);
#else
	*ret_first = gather(from, at, bytes);
	*ret_second = gather((const char *)from + 4, at, bytes);
#endif
}

/* Which lane comes where when those of the bits are put side by side, in front; behind them any. */
INLINE vi order_of(unsigned which)
{
#if defined LANES_WIDE
	return (vi)_mm512_maskz_compress_epi32((__mmask16)which,
		_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
#elif defined __AVX512VL__
	return (vi)_mm256_maskz_compress_epi32(
		(__mmask8)which, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
#else
	vi ret = { 0 };
	for (int n = 0; which; which &= which - 1)
		ret[n++] = __builtin_ctz(which);
	return ret;
#endif
}

INLINE vf put_in_order(vf x, vi order)
{
#if defined LANES_WIDE
	return _mm512_permutexvar_ps((__m512i)order, x);
#elif defined __AVX2__
	return _mm256_permutevar8x32_ps(x, (__m256i)order);
#else
	vf ret;
	for (int k = 0; k < LANES; k++)
		ret[k] = x[order[k]];
	return ret;
#endif
}

INLINE vf all(float x)
{
	vf one = { x };
#if defined LANES_WIDE
	return __builtin_shufflevector(one, one, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
#else
	return __builtin_shufflevector(one, one, 0, 0, 0, 0, 0, 0, 0, 0);
#endif
}

INLINE vf clamp01(vf x)
{
	return least(most(x, all(0)), all(1));
}

#if !defined LANES_WIDE
INLINE float largest(vf x)
{
	x = most(x, __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3));
	x = most(x, __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5));
	return x[0] > x[1] ? x[0] : x[1];
}
#endif

/* A bit for each lane; masks are all ones or all zeros. */
INLINE unsigned bits(vi mask)
{
#if defined LANES_WIDE
	return _mm512_movepi32_mask((__m512i)mask);
#elif defined __AVX2__
	return (unsigned)_mm256_movemask_ps((vf)mask);
#elif defined __SSE2__
	__m128 low = (__m128)__builtin_shufflevector(mask, mask, 0, 1, 2, 3),
	       high = (__m128)__builtin_shufflevector(mask, mask, 4, 5, 6, 7);
	return (unsigned)_mm_movemask_ps(low) | (unsigned)_mm_movemask_ps(high) << 4;
#else
	unsigned ret = 0;
	for (int k = 0; k < LANES; k++)
		ret |= (unsigned)(mask[k] & 1) << k;
	return ret;
#endif
}

INLINE bool any(vi mask)
{
#if defined LANES_WIDE
	return bits(mask) != 0;
#elif defined __SSE2__
	return _mm_movemask_ps((__m128)(__builtin_shufflevector(mask, mask, 0, 1, 2, 3) |
					__builtin_shufflevector(mask, mask, 4, 5, 6, 7))) != 0;
#else
	vl x = (vl)mask;
	return (x[0] | x[1] | x[2] | x[3]) != 0;
#endif
}

#endif
