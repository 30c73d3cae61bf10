/* GCC 12 sees Eigen read a vector of three as one of four. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Warray-bounds"
#endif
#include "process/guard_pcl.hpp"
#include <ctime>
#include <glib.h>
/* GLib brings C++ headers of its own: it comes before what is C alone. */
#include <json-glib/json-glib.h>
extern "C" {
#include "process/bench-coarse.h"
}
#include "process/bench-cloud_pcl.hpp"
#include <pcl/features/fpfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/registration/sample_consensus_prerejective.h>

namespace
{

constexpr float VOXEL_M = 0.5f, FEATURE_M = 2.5f;
constexpr int NEIGHBOURS = 20, DRAWS = 50000;

using points = pcl::PointCloud<pcl::PointXYZ>;
using features = pcl::PointCloud<pcl::FPFHSignature33>;

double cpu_s()
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return double(t.tv_sec) + double(t.tv_nsec) * 1e-9;
}

features::Ptr described(const points::Ptr &from)
{
	pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
	features::Ptr to(new features);
	pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> n;
	n.setKSearch(NEIGHBOURS);
	n.setInputCloud(from);
	n.compute(*normals);
	pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> f;
	f.setRadiusSearch(FEATURE_M);
	f.setInputCloud(from);
	f.setInputNormals(normals);
	f.compute(*to);
	return to;
}

} // namespace

extern "C" bool bench_coarse_pcl(
	const range_grid *a, const range_grid *b, struct bench_coarse_run *ret, GError **error)
{
	return pcl_guard(error, "PCL", [&] {
		double began = cpu_s();
		points::Ptr pa = bench_cloud_thinned(a, VOXEL_M),
			    pb = bench_cloud_thinned(b, VOXEL_M);
		features::Ptr fa = described(pa), fb = described(pb);
		pcl::SampleConsensusPrerejective<pcl::PointXYZ, pcl::PointXYZ, pcl::FPFHSignature33>
			method;
		points moved;
		method.setInputSource(pb);
		method.setSourceFeatures(fb);
		method.setInputTarget(pa);
		method.setTargetFeatures(fa);
		method.setMaximumIterations(DRAWS);
		method.setNumberOfSamples(3);
		method.setCorrespondenceRandomness(5);
		method.setSimilarityThreshold(0.9f);
		method.setMaxCorrespondenceDistance(1.5f * VOXEL_M);
		method.setInlierFraction(0.25f);
		method.align(moved);
		ret->cpu_s = cpu_s() - began;
		Eigen::Matrix4f m = method.getFinalTransformation();
		for (int i = 0; i < 3; i++) {
			for (int k = 0; k < 3; k++)
				ret->pose.rotation[i][k] = m(i, k);
			ret->pose.translation_m[i] = m(i, 3);
		}
		return true;
	});
}
