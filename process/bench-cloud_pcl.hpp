#ifndef PROCESS_BENCH_CLOUD_PCL_HPP
#define PROCESS_BENCH_CLOUD_PCL_HPP
/* A scan as PCL takes it: what the benches that measure PCL have in common. */
extern "C" {
#include "process/range-grid.h"
}
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>

/* The points of a grid, in its own frame: one of every voxel, their mean. */
inline pcl::PointCloud<pcl::PointXYZ>::Ptr bench_cloud_thinned(const range_grid *g, float voxel_m)
{
	using points = pcl::PointCloud<pcl::PointXYZ>;
	points::Ptr all(new points), thin(new points);
	for (size_t i = 0; i < range_grid_cells(g); i++)
		if (g->range_m[i] > 0)
			all->emplace_back(g->x_m[i], g->y_m[i], g->z_m[i]);
	pcl::VoxelGrid<pcl::PointXYZ> voxels;
	voxels.setLeafSize(voxel_m, voxel_m, voxel_m);
	voxels.setInputCloud(all);
	voxels.filter(*thin);
	return thin;
}

#endif
