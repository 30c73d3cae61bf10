#ifndef PROCESS_FINE_H
#define PROCESS_FINE_H
/* Fine alignment of two scans from a start that is nearly right: projective point-to-plane on the range grids, from coarse
 * levels to fine ones.
 *
 * Each scan is a pyramid of planes (pyramid.h). A stage looks at all surfaces in cells of about the same width in metres,
 * whatever their range, so that what stands near the scanner does not outweigh the rest; each cell looks for its partner in
 * the other scan's pyramid by its direction. Both ways, in Gauss-Newton steps, with a Geman-McClure kernel whose width falls
 * from step to step. Weights come from the noise along the beam and the incidence, so ground met at a slant, where a range
 * tells height best, counts for what it is worth, and foliage for next to nothing. */
#include "process/pyramid.h"
#include "process/range-grid.h"

/* What alignment needs of a scan: a pyramid of points and normals. Made once per scan, then used for all its pairs. Const
 * after it is made. It keeps nothing of the grid. */
typedef struct fine_scan fine_scan;
fine_scan *fine_scan_new(const range_grid *g);
/* In narrow cells, for FINE_CLOSELY only. */
fine_scan *fine_scan_new_narrow(const range_grid *g);
void fine_scan_free(fine_scan *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(fine_scan, fine_scan_free)
const pyramid *fine_scan_pyramid(const fine_scan *s); /* the scan's; lives as long */

enum fine_reach {
	FINE_FROM_COARSE, /* the start may be off by 3 m and 15 degrees */
	FINE_FROM_NEAR,   /* by 0.3 m and 2 degrees: starts at a finer level */
	/* In two parts, so that of many candidates only the likely ones are finished: the first as from near, which coarse
	 * candidates are (from afar, a street's front slides to the next window), but to some centimetres only, never converged;
	 * the second from where the first ended. */
	FINE_ROUGHLY,
	FINE_FROM_ROUGH,
	/* From where another reach ended, the last stage again. In narrow cells, which show what stands more than 15 m away as the
	 * others do what is nearer, it halves the error of pairs that little holds. */
	FINE_CLOSELY,
};

struct fine_result {
	struct pose pose; /* takes b's scanner frame to a's */
	/* The last step was below 0.0005 degrees and 0.05 mm, and next to nothing stands where the other scan saw through. Where
	 * bays or windows repeat, a start that is far off may still end in the wrong one: verify knows more. */
	bool converged;
	uint32_t iterations;
	uint32_t pairs; /* of cells, over both ways, at the finest stage */
	double rms_m;   /* of the point-to-plane distances, weighted as in the fit */
	/* Of b's cells that look into a's view, those with a partner within the final gate. */
	double inlier_share;
	/* Of b's cells that stand where a saw through, over these and the partners: near 0 where the pose is right. */
	double through_share;
	/* Of the twist (pose_perturb's: rotation vector in rad, translation in m, in a's frame, about a's origin), from the
	 * residuals, summed over tiles of the view, and the normal equations. It tells of the scans' noise and unevenness; what
	 * is wrong with a whole scan, such as its heading, is not in it. */
	double covariance[6][6];
	/* How well each direction is held, rising, without unit: eigenvalues of the mean of j * j^T over the pairs, weighted as
	 * in the fit, where j is what the distance along the plane's normal changes by, per turn about the pairs' middle (in
	 * units of their rms distance from it) and per move. The moves alone would sum to 1. In a room the least is 0.01 to 0.1;
	 * 0.001 says that one pair in a thousand holds that direction. */
	double information_eigenvalues[6];
};

/* false: fewer than 100 pairs were found, or the equations are singular; *ret then tells how far it came. */
bool fine_align(const fine_scan *a, const fine_scan *b, const struct pose *start,
	enum fine_reach reach, struct fine_result *ret);

#endif
