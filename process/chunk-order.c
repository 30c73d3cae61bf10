#include "process/chunk-order.h"
#include <glib.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define BITS  12
#define COUNT (1u << BITS)

/* SplitMix64 (Steele, Lea and Flood 2014). */
static uint64_t next(uint64_t *state)
{
	uint64_t z = *state += 0x9E3779B97F4A7C15u;
	z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
	z = (z ^ z >> 27) * 0x94D049BB133111EBu;
	return z ^ z >> 31;
}

/* Scrambling is a coin for every node of the binary tree over the places: heads swaps its halves. Node 1 is the root, node n has
 * the halves 2 n and 2 n + 1. */
static void toss(uint64_t seed, uint64_t coins[COUNT / 64])
{
	for (uint32_t i = 0; i < COUNT / 64; i++)
		coins[i] = next(&seed);
}

/* The rank's lowest bit chooses the half of the chunk, the next the quarter of it, and so on. */
static uint32_t place_of(uint32_t rank, const uint64_t coins[COUNT / 64])
{
	uint32_t node = 1;
	for (uint32_t bit = 0; bit < BITS; bit++)
		node = 2 * node + ((rank >> bit ^ (uint32_t)(coins[node / 64] >> node % 64)) & 1);
	return node - COUNT;
}

void chunk_order(uint64_t seed, uint32_t count, uint16_t ret_place[4096])
{
	uint64_t coins[COUNT / 64];
	uint32_t found = 0;
	g_assert(count >= 1 && count <= COUNT);
	toss(seed, coins);
	for (uint32_t rank = 0; rank < COUNT; rank++) {
		uint32_t place = place_of(rank, coins);
		if (place < count)
			ret_place[found++] = (uint16_t)place;
	}
	g_assert(found == count);
}

/* ---- even in space ---- */

/* Discs of which so many cover a surface, when no more fit between them: points to the square of their diameter. */
#define PACKED 0.7f
/* From this many points on they are looked for in cells. */
#define FEW 64u
/* Neighbours are counted within so many usual spacings; points are taken for no farther apart than so many. */
#define AROUND 2.5f
#define UNEVEN 12.f
/* So few around tell nothing; then the point is believed. */
#define ALONE 3u
/* Discs smaller than this part of the spacing keep nothing apart. */
#define LAST_DISC 1.1f
/* Cells from the first point to the farthest, at most: they are counted in integers. */
#define CELLS_MOST 1e8f

struct darts {
	const float (*at)[3];
	const float *spacing;
	uint32_t count, taken, lefts;
	float spacing_most, extent;
	uint16_t *left; /* places that are not taken yet, in the order of before */
	uint16_t *ret;
	float cell;
	uint16_t head[COUNT], next[COUNT]; /* + 1; of the taken ones in cells */
};

static float distance2(const float a[3], const float b[3])
{
	float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return x * x + y * y + z * z;
}

