#ifndef PROCESS_COARSE_H
#define PROCESS_COARSE_H
/* Where might scan b stand relative to scan a? With no start pose. Levelled scans have four degrees of freedom: heading, x
 * and y by correlation of plans (process/plan.h), z by the ground. Scans that are not level have six: what is up is looked
 * for first (process/coarse-upright.h), then the same. What the plans propose is judged by what each scan saw and saw
 * through in the other's view (process/coarse-check.h) and refined on the same points, mostly to some centimetres and tenths
 * of a degree.
 *
 * It proposes; fine alignment and verification decide. A place that looks alike from two ends gives both, about as high, and
 * the wrong one may come first. Of scans that have nothing in common the proposals are few or score low; none has a meaning.
 * It needs surfaces that stand upright: a meadow or open water alone proposes nothing. */
#include "process/range-grid.h"

/* What the search needs of a scan (a thinned view, a plan, samples of its surfaces). Made once per scan; keeps nothing of
 * the grid. Const after: any number of threads may align with it. */
typedef struct coarse_scan coarse_scan;
coarse_scan *coarse_scan_new(const range_grid *g);
void coarse_scan_free(coarse_scan *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(coarse_scan, coarse_scan_free)

struct coarse_candidate {
	struct pose pose; /* takes b's scanner frame to a's */
	/* 0..1: agreement over agreement and conflict, where conflict weighs three times; comparable between candidates of one
	 * pair. */
	double score;
};

struct coarse_options {
	double distance_max_m; /* 0: 40; between the stations */
	bool not_level; /* the scanner frames' z axes may be far from upright: six degrees of freedom */
};

/* Distinct candidates (further apart than 0.5 m or 3 degrees), best first; at most max (up to 40 make sense), maybe none. The
 * same scans give the same candidates. options may be NULL. */
size_t coarse_align(const coarse_scan *a, const coarse_scan *b,
	const struct coarse_options *options, struct coarse_candidate *ret, size_t max);

#endif
