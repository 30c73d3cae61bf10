/* GCC 12 sees Eigen's buffers freed where they are not. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuse-after-free"
#endif
#include <ctime>
#include <exception>
#include <gio/gio.h>
#include <pcl/features/normal_3d.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
/* GLib brings C++ headers of its own: it comes before what is C alone. */
#include <json-glib/json-glib.h>
extern "C" {
#include "process/bench-fine.h"
}
#include "process/bench-cloud_pcl.hpp"

namespace
{
using points = pcl::PointCloud<pcl::PointXYZ>;
using planes = pcl::PointCloud<pcl::PointNormal>;

constexpr float VOXEL_M = 0.25f;
constexpr int NEIGHBOURS = 20, STEPS_MAX = 100;
constexpr double REACH_M = 1.0;

double cpu_s()
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return double(t.tv_sec) + double(t.tv_nsec) * 1e-9;
}

planes::Ptr with_normals(const points::Ptr &from)
{
	planes::Ptr to(new planes);
	pcl::copyPointCloud(*from, *to);
	pcl::NormalEstimation<pcl::PointXYZ, pcl::PointNormal> normals;
	normals.setKSearch(NEIGHBOURS);
	normals.setInputCloud(from);
	normals.compute(*to);
	for (size_t i = 0; i < from->size(); i++)
		(*to)[i].getVector3fMap() = (*from)[i].getVector3fMap();
	return to;
}

Eigen::Matrix4d matrix_of(const struct pose *p)
{
	Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			m(i, k) = p->rotation[i][k];
		m(i, 3) = p->translation_m[i];
	}
	return m;
}

template <typename Method, typename Cloud>
void align(Method &method, const Cloud &a, const Cloud &b, const struct pose *start,
	struct bench_fine_run *ret)
{
	typename Cloud::element_type moved;
	double begin = cpu_s();
	method.setMaxCorrespondenceDistance(REACH_M);
	method.setMaximumIterations(STEPS_MAX);
	method.setTransformationEpsilon(1e-10);
	method.setInputTarget(a);
	method.setInputSource(b);
	method.align(moved, matrix_of(start));
	ret->align_s = cpu_s() - begin;
	ret->converged = method.hasConverged();
	Eigen::Matrix4d m = method.getFinalTransformation();
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			ret->pose.rotation[i][k] = m(i, k);
		ret->pose.translation_m[i] = m(i, 3);
	}
}

void run(enum bench_fine_method method, const range_grid *a, const range_grid *b,
	const struct pose *start, struct bench_fine_run *ret)
{
	double begin = cpu_s();
	points::Ptr pa = bench_cloud_thinned(a, VOXEL_M), pb = bench_cloud_thinned(b, VOXEL_M);
	if (method == BENCH_FINE_GICP) {
		ret->prepare_s = cpu_s() - begin;
		pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double> gicp;
		align(gicp, pa, pb, start, ret);
		return;
	}
	planes::Ptr na = with_normals(pa), nb = with_normals(pb);
	ret->prepare_s = cpu_s() - begin;
	pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal, double> icp;
	align(icp, na, nb, start, ret);
}
} // namespace

bool bench_fine_pcl(enum bench_fine_method method, const range_grid *a, const range_grid *b,
	const struct pose *start, struct bench_fine_run *ret, GError **error)
{
	try {
		*ret = {};
		run(method, a, b, start, ret);
		return true;
	} catch (const std::exception &e) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "PCL: %s", e.what());
	} catch (...) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "PCL failed");
	}
	return false;
}
