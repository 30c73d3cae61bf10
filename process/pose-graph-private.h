#ifndef PROCESS_POSE_GRAPH_PRIVATE_H
#define PROCESS_POSE_GRAPH_PRIVATE_H
/* What pose-graph.c (the least squares) and pose-graph-robust.c (which links count) have in common. */
#include "process/pose-graph-cholesky.h"
#include "process/pose-graph.h"

typedef double matrix6[6][6];

/* How far the poses are from the link: the twist from the link's pose to the one between a and b, and what it changes by per
 * small motion of a and b, each to its own right (pose * exp). Either may be NULL. */
void pose_link_residual(const struct pose_link *l, const struct pose *a, const struct pose *b,
	double ret[6], double ret_by_a[6][6], double ret_by_b[6][6]);

/* Inverse of the covariance plus floors on its diagonal. A covariance that is none is taken for its diagonal. */
void pose_link_information(
	const struct pose_link *l, double floor_m, double floor_rad, double ret[6][6]);
double pose_link_error(const struct pose_link *l, const matrix6 information, const struct pose *a,
	const struct pose *b); /* squared, in sigmas */

/* Minimises over the nodes that are not held: the sum of weight * error^2. Links of weight 0 are not there; all nodes that
 * are not held must hang together with one that is, by links of a weight. */
void pose_graph_minimise(struct pose_node *node, size_t nodes, const struct pose_link *link,
	size_t links, const matrix6 *information, const double *weight, const bool *held,
	int steps_max);

/* Components by the links with a weight above 0, 0-based; ret_first: the lowest node of each. Returns how many. Fixed nodes
 * are one. */
uint32_t pose_graph_components(const struct pose_node *node, size_t nodes,
	const struct pose_link *link, size_t links, const double *weight, uint32_t *ret_component,
	uint32_t *ret_first);

/* Fixed nodes, and the first of each component that has none. */
void pose_graph_hold(const struct pose_node *node, size_t nodes, const uint32_t *component,
	const uint32_t *first, bool *ret_held);

/* Sets weight to 1 or 0, outlier and undecided; leaves poses that are nearly right. gate: the information by which links
 * are judged. */
void pose_graph_reject(struct pose_node *node, size_t nodes, struct pose_link *link, size_t links,
	const matrix6 *gate, double *ret_weight);

/* pose-graph-tree.c: poses along a tree of the links that most triangles speak for, then those that are held best. A triangle
 * speaks for its links when it closes to within limit, in squared sigmas. */
void pose_graph_spread(struct pose_node *node, size_t nodes, const struct pose_link *link,
	size_t links, const matrix6 *gate, double limit);
/* Marks the links without which their two ends hang together no more. Links of weight 0 are not there. */
void pose_graph_bridges(const struct pose_node *node, size_t nodes, const struct pose_link *link,
	size_t links, const double *weight, bool *ret_bridge);

#endif
