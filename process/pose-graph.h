#ifndef PROCESS_POSE_GRAPH_H
#define PROCESS_POSE_GRAPH_H
/* Poses of many scans from relative ones, some of which may be wrong: least squares over SE(3), each link weighted by its
 * covariance, Gauss-Newton with damping on a sparse matrix (pose-graph-cholesky.h).
 *
 * Links that disagree with the loops that they close are found by graduated non-convexity with truncated least squares (Yang,
 * Antonante, Tzoumas and Carlone 2020), from poses along the tree of the links that most triangles speak for. They are left
 * out altogether. Where a loop disagrees and nothing tells which of its links is wrong, none of them is used: a pose that may
 * as well be wrong is worse than none. */
#include "process/pose.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct pose_node {
	bool fixed;       /* stays where it is; all fixed nodes are tied together */
	struct pose pose; /* of a fixed node given, of others the result */
	/* The results. */
	uint32_t
		component; /* 1..: nodes that used links tie together; the fixed ones first, if any */
	/* Relative to the lowest node of the component, which is held where the solution has it; about the node's own origin
	 * and in its own axes: rotation vector in rad, translation in m. */
	double covariance[6][6];
};

struct pose_link {
	uint32_t a, b;           /* nodes, a != b; two may have several links */
	struct pose pose;        /* takes b to a */
	double covariance[6][6]; /* of pose_perturb's twist, in a's frame, as fine_result's */
	bool trusted;            /* a person vouches for it: never an outlier */
	/* The results. */
	bool outlier;
	bool undecided; /* an outlier only because nothing tells it from the one that is wrong */
	double loop_rad,
		loop_m; /* how far it is from the poses; of an outlier that no other link ties, 0 */
};

struct pose_graph_options {
	/* Covariances tell of noise alone. What is added to each link's: 1 sigma, 0: 1 mm and 0.003 degrees. */
	double floor_m, floor_rad;
	/* What is added where it is asked whether a link disagrees, 0: 5 mm and 0.03 degrees; a link may be off by about 5 of
	 * these. */
	double gate_m, gate_rad;
};
/* options may be NULL. */
void pose_graph_solve(struct pose_node *node, size_t nodes, struct pose_link *link, size_t links,
	const struct pose_graph_options *options);

#endif
