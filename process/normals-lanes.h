#ifndef PROCESS_NORMALS_LANES_H
#define PROCESS_NORMALS_LANES_H
/* Eight cells side by side, in GCC's and clang's vectors: AVX2 in functions that are built for it, whatever the processor has
 * elsewhere. Internal to normals*.c. All is inlined, so that it takes on the caller's target. */
#include <stdint.h>

#define LANES 8

typedef float vf __attribute__((vector_size(32)));
typedef int32_t vi __attribute__((vector_size(32)));
typedef float vf_loose __attribute__((vector_size(32), aligned(4), may_alias));
typedef uint8_t vb __attribute__((vector_size(8), aligned(1), may_alias));
typedef uint32_t vu_loose __attribute__((vector_size(32), aligned(4), may_alias));

#define INLINE static inline __attribute__((always_inline))

INLINE vf load(const float *at)
{
	return *(const vf_loose *)at;
}

INLINE void store(float *at, vf x)
{
	*(vf_loose *)at = x;
}

INLINE vf load_bytes(const uint8_t *at)
{
	return __builtin_convertvector(*(const vb *)at, vf);
}

INLINE vf choose(vi mask, vf yes, vf no)
{
	return (vf)(((vi)yes & mask) | ((vi)no & ~mask));
}

INLINE vf where(vi mask, vf x)
{
	return (vf)((vi)x & mask);
}

INLINE vf least(vf a, vf b)
{
	return choose(a < b, a, b);
}

INLINE vf most(vf a, vf b)
{
	return choose(a > b, a, b);
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

INLINE vf all(float x)
{
	return x - (vf){ 0 };
}

INLINE float largest(vf x)
{
	float y = x[0];
	for (int k = 1; k < LANES; k++)
		y = x[k] > y ? x[k] : y;
	return y;
}

#endif
