#include "render/bench-reproject.h"
#include "render/filter.h"
#include "render/surface-pass.h"
#include <math.h>

/* Depths that agree: part of the depth, and metres. */
#define AGREE_PART 0.02
#define AGREE_M    0.02
/* Of a depth: what rounding may do. */
#define ROUNDING 1e-5

bool reproject_place(const struct camera *from, const double px[2], double depth_m,
	const struct camera *to, double ret_px[2], double *ret_depth_m)
{
	double point_m[3];
	camera_place(from, px, depth_m, point_m);
	return camera_project(to, point_m, ret_px, ret_depth_m);
}

/* The left upper one of the four nearest pixels. */
static bool corner_of(uint32_t width, uint32_t height, const double px[2], int32_t ret[2])
{
	double x = floor(px[0] - 0.5), y = floor(px[1] - 0.5);
	if (!(x >= 0 && y >= 0 && x < (double)width - 1 && y < (double)height - 1))
		return false;
	ret[0] = (int32_t)x;
	ret[1] = (int32_t)y;
	return true;
}

bool reproject_shows(const struct camera *c, const visibility_mask *m, const double point_m[3])
{
	double px[2] = { 0 }, depth_m = 0;
	int32_t at[2];
	if (!camera_project(c, point_m, px, &depth_m) || !corner_of(m->width, m->height, px, at))
		return false;
	for (int n = 0; n < 4; n++)
		if (depth_m * (1 + ROUNDING) >
			mask_depth(mask_key(m, at[0] + (n & 1), at[1] + (n >> 1))))
			return false;
	return true;
}

double reproject_depth(const frame *f, int32_t key)
{
	const struct mask_step *step =
		&frame_pipeline(f, key & ((1 << MASK_PIPELINE_BITS) - 1))->mask;
	return (mask_depth(key) - (double)step->offset_m) / (1 + (double)step->offset_relative);
}

float *reproject_depths(
	const frame *f, const visibility_mask *m, const struct chunk_view *views, uint32_t count)
{
	size_t pixels = (size_t)m->width * m->height;
	float *ret = g_new(float, pixels);
#pragma omp parallel for schedule(static)
	for (size_t at = 0; at < pixels; at++) {
		int32_t key = mask_key(m, (int32_t)(at % m->width), (int32_t)(at / m->width));
		ret[at] = key == MASK_EMPTY ? FILTER_FAR : (float)reproject_depth(f, key);
	}
	surface_pass(f, m, views, count, &(struct surface_planes){ .depth_m = ret });
	return ret;
}

static bool agrees(
	const struct camera *c, const float *depths_m, const double px[2], double depth_m)
{
	int32_t at[2];
	if (!corner_of(c->width, c->height, px, at))
		return false;
	for (int n = 0; n < 4; n++) {
		size_t row = (size_t)at[1] + (size_t)(n >> 1),
		       column = (size_t)at[0] + (size_t)(n & 1);
		double there_m = (double)depths_m[row * c->width + column];
		if (!(fabs(there_m - depth_m) <= AGREE_PART * depth_m + AGREE_M))
			return false;
	}
	return true;
}

static void find_row(reprojection *r, uint32_t y, const struct camera *now, const float *now_m,
	const struct camera *before, const float *before_m)
{
	float(*to)[2] = r->before_px + (size_t)y * r->width;
	for (uint32_t x = 0; x < r->width; x++) {
		double depth_m = (double)now_m[(size_t)y * r->width + x];
		double px[2] = { x + 0.5, y + 0.5 }, was_px[2] = { 0 }, was_m = 0;
		bool seen = depth_m < (double)FILTER_FAR &&
			    reproject_place(now, px, depth_m, before, was_px, &was_m) &&
			    agrees(before, before_m, was_px, was_m);
		for (int k = 0; k < 2; k++)
			to[x][k] = seen ? (float)was_px[k] : NAN;
	}
}

reprojection *reprojection_new(const struct camera *now, const float *now_m,
	const struct camera *before, const float *before_m)
{
	reprojection *r = g_new0(reprojection, 1);
	r->width = now->width;
	r->height = now->height;
	r->before_px = g_malloc((size_t)r->width * r->height * sizeof *r->before_px);
#pragma omp parallel for schedule(dynamic, 16)
	for (uint32_t y = 0; y < r->height; y++)
		find_row(r, y, now, now_m, before, before_m);
	return r;
}

void reprojection_free(reprojection *r)
{
	if (!r)
		return;
	g_free(r->before_px);
	g_free(r);
}

/* px[] is amid four pixels, or at most a rounding beyond them. */
static float between(const float *plane, const reprojection *r, const float px[2])
{
	float x = px[0] - 0.5f, y = px[1] - 0.5f;
	uint32_t column = (uint32_t)CLAMP(x, 0, (float)(r->width - 2)),
		 row = (uint32_t)CLAMP(y, 0, (float)(r->height - 2));
	float u = x - (float)column, v = y - (float)row;
	const float *a = plane + (size_t)row * r->width + column, *below = a + r->width;
	float upper = a[0] + u * (a[1] - a[0]), lower = below[0] + u * (below[1] - below[0]);
	return upper + v * (lower - upper);
}

/* false: some of it was not to be seen. */
static bool compare_square(const reprojection *r, const float *now, const float *before,
	uint32_t left, uint32_t top, uint32_t side, double ret_mean[2])
{
	double sum[2] = { 0 };
	for (uint32_t y = top; y < top + side; y++)
		for (uint32_t x = left; x < left + side; x++) {
			size_t at = (size_t)y * r->width + x;
			if (isnan(r->before_px[at][0]))
				return false;
			sum[0] += now[at];
			sum[1] += between(before, r, r->before_px[at]);
		}
	for (int k = 0; k < 2; k++)
		ret_mean[k] = sum[k] / ((double)side * side);
	return true;
}

void reprojection_add(const reprojection *r, const float *now, const float *before, uint32_t side,
	struct reprojection_sums *to)
{
	double error2 = 0, light = 0, light2 = 0;
	uint64_t places = 0;
#pragma omp parallel for schedule(static) reduction(+ : error2, light, light2, places)
	for (uint32_t y = 0; y < r->height / side; y++)
		for (uint32_t x = 0; x < r->width / side; x++) {
			double mean[2];
			if (!compare_square(r, now, before, x * side, y * side, side, mean))
				continue;
			error2 += (mean[0] - mean[1]) * (mean[0] - mean[1]);
			light += mean[0];
			light2 += mean[0] * mean[0];
			places++;
		}
	to->error2 += error2;
	to->light += light;
	to->light2 += light2;
	to->places += places;
}

double reprojection_change(const struct reprojection_sums *s)
{
	return s->places ? s->error2 / (double)s->places : NAN;
}

double reprojection_share(const struct reprojection_sums *s)
{
	double places = (double)s->places;
	double variance =
		s->places ? s->light2 / places - s->light / places * s->light / places : 0;
	return variance > 0 ? reprojection_change(s) / variance : NAN;
}
