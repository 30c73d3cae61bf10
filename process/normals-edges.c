#include "process/lanes.h"
#include "process/normals-tile.h"
#include <string.h>

/* How far off the plane of a neighbour's window the point itself may be, in sigma. */
#define ON_PLANE     2.5f
#define WINDOW_SHARE 60
#define EDGE_COLUMNS 16 /* nearer to the ends of a row, neighbours may be at the other */

INLINE const float *offset_at(const struct normals_planes *p, size_t i)
{
	return p->offset_m + (i - p->offset_from);
}

/* How far the point is from the plane of cell k's window, along the ray. */
static float off_plane_m(const range_grid *g, const struct normals_planes *p, size_t i, size_t k)
{
	float away = p->normal[0][k] * g->x_m[i] + p->normal[1][k] * g->y_m[i] +
		     p->normal[2][k] * g->z_m[i];
	return away < 0 ? fabsf(g->range_m[i] * (1 + *offset_at(p, k) / away)) : INFINITY;
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
			if (!range_grid_step(g, row, column, (int)(down[w] * cells),
				    (int)(right[w] * cells), &k) ||
				!(*offset_at(p, k) > 0))
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
	size_t k = *offset_at(p, i) < 0 ? find_plane(g, o, p, row, column) : i;
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

/* Eight cells, or blocks of four that share a plane. */
struct lanes {
	vf x, y, z, range; /* where, or in the middle */
	vi open;           /* creased, and no other plane found */
	vf normal[3];
};

/* Eight values that lie side by side (every 1), or two columns apart. */
INLINE vf load_every(const float *plane, int every)
{
	return every == 1 ? load(plane) : evens(load(plane), load(plane + LANES));
}

/* Looks with the widest window of those that need it. Only planes of cells that are not creased are taken and only others are
 * replaced, so nothing is read that was written; and no cell is its own neighbour. */
INLINE void find_planes(struct lanes *l, const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column, int every)
{
	const size_t i = (size_t)row * g->columns + column;
	float cells = window_cells(g, o, largest(where(l->open, l->range)));
	vi seen = { 0 }; /* where none is whole half a window away, it is clutter */
	for (int shift = 0; shift < 2 && any(l->open) && (!shift || any(seen));
		shift++, cells /= 2) {
		/* The least distance off a plane along the ray is range * off / ahead: as a fraction, for
		 * division is slow. */
		vf least_off = all(ON_PLANE * o->range_noise_m), least_ahead = l->range;
		vi found = { 0 }, further = steps(g, row, cells);
#pragma GCC unroll 1
		for (int w = 0; w < LANES; w++) {
			size_t k = i + (ptrdiff_t)further[w];
			vf offset = load_every(offset_at(p, k), every);
			vi whole = l->open & (offset > 0);
			seen |= whole;
			vf nx = load_every(p->normal[0] + k, every),
			   ny = load_every(p->normal[1] + k, every),
			   nz = load_every(p->normal[2] + k, every);
			vf ahead = -(nx * l->x + ny * l->y + nz * l->z);
			vf off = magnitude(offset - ahead);
			vi better = whole & (ahead > 0) & (off * least_ahead < least_off * ahead);
			better = better < 0; /* the compiler sees a comparison, and blends */
			found |= better;
			least_off = choose(better, off, least_off);
			least_ahead = choose(better, ahead, least_ahead);
			l->normal[0] = choose(better, nx, l->normal[0]);
			l->normal[1] = choose(better, ny, l->normal[1]);
			l->normal[2] = choose(better, nz, l->normal[2]);
		}
		l->open &= ~found;
	}
}

INLINE void sharpen_lanes(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column)
{
	const size_t i = (size_t)row * g->columns + column;
	struct lanes l = { .open = load(offset_at(p, i)) < 0 };
	if (!any(l.open))
		return;
	l.x = load(g->x_m + i);
	l.y = load(g->y_m + i);
	l.z = load(g->z_m + i);
	l.range = load(g->range_m + i);
	for (int axis = 0; axis < 3; axis++)
		l.normal[axis] = load(p->normal[axis] + i);
	find_planes(&l, g, o, p, row, column, 1);
	for (int axis = 0; axis < 3; axis++)
		store(p->normal[axis] + i, l.normal[axis]);
}

/* The mean of four cells each. */
INLINE vf load_blocks(const float *plane, size_t below)
{
	vf first = load(plane) + load(plane + below),
	   second = load(plane + LANES) + load(plane + LANES + below);
	return 0.25f * (evens(first, second) + odds(first, second));
}

/* Two rows of sixteen cells; false: not all of them are in blocks of four that share a plane. */
INLINE bool sharpen_blocks(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t column)
{
	const size_t i = (size_t)row * g->columns + column, below = g->columns;
	const float *offset = offset_at(p, i);
	vf first = load(offset), second = load(offset + LANES), even = evens(first, second);
	vi differs = (first != load(offset + below)) | (second != load(offset + below + LANES)) |
		     (even != odds(first, second));
	if (any(differs))
		return false;
	struct lanes l = { .open = even < 0 };
	if (!any(l.open))
		return true;
	l.x = load_blocks(g->x_m + i, below);
	l.y = load_blocks(g->y_m + i, below);
	l.z = load_blocks(g->z_m + i, below);
	l.range = load_blocks(g->range_m + i, below);
	for (int axis = 0; axis < 3; axis++)
		l.normal[axis] = load_every(p->normal[axis] + i, 2);
	find_planes(&l, g, o, p, row, column, 2);
	for (int axis = 0; axis < 3; axis++) {
		vf half[2] = { first_half(l.normal[axis], l.normal[axis]),
			second_half(l.normal[axis], l.normal[axis]) };
		for (int k = 0; k < 2; k++) {
			store(p->normal[axis] + i + k * LANES, half[k]);
			store(p->normal[axis] + i + below + k * LANES, half[k]);
		}
	}
	return true;
}

INLINE void sharpen_run(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t rows, uint32_t column, uint32_t end)
{
	for (; column < MIN(end, EDGE_COLUMNS); column++)
		for (uint32_t r = 0; r < rows; r++)
			sharpen_cell(g, o, p, row + r, column);
	for (; column + 2 * LANES <= end && column + 2 * LANES + EDGE_COLUMNS <= g->columns;
		column += 2 * LANES) {
		if (rows == 2 && sharpen_blocks(g, o, p, row, column))
			continue;
		for (uint32_t r = 0; r < rows; r++) {
			sharpen_lanes(g, o, p, row + r, column);
			sharpen_lanes(g, o, p, row + r, column + LANES);
		}
	}
	for (; column < end; column++)
		for (uint32_t r = 0; r < rows; r++)
			sharpen_cell(g, o, p, row + r, column);
}

INLINE void sharpen_row(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t rows, uint32_t column, uint32_t end)
{
	if (rows == 2)
		sharpen_run(g, o, p, row, 2, column, end);
	else
		sharpen_run(g, o, p, row, 1, column, end);
}

static void sharpen_row_portable(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, uint32_t row, uint32_t rows, uint32_t column, uint32_t end)
{
	sharpen_row(g, o, p, row, rows, column, end);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void sharpen_row_avx2(const range_grid *g,
	const struct normals_options *o, const struct normals_planes *p, uint32_t row,
	uint32_t rows, uint32_t column, uint32_t end)
{
	sharpen_row(g, o, p, row, rows, column, end);
}
#endif

void sharpen_area(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, struct area area)
{
	void (*sharpen)(const range_grid *, const struct normals_options *,
		const struct normals_planes *, uint32_t, uint32_t, uint32_t, uint32_t) =
		sharpen_row_portable;
#if defined __x86_64__
	if (!o->portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		sharpen = sharpen_row_avx2;
#endif
	for (uint32_t row = area.row; row < area.rows_end; row += 2)
		sharpen(g, o, p, row, MIN(2, area.rows_end - row), area.column, area.columns_end);
}
