#ifndef PROCESS_CLOUD_VERDICT_H
#define PROCESS_CLOUD_VERDICT_H
/* Whether a pose between two clouds is true: by how their surfaces agree, and by free space where it is known. */
#include "process/cloud-align.h"

/* A point of b and the point of a that is nearest to it, both in a's frame. */
struct cloud_partner {
	double a_m[3], b_m[3], a_normal[3], b_normal[3];
};

struct cloud_evidence {
	const struct cloud_partner *partners; /* all of b's, thinned to voxels */
	size_t count, points_of_a;
	double voxel_m, rival_score;
	const range_grid *grid_a, *grid_b; /* NULL: not known from where they were seen */
};

/* ret->pose is what is judged; sets fine, verification and free_space. */
void cloud_verdict(const struct cloud_evidence *e, struct cloud_align_result *ret);
/* There is nothing to judge. */
void cloud_verdict_none(struct cloud_align_result *ret, const char *why);

#endif
