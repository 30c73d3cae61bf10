#ifndef PROCESS_COARSE_VIEW_H
#define PROCESS_COARSE_VIEW_H
/* What a scan saw, thinned to about a degree: enough to find where another scan stands, small enough to stay in the cache.
 * Each cell stands for a block of the grid: one point of it, the normal of the surface there, and how near and how far the
 * block reaches. A table of equal angles finds the cell of a direction. Const after it is made. */
#include "process/range-grid.h"

#define COARSE_VIEW_NONE    (-1.0f) /* nobody looked there */
#define COARSE_VIEW_NOTHING 0.0f    /* looked, and nothing came back */

struct coarse_cell {
	float point_m[3]; /* in the scanner frame */
	float normal[3];  /* unit, towards the scanner; 0: no plane there */
	float near_m,
		far_m; /* ranges of the block's points; near_m may be COARSE_VIEW_NONE or _NOTHING */
};

struct coarse_view {
	uint32_t columns, rows;
	struct coarse_cell *cell; /* row by row, as the grid's */
	/* Directions. */
	uint32_t lattice_columns, lattice_rows;
	float azimuth_min_rad, elevation_max_rad, columns_per_rad, rows_per_rad;
	uint32_t *lattice; /* index of a cell, RANGE_GRID_NONE */
};

struct coarse_view *coarse_view_new(const range_grid *g);
void coarse_view_free(struct coarse_view *v); /* NULL is fine */

/* atan2 to within 0.0003 rad. */
static inline float coarse_atan2(float y, float x)
{
	float ax = fabsf(x), ay = fabsf(y);
	float high = ax > ay ? ax : ay, low = ax > ay ? ay : ax;
	float t = high > 0 ? low / high : 0, s = t * t;
	float r =
		t *
		(0.99997726f +
			s * (-0.33262347f +
				    s * (0.19354346f +
						s * (-0.11643287f +
							    s * (0.05265332f - s * 0.01172120f)))));
	r = ay > ax ? (float)G_PI_2 - r : r;
	r = x < 0 ? (float)G_PI - r : r;
	return y < 0 ? -r : r;
}

/* The cell that looks in a direction (need not be of unit length); NULL: nobody looked there. */
static inline const struct coarse_cell *coarse_view_find(
	const struct coarse_view *v, const float p[3])
{
	float azimuth = coarse_atan2(p[0], p[1]) - v->azimuth_min_rad;
	azimuth += azimuth < 0 ? (float)(2 * G_PI) : 0;
	float level = sqrtf(p[0] * p[0] + p[1] * p[1]);
	float row = (v->elevation_max_rad - coarse_atan2(p[2], level)) * v->rows_per_rad;
	float column = azimuth * v->columns_per_rad;
	if (!(row >= 0 && row < (float)v->lattice_rows))
		return NULL;
	if (!(column < (float)v->lattice_columns))
		return NULL;
	uint32_t at = v->lattice[(uint32_t)row * v->lattice_columns + (uint32_t)column];
	if (at == RANGE_GRID_NONE || v->cell[at].near_m < 0)
		return NULL;
	return &v->cell[at];
}

#endif
