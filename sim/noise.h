#ifndef SIM_NOISE_H
#define SIM_NOISE_H
/* Chance that is a pure function of numbers: hashes, dice that are counters, and smooth noise.
 * Nothing here keeps state outside its arguments, so a world is the same on every run and on every
 * thread. */
#include <stdint.h>

static inline uint32_t hash_u32(uint32_t x)
{
	x ^= x >> 16;
	x *= 0x7feb352dU;
	x ^= x >> 15;
	x *= 0x846ca68bU;
	return x ^ x >> 16;
}

static inline uint64_t hash_u64(uint64_t x)
{
	x += 0x9e3779b97f4a7c15U;
	x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9U;
	x = (x ^ x >> 27) * 0x94d049bb133111ebU;
	return x ^ x >> 31;
}

/* Of a cell in the plane or in space. */
static inline uint32_t hash_cell(int x, int y, int z, uint32_t seed)
{
	return hash_u32((uint32_t)x * 0x8da6b343U ^ (uint32_t)y * 0xd8163841U ^
			(uint32_t)z * 0xcb1ab31fU ^ seed);
}

/* To 0..1, 1 excluded. */
static inline float hash_unit(uint32_t h)
{
	return (float)(h >> 8) * 0x1p-24f;
}

/* Dice: the seed is fixed, each roll counts one further. */
struct dice {
	uint64_t seed, count;
};

static inline struct dice dice_of(uint64_t seed, uint64_t purpose)
{
	return (struct dice){ hash_u64(seed ^ hash_u64(purpose)), 0 };
}

static inline float roll(struct dice *d)
{
	return (float)(hash_u64(d->seed + d->count++) >> 40) * 0x1p-24f;
}

static inline float roll_in(struct dice *d, float from, float to)
{
	return from + (to - from) * roll(d);
}

/* from..to, both included. */
static inline int roll_int(struct dice *d, int from, int to)
{
	return from + (int)(roll(d) * (float)(to - from + 1));
}

/* floorf without SSE 4.1 is a call; this is three instructions. */
static inline int floor_int(float x)
{
	int i = (int)x;
	return i - ((float)i > x);
}

static inline float smooth_unit(float t)
{
	return t * t * (3 - 2 * t);
}

/* Value noise, -1..1, with features of about unit size. */
static inline float noise_2d(float x, float y, uint32_t seed)
{
	int ix = floor_int(x), iy = floor_int(y);
	float tx = smooth_unit(x - (float)ix), ty = smooth_unit(y - (float)iy);
	float a = hash_unit(hash_cell(ix, iy, 0, seed)),
	      b = hash_unit(hash_cell(ix + 1, iy, 0, seed));
	float c = hash_unit(hash_cell(ix, iy + 1, 0, seed));
	float d = hash_unit(hash_cell(ix + 1, iy + 1, 0, seed));
	a += (b - a) * tx;
	c += (d - c) * tx;
	return 2 * (a + (c - a) * ty) - 1;
}

static inline float noise_3d(float x, float y, float z, uint32_t seed)
{
	int iz = floor_int(z);
	float t = smooth_unit(z - (float)iz);
	float a = noise_2d(x, y, seed + (uint32_t)iz * 0x9e3779b9U);
	float b = noise_2d(x, y, seed + (uint32_t)(iz + 1) * 0x9e3779b9U);
	return a + (b - a) * t;
}

#endif
