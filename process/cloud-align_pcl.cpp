/* GCC 12 sees Eigen's buffers freed where they are not. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuse-after-free"
#endif
#include "process/cloud-match_pcl.hpp"
extern "C" {
#include "process/cloud-align.h"
#include "process/cloud-verdict.h"
}
#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <pcl/registration/gicp.h>

namespace
{
/* Of the coarse voxels: this share of the radius that holds three quarters of the smaller cloud. */
constexpr double VOXEL_SHARE = 1.0 / 16;
constexpr float SCALES[] = { 1, 0.6f, 1.6f }; /* until one is accepted */
constexpr size_t COARSE_POINTS = 8000, FINE_POINTS = 30000, POINTS_MIN = 100, REFINED = 6;
constexpr int FINER = 2; /* the fine voxels are smaller by this */

struct pair {
	cloud_frame a, b;
	double radius_m;
	range_grid *grid_a = nullptr, *grid_b = nullptr;

	~pair()
	{
		range_grid_free(grid_a);
		range_grid_free(grid_b);
	}
};

double cpu_s()
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return double(t.tv_sec) + double(t.tv_nsec) * 1e-9;
}

/* ---- poses ---- */

struct pose to_pose(const pair &p, const Eigen::Isometry3d &between_centres)
{
	Eigen::Isometry3d m = Eigen::Translation3d(p.a.centre) * between_centres *
			      Eigen::Translation3d(-p.b.centre);
	struct pose ret;
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			ret.rotation[i][k] = m.linear()(i, k);
		ret.translation_m[i] = m.translation()[i];
	}
	return ret;
}

Eigen::Isometry3d from_pose(const pair &p, const struct pose *pose)
{
	Eigen::Isometry3d m = Eigen::Isometry3d::Identity();
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			m.linear()(i, k) = pose->rotation[i][k];
		m.translation()[i] = pose->translation_m[i];
	}
	return Eigen::Translation3d(-p.a.centre) * m * Eigen::Translation3d(p.b.centre);
}

/* ---- refining ---- */

using gicp = pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double>;

Eigen::Isometry3d refine(const cloud_level &a, const cloud_level &b, const Eigen::Isometry3d &start,
	double gate_m, int iterations, uint32_t *ret_iterations, bool *ret_converged)
{
	gicp g;
	pcl::PointCloud<pcl::PointXYZ> unused;
	g.setInputTarget(a.points);
	g.setInputSource(b.points);
	g.setMaxCorrespondenceDistance(gate_m);
	g.setMaximumIterations(iterations);
	g.setTransformationEpsilon(1e-5);
	g.setRotationEpsilon(1e-6);
	g.setTranslationGradientTolerance(1e-4);
	g.setRotationGradientTolerance(1e-4);
	g.align(unused, start.matrix());
	Eigen::Isometry3d ret;
	ret.matrix() = g.getFinalTransformation();
	*ret_converged = g.hasConverged();
	*ret_iterations += uint32_t(iterations);
	if (!ret.matrix().allFinite())
		return start;
	Eigen::Quaterniond turn(ret.linear());
	ret.linear() = turn.normalized().toRotationMatrix();
	return ret;
}

/* All of them on coarse voxels; best first. Those that came to the same place are one. */
void refine_all(const cloud_level &a, const cloud_level &b, std::vector<cloud_candidate> &all)
{
	uint32_t iterations = 0;
	bool converged;
	std::vector<cloud_candidate> ret;
	for (cloud_candidate &c : all) {
		c.pose = refine(a, b, c.pose, 2 * a.voxel_m, 20, &iterations, &converged);
		c.score = cloud_score(a, b, c.pose, a.voxel_m);
	}
	std::stable_sort(all.begin(), all.end(),
		[](const auto &x, const auto &y) { return x.score > y.score; });
	for (const cloud_candidate &c : all)
		if (std::none_of(ret.begin(), ret.end(), [&](const auto &there) {
			    return !cloud_poses_differ(there.pose, c.pose, 2 * a.voxel_m);
		    }))
			ret.push_back(c);
	all = ret;
}