static uint32_t cell_of(int32_t x, int32_t y, int32_t z)
{
	return ((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u) %
	       COUNT;
}

static void find_cell(const struct darts *d, const float at[3], int32_t ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = (int32_t)floorf(at[k] / d->cell);
}

static void put(struct darts *d, uint32_t place)
{
	int32_t c[3];
	find_cell(d, d->at[place], c);
	uint32_t cell = cell_of(c[0], c[1], c[2]);
	d->next[place] = d->head[cell];
	d->head[cell] = (uint16_t)(place + 1);
}

static bool is_near_in(const struct darts *d, uint32_t cell, const float at[3], float radius2)
{
	for (uint16_t n = d->head[cell]; n; n = d->next[n - 1])
		if (distance2(at, d->at[n - 1]) < radius2)
			return true;
	return false;
}

/* Those that reach so far around. */
static void find_cells(
	const struct darts *d, const float at[3], float radius, int32_t low[3], int32_t high[3])
{
	for (int k = 0; k < 3; k++) {
		low[k] = (int32_t)floorf((at[k] - radius) / d->cell);
		high[k] = (int32_t)floorf((at[k] + radius) / d->cell);
	}
}

/* Whether one that is taken already is that near; the radius is no larger than a cell. */
static bool is_near(const struct darts *d, const float at[3], float radius)
{
	int32_t low[3], high[3];
	float radius2 = radius * radius;
	find_cells(d, at, radius, low, high);
	for (int32_t z = low[2]; z <= high[2]; z++)
		for (int32_t y = low[1]; y <= high[1]; y++)
			for (int32_t x = low[0]; x <= high[0]; x++)
				if (is_near_in(d, cell_of(x, y, z), at, radius2))
					return true;
	return false;
}

static bool is_near_few(const struct darts *d, const float at[3], float radius)
{
	float radius2 = radius * radius;
	for (uint32_t n = 0; n < d->taken; n++)
		if (distance2(at, d->at[d->ret[n]]) < radius2)
			return true;
	return false;
}

/* One round: all that are left, with discs of so many spacings. */
static void throw_all(struct darts *d, float discs)
{
	uint32_t still_left = 0;
	bool few = PACKED / (discs * discs) * (float)d->count < FEW;
	d->cell = fmaxf(discs * d->spacing_most, d->extent / CELLS_MOST);
	memset(d->head, 0, sizeof d->head);
	for (uint32_t n = 0; !few && n < d->taken; n++)
		put(d, d->ret[n]);
	for (uint32_t n = 0; n < d->lefts; n++) {
		uint32_t place = d->left[n];
		const float *at = d->at[place];
		float radius = discs * d->spacing[place];
		if (few ? is_near_few(d, at, radius) : is_near(d, at, radius)) {
			d->left[still_left++] = (uint16_t)place;
			continue;
		}
		d->ret[d->taken++] = (uint16_t)place;
		if (!few)
			put(d, place);
	}
	d->lefts = still_left;
}

static int by_value(const void *a, const void *b)
{
	const float *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static float median(const float *values, uint32_t count)
{
	float sorted[COUNT];
	memcpy(sorted, values, count * sizeof *sorted);
	qsort(sorted, count, sizeof *sorted, by_value);
	return sorted[count / 2];
}

static uint32_t count_in(const struct darts *d, uint32_t cell, const float at[3], float radius2)
{
	uint32_t count = 0;
	for (uint16_t n = d->head[cell]; n; n = d->next[n - 1])
		count += distance2(at, d->at[n - 1]) < radius2;
	return count;
}

/* With itself. Two cells around may have the same place in the table, so some are counted twice; few. */
static uint32_t count_near(const struct darts *d, const float at[3], float radius)
{
	int32_t low[3], high[3];
	uint32_t count = 0;
	find_cells(d, at, radius, low, high);
	for (int32_t z = low[2]; z <= high[2]; z++)
		for (int32_t y = low[1]; y <= high[1]; y++)
			for (int32_t x = low[0]; x <= high[0]; x++)
				count += count_in(d, cell_of(x, y, z), at, radius * radius);
	return MAX(count, 1);
}

/* How far points are from each other where each is. What a point says that it stands for is no more than about right, and not at all
 * beside gaps; who has the larger spacing would come later than he should. */
static void find_spacings(struct darts *d, const float *claimed_m, float usual, float ret[COUNT])
{
	float radius = AROUND * usual;
	d->cell = fmaxf(radius, d->extent / CELLS_MOST);
	memset(d->head, 0, sizeof d->head);
	for (uint32_t n = 0; n < d->count; n++)
		put(d, n);
	for (uint32_t n = 0; n < d->count; n++) {
		uint32_t around = count_near(d, d->at[n], radius);
		float found = radius * sqrtf((float)G_PI / (float)around);
		if (around <= ALONE)
			found = fmaxf(found, claimed_m[n]);
		ret[n] = fminf(found, UNEVEN * usual);
		d->spacing_most = fmaxf(d->spacing_most, ret[n]);
	}
}

void chunk_order_even(
	const double (*at_m)[3], const float *spacing_m, uint32_t count, uint16_t place[4096])
{
	float at[COUNT][3], spacing[COUNT], extent = 0;
	uint16_t left[COUNT];
	g_assert(count >= 1 && count <= COUNT);
	for (uint32_t n = 0; n < count; n++)
		for (int k = 0; k < 3; k++) {
			at[n][k] = (float)(at_m[n][k] - at_m[0][k]);
			extent = fmaxf(extent, fabsf(at[n][k]));
		}
	struct darts d = { .at = (const float(*)[3])at,
		.spacing = spacing,
		.extent = extent,
		.count = count,
		.lefts = count,
		.left = left,
		.ret = place };
	memcpy(left, place, count * sizeof *left);
	find_spacings(&d, spacing_m, median(spacing_m, count), spacing);
	for (float discs = sqrtf(PACKED * (float)count); discs > LAST_DISC && d.lefts;
		discs *= (float)G_SQRT2 / 2)
		throw_all(&d, discs);
	memcpy(place + d.taken, left, d.lefts * sizeof *place);
}
