#ifndef RENDER_GRAIN_H
#define RENDER_GRAIN_H
/* Noise that textures are made of: pure functions of place and seed, so a texture is the same on
 * every run. Gradient noise (Perlin 2002) on a lattice that repeats, since what stands on paper
 * has to be seamless. Keeps no state; any thread. */
#include <math.h>
#include <stdint.h>

static inline uint32_t grain_hash(uint32_t x, uint32_t y, uint32_t seed)
{
	uint64_t h = ((uint64_t)y << 32 | x) + seed * 0x9e3779b97f4a7c15U;
	h *= 0xbf58476d1ce4e5b9U;
	h ^= h >> 32;
	h *= 0x94d049bb133111ebU;
	return (uint32_t)(h >> 32);
}

/* Of a whole number, 0..1, 1 excluded. */
static inline float grain_unit(uint32_t x, uint32_t y, uint32_t seed)
{
	return (float)(grain_hash(x, y, seed) >> 8) * 0x1p-24f;
}

/* 0 below from, 1 above to, smooth between; from may be the greater one. */
static inline float grain_step(float from, float to, float x)
{
	float t = (x - from) / (to - from);
	t = t < 0 ? 0 : t > 1 ? 1 : t;
	return t * t * (3 - 2 * t);
}

/* floorf without SSE 4.1 is a call; this is three instructions. */
static inline int grain_floor(float x)
{
	int i = (int)x;
	return i - ((float)i > x);
}

static inline int grain_wrap(int i, int cells)
{
	return i < 0 ? i + cells : i >= cells ? i - cells : i;
}

static inline float grain_slope(int ix, int iy, float dx, float dy, uint32_t seed)
{
	static const float slope[8][2] = { { 1, 0 }, { 0.7071f, 0.7071f }, { 0, 1 },
		{ -0.7071f, 0.7071f }, { -1, 0 }, { -0.7071f, -0.7071f }, { 0, -1 },
		{ 0.7071f, -0.7071f } };
	const float *s = slope[grain_hash((uint32_t)ix, (uint32_t)iy, seed) >> 29];
	return s[0] * dx + s[1] * dy;
}

/* -1..1, mean 0, standard deviation about 0.3; x and y in cells of the lattice, which repeats
 * after so many. They may lie outside it by as much as it is large. */
static inline float grain_noise(float x, float y, int columns, int rows, uint32_t seed)
{
	int column = grain_floor(x), row = grain_floor(y);
	float dx = x - (float)column, dy = y - (float)row;
	int left = grain_wrap(column, columns), right = grain_wrap(left + 1, columns);
	int top = grain_wrap(row, rows), bottom = grain_wrap(top + 1, rows);
	float a = grain_slope(left, top, dx, dy, seed),
	      b = grain_slope(right, top, dx - 1, dy, seed);
	float c = grain_slope(left, bottom, dx, dy - 1, seed),
	      d = grain_slope(right, bottom, dx - 1, dy - 1, seed);
	float tx = dx * dx * dx * (dx * (6 * dx - 15) + 10),
	      ty = dy * dy * dy * (dy * (6 * dy - 15) + 10);
	a += (b - a) * tx;
	c += (d - c) * tx;
	return a + (c - a) * ty;
}

#endif
