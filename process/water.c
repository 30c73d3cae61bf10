#include "process/water.h"
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STEP_M       0.07 /* from one surfel to the next */
#define REACH        3    /* columns; far out, little comes back */
#define AREA_M2      250.0
#define SPREAD_M     0.07 /* standard deviation of the level */
#define SHORE_M      0.15 /* what is so much higher is its shore, so much lower: it is no water */
#define SHORE_LEAST  12u
#define LOWER_MOST   0.6 /* of the side of a square of its size: strays in the water */
#define LOCK_M       1.5
#define STATION_M    4.0
#define DECK_DROP_M  1.5
#define DECK_WIDTH_M 60.0
#define DECK_GAP     2 /* columns between the deck's edge and the first of the water */

struct basin {
	uint32_t index, surfels;
	uint32_t higher, lower; /* neighbours, but water that is a lock's fall lower */
	double sum_m, squares_m2;
	bool is_water;
};

struct finder {
	const ground *g;
	const voxels *v;
	uint32_t *basin_of; /* of each surfel of the ground */
	GArray *basins;     /* of struct basin */
	uint8_t *class;
};

static double level_of(const voxels *v, uint32_t i)
{
	return (v->voxel[i].at[2] + (double)v->voxel[i].place[2]) * v->size_m;
}

/* The surfel of the ground at a place of the plan whose height is nearest to i's; VOXEL_NONE: none within a metre. */
static uint32_t beside(const struct finder *f, uint32_t i, int x, int y)
{
	const struct voxel *c = &f->v->voxel[i];
	uint32_t best = VOXEL_NONE;
	double nearest = INFINITY;
	const int up = (int)ceil(1 / f->v->size_m);
	const uint32_t *other = NULL;
	const uint32_t count = voxel_columns_find(ground_plan(f->g), c->at[0] + x, c->at[1] + y,
		c->at[2] - up, c->at[2] + up, &other);
	for (uint32_t k = 0; k < count; k++) {
		if (!ground_is(f->g, other[k]))
			continue;
		double off = fabs(level_of(f->v, other[k]) - level_of(f->v, i));
		if (off < nearest) {
			nearest = off;
			best = other[k];
		}
	}
	return best;
}

static void fill_basin(struct finder *f, uint32_t from, GArray *queue)
{
	struct basin b = { .index = f->basins->len };
	g_array_set_size(queue, 0);
	g_array_append_val(queue, from);
	f->basin_of[from] = f->basins->len;
	for (guint k = 0; k < queue->len; k++) {
		uint32_t i = g_array_index(queue, uint32_t, k);
		double level = level_of(f->v, i);
		b.surfels++;
		b.sum_m += level;
		b.squares_m2 += level * level;
		for (int y = -REACH; y <= REACH; y++)
			for (int x = -REACH; x <= REACH; x++) {
				uint32_t other = x || y ? beside(f, i, x, y) : VOXEL_NONE;
				if (other == VOXEL_NONE || f->basin_of[other] != VOXEL_NONE ||
					fabs(level_of(f->v, other) - level) > STEP_M)
					continue;
				f->basin_of[other] = f->basins->len;
				g_array_append_val(queue, other);
			}
	}
	g_array_append_val(f->basins, b);
}

static struct basin *basin_at(const struct finder *f, uint32_t i)
{
	return &g_array_index(f->basins, struct basin, f->basin_of[i]);
}

static bool is_level(const struct finder *f, const struct basin *b)
{
	double mean = b->sum_m / b->surfels, cell = f->v->size_m;
	double spread = sqrt(fmax(b->squares_m2 / b->surfels - mean * mean, 0));
	return b->surfels * cell * cell >= AREA_M2 && spread <= SPREAD_M;
}

/* Counts what lies around the level basins, into each of them. */
static void look_at_shores(struct finder *f, uint32_t of)
{
	for (uint32_t i = 0; i < f->v->count; i++) {
		if (f->basin_of[i] != of)
			continue;
		struct basin *b = basin_at(f, i);
		for (int k = 0; k < 9; k++) {
			uint32_t other = beside(f, i, k % 3 - 1, k / 3 - 1);
			if (other == VOXEL_NONE || f->basin_of[other] == of)
				continue;
			double up = level_of(f->v, other) - level_of(f->v, i);
			b->higher += up > SHORE_M;
			b->lower +=
				up < -SHORE_M && !(basin_at(f, other)->is_water && up > -LOCK_M);
		}
	}
}

static int by_level(const void *a, const void *b)
{
	const struct basin *const *x = a, *const *y = b;
	double p = (*x)->sum_m / (*x)->surfels, q = (*y)->sum_m / (*y)->surfels;
	return (p > q) - (p < q);
}

