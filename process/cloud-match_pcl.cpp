#include "process/cloud-match_pcl.hpp"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

namespace
{
constexpr int DRAWS = 400000;
constexpr float LENGTHS_ALIKE = 0.9f; /* shorter over longer */
constexpr float EDGE_VOXELS = 5;      /* at least, between the points of a triple */
constexpr float GATE_VOXELS = 1.5f;
constexpr float NORMALS_ALIKE = 0.7f; /* cosine */
constexpr double DIFFERENT_RAD = 5 * M_PI / 180;
constexpr size_t SCORE_POINTS = 2500, POOL = 60;

struct match {
	int a, b;
};

using feature_tree = pcl::KdTreeFLANN<pcl::FPFHSignature33>;

/* Nearest in feature space, both ways. */
void add_matches(
	const cloud_level &from, const cloud_level &to, bool swapped, std::vector<match> &ret)
{
	feature_tree tree;
	tree.setInputCloud(to.features);
	std::vector<int> nearest(from.features->size(), -1);
#pragma omp parallel for schedule(dynamic, 64)
	for (size_t i = 0; i < nearest.size(); i++) {
		pcl::Indices index(1);
		std::vector<float> distance(1);
		const auto &f = (*from.features)[i];
		if (std::isfinite(f.histogram[0]) &&
			tree.nearestKSearch(f, 1, index, distance) == 1)
			nearest[i] = index[0];
	}
	for (size_t i = 0; i < nearest.size(); i++)
		if (nearest[i] >= 0)
			ret.push_back(swapped ? match{ nearest[i], int(i) }
					      : match{ int(i), nearest[i] });
}

/* Those that both clouds agree on; all where that leaves few. */
std::vector<match> matches_of(const cloud_level &a, const cloud_level &b)
{
	std::vector<match> forth, back, both, all;
	auto before = [](const match &x, const match &y) {
		return x.a < y.a || (x.a == y.a && x.b < y.b);
	};
	add_matches(a, b, false, forth);
	add_matches(b, a, true, back);
	std::sort(forth.begin(), forth.end(), before);
	std::sort(back.begin(), back.end(), before);
	std::set_intersection(forth.begin(), forth.end(), back.begin(), back.end(),
		std::back_inserter(both), before);
	if (both.size() >= 150)
		return both;
	std::set_union(forth.begin(), forth.end(), back.begin(), back.end(),
		std::back_inserter(all), before);
	return all;
}

Eigen::Vector3f at(const cloud_level &l, int i)
{
	return (*l.points)[i].getVector3fMap();
}

Eigen::Vector3f normal(const cloud_level &l, int i)
{
	return (*l.normals)[i].getNormalVector3fMap();
}

struct search {
	const cloud_level &a, &b;
	std::vector<match> matches;
	std::mt19937 random;

	bool draw(match triple[3])
	{
		for (int i = 0; i < 3; i++)
			triple[i] = matches[random() % matches.size()];
		for (int i = 0; i < 3; i++) {
			const match &m = triple[i], &n = triple[(i + 1) % 3];
			float d = (at(a, m.a) - at(a, n.a)).norm(),
			      e = (at(b, m.b) - at(b, n.b)).norm();
			if (std::min(d, e) < LENGTHS_ALIKE * std::max(d, e) ||
				d < EDGE_VOXELS * a.voxel_m)
				return false;
		}
		return true;
	}

	/* The frame of a triple: its first side, its plane. */
	static Eigen::Matrix3f frame_of(const Eigen::Matrix3f &p)
	{
		Eigen::Vector3f x = (p.col(1) - p.col(0)).normalized(),
				z = x.cross(p.col(2) - p.col(0)).normalized();
		Eigen::Matrix3f f;
		f << x, z.cross(x), z;
		return f;
	}

	bool fit(const match triple[3], Eigen::Isometry3f &ret) const
	{
		Eigen::Matrix3f p, q;
		for (int i = 0; i < 3; i++) {
			p.col(i) = at(b, triple[i].b);
			q.col(i) = at(a, triple[i].a);
		}
		ret.setIdentity();
		ret.linear() = frame_of(q) * frame_of(p).transpose();
		Eigen::Vector3f from = p.rowwise().mean(), to = q.rowwise().mean();
		ret.translation() = to - ret.linear() * from;
		for (int i = 0; i < 3; i++)
			if (!((ret.linear() * normal(b, triple[i].b)).dot(normal(a, triple[i].a)) >=
				    NORMALS_ALIKE))
				return false;
		return true;
	}

