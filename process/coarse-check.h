#ifndef PROCESS_COARSE_CHECK_H
#define PROCESS_COARSE_CHECK_H
/* How well a pose fits, told from some hundred points of one scan in the view of the other: they agree with what it saw, hide
 * behind it, or stand where it saw through. And a few steps of point-to-plane alignment on the same points, so that the
 * judgement is not of the search's raster. */
#include "process/coarse-view.h"
#include "process/pose.h"

struct coarse_sample {
	float point_m[3], normal[3];
	float weight;
};

/* Evenly over the surfaces that the scan saw, not over its directions, in an order whose every beginning is a fair
 * choice of the whole. Few of them on the ground (by the given up direction), which fits everywhere. Caller frees. */
struct coarse_sample *coarse_samples_new(
	const struct coarse_view *v, const double up[3], size_t *ret_count);

struct coarse_fit {
	float agree, conflict, hidden,
		total; /* weights; total includes what looks out of the view */
};

/* Samples of b in a's view; the pose takes b's frame to a's. Adds to *ret. */
void coarse_check(const struct coarse_view *a, const struct coarse_sample *b, size_t count,
	const struct pose *pose, float tolerance_m, struct coarse_fit *ret);

struct coarse_refining {
	uint32_t steps;
	float gate_from_m, gate_to_m;
	/* How firmly b's uprightness is kept, as levelled; 0: free. */
	float tilt_sigma_rad;
};
/* false: too few pairs, or they leave the pose open; *pose is then as far as it came. */
bool coarse_refine(const struct coarse_view *a, const struct coarse_sample *b, size_t count,
	const struct coarse_refining *how, struct pose *pose);

#endif
