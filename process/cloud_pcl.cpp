#include "process/guard_pcl.hpp"
extern "C" {
#include "process/cloud.h"
}
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <pcl/common/centroid.h>
#include <pcl/common/eigen.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <unordered_map>
#include <vector>

namespace
{
constexpr float RADIUS_M = 0.06f;
constexpr uint32_t BLOCK_POINTS = 400000;
constexpr int NEIGHBOURS = 16, SIZE_NEIGHBOURS = 8;
/* On the points of a square grid the third neighbour has 0.71 of the distance of the eighth, on most others less. */
constexpr float ALONE = 0.8f;
/* A neighbourhood narrower than this, in variance, is a line: it is widened. */
constexpr float LINE = 0.03f;
constexpr int WIDENINGS = 2;
/* Normals less upright than this look sideways, and are told apart by heights. */
constexpr float UPRIGHT = 0.3f;
/* At a crease the neighbours are of two faces: they are so far off one plane, in sizes of a point. Among so many, one with so much less of an error, whose plane holds the point within so many
 * of its own errors, tells which way the face looks that the point is on. */
constexpr int MEND_NEIGHBOURS = 40;
constexpr float MEND_SIZES = 0.15f, MEND_BETTER = 0.45f, MEND_HOLDS = 2.0f;

using cloud_xyz = pcl::PointCloud<pcl::PointXYZ>;
using tree_xyz = pcl::KdTreeFLANN<pcl::PointXYZ>;

struct box {
	double min[3], max[3];
};

void get(const struct cloud_view *v, size_t i, double ret[3])
{
	std::memcpy(ret, cloud_view_at(v, i), 3 * sizeof(double));
}

/* ---- blocks ---- */

struct block {
	size_t begin, end; /* in the order */
	box bounds;
};

box bounds_of(
	const struct cloud_view *v, const std::vector<uint32_t> &order, size_t begin, size_t end)
{
	box b;
	std::fill_n(b.min, 3, INFINITY);
	std::fill_n(b.max, 3, -INFINITY);
	for (size_t i = begin; i < end; i++) {
		double p[3];
		get(v, order[i], p);
		for (int k = 0; k < 3; k++) {
			b.min[k] = std::min(b.min[k], p[k]);
			b.max[k] = std::max(b.max[k], p[k]);
		}
	}
	return b;
}

int longest_side(const box &b)
{
	int axis = 0;
	for (int k = 1; k < 3; k++)
		if (b.max[k] - b.min[k] > b.max[axis] - b.min[axis])
			axis = k;
	return axis;
}

/* Halves across the longest side, so that blocks have equal points, however uneven the cloud is. */
void split(const struct cloud_view *v, std::vector<uint32_t> &order, size_t begin, size_t end,
	size_t most, std::vector<block> &ret)
{
	box b = bounds_of(v, order, begin, end);
	if (end - begin <= most) {
		ret.push_back({ begin, end, b });
		return;
	}
	int axis = longest_side(b);
	size_t middle = begin + (end - begin) / 2;
	std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
		[=](uint32_t i, uint32_t j) {
			double p[3], q[3];
			get(v, i, p);
			get(v, j, q);
			return p[axis] < q[axis] || (p[axis] == q[axis] && i < j);
		});
	split(v, order, begin, middle, most, ret);
	split(v, order, middle, end, most, ret);
}

/* What must be known around a block: twenty times how far its points are apart if they lie in a plane. */
double margin_of(const block &b)
{
	double side[3];
	for (int k = 0; k < 3; k++)
		side[k] = b.bounds.max[k] - b.bounds.min[k];
	std::sort(side, side + 3);
	return 20 * std::sqrt(std::max(side[2] * side[1], 1e-6) / double(b.end - b.begin));
}

bool meets(const box &a, const box &b, double margin)
{
	for (int k = 0; k < 3; k++)
		if (a.min[k] > b.max[k] + margin || a.max[k] < b.min[k] - margin)
			return false;
	return true;
}

/* ---- one block ---- */

struct surroundings {
	cloud_xyz::Ptr all,
		thinned; /* its own points first; from its centre; the same where nothing is to be thinned */
	tree_xyz all_tree, thinned_tree;
	double centre[3];
	size_t own;
};

