#ifndef PROCESS_PYRAMID_SUMS_H
#define PROCESS_PYRAMID_SUMS_H
/* The sums of a pyramid's level: per cell count, mean and products about the mean of its points. Planes have an empty cell
 * around them, so that neighbours can be read without asking; where the grid wraps, the side ones repeat the far side. */
#include "process/range-grid.h"

enum {
	SUM_COUNT,
	SUM_RANGE, /* of the mean */
	SUM_X,     /* the mean */
	SUM_Y,
	SUM_Z,
	SUM_XX, /* sums of products about it */
	SUM_XY,
	SUM_XZ,
	SUM_YY,
	SUM_YZ,
	SUM_ZZ,
	SUM_PLANES
};

struct sums {
	uint32_t columns, rows;
	size_t stride; /* of a row */
	float *plane[SUM_PLANES];
};

/* What is fitted to a row of cells; planes of `columns` each. */
enum {
	FIT_COUNT, /* of points; 0: no plane */
	FIT_NX,    /* unit, towards the scanner */
	FIT_NY,
	FIT_NZ,
	FIT_VARIANCE, /* along the beam, m2 */
	FIT_COSINE,   /* of the incidence */
	FIT_PLANES
};

static inline size_t sums_at(const struct sums *s, uint32_t row, uint32_t column)
{
	return (row + 1) * s->stride + column + 1;
}

/* Blocks of across x down lattice cells. across is 1, 2, 4 or 8. */
void sums_of_grid(
	const range_grid *g, uint32_t across, uint32_t down, bool portable, struct sums *ret);
void sums_of_level_below(const struct sums *below, bool wraps, struct sums *ret);
void sums_clear(struct sums *s);

/* Planes through a row of cells and what belongs to them of their neighbours: those whose range differs by less than
 * slack_m and slope times the range. */
void sums_fit_row(const struct sums *s, uint32_t row, float slack_m, float slope, bool portable,
	float *ret[FIT_PLANES]);

#endif
