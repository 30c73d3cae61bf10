#ifndef PROCESS_PART_POINT_H
#define PROCESS_PART_POINT_H
/* A point of a scan as models take it: placed on the curve, with all that is known of it. */
#include "process/model-part.h"
#include "process/scan-points.h"

/* The points of a scan and what is known of them. */
struct part_source {
	struct scan_points points;
	const scan_segments *segments; /* NULL: none */
	const scan_features *features; /* NULL: none */
};
/* false: outside the lattice. *reach_m rises to how far off the site's origin it is along an axis. Any thread, each with a reach of
 * its own. */
bool part_point_take(const struct part_source *s, uint64_t i, double cell_m, struct part_point *ret,
	double *reach_m);

#endif
