#include "process/guard_pcl.hpp"
#include <glib.h>
#include <math.h>
extern "C" {
#include "process/bench-process.h"
}
#include <limits>
#include <pcl/features/integral_image_normal.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/point_types.h>

namespace
{

using cloud = pcl::PointCloud<pcl::PointXYZ>;
using normals = pcl::PointCloud<pcl::Normal>;

cloud::Ptr cloud_of(const range_grid *g)
{
	const float none = std::numeric_limits<float>::quiet_NaN();
	cloud::Ptr c(new cloud(g->columns, g->rows, pcl::PointXYZ(none, none, none)));
	c->is_dense = false;
	for (size_t i = 0; i < c->size(); i++)
		if (g->range_m[i] > 0)
			(*c)[i] = pcl::PointXYZ(g->x_m[i], g->y_m[i], g->z_m[i]);
	return c;
}

double compute(pcl::Feature<pcl::PointXYZ, pcl::Normal> &method, normals &ret)
{
	double start_s = bench_cpu_s();
	method.compute(ret);
	return bench_cpu_s() - start_s;
}

double by_grid(const cloud::Ptr &c, enum bench_pcl method, normals &ret)
{
	using estimation = pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal>;
	estimation e;
	e.setNormalEstimationMethod(method == BENCH_PCL_COVARIANCE ? estimation::COVARIANCE_MATRIX
				    : method == BENCH_PCL_GRADIENT
					    ? estimation::AVERAGE_3D_GRADIENT
					    : estimation::AVERAGE_DEPTH_CHANGE);
	e.setMaxDepthChangeFactor(0.02f);
	e.setNormalSmoothingSize(7);
	e.setInputCloud(c);
	return compute(e, ret);
}

/* Only points that are there: the tree has no use for the others. */
double by_neighbours(const cloud::Ptr &c, normals &ret)
{
	pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> e(1);
	pcl::IndicesPtr there(new pcl::Indices);
	for (size_t i = 0; i < c->size(); i++)
		if (pcl::isFinite((*c)[i]))
			there->push_back(static_cast<int>(i));
	cloud::Ptr dense(new cloud(*c, *there));
	pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
	normals found;
	e.setInputCloud(dense);
	e.setSearchMethod(tree);
	e.setKSearch(20);
	double cpu_s = compute(e, found);
	const float none = std::numeric_limits<float>::quiet_NaN();
	ret.assign(c->size(), pcl::Normal(none, none, none));
	for (size_t i = 0; i < there->size(); i++)
		ret[(*there)[i]] = found[i];
	return cpu_s;
}

} // namespace

extern "C" bool bench_pcl_normals(const range_grid *g, enum bench_pcl method,
	float *const ret_normal[3], double *ret_cpu_s, GError **error)
{
	return pcl_guard(error, "normals by PCL", [&] {
		cloud::Ptr c = cloud_of(g);
		normals found;
		*ret_cpu_s = method == BENCH_PCL_NEIGHBOURS ? by_neighbours(c, found)
							    : by_grid(c, method, found);
		for (size_t i = 0; i < found.size(); i++) {
			bool good = pcl::isFinite(found[i]);
			for (int k = 0; k < 3; k++)
				ret_normal[k][i] = good ? found[i].normal[k] : 0;
		}
		return true;
	});
}