void gather(const struct cloud_view *v, const std::vector<uint32_t> &order,
	const std::vector<block> &blocks, const block &b, surroundings &s)
{
	double margin = margin_of(b);
	s.all.reset(new cloud_xyz);
	s.own = b.end - b.begin;
	for (int k = 0; k < 3; k++)
		s.centre[k] = (b.bounds.min[k] + b.bounds.max[k]) / 2;
	auto add = [&](uint32_t i, bool all) {
		double p[3];
		get(v, i, p);
		if (!all &&
			!meets(b.bounds, { { p[0], p[1], p[2] }, { p[0], p[1], p[2] } }, margin))
			return;
		s.all->push_back(pcl::PointXYZ(float(p[0] - s.centre[0]), float(p[1] - s.centre[1]),
			float(p[2] - s.centre[2])));
	};
	for (size_t i = b.begin; i < b.end; i++)
		add(order[i], true);
	for (const block &other : blocks)
		if (&other != &b && meets(other.bounds, b.bounds, margin))
			for (size_t i = other.begin; i < other.end; i++)
				add(order[i], false);
}

uint64_t voxel_of(const pcl::PointXYZ &p, float side)
{
	auto at = [side](float x) { return uint64_t(int64_t(std::floor(x / side))) & 0x1fffff; };
	return at(p.x) | at(p.y) << 21 | at(p.z) << 42;
}

/* One point of every voxel, as it is: means would hide how rough the surface is. */
cloud_xyz::Ptr thin(const cloud_xyz &all, float side)
{
	std::vector<std::pair<uint64_t, uint32_t>> voxels(all.size());
	for (size_t i = 0; i < all.size(); i++)
		voxels[i] = { voxel_of(all[i], side), uint32_t(i) };
	std::sort(voxels.begin(), voxels.end());
	cloud_xyz::Ptr ret(new cloud_xyz);
	for (size_t i = 0; i < voxels.size(); i++)
		if (i == 0 || voxels[i].first != voxels[i - 1].first)
			ret->push_back(all[voxels[i].second]);
	return ret;
}

void prepare(surroundings &s, float radius)
{
	s.all_tree.setInputCloud(s.all);
	s.thinned = thin(*s.all, radius / 3);
	if (s.thinned->size() > s.all->size() / 4 * 3)
		s.thinned = s.all;
	else
		s.thinned_tree.setInputCloud(s.thinned);
}

const tree_xyz &search_tree(const surroundings &s)
{
	return s.thinned == s.all ? s.all_tree : s.thinned_tree;
}

struct fit {
	Eigen::Vector3f normal, middle;
	float error, curvature;
	bool good;
};

struct scratch {
	pcl::Indices index;
	std::vector<float> distance2;
};

fit fit_plane(const surroundings &s, const pcl::PointXYZ &p, scratch &t)
{
	fit f = { Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), NAN, NAN, false };
	int k = NEIGHBOURS;
	for (int i = 0; i <= WIDENINGS; i++, k *= 3) {
		int most = int(std::min<size_t>(size_t(k), s.thinned->size()));
		if (most < 3 || search_tree(s).nearestKSearch(p, most, t.index, t.distance2) < 3)
			return f;
		Eigen::Matrix3d covariance, vectors;
		Eigen::Vector4d mean = Eigen::Vector4d::Zero();
		Eigen::Vector3d values;
		pcl::computeMeanAndCovarianceMatrix(*s.thinned, t.index, covariance, mean);
		pcl::eigen33(covariance, vectors, values);
		if (!(values[2] > 0) || !vectors.allFinite())
			continue; /* all at one place */
		values = values.cwiseMax(0);
		f.normal = vectors.col(0).cast<float>().normalized();
		f.middle = mean.head<3>().cast<float>();
		f.error = float(std::sqrt(values[0]));
		f.curvature = float(values[0] / values.sum());
		f.good = f.normal.allFinite();
		if (values[1] > LINE * values[2])
			break;
	}
	return f;
}

