#include "process/cloud.h"
#include <stdlib.h>
#include <string.h>

#define RINGS_MIN      8u
#define RINGS_MAX      512u
#define RING_POINTS    50u  /* on average, at least */
#define RING_SHARE     0.98 /* of all points must stand on rings */
#define RING_THICKNESS 0.2  /* of the distance to the next, at most */
#define COLUMNS_MAX    20000u

struct cloud_view cloud_view_of(const points *p)
{
	return (struct cloud_view){
		.first = p->record, .count = p->count, .stride = sizeof *p->record
	};
}

static void get(const struct cloud_view *v, size_t i, double ret[3])
{
	memcpy(ret, cloud_view_at(v, i), 3 * sizeof *ret);
}

static int falling(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x < y) - (x > y);
}

/* Of all points that are not at the origin; caller frees. */
static double *sorted_elevations(const struct cloud_view *v, size_t *ret_count)
{
	double *elevation = g_new(double, v->count + 1);
	size_t count = 0;
	for (size_t i = 0; i < v->count; i++) {
		double p[3];
		get(v, i, p);
		double level = hypot(p[0], p[1]);
		if (level > 0 || p[2] != 0)
			elevation[count++] = atan2(p[2], level);
	}
	qsort(elevation, count, sizeof *elevation, falling);
	*ret_count = count;
	return elevation;
}

/* Runs of elevations without a gap. */
struct rings {
	double middle[RINGS_MAX], thickness[RINGS_MAX];
	size_t points[RINGS_MAX];
	uint32_t count;
};

static bool split_at(const double *elevation, size_t count, double gap, struct rings *ret)
{
	ret->count = 0;
	for (size_t begin = 0, end = 0; begin < count; begin = end) {
		for (end = begin + 1; end < count && elevation[end - 1] - elevation[end] < gap;)
			end++;
		if (ret->count == RINGS_MAX)
			return false;
		ret->middle[ret->count] = elevation[begin + (end - begin) / 2];
		ret->thickness[ret->count] = elevation[begin] - elevation[end - 1];
		ret->points[ret->count++] = end - begin;
	}
	return true;
}

/* Thin rings far from each other, with as good as all points. Stray points make rings of their own, with few points: those do
 * not count. */
static bool are_rings(struct rings *r, size_t count)
{
	size_t on_rings = 0;
	uint32_t kept = 0;
	for (uint32_t i = 0; i < r->count; i++) {
		if (r->points[i] < RING_POINTS)
			continue;
		on_rings += r->points[i];
		r->middle[kept] = r->middle[i];
		r->thickness[kept++] = r->thickness[i];
	}
	r->count = kept;
	if (kept < RINGS_MIN || (double)on_rings < RING_SHARE * (double)count)
		return false;
	for (uint32_t i = 0; i + 1 < kept; i++)
		if (fmax(r->thickness[i], r->thickness[i + 1]) >
			RING_THICKNESS * (r->middle[i] - r->middle[i + 1]))
			return false;
	return true;
}

bool cloud_find_rings(const struct cloud_view *v, double **ret_elevation_rad, uint32_t *ret_rings)
{
	size_t count;
	g_autofree double *elevation = sorted_elevations(v, &count);
	if (count < RINGS_MIN * RING_POINTS)
		return false;
	/* Between lidars of 512 rings over 30 degrees and of 8 over 40. */
	for (double gap = 0.04 * G_PI / 180; gap < 4 * G_PI / 180; gap *= 2) {
		struct rings r;
		if (!split_at(elevation, count, gap, &r) || !are_rings(&r, count))
			continue;
		*ret_elevation_rad = g_memdup2(r.middle, r.count * sizeof *r.middle);
		*ret_rings = r.count;
		return true;
	}
	return false;
}

static uint32_t nearest_ring(const double *elevation, uint32_t rings, double of)
{
	uint32_t low = 0, high = rings - 1;
	while (high - low > 1) {
		uint32_t middle = (low + high) / 2;
		*(of > elevation[middle] ? &high : &low) = middle;
	}
	return fabs(of - elevation[low]) <= fabs(of - elevation[high]) ? low : high;
}

