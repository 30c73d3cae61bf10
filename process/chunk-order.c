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
/* Neighbours are counted within so many usual spacings; points are taken for no farther apart than so many. */
#define AROUND 2.5f
#define UNEVEN 12.f
/* So few around tell nothing; then the point is believed. */
#define ALONE 3u
/* Discs smaller than this part of the spacing keep nothing apart. */
#define LAST_DISC 1.1f
/* Cells from the first point to the farthest, at most: they are counted in integers. */
#define CELLS_MOST 1e8f

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

/* Points whose spacing is more than this many usual ones look for who is near by themselves. */
#define WIDE 1.5f
/* A point that is taken tells all others, if that is less work than to find those in reach. */
#define CELLS_WORTH 256

/* All points in the order of their cells, whose places in a table are hashed: those of a place are one run, maybe of several cells. */
struct cells {
	float cell;
	uint16_t start[COUNT + 1], place[COUNT];
	float x[COUNT], y[COUNT], z[COUNT];
	/* Square of how far the next one that was taken is, of those that told it. */
	float near2[COUNT];
};

struct darts {
	const float (*at)[3];
	const float *spacing;
	uint32_t count, taken, lefts;
	float usual, extent;
	uint16_t *left; /* places that are not taken yet, in the order of before */
	uint16_t *ret;
	struct cells cells;
	uint16_t in_cells[COUNT]; /* of each place */
	uint16_t looked[COUNT];   /* how many of the taken ones a wide point has looked at */
};

static uint32_t cell_of(int32_t x, int32_t y, int32_t z)
{
	return ((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u) %
	       COUNT;
}

static void find_cell(const struct cells *c, const float at[3], int32_t ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = (int32_t)floorf(at[k] / c->cell);
}

static void fill_cells(struct darts *d, float cell)
{
	struct cells *c = &d->cells;
	uint16_t of[COUNT], end[COUNT + 1] = { 0 };
	c->cell = fmaxf(cell, d->extent / CELLS_MOST);
	for (uint32_t n = 0; n < d->count; n++) {
		int32_t at[3];
		find_cell(c, d->at[n], at);
		of[n] = (uint16_t)cell_of(at[0], at[1], at[2]);
		end[of[n] + 1]++;
	}
	for (uint32_t i = 0; i < COUNT; i++)
		end[i + 1] = (uint16_t)(end[i + 1] + end[i]);
	memcpy(c->start, end, sizeof end);
	for (uint32_t n = 0; n < d->count; n++) {
		const uint16_t i = end[of[n]]++;
		c->place[i] = (uint16_t)n;
		d->in_cells[n] = i;
		c->x[i] = d->at[n][0], c->y[i] = d->at[n][1], c->z[i] = d->at[n][2];
		c->near2[i] = INFINITY;
	}
}

/* ---- how far points are apart ---- */

/* Neighbours of one cell, gathered from those around; counted for all of its points. */
struct around {
	int32_t cell[3];
	uint32_t count;
	float x[2 * COUNT], y[2 * COUNT], z[2 * COUNT];
};

/* Two cells around may have the same place in the table, so some are there twice; few. */
static void gather(const struct cells *c, const int32_t cell[3], struct around *a)
{
	memcpy(a->cell, cell, sizeof a->cell);
	a->count = 0;
	for (int n = 0; n < 27; n++) {
		const uint32_t of =
			cell_of(cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1);
		for (uint32_t i = c->start[of]; i < c->start[of + 1] && a->count < 2 * COUNT; i++) {
			a->x[a->count] = c->x[i], a->y[a->count] = c->y[i];
			a->z[a->count++] = c->z[i];
		}
	}
}

/* With itself. */
static uint32_t count_near(const struct around *a, float x, float y, float z, float radius2)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < a->count; i++) {
		const float dx = x - a->x[i], dy = y - a->y[i], dz = z - a->z[i];
		count += dx * dx + dy * dy + dz * dz < radius2;
	}
	return MAX(count, 1);
}