	int count(const Eigen::Isometry3f &pose) const
	{
		float gate2 = GATE_VOXELS * a.voxel_m * GATE_VOXELS * a.voxel_m;
		int inliers = 0;
		for (const match &m : matches)
			inliers += (pose * at(b, m.b) - at(a, m.a)).squaredNorm() < gate2;
		return inliers;
	}
};

/* Keeps the best that differ. */
void enter(std::vector<cloud_candidate> &pool, const cloud_candidate &c, size_t most,
	double distance_m)
{
	for (cloud_candidate &there : pool)
		if (!cloud_poses_differ(there.pose, c.pose, distance_m)) {
			if (c.score > there.score)
				there = c;
			std::stable_sort(pool.begin(), pool.end(),
				[](const auto &x, const auto &y) { return x.score > y.score; });
			return;
		}
	auto place = std::find_if(
		pool.begin(), pool.end(), [&](const auto &there) { return there.score < c.score; });
	pool.insert(place, c);
	if (pool.size() > most)
		pool.pop_back();
}

/* Axes of a's normals: which of three a direction is nearest to. */
Eigen::Matrix3f axes_of(const cloud_level &l)
{
	Eigen::Matrix3f scatter = Eigen::Matrix3f::Zero();
	for (const auto &n : *l.normals)
		scatter += n.getNormalVector3fMap() * n.getNormalVector3fMap().transpose();
	return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(scatter).eigenvectors();
}
} // namespace

bool cloud_poses_differ(const Eigen::Isometry3d &p, const Eigen::Isometry3d &q, double distance_m)
{
	Eigen::Isometry3d d = p.inverse() * q;
	return Eigen::AngleAxisd(d.linear()).angle() > DIFFERENT_RAD ||
	       (p.translation() - q.translation()).norm() > distance_m;
}

double cloud_score(
	const cloud_level &a, const cloud_level &b, const Eigen::Isometry3d &pose, float gate_m)
{
	Eigen::Isometry3f move = pose.cast<float>();
	Eigen::Matrix3f axes = axes_of(a);
	double agree[3] = { 0 }, all[3] = { 0 };
	pcl::Indices index(1);
	std::vector<float> distance2(1);
	for (size_t i = 0; i < b.points->size(); i += b.points->size() / SCORE_POINTS + 1) {
		Eigen::Vector3f n = move.linear() * normal(b, int(i));
		Eigen::Index axis;
		(axes.transpose() * n).cwiseAbs().maxCoeff(&axis);
		pcl::PointXYZ p;
		p.getVector3fMap() = move * at(b, int(i));
		all[axis]++;
		if (a.tree->nearestKSearch(p, 1, index, distance2) == 1 &&
			distance2[0] < gate_m * gate_m &&
			std::fabs(n.dot(normal(a, index[0]))) > NORMALS_ALIKE)
			agree[axis]++;
	}
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += all[k] > 0 ? agree[k] / all[k] : 0;
	return sum / 3;
}

std::vector<cloud_candidate> cloud_match(
	const cloud_level &a, const cloud_level &b, uint32_t seed, size_t most)
{
	search s = { a, b, matches_of(a, b), std::mt19937(seed) };
	std::vector<cloud_candidate> pool, ret;
	double distance_m = 3 * a.voxel_m;
	for (int i = 0; s.matches.size() >= 3 && i < DRAWS; i++) {
		match triple[3];
		cloud_candidate c;
		Eigen::Isometry3f pose;
		if (!s.draw(triple) || !s.fit(triple, pose))
			continue;
		c.score = s.count(pose);
		if (pool.size() == POOL && c.score <= pool.back().score)
			continue;
		c.pose = pose.cast<double>();
		enter(pool, c, POOL, distance_m);
	}
	for (cloud_candidate &c : pool) {
		c.score = cloud_score(a, b, c.pose, GATE_VOXELS * a.voxel_m);
		enter(ret, c, most, distance_m);
	}
	return ret;
}
