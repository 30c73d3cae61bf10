#ifndef PROCESS_VERIFY_VIEW_H
#define PROCESS_VERIFY_VIEW_H
/* What a scan says of each direction, at about half a degree: the surface there, how near and how far the block of beams
 * reaches, and how much of it saw through to nothing. Const after it is made; keeps the pyramid, which must live longer. */
#include "process/pyramid.h"

struct verify_block {
	float near_m, far_m; /* of its points; 0: none */
	uint8_t looked;      /* beams that went there, at most 255 */
	uint8_t nothing;     /* share of them that did not come back, 0..255 */
};

struct verify_view {
	uint32_t columns, rows; /* those of the pyramid's level 0 */
	bool wraps;
	float column_rad, row_rad, azimuth_min_rad, elevation_max_rad;
	float noise_m, range_max_m;  /* the farthest point */
	const struct surfel *surfel; /* the pyramid's */
	struct verify_block *block;
};

struct verify_view *verify_view_new(const range_grid *g, const pyramid *p);
void verify_view_free(struct verify_view *v); /* NULL is fine */

/* The cell that looks in a direction; false: outside. */
static inline bool verify_view_find(
	const struct verify_view *v, const float p[3], int32_t *ret_row, int32_t *ret_column)
{
	float azimuth = atan2f(p[0], p[1]) - v->azimuth_min_rad;
	azimuth += azimuth < 0 ? (float)(2 * G_PI) : 0;
	float row = (v->elevation_max_rad - atan2f(p[2], sqrtf(p[0] * p[0] + p[1] * p[1]))) /
		    v->row_rad;
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

/* Index of a neighbour, or -1 beyond the edge. */
static inline int64_t verify_view_at(const struct verify_view *v, int32_t row, int32_t column)
{
	if (v->wraps)
		column = column < 0                      ? column + (int32_t)v->columns
			 : column >= (int32_t)v->columns ? column - (int32_t)v->columns
							 : column;
	if (row < 0 || row >= (int32_t)v->rows || column < 0 || column >= (int32_t)v->columns)
		return -1;
	return (int64_t)row * v->columns + column;
}

#endif
