#ifndef PROCESS_RANGE_GRID_H
#define PROCESS_RANGE_GRID_H
/* A scan in memory as a grid of points: what stands next to each other in the grid was seen next to each other. It is made
 * from a panorama, whose cells are equal in angle, or from an ordered scan of another scanner, whose cells are not; a lattice
 * of equal angles tells which cell looks in a direction, for either.
 *
 * Only measured cells have a point. One owner; const after it is made, then any number of threads may read. */
#include "acquire/panorama.h"
#include "process/pose.h"
#include <glib.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RANGE_GRID_NONE G_MAXUINT32

/* Equal angles over the directions that the scan looked in. */
struct range_lattice {
	uint32_t columns, rows;
	double column_rad, row_rad;
	double azimuth_min_rad;   /* left edge of column 0; azimuth clockwise from +y */
	double elevation_max_rad; /* upper edge of row 0 */
	bool wraps;               /* the last column is beside the first: a full turn */
	/* Index of the grid's cell whose point, or whose look into the void, is nearest the lattice cell's centre;
	 * RANGE_GRID_NONE where the scan did not look. NULL for a panorama: the same index. */
	uint32_t *cell;
};

typedef struct range_grid range_grid;
struct range_grid {
	uint32_t columns, rows;
	bool wraps; /* the last column is beside the first */
	double column_rad,
		row_rad; /* angle between neighbours, at the horizon; the median of an uneven grid */
	/* Planes of rows * columns, row by row, row 0 the highest, columns clockwise, 64-byte aligned. */
	float *x_m, *y_m, *z_m; /* in the scanner frame; 0 where there is no point */
	float *range_m;         /* 0: no point */
	uint8_t *cell;          /* enum panorama_cell; only CELL_MEASURED has a point */
	uint16_t *intensity;    /* NULL: none */
	uint8_t *rgb;           /* 3 bytes a cell; NULL: no colour */
	struct range_lattice lattice;
};

/* Points as an ordered scan has them: planes as above, any of them but x, y, z and cell may be NULL. Copies. The scanner is
 * at the origin. */
struct range_grid_desc {
	uint32_t columns, rows;
	const double *x_m, *y_m, *z_m;
	const uint8_t *cell;
	const uint16_t *intensity;
	const uint8_t *rgb;
};

range_grid *range_grid_from_panorama(const panorama *p);
/* Refuses a grid without a point, and points that are not finite. */
range_grid *range_grid_new(const struct range_grid_desc *desc, GError **error);
/* One cell for each block of so many rows and columns of another grid: the first that has a point. Its lattice finds nothing. */
range_grid *range_grid_thin(const range_grid *g, uint32_t every);
void range_grid_free(range_grid *g); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(range_grid, range_grid_free)

static inline size_t range_grid_cells(const range_grid *g)
{
	return (size_t)g->columns * g->rows;
}
size_t range_grid_count(const range_grid *g); /* measured cells */

/* The lattice cell of a direction (need not be of unit length), or -1 where the scan did not look. */
static inline int64_t range_lattice_find(
	const struct range_lattice *l, double x, double y, double z)
{
	double azimuth = atan2(x, y) - l->azimuth_min_rad;
	if (azimuth < 0)
		azimuth += 2 * G_PI;
	double row = (l->elevation_max_rad - atan2(z, sqrt(x * x + y * y))) / l->row_rad;
	double column = azimuth / l->column_rad;
	if (!(row >= 0 && row < l->rows))
		return -1;
	if (!(column < l->columns)) {
		if (!l->wraps)
			return -1;
		column = 0; /* rounding at the seam */
	}
	return (int64_t)row * l->columns + (int64_t)column;
}

/* The grid's cell that looks in that direction, or RANGE_GRID_NONE. */
static inline uint32_t range_grid_find(const range_grid *g, double x, double y, double z)
{
	int64_t at = range_lattice_find(&g->lattice, x, y, z);
	return at < 0 ? RANGE_GRID_NONE : g->lattice.cell ? g->lattice.cell[at] : (uint32_t)at;
}

/* The cell that many rows down and columns to the right, over the seam where there is one; false: beyond the grid. */
static inline bool range_grid_step(
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

/* Diameter of the patch that a point stands for: range times the angle between beams (Xu & Chen 2004, section 3). */
static inline float range_grid_point_size_m(const range_grid *g, size_t index)
{
	return g->range_m[index] * (float)fmax(g->column_rad, g->row_rad);
}

#endif
