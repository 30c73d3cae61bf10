#include "process/normals-lanes.h"
#include "process/normals-tile.h"
#include <string.h>

/* How far off the plane of a neighbour's window the point itself may be, in sigma. */
#define ON_PLANE      2.5f
#define WINDOW_SHARE  60
#define STRIP_COLUMNS 256 /* whose planes, of all rows that are looked at, fit the nearer caches */
#define EDGE_COLUMNS  16  /* nearer to the ends of a row, neighbours may be at the other */

/* The cell that many rows and columns away; false: beyond the grid. */
static bool step(
	const range_grid *g, uint32_t row, uint32_t column, int down, int right, size_t *ret)
{
	int64_t r = (int64_t)row + down, c = (int64_t)column + right;
	if (g->wraps)
		c = c < 0 ? c + g->columns : c >= g->columns ? c - g->columns : c;
	if (r < 0 || r >= g->rows || c < 0 || c >= g->columns)
		return false;
	*ret = (size_t)r * g->columns + (size_t)c;
	return true;
}

/* How far the point is from the plane of cell k's window, along the ray. */
static float off_plane_m(const range_grid *g, const struct normals_planes *p, size_t i, size_t k)
{
	float away = p->normal[0][k] * g->x_m[i] + p->normal[1][k] * g->y_m[i] +
		     p->normal[2][k] * g->z_m[i];
	return away < 0 ? fabsf(g->range_m[i] * (1 + p->offset_m[k] / away)) : INFINITY;
}

/* About the windows of the fit; a quarter of their half width. */
static inline float window_cells(
	const range_grid *g, const struct normals_options *o, float range_m)
{
	float beam_m = range_m * (float)g->row_rad;
	float reach_m = MAX(o->radius_m, sqrtf(WINDOW_SHARE * o->range_noise_m * beam_m));
	return MIN(reach_m / beam_m, (float)SHARPEN_REACH) / 4;
}

/* Half the windows' width away in all directions, then a quarter. */
static const vf down = { 0, 0, -4, 4, -3, -3, 3, 3 }, right = { -4, 4, 0, 0, -3, 3, -3, 3 };

static size_t find_plane(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column, best = i, k;
	float least = ON_PLANE * o->range_noise_m, cells = window_cells(g, o, g->range_m[i]);
	for (int shift = 0; shift < 2 && best == i; shift++, cells /= 2)
		for (int w = 0; w < 8; w++) {
			if (!step(g, row, column, (int)(down[w] * cells), (int)(right[w] * cells),
				    &k) ||
				!(p->offset_m[k] > 0))
				continue;
			float off = off_plane_m(g, p, i, k);
			if (off < least) {
				least = off;
				best = k;
			}
		}
	return best;
}

static void sharpen_cell(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column;
	size_t k = p->offset_m[i] < 0 ? find_plane(g, o, p, row, column) : i;
	for (int axis = 0; axis < 3 && k != i; axis++)
		p->normal[axis][i] = p->normal[axis][k];
}

/* How many cells further those are; 0: beyond the grid. */
INLINE vi steps(const range_grid *g, uint32_t row, float cells)
{
	vi rows = __builtin_convertvector(down * cells, vi),
	   columns = __builtin_convertvector(right * cells, vi), at = rows + (int32_t)row;
	return (rows * (int32_t)g->columns + columns) & (at >= 0) & (at < (int32_t)g->rows);
}

/* The same for eight cells side by side, with the widest window of those that need it. Only planes of cells that are not creased
 * are taken and only others are replaced, so nothing is read that was written; and no cell is its own neighbour. */
INLINE void sharpen_lanes(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column;
	vi open = load(p->offset_m + i) < 0;
	if (!any(open))
		return;
	vf x = load(g->x_m + i), y = load(g->y_m + i), z = load(g->z_m + i),
	   range = load(g->range_m + i);
	float cells = window_cells(g, o, largest(where(open, range)));
	vi seen = { 0 }; /* where none is whole half a window away, it is clutter */
	vf normal[3] = { load(p->normal[0] + i), load(p->normal[1] + i), load(p->normal[2] + i) };
	for (int shift = 0; shift < 2 && any(open) && (!shift || any(seen)); shift++, cells /= 2) {
		/* The least distance off a plane along the ray is range * off / ahead: as a fraction, for
		 * division is slow. */
		vf least_off = all(ON_PLANE * o->range_noise_m), least_ahead = range;
		vi found = { 0 }, further = steps(g, row, cells);
		for (int w = 0; w < LANES; w++) {
			size_t k = i + (ptrdiff_t)further[w];
			vf offset = load(p->offset_m + k);
			vi whole = open & (offset > 0);
			seen |= whole;
			vf nx = load(p->normal[0] + k), ny = load(p->normal[1] + k),
			   nz = load(p->normal[2] + k);
			vf ahead = -(nx * x + ny * y + nz * z);
			vf off = magnitude(offset - ahead);
			vi better = whole & (ahead > 0) & (off * least_ahead < least_off * ahead);
			better = better < 0; /* the compiler sees a comparison, and blends */
			found |= better;
			least_off = choose(better, off, least_off);
			least_ahead = choose(better, ahead, least_ahead);
			normal[0] = choose(better, nx, normal[0]);
			normal[1] = choose(better, ny, normal[1]);
			normal[2] = choose(better, nz, normal[2]);
		}
		open &= ~found;
	}
	for (int axis = 0; axis < 3; axis++)
		store(p->normal[axis] + i, normal[axis]);
}

INLINE void sharpen_row(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column, uint32_t end)
{
	for (; column < MIN(end, EDGE_COLUMNS); column++)
		sharpen_cell(g, o, p, row, column);
	for (; column < end && column + LANES + EDGE_COLUMNS <= g->columns; column += LANES)
		sharpen_lanes(g, o, p, row, column);
	for (; column < end; column++)
		sharpen_cell(g, o, p, row, column);
}

static void sharpen_row_portable(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column, uint32_t end)
{
	sharpen_row(g, o, p, row, column, end);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void sharpen_row_avx2(const range_grid *g,
	const struct normals_options *o, const struct normals_planes *p, uint32_t row,
	uint32_t column, uint32_t end)
{
	sharpen_row(g, o, p, row, column, end);
}
#endif

typedef void (*sharpen_function)(const range_grid *, const struct normals_options *,
	const struct normals_planes *, uint32_t, uint32_t, uint32_t);

void sharpen_rows(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t first, uint32_t end)
{
	sharpen_function sharpen = sharpen_row_portable;
#if defined __x86_64__
	if (!o->portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		sharpen = sharpen_row_avx2;
#endif
	uint32_t strips = (g->columns + STRIP_COLUMNS - 1) / STRIP_COLUMNS;
#pragma omp parallel for schedule(dynamic, 1) if (!o->single_thread)
	for (uint32_t strip = 0; strip < strips; strip++)
		for (uint32_t row = first; row < end; row++)
			sharpen(g, o, p, row, strip * STRIP_COLUMNS,
				MIN((strip + 1) * STRIP_COLUMNS, g->columns));
}
