#ifndef PROCESS_CLOUD_MATCH_PCL_HPP
#define PROCESS_CLOUD_MATCH_PCL_HPP
/* Poses between two clouds from what their points look like, and how well a pose fits. Inside the bridge only. */
#include "process/cloud-level_pcl.hpp"
#include <Eigen/Geometry>

struct cloud_candidate {
	Eigen::Isometry3d pose; /* takes points of b, from its centre, to a, from its centre */
	double score;		/* 0..1, of cloud_score */
};

/* Shares of b's points that have a partner in a, nearer than gate and with a normal like theirs: apart for the points of each of
 * three directions of normals, those of a, then the mean; so much ground does not outweigh the little that holds the rest. */
double cloud_score(const cloud_level &a, const cloud_level &b, const Eigen::Isometry3d &pose, float gate_m);

bool cloud_poses_differ(const Eigen::Isometry3d &p, const Eigen::Isometry3d &q, double distance_m);

/* Distinct, best first. */
std::vector<cloud_candidate> cloud_match(
	const cloud_level &a, const cloud_level &b, uint32_t seed, size_t most);

#endif
