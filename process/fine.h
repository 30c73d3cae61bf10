#ifndef PROCESS_FINE_H
#define PROCESS_FINE_H
/* Fine alignment of two scans from a start that is nearly right: projective point-to-plane on the range grids, from coarse
 * levels to fine ones. */
#include "process/pyramid.h"
#include "process/range-grid.h"

/* What alignment needs of a scan: a pyramid of points and normals. Made once per scan, then used for all its pairs. Const
 * after it is made. It keeps nothing of the grid. */
typedef struct fine_scan fine_scan;
fine_scan *fine_scan_new(const range_grid *g);
void fine_scan_free(fine_scan *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(fine_scan, fine_scan_free)
const pyramid *fine_scan_pyramid(const fine_scan *s); /* the scan's; lives as long */

enum fine_reach {
	FINE_FROM_COARSE, /* the start may be off by 3 m and 15 degrees */
	FINE_FROM_NEAR,   /* by 0.3 m and 2 degrees: starts at a finer level */
};

struct fine_result {
	struct pose pose;           /* takes b's scanner frame to a's */
	bool converged;             /* the last steps were below 0.0005 degrees and 0.05 mm */
	uint32_t iterations, pairs; /* pairs: of points, at the finest level */
	double rms_m;               /* of the point-to-plane distances of the inliers */
	double inlier_share; /* of b's points that look into a's view: with a partner within the final gate */
	/* Of the twist (pose_perturb's: rotation vector in rad, translation in m, in a's frame, about a's origin), from the
	 * residuals and the normal equations. */
	double covariance[6][6];
	double information_eigenvalues
		[6]; /* of the scaled normal equations, rising: how well the worst direction is held */
};

/* false: fewer than 100 pairs were found, or the equations are singular; *ret then tells how far it came. */
bool fine_align(const fine_scan *a, const fine_scan *b, const struct pose *start,
	enum fine_reach reach, struct fine_result *ret);

#endif
