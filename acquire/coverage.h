#ifndef ACQUIRE_COVERAGE_H
#define ACQUIRE_COVERAGE_H
/* Which cells of a panorama's grid a beam has gone to, while the scan runs: one bit a cell. From it
 * the scan knows where it has to go again, be it for lost revolutions, an unplugged lidar or a scan
 * that was resumed. One owner. */
#include "acquire/panorama.h"

typedef struct coverage coverage;

/* Angles of the stage's front; the lidar sees front and back, so 0..pi is a whole panorama. */
struct front_interval {
	double from_rad, to_rad;
};

coverage *coverage_new(const struct panorama_desc *desc);
void coverage_free(coverage *c); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(coverage, coverage_free)

/* The beams of a line, in the order of its sweep: they stand for what lies between two of them too, where that is not more than
 * 2.5 degrees of a column. Which rows the beams of a lidar meet differs from turn to turn when it measures at its own beat. */
void coverage_add(coverage *c, const double *azimuth_rad, const float *elevation_rad, size_t beams);
/* Forgets what was seen while the front was between these angles (front and back columns). */
void coverage_clear(coverage *c, double from_rad, double to_rad);

/* Share of the columns that are as full as the others. */
double coverage_fraction(const coverage *c);
uint32_t coverage_missing_columns(const coverage *c);
/* Where the front must pass again, in rising order, gaps under join_rad joined; caller frees. Of
 * struct front_interval. */
GArray *coverage_missing(const coverage *c, double join_rad);

#endif
