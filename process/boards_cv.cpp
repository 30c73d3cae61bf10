#include "process/board-corners.h"
#include "process/guard_cv.hpp"
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

/* Boards in one photo: more would not fit so that they can be read. */
static const int boards_max = 4;

static std::vector<cv::Point3f> corners_of(const struct board_desc *desc)
{
	std::vector<cv::Point3f> v;
	for (uint32_t j = 0; j < desc->rows; j++)
		for (uint32_t i = 0; i < desc->columns; i++)
			v.emplace_back(
				(float)(i * desc->square_m), (float)(j * desc->square_m), 0.f);
	return v;
}

static std::vector<cv::Point2f> pixels_of(
	const struct board_desc *desc, const struct board_view *view)
{
	std::vector<cv::Point2f> v;
	for (uint32_t i = 0; i < desc->columns * desc->rows; i++)
		v.emplace_back((float)view->corner[i][0], (float)view->corner[i][1]);
	return v;
}

static void keep(const std::vector<cv::Point2f> &found, const struct board_desc *desc,
	const struct photo *photo, GArray *views)
{
	struct board_view view = {};
	size_t n = found.size();
	bool leftwards = found[desc->columns - 1].x < found[0].x;
	view.front_rad = photo->front_rad;
	for (size_t i = 0; i < n; i++) {
		const cv::Point2f &p = found[leftwards ? n - 1 - i : i];
		view.corner[i][0] = p.x;
		view.corner[i][1] = p.y;
	}
	board_corners_refine(
		photo->pixels, photo->info.width, photo->info.height, desc, view.corner);
	g_array_append_val(views, view);
}

/* So that the next search finds another. */
static void paint_over(cv::Mat &picture, const std::vector<cv::Point2f> &found)
{
	std::vector<cv::Point> hull;
	std::vector<cv::Point2f> outline;
	cv::convexHull(found, outline);
	cv::Point2f middle(0, 0);
	for (const auto &p : outline)
		middle += p * (1.f / (float)outline.size());
	for (const auto &p : outline)
		hull.emplace_back(middle + (p - middle) * 1.35f);
	cv::fillConvexPoly(picture, hull, cv::Scalar(128));
}

/* Searched in a picture this high, which takes a tenth of the time, and if need be in the whole. */
static const double quick_px = 640;
/* Half the window in which a corner is refined, in squares: no other corner may lie in it. */
static const double window_squares = 0.4;

static bool find_one(
	const cv::Mat &picture, double scale, cv::Size size, std::vector<cv::Point2f> &found)
{
	cv::Mat look = picture;
	if (scale < 1)
		cv::resize(picture, look, cv::Size(), scale, scale, cv::INTER_AREA);
	if (!cv::findChessboardCornersSB(look, size, found, 0))
		return false;
	/* Pixel centres are whole numbers. */
	for (auto &p : found)
		p = (p + cv::Point2f(0.5f, 0.5f)) / scale - cv::Point2f(0.5f, 0.5f);
	return true;
}

/* What the search says of corners is biased by a few tenths of a pixel where squares are seen at a slant. */
static void refine(const cv::Mat &picture, std::vector<cv::Point2f> &found)
{
	double least = 1e9;
	for (size_t k = 1; k < found.size(); k++)
		for (size_t l = 0; l < k; l++)
			least = std::min(least, cv::norm(found[k] - found[l]));
	int half = std::max(2, (int)(least * window_squares));
	cv::cornerSubPix(picture, found, cv::Size(half, half), cv::Size(-1, -1),
		cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 1e-3));
}

bool boards_find(
	const struct photo *photo, const struct board_desc *desc, GArray *views, GError **error)
{
	return cv_guard(error, "a photo cannot be searched for checkerboards", [&] {
		/* Brightness alone: the first plane of NV12. */
		cv::Mat whole((int)photo->info.height, (int)photo->info.width, CV_8UC1,
			const_cast<uint8_t *>(photo->pixels));
		cv::Mat picture = whole.clone();
		cv::Size size((int)desc->columns, (int)desc->rows);
		double scale = std::min(1.0, quick_px / std::max(whole.rows, whole.cols));
		for (int i = 0; i < boards_max; i++) {
			std::vector<cv::Point2f> found;
			if (!find_one(picture, scale, size, found) &&
				!(i == 0 && scale < 1 && find_one(picture, scale = 1, size, found)))
				break;
			refine(whole, found);
			keep(found, desc, photo, views);
			paint_over(picture, found);
		}
		return true;
	});
}

static cv::Matx33d matrix_of(const struct camera_calibration *c)
{
	return cv::Matx33d(c->fx, 0, c->cx, 0, c->fy, c->cy, 0, 0, 1);
}

bool boards_pose(const struct camera_calibration *camera, const struct board_desc *desc,
	const struct board_view *view, struct pose *ret)
{
	return cv_guard(nullptr, "a checkerboard's pose", [&] {
		cv::Mat distortion(5, 1, CV_64F, const_cast<double *>(camera->distortion)),
			rotation, translation;
		cv::Matx33d turn;
		if (!cv::solvePnP(corners_of(desc), pixels_of(desc, view), matrix_of(camera),
			    distortion, rotation, translation))
			return false;
		cv::Rodrigues(rotation, turn);
		for (int i = 0; i < 3; i++) {
			for (int j = 0; j < 3; j++)
				ret->rotation[i][j] = turn(i, j);
			ret->translation_m[i] = translation.at<double>(i);
		}
		return true;
	});
}

bool boards_intrinsics(const struct board_desc *desc, const GArray *views,
	struct camera_calibration *camera, double *ret_rms_px, GError **error)
{
	return cv_guard(error, "the camera cannot be calibrated", [&] {
		std::vector<std::vector<cv::Point3f>> points(views->len, corners_of(desc));
		std::vector<std::vector<cv::Point2f>> pixels;
		std::vector<cv::Mat> rotations, translations;
		cv::Mat k = cv::Mat(matrix_of(camera)),
			d = cv::Mat(5, 1, CV_64F, camera->distortion).clone();
		for (guint i = 0; i < views->len; i++)
			pixels.push_back(
				pixels_of(desc, &g_array_index(views, struct board_view, i)));
		*ret_rms_px = cv::calibrateCamera(points, pixels,
			cv::Size((int)camera->width, (int)camera->height), k, d, rotations,
			translations, cv::CALIB_USE_INTRINSIC_GUESS);
		camera->fx = k.at<double>(0, 0), camera->fy = k.at<double>(1, 1);
		camera->cx = k.at<double>(0, 2), camera->cy = k.at<double>(1, 2);
		for (int i = 0; i < 5; i++)
			camera->distortion[i] = d.at<double>(i);
		return true;
	});
}