/* ---- the check ---- */

void put(double into[3], const Eigen::Vector3d &v)
{
	std::memcpy(into, v.data(), 3 * sizeof(double));
}

/* Each point of b with its partner in a. */
void judge(const pair &p, const cloud_level &a, const cloud_level &b, const Eigen::Isometry3d &pose,
	double rival_score, struct cloud_align_result *ret)
{
	std::vector<struct cloud_partner> partners(b.points->size());
	pcl::Indices index(1);
	std::vector<float> distance2(1);
	for (size_t i = 0; i < partners.size(); i++) {
		struct cloud_partner &t = partners[i];
		Eigen::Vector3d q = pose * (*b.points)[i].getVector3fMap().cast<double>();
		pcl::PointXYZ there;
		there.getVector3fMap() = q.cast<float>();
		a.tree->nearestKSearch(there, 1, index, distance2);
		put(t.b_m, q + p.a.centre);
		put(t.a_m, (*a.points)[index[0]].getVector3fMap().cast<double>() + p.a.centre);
		put(t.b_normal,
			pose.linear() * (*b.normals)[i].getNormalVector3fMap().cast<double>());
		put(t.a_normal, (*a.normals)[index[0]].getNormalVector3fMap().cast<double>());
	}
	ret->pose = ret->fine.pose = to_pose(p, pose);
	struct cloud_evidence e = { partners.data(), partners.size(), a.points->size(),
		(double)std::max(a.voxel_m, b.voxel_m), rival_score, p.grid_a, p.grid_b };
	cloud_verdict(&e, ret);
}

/* Two clouds on voxels of one size. */
struct levels {
	cloud_level a, b;
};

levels levels_of(const pair &p, double voxel_m, size_t most, bool features)
{
	levels l = { cloud_level_of(p.a, float(voxel_m), most, features),
		cloud_level_of(p.b, float(voxel_m), most, features) };
	float coarser = std::max(l.a.voxel_m, l.b.voxel_m);
	if (l.a.voxel_m < coarser)
		l.a = cloud_level_of(p.a, coarser, most, features);
	if (l.b.voxel_m < coarser)
		l.b = cloud_level_of(p.b, coarser, most, features);
	return l;
}

void finish(const pair &p, const Eigen::Isometry3d &start, double voxel_m, double rival_score,
	struct cloud_align_result *ret)
{
	levels l = levels_of(p, voxel_m / FINER, FINE_POINTS, false);
	if (l.a.points->size() < POINTS_MIN || l.b.points->size() < POINTS_MIN)
		return cloud_verdict_none(ret, "too few of their points lie on surfaces");
	uint32_t iterations = 0;
	Eigen::Isometry3d pose =
		refine(l.a, l.b, start, 3 * l.a.voxel_m, 60, &iterations, &ret->fine.converged);
	ret->fine.iterations = iterations;
	ret->voxel_m = voxel_m;
	ret->fine_voxel_m = l.a.voxel_m;
	judge(p, l.a, l.b, pose, rival_score, ret);
}

/* ---- from nothing ---- */

void align_at(const pair &p, double voxel_m, const struct cloud_align_options *o, uint32_t seed,
	struct cloud_align_result *ret)
{
	double begin = cpu_s();
	levels l = levels_of(p, voxel_m, COARSE_POINTS, true);
	std::vector<cloud_candidate> all;
	if (l.a.points->size() >= POINTS_MIN && l.b.points->size() >= POINTS_MIN)
		all = cloud_match(l.a, l.b, seed, REFINED);
	if (o->start && l.a.tree && l.b.tree)
		all.push_back({ from_pose(p, o->start), 0 });
	ret->candidates += uint32_t(all.size());
	double middle = cpu_s();
	ret->coarse_s += middle - begin;
	if (all.empty())
		return cloud_verdict_none(ret, "no places look alike in both");
	refine_all(l.a, l.b, all);
	double rival = all.size() > 1 && all[0].score > 0 ? all[1].score / all[0].score : 0;
	finish(p, all[0].pose, l.a.voxel_m, rival, ret);
	ret->fine_s += cpu_s() - middle;
}