/* The normal of the point's own face; errors stay, for they tell where creases are. of: of the block's own points. */
Eigen::Vector3f mended(
	const surroundings &s, const std::vector<fit> &of, size_t i, float size, scratch &t)
{
	scratch beside;
	const fit &own = of[i];
	Eigen::Vector3f ret = own.normal, at = (*s.all)[i].getVector3fMap();
	float best = INFINITY;
	int k = int(std::min<size_t>(MEND_NEIGHBOURS, s.all->size()));
	if (!own.good || !(own.error > MEND_SIZES * size) ||
		s.all_tree.nearestKSearch((*s.all)[i], k, t.index, t.distance2) < k)
		return ret;
	for (int j : t.index) {
		const fit f = size_t(j) < s.own ? of[j] : fit_plane(s, (*s.all)[j], beside);
		if (!f.good || !(f.error < MEND_BETTER * own.error))
			continue;
		float off = std::fabs(f.normal.dot(at - f.middle));
		if (off < MEND_HOLDS * f.error && std::hypot(off, f.error) < best) {
			best = std::hypot(off, f.error);
			ret = f.normal;
		}
	}
	return ret;
}

/* So many points lie in a disc of the distance of the last of them; but where the third is nearly as far away it stands alone, or with one or
 * two beside it. */
float size_of(const surroundings &s, const pcl::PointXYZ &p, scratch &t, uint8_t *ret_alone)
{
	*ret_alone = false;
	int k = int(std::min<size_t>(SIZE_NEIGHBOURS + 1, s.all->size())); /* the first is itself */
	int found = k < 2 ? 0 : s.all_tree.nearestKSearch(p, k, t.index, t.distance2);
	if (found < 2)
		return NAN;
	*ret_alone = found > 3 && t.distance2[3] > ALONE * ALONE * t.distance2.back();
	return std::sqrt(t.distance2.back() * float(M_PI) / float(k - 1));
}

/* Where points hang in the air, as leaves do and what was met by chance, or stand alone, the eighth neighbour tells nothing of a patch, and
 * may be metres away: none of them is larger than so many medians of all. */
constexpr float LOOSE_CURVATURE = 0.04f, LOOSE_MEDIANS = 2.5f;

void limit_sizes(cloud_geometry *g, const std::vector<uint8_t> &alone)
{
	std::vector<float> sizes;
	for (uint64_t i = 0; i < g->count; i++)
		if (std::isfinite(g->point_size_m[i]))
			sizes.push_back(g->point_size_m[i]);
	if (sizes.empty())
		return;
	std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
	float most = LOOSE_MEDIANS * sizes[sizes.size() / 2];
	for (uint64_t i = 0; i < g->count; i++)
		if ((alone[i] || !(g->curvature[i] <= LOOSE_CURVATURE)) &&
			g->point_size_m[i] > most)
			g->point_size_m[i] = most;
}

/* ---- which way a normal looks ---- */

/* The highest point of each cell of a plan. */
struct heights {
	float cell;
	std::unordered_map<uint64_t, float> highest;

	static uint64_t key(float x, float y, float cell)
	{
		return uint64_t(uint32_t(int32_t(std::floor(x / cell)))) << 32 |
		       uint32_t(int32_t(std::floor(y / cell)));
	}

	explicit heights(const cloud_xyz &all, float cell) : cell(cell)
	{
		for (const auto &p : all) {
			auto at = highest.emplace(key(p.x, p.y, cell), p.z).first;
			at->second = std::max(at->second, p.z);
		}
	}

	float at(float x, float y) const
	{
		auto found = highest.find(key(x, y, cell));
		return found == highest.end() ? -std::numeric_limits<float>::max() : found->second;
	}
};

/* Like the median distance of points in plan, from how many cells of a metre have any. */
float plan_spacing(const cloud_xyz &all)
{
	heights metres(all, 1);
	return std::sqrt(float(metres.highest.size()) / float(std::max<size_t>(all.size(), 1)));
}

bool looks_out(const heights &h, const pcl::PointXYZ &p, const Eigen::Vector3f &n)
{
	if (std::fabs(n.z()) >= UPRIGHT)
		return n.z() > 0;
	Eigen::Vector2f side = n.head<2>().normalized() * h.cell * 1.5f;
	float before = h.at(p.x + side.x(), p.y + side.y()),
	      behind = h.at(p.x - side.x(), p.y - side.y());
	return before == behind ? n.z() >= 0 : before < behind;
}

