#ifndef PROCESS_COARSE_H
#define PROCESS_COARSE_H
/* Where might scan b stand relative to scan a? With no start pose. Levelled scans have four degrees of freedom: yaw by
 * circular correlation, x and y by correlation of plans, z by the ground. Scans that are not level have six.
 *
 * It proposes; fine alignment and verification decide. */
#include "process/range-grid.h"

/* What the search needs of a scan (ground, plan of upright surfaces, descriptors ...). Made once per scan. Const after. */
typedef struct coarse_scan coarse_scan;
coarse_scan *coarse_scan_new(const range_grid *g);
void coarse_scan_free(coarse_scan *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(coarse_scan, coarse_scan_free)

struct coarse_candidate {
	struct pose pose; /* takes b's scanner frame to a's */
	double score;     /* 0..1: comparable between candidates of one pair */
};

struct coarse_options {
	double distance_max_m; /* 0: 40; between the stations */
	bool not_level; /* the scanner frames' z axes may be far from upright: six degrees of freedom */
};

/* Distinct candidates (further apart than 0.5 m or 3 degrees), best first; at most max, maybe none. */
size_t coarse_align(const coarse_scan *a, const coarse_scan *b,
	const struct coarse_options *options, struct coarse_candidate *ret, size_t max);

#endif