bool is_better(const struct cloud_align_result &x, const struct cloud_align_result &y)
{
	bool accepted = x.verification.verdict == VERDICT_ACCEPTED;
	if (accepted != (y.verification.verdict == VERDICT_ACCEPTED))
		return accepted;
	return x.verification.overlap > y.verification.overlap;
}

bool align(const pair &p, const struct cloud_align_options *o, struct cloud_align_result *ret)
{
	double voxel_m = o->voxel_m > 0 ? o->voxel_m : p.radius_m * VOXEL_SHARE, coarse_s = 0,
	       fine_s = 0;
	uint32_t seed = o->seed, candidates = 0;
	for (float scale : SCALES) {
		struct cloud_align_result r = *ret;
		r.coarse_s = r.fine_s = r.candidates = 0;
		align_at(p, voxel_m * scale, o, seed++, &r);
		coarse_s += r.coarse_s;
		fine_s += r.fine_s;
		candidates += r.candidates;
		if (scale == SCALES[0] || is_better(r, *ret))
			*ret = r;
		if (ret->verification.verdict == VERDICT_ACCEPTED)
			break;
	}
	ret->coarse_s = coarse_s;
	ret->fine_s = fine_s;
	ret->candidates = candidates;
	return true;
}

/* ---- what is given ---- */

bool check(const struct cloud_view *v, const char *name, GError **error)
{
	if (v->count < POINTS_MIN || v->count > G_MAXUINT32 / 2) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"cloud %s has %zu points: no number that can be aligned", name, v->count);
		return false;
	}
	for (size_t i = 0; i < v->count; i++) {
		Eigen::Vector3d p;
		std::memcpy(p.data(), cloud_view_at(v, i), 3 * sizeof(double));
		if (p.allFinite())
			continue;
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"point %zu of cloud %s is not finite", i + 1, name);
		return false;
	}
	return true;
}

template <typename Work>
bool with_pair(const struct cloud_view *a, const struct cloud_view *b,
	struct cloud_align_result *ret, GError **error, Work work)
{
	*ret = (struct cloud_align_result){};
	ret->pose = ret->fine.pose = POSE_IDENTITY;
	if (!check(a, "A", error) || !check(b, "B", error))
		return false;
	return pcl_guard(error, "alignment", [&] {
		pair p;
		p.grid_a = cloud_range_grid(a, NULL);
		p.grid_b = cloud_range_grid(b, NULL);
		p.a = cloud_frame_of(a, p.grid_a);
		p.b = cloud_frame_of(b, p.grid_b);
		p.radius_m = std::min(p.a.radius_m, p.b.radius_m);
		if (!(p.radius_m > 1e-3)) {
			cloud_verdict_none(ret, "one of them is a single place");
			return true;
		}
		return work(p);
	});
}
} // namespace

bool cloud_align(const struct cloud_view *a, const struct cloud_view *b,
	const struct cloud_align_options *options, struct cloud_align_result *ret, GError **error)
{
	static const struct cloud_align_options usual = {};
	return with_pair(a, b, ret, error,
		[&](const pair &p) { return align(p, options ? options : &usual, ret); });
}

bool cloud_align_near(const struct cloud_view *a, const struct cloud_view *b,
	const struct pose *start, struct cloud_align_result *ret, GError **error)
{
	return with_pair(a, b, ret, error, [&](const pair &p) {
		double begin = cpu_s();
		finish(p, from_pose(p, start), p.radius_m * VOXEL_SHARE, 0, ret);
		ret->fine_s = cpu_s() - begin;
		return true;
	});
}