double cloud_ring_height_rad(const double *elevation_rad, uint32_t rings, double at_rad)
{
	uint32_t at = nearest_ring(elevation_rad, rings, at_rad), above = at ? at - 1 : at,
		 below = MIN(at + 1, rings - 1);
	return (elevation_rad[above] - elevation_rad[below]) / MAX(below - above, 1);
}

/* ---- as a grid ---- */

/* As many columns as the fullest ring has points: a ring has at most one beam a column then, nearly always. */
static uint32_t count_columns(const uint32_t *ring, size_t count, uint32_t rings)
{
	g_autofree uint32_t *held = g_new0(uint32_t, rings);
	uint32_t most = 4;
	for (size_t i = 0; i < count; i++)
		if (ring[i] != RANGE_GRID_NONE)
			most = MAX(most, ++held[ring[i]]);
	return MIN(most, COLUMNS_MAX);
}

static uint32_t *assign_rings(const struct cloud_view *v, const double *elevation, uint32_t rings)
{
	uint32_t *ring = g_new(uint32_t, v->count);
	for (size_t i = 0; i < v->count; i++) {
		double p[3];
		get(v, i, p);
		double level = hypot(p[0], p[1]);
		ring[i] = level > 0 || p[2] != 0
				  ? nearest_ring(elevation, rings, atan2(p[2], level))
				  : RANGE_GRID_NONE;
	}
	return ring;
}

static uint32_t column_of(const double p[3], uint32_t columns)
{
	double turn = atan2(p[0], p[1]) / (2 * G_PI);
	return (uint32_t)((turn - floor(turn)) * columns) % columns;
}

/* Where two beams meet in a cell the nearer point stays: what it hides is not free space. */
static uint32_t *fill(
	const struct cloud_view *v, const uint32_t *ring, uint32_t columns, uint32_t rings)
{
	size_t cells = (size_t)columns * rings;
	uint32_t *index = g_new(uint32_t, cells);
	memset(index, 0xff, cells * sizeof *index);
	for (size_t i = 0; i < v->count; i++) {
		double p[3], q[3];
		if (ring[i] == RANGE_GRID_NONE)
			continue;
		get(v, i, p);
		uint32_t *at = &index[(size_t)ring[i] * columns + column_of(p, columns)];
		if (*at != RANGE_GRID_NONE) {
			get(v, *at, q);
			if (hypot(hypot(q[0], q[1]), q[2]) <= hypot(hypot(p[0], p[1]), p[2]))
				continue;
		}
		*at = (uint32_t)i;
	}
	return index;
}

static range_grid *grid_of(
	const struct cloud_view *v, const uint32_t *index, uint32_t columns, uint32_t rings)
{
	size_t cells = (size_t)columns * rings;
	g_autofree double *xyz = g_new0(double, 3 * cells);
	g_autofree uint8_t *cell = g_new0(uint8_t, cells);
	for (size_t i = 0; i < cells; i++) {
		double p[3];
		if (index[i] == RANGE_GRID_NONE)
			continue;
		get(v, index[i], p);
		for (size_t k = 0; k < 3; k++)
			xyz[k * cells + i] = p[k];
		cell[i] = CELL_MEASURED;
	}
	struct range_grid_desc desc = { .columns = columns,
		.rows = rings,
		.x_m = xyz,
		.y_m = xyz + cells,
		.z_m = xyz + 2 * cells,
		.cell = cell };
	return range_grid_new(&desc, NULL);
}

range_grid *cloud_range_grid(const struct cloud_view *v, uint32_t **ret_index)
{
	g_autofree double *elevation = NULL;
	uint32_t rings;
	if (v->count >= RANGE_GRID_NONE || !cloud_find_rings(v, &elevation, &rings))
		return NULL;
	g_autofree uint32_t *ring = assign_rings(v, elevation, rings);
	uint32_t columns = count_columns(ring, v->count, rings);
	g_autofree uint32_t *index = fill(v, ring, columns, rings);
	range_grid *g = grid_of(v, index, columns, rings);
	if (g && ret_index)
		*ret_index = g_steal_pointer(&index);
	return g;
}
