#ifndef PROCESS_CLOUD_LEVEL_PCL_HPP
#define PROCESS_CLOUD_LEVEL_PCL_HPP
/* A cloud thinned to voxels of one size, with normals and, where they are asked for, FPFH. Inside the bridge only. */
#include "process/guard_pcl.hpp"
extern "C" {
#include "process/cloud.h"
}
#include <memory>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <vector>

struct cloud_level {
	float voxel_m;
	pcl::PointCloud<pcl::PointXYZ>::Ptr points; /* means of the voxels, from the centre */
	pcl::PointCloud<pcl::Normal>::Ptr normals;
	pcl::PointCloud<pcl::FPFHSignature33>::Ptr features; /* null: not computed */
	std::shared_ptr<pcl::KdTreeFLANN<pcl::PointXYZ>> tree;
};

/* What is known of a whole cloud. */
struct cloud_frame {
	const struct cloud_view *view;
	Eigen::Vector3d centre;
	double radius_m; /* three quarters of the points are nearer to the centre */
	bool has_viewpoint;
	Eigen::Vector3d viewpoint; /* from the centre */
};

cloud_frame cloud_frame_of(const struct cloud_view *v, bool at_origin);
/* Voxels grow until there are no more than `most`. Points without a normal are left out. */
cloud_level cloud_level_of(const cloud_frame &f, float voxel_m, size_t most, bool features);

#endif
