#ifndef PROCESS_VERIFY_VIEW_H
#define PROCESS_VERIFY_VIEW_H
/* What a scan says of each direction, at about half a degree: the surface there, and around it how near and how far the beams
 * went and how many came back from nothing. Const after it is made. It refers to the pyramid, which must live longer, and
 * keeps nothing of the grid. */
#include "process/coarse-view.h"
#include "process/pyramid.h"

/* Over a cell of the pyramid's level 0 and its eight neighbours: edges, and poses that are a little off, must not look like
 * contradictions. */
struct verify_around {
	float near_m, far_m; /* of all points there; near_m above far_m: there are none */
	uint8_t looked;      /* of the nine cells, how many were looked into */
	uint8_t empty;       /* of those, how many gave next to nothing back */
};

struct verify_view {
	uint32_t columns, rows;
	bool wraps;
	float column_rad, row_rad, azimuth_min_rad, elevation_max_rad;
	float range_max_m;           /* the farthest point */
	float beams;                 /* of the scan that a cell stands for */
	const struct surfel *surfel; /* the pyramid's */
	struct verify_around *around;
};

struct verify_view *verify_view_new(const range_grid *g, const pyramid *p);
void verify_view_free(struct verify_view *v); /* NULL is fine */

/* The cell that looks in a direction; false: outside. */
static inline bool verify_view_find(
	const struct verify_view *v, const float p[3], int32_t *ret_row, int32_t *ret_column)
{
	float azimuth = coarse_atan2(p[0], p[1]) - v->azimuth_min_rad;
	azimuth += azimuth < 0 ? (float)(2 * G_PI) : 0;
	float level = sqrtf(p[0] * p[0] + p[1] * p[1]);
	float row = (v->elevation_max_rad - coarse_atan2(p[2], level)) / v->row_rad;
	int32_t column = (int32_t)(azimuth / v->column_rad);
	if (!(row >= 0 && row < (float)v->rows))
		return false;
	if (column >= (int32_t)v->columns) {
		if (!v->wraps)
			return false;
		column = 0;
	}
	*ret_row = (int32_t)row;
	*ret_column = column;
	return true;
}

/* Index of a cell that may lie beyond the edge: -1 then. */
static inline int64_t verify_view_at(const struct verify_view *v, int32_t row, int32_t column)
{
	int32_t columns = (int32_t)v->columns;
	if (v->wraps)
		column += column < 0 ? columns : column >= columns ? -columns : 0;
	if (row < 0 || row >= (int32_t)v->rows || column < 0 || column >= columns)
		return -1;
	return (int64_t)row * columns + column;
}

#endif
