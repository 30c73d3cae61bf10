#include "process/guard_cv.hpp"
extern "C" {
#include "process/plane-outline.h"
}
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

static const float cell_least_m = 0.02f;
static const float cell_spacing =
	0.08f; /* of the mean: where points are sparse cells need not be small */
static const int cells_most = 4000; /* a side */
static const int slit_cells = 4;    /* half of the widest */

struct raster {
	float cell_m, low[2];
	int width, height;
	cv::Mat reach,
		beyond; /* of the point in a cell, in cells: its patch, 0: none; what is covered in the end */
	cv::Mat beside; /* 255 where points near the plane reach */
};

static raster raster_of(const plane_spot *spot, uint32_t count)
{
	float low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY }, reach = 0;
	double spacing = 0;
	for (uint32_t n = 0; n < count; n++) {
		spacing += (double)spot[n].spacing_m / count;
		reach = std::max(reach, spot[n].reach_m);
		for (int k = 0; k < 2; k++) {
			low[k] = std::min(low[k], spot[n].at[k]);
			high[k] = std::max(high[k], spot[n].at[k]);
		}
	}
	raster r;
	float longest = std::max(high[0] - low[0], high[1] - low[1]) + 2 * reach;
	r.cell_m = std::max(
		{ cell_least_m, cell_spacing * (float)spacing, longest / (float)(cells_most - 8) });
	for (int k = 0; k < 2; k++)
		r.low[k] = low[k] - reach - 3 * r.cell_m;
	r.width = (int)((high[0] + reach - r.low[0]) / r.cell_m) + 4;
	r.height = (int)((high[1] + reach - r.low[1]) / r.cell_m) + 4;
	r.reach = cv::Mat::zeros(r.height, r.width, CV_32F);
	r.beyond = cv::Mat::zeros(r.height, r.width, CV_32F);
	r.beside = cv::Mat::zeros(r.height, r.width, CV_8U);
	for (uint32_t n = 0; n < count; n++) {
		int x = (int)((spot[n].at[0] - r.low[0]) / r.cell_m),
		    y = (int)((spot[n].at[1] - r.low[1]) / r.cell_m);
		if (spot[n].is_beside) {
			cv::circle(r.beside, cv::Point(x, y),
				(int)std::ceil(spot[n].reach_m / r.cell_m), cv::Scalar(255),
				cv::FILLED);
			continue;
		}
		float &at = r.reach.at<float>(y, x), &beyond = r.beyond.at<float>(y, x);
		/* Cells beside each other reach each other. */
		at = std::max(at, std::max(spot[n].reach_m / r.cell_m, 1.5f));
		beyond = std::max(
			beyond, std::min(spot[n].reach_m, spot[n].spacing_m / 2 + PLANE_GROWN_M) /
					r.cell_m);
	}
	return r;
}

/* Of each cell the nearest one with a point. */
struct nearest {
	cv::Mat away, label;
	std::vector<cv::Point> of;
};

static nearest nearest_of(const raster &r)
{
	nearest n;
	cv::Mat empty = r.reach == 0;
	cv::distanceTransform(empty, n.away, n.label, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
	n.of.resize((size_t)r.width * (size_t)r.height + 1);
	for (int y = 0; y < r.height; y++)
		for (int x = 0; x < r.width; x++)
			if (!empty.at<uchar>(y, x))
				n.of[(size_t)n.label.at<int>(y, x)] = cv::Point(x, y);
	return n;
}

static cv::Mat round(int radius)
{
	return cv::getStructuringElement(
		cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1));
}

static void close_slits(const raster &r, cv::Mat &covered)
{
	cv::Mat closed;
	cv::morphologyEx(covered, closed, cv::MORPH_CLOSE, round(slit_cells));
	covered |= closed & r.beside;
}

static cv::Mat covered_of(const raster &r)
{
	nearest n = nearest_of(r);
	cv::Mat covered = cv::Mat::zeros(r.height, r.width, CV_8U), inside;
	for (int y = 0; y < r.height; y++)
		for (int x = 0; x < r.width; x++) {
			float reach = r.reach.at<float>(n.of[(size_t)n.label.at<int>(y, x)]);
			covered.at<uchar>(y, x) = n.away.at<float>(y, x) <= reach ? 255 : 0;
		}
	cv::distanceTransform(covered, inside, cv::DIST_L2, 5);
	for (int y = 0; y < r.height; y++)
		for (int x = 0; x < r.width; x++) {
			cv::Point of = n.of[(size_t)n.label.at<int>(y, x)];
			float back = r.reach.at<float>(of) - r.beyond.at<float>(of);
			if (back > 0 && !(inside.at<float>(y, x) > back + 0.5f))
				covered.at<uchar>(y, x) = 0;
		}
	close_slits(r, covered);
	/* Whiskers go. */
	cv::morphologyEx(covered, covered, cv::MORPH_OPEN, round(2));
	return covered;
}

/* Contours run through the middles of cells: at twice the size they are a quarter of a cell inside of the border. */
static void append(
	const raster &r, const std::vector<cv::Point> &contour, GArray *place, GArray *end)
{
	for (const cv::Point &p : contour) {
		float at[2] = { r.low[0] + ((float)p.x + 0.5f) / 2 * r.cell_m,
			r.low[1] + ((float)p.y + 0.5f) / 2 * r.cell_m };
		g_array_append_vals(place, at, 1);
	}
	uint32_t ends = place->len;
	g_array_append_vals(end, &ends, 1);
}

/* Whether each contour is of something large enough. */
static std::vector<bool> kept_of(const std::vector<std::vector<cv::Point>> &contours,
	const std::vector<cv::Vec4i> &tree, double part_least, double hole_least)
{
	std::vector<bool> kept(contours.size());
	for (int holes = 0; holes < 2; holes++)
		for (size_t n = 0; n < contours.size(); n++) {
			bool is_hole = tree[n][3] >= 0;
			if (is_hole == (holes == 1))
				kept[n] = contours[n].size() >= 8 &&
					  cv::contourArea(contours[n]) >=
						  (is_hole ? hole_least : part_least) &&
					  (!is_hole || kept[(size_t)tree[n][3]]);
		}
	return kept;
}

static bool outline(const plane_spot *spot, uint32_t count, double part_least_m2,
	double hole_least_m2, GArray *place, GArray *end, float *ret_step_m)
{
	raster r = raster_of(spot, count);
	cv::Mat covered = covered_of(r), twice;
	std::vector<std::vector<cv::Point>> contours;
	std::vector<cv::Vec4i> tree;
	cv::resize(covered, twice, cv::Size(), 2, 2, cv::INTER_NEAREST);
	cv::findContours(twice, contours, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
	double cell_m2 = (double)(r.cell_m * r.cell_m) / 4;
	std::vector<bool> kept =
		kept_of(contours, tree, part_least_m2 / cell_m2, hole_least_m2 / cell_m2);
	for (size_t n = 0; n < contours.size(); n++)
		if (kept[n])
			append(r, contours[n], place, end);
	*ret_step_m = r.cell_m;
	return true;
}

extern "C" bool plane_outline(const struct plane_spot *spot, uint32_t count, double part_least_m2,
	double hole_least_m2, GArray *place, GArray *end, float *ret_step_m, GError **error)
{
	return cv_guard(error, "finding the outline of a plane", [&] {
		return !count ||
		       outline(spot, count, part_least_m2, hole_least_m2, place, end, ret_step_m);
	});
}
