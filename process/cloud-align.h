#ifndef PROCESS_CLOUD_ALIGN_H
#define PROCESS_CLOUD_ALIGN_H
/* Two clouds without a grid into one frame, with no idea where they stand to each other: six degrees of freedom.
 *
 * Coarse: FPFH (Rusu, Blodow and Beetz 2009) of both clouds, thinned to voxels, and triples of points whose features and
 * distances agree, drawn at random (Fischler and Bolles 1981; lengths first, as Buch and others 2013 have it). The best
 * distinct poses are refined by GICP (Segal, Haehnel and Thrun 2009) from coarse voxels to fine ones. FPFH, GICP and the trees are
 * PCL's. What was drawn at random repeats with the seed.
 *
 * Verified like scans with a grid where both clouds are sweeps from a place that is known (cloud_range_grid): nothing may
 * stand where the other saw through. Of other clouds nobody knows what they saw through. There agreement alone must do, so
 * its limits are strict, and the reason says so. */
#include "process/cloud.h"
#include "process/verify.h"

struct cloud_align_options {
	uint32_t seed;
	const struct pose *start; /* one more pose to try; NULL: none */
	double voxel_m;           /* 0: by how large the smaller cloud is; of the coarse clouds */
};

struct cloud_align_result {
	struct pose pose; /* takes b's frame to a's; the best there is, also when refused */
	struct fine_result fine;
	struct verification verification; /* the shares of solid angle are 0 without free space */
	bool free_space;                  /* could be looked at */
	double voxel_m, fine_voxel_m;     /* that were used */
	uint32_t candidates;              /* that were refined */
	double coarse_s, fine_s;          /* CPU time; fine with the verification */
};

/* Always gives a verdict; not accepting is an answer. false and an error: points that are not finite, or fewer than 100 in a
 * cloud, or no memory. */
bool cloud_align(const struct cloud_view *a, const struct cloud_view *b,
	const struct cloud_align_options *options, struct cloud_align_result *ret, GError **error);

/* Only the refinement from a start that is nearly right, and the check; rivals are not looked for. */
bool cloud_align_near(const struct cloud_view *a, const struct cloud_view *b,
	const struct pose *start, struct cloud_align_result *ret, GError **error);

#endif