bool looks_to(const struct cloud_view *v, const surroundings &s, const pcl::PointXYZ &p,
	const Eigen::Vector3f &n)
{
	Eigen::Vector3d at(v->viewpoint_m[0] - s.centre[0], v->viewpoint_m[1] - s.centre[1],
		v->viewpoint_m[2] - s.centre[2]);
	return n.cast<double>().dot(at - p.getVector3fMap().cast<double>()) >= 0;
}

/* ---- all ---- */

void put(cloud_geometry *g, uint32_t i, const fit &f, float size, bool turn)
{
	for (int k = 0; k < 3; k++)
		g->normal[i][k] = f.good ? (turn ? -f.normal[k] : f.normal[k]) : 0;
	g->plane_error_m[i] = f.error;
	g->curvature[i] = f.curvature;
	g->point_size_m[i] = size;
}

void estimate_block(const struct cloud_view *v, const std::vector<uint32_t> &order, const block &b,
	const surroundings &s, bool single_thread, cloud_geometry *ret, std::vector<uint8_t> &alone)
{
	heights h(v->has_viewpoint ? cloud_xyz() : *s.all,
		std::clamp(4 * plan_spacing(*s.all), 0.1f, 2.0f));
	std::vector<fit> fits(s.own);
#pragma omp parallel if (!single_thread)
	{
		scratch t;
#pragma omp for schedule(dynamic, 1024)
		for (size_t i = 0; i < s.own; i++)
			fits[i] = fit_plane(s, (*s.all)[i], t);
#pragma omp for schedule(dynamic, 1024)
		for (size_t i = 0; i < s.own; i++) {
			const pcl::PointXYZ &p = (*s.all)[i];
			uint32_t to = order[b.begin + i];
			float size = size_of(s, p, t, &alone[to]);
			fit f = fits[i];
			f.normal = mended(s, fits, i, size, t);
			bool right = v->has_viewpoint ? looks_to(v, s, p, f.normal)
						      : looks_out(h, p, f.normal);
			put(ret, to, f, size, !right);
		}
	}
}

cloud_geometry *geometry_of(size_t count)
{
	cloud_geometry *g = g_new0(cloud_geometry, 1);
	g->count = count;
	g->normal = static_cast<float(*)[3]>(g_malloc0_n(count, sizeof *g->normal));
	g->plane_error_m = g_new(float, count);
	g->curvature = g_new(float, count);
	g->point_size_m = g_new(float, count);
	return g;
}

bool check(const struct cloud_view *v, GError **error)
{
	if (v->count > G_MAXUINT32 / 2) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_SUPPORTED,
			"%zu points are more than a cloud can have here", v->count);
		return false;
	}
	for (size_t i = 0; i < v->count; i++) {
		double p[3];
		get(v, i, p);
		if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
			continue;
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA, "point %zu is not finite",
			i + 1);
		return false;
	}
	return true;
}

bool estimate(const struct cloud_view *v, const struct cloud_geometry_options *o, cloud_geometry *g,
	GError **error)
{
	std::vector<uint32_t> order(v->count);
	std::vector<uint8_t> alone(v->count);
	std::vector<block> blocks;
	std::iota(order.begin(), order.end(), 0);
	if (v->count)
		split(v, order, 0, v->count, o->block_points ? o->block_points : BLOCK_POINTS,
			blocks);
	for (const block &b : blocks) {
		surroundings s;
		if (o->progress && !o->progress(double(b.begin) / double(v->count), o->user_data)) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
			return false;
		}
		gather(v, order, blocks, b, s);
		prepare(s, o->radius_m > 0 ? o->radius_m : RADIUS_M);
		estimate_block(v, order, b, s, o->single_thread, g, alone);
	}
	limit_sizes(g, alone);
	return true;
}
} // namespace

void cloud_geometry_free(cloud_geometry *g)
{
	if (!g)
		return;
	g_free(g->normal);
	g_free(g->plane_error_m);
	g_free(g->curvature);
	g_free(g->point_size_m);
	g_free(g);
}

cloud_geometry *cloud_geometry_estimate(
	const struct cloud_view *v, const struct cloud_geometry_options *options, GError **error)
{
	static const struct cloud_geometry_options usual = {};
	if (!check(v, error))
		return NULL;
	cloud_geometry *g = geometry_of(v->count);
	if (pcl_guard(error, "normals",
		    [&] { return estimate(v, options ? options : &usual, g, error); }))
		return g;
	cloud_geometry_free(g);
	return NULL;
}