/* How far points are from each other where each is. What a point says that it stands for is no more than about right, and not at all
 * beside gaps; who has the larger spacing would come later than he should. */
static void find_spacings(struct darts *d, const float *claimed_m, float ret[COUNT])
{
	const struct cells *c = &d->cells;
	const float radius = AROUND * d->usual;
	struct around a = { .count = 0 };
	fill_cells(d, radius);
	for (uint32_t i = 0; i < d->count; i++) {
		const uint16_t n = c->place[i];
		int32_t cell[3];
		find_cell(c, d->at[n], cell);
		if (i == 0 || memcmp(cell, a.cell, sizeof cell) != 0)
			gather(c, cell, &a);
		const uint32_t around = count_near(&a, c->x[i], c->y[i], c->z[i], radius * radius);
		float found = radius * sqrtf((float)G_PI / (float)around);
		if (around <= ALONE)
			found = fmaxf(found, claimed_m[n]);
		ret[n] = fminf(found, UNEVEN * d->usual);
	}
}

/* ---- who is too near to one that is taken ---- */

static void tell_run(struct cells *c, const float at[3], uint32_t from, uint32_t to)
{
	for (uint32_t i = from; i < to; i++) {
		const float x = at[0] - c->x[i], y = at[1] - c->y[i], z = at[2] - c->z[i],
			    far2 = x * x + y * y + z * z;
		c->near2[i] = far2 < c->near2[i] ? far2 : c->near2[i];
	}
}

/* Those that are that near to one that is taken hear of it, others may. */
static void tell(struct darts *d, const float at[3], float reach)
{
	struct cells *c = &d->cells;
	const float across = 2 * reach / c->cell + 2;
	int32_t low[3], high[3];
	if (across * across * across > CELLS_WORTH) {
		tell_run(c, at, 0, d->count);
		return;
	}
	for (int k = 0; k < 3; k++) {
		low[k] = (int32_t)floorf((at[k] - reach) / c->cell);
		high[k] = (int32_t)floorf((at[k] + reach) / c->cell);
	}
	for (int32_t z = low[2]; z <= high[2]; z++)
		for (int32_t y = low[1]; y <= high[1]; y++)
			for (int32_t x = low[0]; x <= high[0]; x++) {
				const uint32_t of = cell_of(x, y, z);
				tell_run(c, at, c->start[of], c->start[of + 1]);
			}
}

static float distance2(const float a[3], const float b[3])
{
	float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return x * x + y * y + z * z;
}

/* Whether one that is taken already is nearer than the disc of this one reaches. */
static bool is_near(struct darts *d, uint32_t place, float discs)
{
	const float radius = discs * d->spacing[place], radius2 = radius * radius;
	float *near2 = &d->cells.near2[d->in_cells[place]];
	if (d->spacing[place] > WIDE * d->usual)
		while (*near2 >= radius2 && d->looked[place] < d->taken)
			*near2 = fminf(
				*near2, distance2(d->at[place], d->at[d->ret[d->looked[place]++]]));
	return *near2 < radius2;
}

/* One round: all that are left, with discs of so many spacings. */
static void throw_all(struct darts *d, float discs)
{
	/* a little farther, for what is rounded */
	const float reach = 1.001f * discs * WIDE * d->usual;
	uint32_t still_left = 0;
	for (uint32_t n = 0; n < d->lefts; n++) {
		const uint16_t place = d->left[n];
		if (is_near(d, place, discs)) {
			d->left[still_left++] = place;
			continue;
		}
		d->ret[d->taken++] = place;
		tell(d, d->at[place], reach);
	}
	d->lefts = still_left;
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
		.usual = median(spacing_m, count),
		.count = count,
		.lefts = count,
		.left = left,
		.ret = place };
	memcpy(left, place, count * sizeof *left);
	find_spacings(&d, spacing_m, spacing);
	for (float discs = sqrtf(PACKED * (float)count); discs > LAST_DISC && d.lefts;
		discs *= (float)G_SQRT2 / 2)
		throw_all(&d, discs);
	memcpy(place + d.taken, left, d.lefts * sizeof *place);
}