/* The lowest first: what lies above the next water in a lock is water too. */
static void tell_water(struct finder *f)
{
	g_autoptr(GPtrArray) level = g_ptr_array_new();
	for (guint k = 0; k < f->basins->len; k++)
		if (is_level(f, &g_array_index(f->basins, struct basin, k)))
			g_ptr_array_add(level, &g_array_index(f->basins, struct basin, k));
	if (level->len)
		qsort(level->pdata, level->len, sizeof(gpointer), by_level);
	for (guint k = 0; k < level->len; k++) {
		struct basin *b = level->pdata[k];
		look_at_shores(f, b->index);
		b->is_water = b->higher >= SHORE_LEAST && b->lower <= LOWER_MOST * sqrt(b->surfels);
	}
}

static void keep_off_stations(struct finder *f, const double (*station_m)[3], size_t stations)
{
	for (uint32_t i = 0; i < f->v->count; i++) {
		double at[3];
		voxel_point_m(f->v, i, at);
		for (size_t k = 0; ground_is(f->g, i) && k < stations; k++)
			if (hypot(at[0] - station_m[k][0], at[1] - station_m[k][1]) < STATION_M)
				basin_at(f, i)->is_water = false;
	}
}

/* ---- decks ---- */

/* Whether, that way, the ground ends at a drop into water. */
static bool drops_into_water(const struct finder *f, uint32_t i, int x, int y)
{
	double at[3], step = f->v->size_m, edge = level_of(f->v, i);
	int gap = 0;
	voxel_point_m(f->v, i, at);
	for (double far = step * hypot(x, y); far < DECK_WIDTH_M; far += step * hypot(x, y)) {
		at[0] += x * step;
		at[1] += y * step;
		uint32_t top = ground_top(f->g, at);
		if (top == VOXEL_NONE) {
			gap++;
			continue;
		}
		if (f->class[top] == CLASS_WATER)
			return gap <= DECK_GAP && edge - level_of(f->v, top) >= DECK_DROP_M;
		edge = level_of(f->v, top);
		gap = 0;
	}
	return false;
}

static bool is_deck(const struct finder *f, uint32_t i)
{
	static const int way[4][2] = { { 1, 0 }, { 1, 1 }, { 0, 1 }, { -1, 1 } };
	for (int k = 0; k < 4; k++)
		if (drops_into_water(f, i, way[k][0], way[k][1]) &&
			drops_into_water(f, i, -way[k][0], -way[k][1]))
			return true;
	return false;
}

/* What most of those around it are. */
static uint8_t class_around(const struct finder *f, const uint8_t *class, uint32_t i)
{
	int decks = 0, all = 0;
	for (int k = 0; k < 25; k++) {
		uint32_t other = beside(f, i, k % 5 - 2, k / 5 - 2);
		if (other == VOXEL_NONE || class[other] == CLASS_WATER)
			continue;
		all++;
		decks += class[other] == CLASS_STRUCTURE;
	}
	return 2 * decks > all ? CLASS_STRUCTURE : CLASS_TERRAIN;
}

static void find_decks(struct finder *f)
{
	g_autofree uint8_t *found = g_memdup2(f->class, f->v->count + 1);
	for (uint32_t i = 0; i < f->v->count; i++)
		if (ground_is(f->g, i) && f->class[i] == CLASS_TERRAIN && is_deck(f, i))
			found[i] = CLASS_STRUCTURE;
	for (uint32_t i = 0; i < f->v->count; i++)
		if (ground_is(f->g, i) && f->class[i] == CLASS_TERRAIN)
			f->class[i] = class_around(f, found, i);
}

uint8_t *water_find(const ground *g, const double (*station_m)[3], size_t stations)
{
	struct finder f = { .g = g, .v = ground_surfels(g) };
	g_autoptr(GArray) queue = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g_autoptr(GArray) basins = g_array_new(FALSE, FALSE, sizeof(struct basin));
	g_autofree uint32_t *basin_of = g_new(uint32_t, f.v->count + 1);
	bool any = false;
	f.basins = basins;
	f.basin_of = basin_of;
	f.class = g_malloc(f.v->count + 1);
	memset(f.class, CLASS_TERRAIN, f.v->count + 1);
	memset(basin_of, 0xFF, f.v->count * sizeof *basin_of);
	for (uint32_t i = 0; i < f.v->count; i++)
		if (basin_of[i] == VOXEL_NONE && ground_is(g, i))
			fill_basin(&f, i, queue);
	tell_water(&f);
	keep_off_stations(&f, station_m, stations);
	for (uint32_t i = 0; i < f.v->count; i++)
		if (ground_is(g, i) && basin_at(&f, i)->is_water) {
			f.class[i] = CLASS_WATER;
			any = true;
		}
	if (any)
		find_decks(&f);
	return f.class;
}
