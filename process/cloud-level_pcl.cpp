#include "process/cloud-level_pcl.hpp"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <pcl/features/fpfh_omp.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>

/* Radii in voxels: of normals, of FPFH. */
static constexpr float NORMAL_VOXELS = 2.5f, FEATURE_VOXELS = 5;
static constexpr size_t RADIUS_SAMPLES = 20000;

using cloud_xyz = pcl::PointCloud<pcl::PointXYZ>;

static Eigen::Vector3d point_of(const struct cloud_view *v, size_t i)
{
	Eigen::Vector3d p;
	std::memcpy(p.data(), cloud_view_at(v, i), 3 * sizeof(double));
	return p;
}

cloud_frame cloud_frame_of(const struct cloud_view *v, bool at_origin)
{
	cloud_frame f = { v, Eigen::Vector3d::Zero(), 0, v->has_viewpoint || at_origin,
		Eigen::Vector3d::Zero() };
	for (size_t i = 0; i < v->count; i++)
		f.centre += (point_of(v, i) - f.centre) / double(i + 1);
	std::vector<double> distance;
	for (size_t i = 0; i < v->count; i += v->count / RADIUS_SAMPLES + 1)
		distance.push_back((point_of(v, i) - f.centre).norm());
	auto at = distance.begin() + distance.size() / 4 * 3;
	std::nth_element(distance.begin(), at, distance.end());
	f.radius_m = *at;
	if (v->has_viewpoint)
		f.viewpoint =
			Eigen::Vector3d(v->viewpoint_m[0], v->viewpoint_m[1], v->viewpoint_m[2]);
	f.viewpoint -= f.centre;
	return f;
}

/* ---- voxels ---- */

static uint64_t voxel_of(const Eigen::Vector3d &p, double side)
{
	uint64_t key = 0;
	for (int k = 0; k < 3; k++)
		key = key << 21 | (uint64_t(int64_t(std::floor(p[k] / side))) & 0x1fffff);
	return key;
}

static cloud_xyz::Ptr means_of(const cloud_frame &f, double side)
{
	std::vector<std::pair<uint64_t, uint32_t>> voxels(f.view->count);
	for (size_t i = 0; i < voxels.size(); i++)
		voxels[i] = { voxel_of(point_of(f.view, i) - f.centre, side), uint32_t(i) };
	std::sort(voxels.begin(), voxels.end());
	cloud_xyz::Ptr ret(new cloud_xyz);
	for (size_t begin = 0, end = 0; begin < voxels.size(); begin = end) {
		Eigen::Vector3d sum = Eigen::Vector3d::Zero();
		for (; end < voxels.size() && voxels[end].first == voxels[begin].first; end++)
			sum += point_of(f.view, voxels[end].second) - f.centre;
		sum /= double(end - begin);
		ret->push_back(pcl::PointXYZ(float(sum[0]), float(sum[1]), float(sum[2])));
	}
	return ret;
}

/* ---- normals and features ---- */

static void turn(const cloud_frame &f, const pcl::PointXYZ &p, pcl::Normal &n)
{
	Eigen::Vector3f to =
		f.has_viewpoint ? Eigen::Vector3f(f.viewpoint.cast<float>() - p.getVector3fMap())
				: Eigen::Vector3f::UnitZ();
	if (n.getNormalVector3fMap().dot(to) < 0)
		n.getNormalVector3fMap() *= -1;
}

static void add_normals(const cloud_frame &f, cloud_level &l)
{
	pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation;
	pcl::PointCloud<pcl::Normal> normals;
	estimation.setInputCloud(l.points);
	estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
	estimation.setRadiusSearch(NORMAL_VOXELS * l.voxel_m);
	estimation.compute(normals);
	cloud_xyz::Ptr kept(new cloud_xyz);
	l.normals.reset(new pcl::PointCloud<pcl::Normal>);
	for (size_t i = 0; i < normals.size(); i++) {
		if (!normals[i].getNormalVector3fMap().allFinite())
			continue;
		turn(f, (*l.points)[i], normals[i]);
		kept->push_back((*l.points)[i]);
		l.normals->push_back(normals[i]);
	}
	l.points = kept;
}

static void add_features(cloud_level &l)
{
	pcl::FPFHEstimationOMP<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
	l.features.reset(new pcl::PointCloud<pcl::FPFHSignature33>);
	estimation.setInputCloud(l.points);
	estimation.setInputNormals(l.normals);
	estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
	estimation.setRadiusSearch(FEATURE_VOXELS * l.voxel_m);
	estimation.compute(*l.features);
}

cloud_level cloud_level_of(const cloud_frame &f, float voxel_m, size_t most, bool features)
{
	cloud_level l;
	l.voxel_m = voxel_m;
	l.points = means_of(f, voxel_m);
	while (l.points->size() > most) {
		l.voxel_m *= std::max(1.1f, std::sqrt(float(l.points->size()) / float(most)));
		l.points = means_of(f, l.voxel_m);
	}
	add_normals(f, l);
	if (l.points->empty())
		return l;
	if (features)
		add_features(l);
	l.tree = std::make_shared<pcl::KdTreeFLANN<pcl::PointXYZ>>();
	l.tree->setInputCloud(l.points);
	return l;
}
