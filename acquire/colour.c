#include "acquire/colour.h"
#include <math.h>

#define SKY_RANGE_M 2000.0
/* A photo's weight is full within the first share of the spacing between photos, and none beyond
 * the second. */
#define FULL_SHARE 0.35
#define NONE_SHARE 0.65

bool colour_project(
	const struct camera_calibration *c, const double head_m[3], double *ret_u, double *ret_v)
{
	double d[3], v[3];
	for (int k = 0; k < 3; k++)
		d[k] = head_m[k] - c->translation_m[k];
	for (int k = 0; k < 3; k++)
		v[k] = c->rotation[k][0] * d[0] + c->rotation[k][1] * d[1] +
		       c->rotation[k][2] * d[2];
	if (v[2] <= 1e-6)
		return false;
	double x = v[0] / v[2], y = v[1] / v[2], r2 = x * x + y * y;
	const double *k = c->distortion;
	double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
	*ret_u = c->fx * (x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)) + c->cx;
	*ret_v = c->fy * (y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y) + c->cy;
	/* Far outside the picture the distortion folds back; a wide margin keeps that out. */
	return r2 < 16 && *ret_u >= 0 && *ret_v >= 0 && *ret_u <= c->width - 1 &&
	       *ret_v <= c->height - 1;
}

static float sample_plane(const uint8_t *plane, uint32_t stride, uint32_t step, double u, double v,
	uint32_t width, uint32_t height)
{
	u = CLAMP(u, 0, width - 1.0);
	v = CLAMP(v, 0, height - 1.0);
	uint32_t x = MIN((uint32_t)u, width - 2), y = MIN((uint32_t)v, height - 2);
	float fx = (float)(u - x), fy = (float)(v - y);
	const uint8_t *p = plane + (size_t)y * stride + (size_t)x * step;
	float top = p[0] + (p[step] - p[0]) * fx,
	      bottom = p[stride] + (p[stride + step] - p[stride]) * fx;
	return top + (bottom - top) * fy;
}

/* NV12, BT.601 limited range, to RGB 0..255. A chroma sample lies in the middle of its four pixels.
 */
static void sample_photo(const struct photo *photo, double u, double v, float rgb[3])
{
	uint32_t w = photo->info.width, h = photo->info.height;
	const uint8_t *chroma = photo->pixels + (size_t)w * h;
	double cu = (u - 0.5) / 2, cv = (v - 0.5) / 2;
	float y = 1.164f * (sample_plane(photo->pixels, w, 1, u, v, w, h) - 16);
	float cb = sample_plane(chroma, w, 2, cu, cv, w / 2, h / 2) - 128;
	float cr = sample_plane(chroma + 1, w, 2, cu, cv, w / 2, h / 2) - 128;
	rgb[0] = y + 1.596f * cr;
	rgb[1] = y - 0.813f * cr - 0.392f * cb;
	rgb[2] = y + 2.017f * cb;
}

static void to_head_frame(const double point_m[3], double front_rad, double ret_m[3])
{
	double s = sin(front_rad), c = cos(front_rad);
	ret_m[0] = point_m[0] * c - point_m[1] * s;
	ret_m[1] = point_m[0] * s + point_m[1] * c;
	ret_m[2] = point_m[2];
}

static double weight_at(double angle_rad, double spacing_rad)
{
	double share = fabs(angle_rad) / spacing_rad;
	double t = CLAMP((NONE_SHARE - share) / (NONE_SHARE - FULL_SHARE), 0.0, 1.0);
	return t * t * (3 - 2 * t);
}

/* Adds one photo's view of the point; the weight that it was given. */
static double add_photo(const struct photo *photo, const struct calibration *c,
	const double point_m[3], double weight, float sum[3])
{
	double head[3], u, v;
	float rgb[3];
	to_head_frame(point_m, photo->front_rad + c->stage.azimuth_zero_rad, head);
	if (!colour_project(&c->camera, head, &u, &v))
		return 0;
	sample_photo(photo, u, v, rgb);
	for (int k = 0; k < 3; k++)
		sum[k] += (float)weight * rgb[k];
	return weight;
}

static void colour_cell(panorama *p, uint32_t row, uint32_t column, const struct photo *photos,
	uint32_t count, const struct calibration *c)
{
	double spacing = 2 * G_PI / count, azimuth = panorama_azimuth_rad(p, row, column),
	       total = 0, nearest = INFINITY;
	double elevation = panorama_elevation_rad(p, row, column);
	size_t i = panorama_index(p, row, column);
	double range = p->range_m[i] > 0 ? p->range_m[i] : SKY_RANGE_M;
	double point[3] = { range * cos(elevation) * sin(azimuth),
		range * cos(elevation) * cos(azimuth), range * sin(elevation) };
	const struct photo *near = NULL;
	float sum[3] = { 0 };
	for (uint32_t k = 0; k < count; k++) {
		double off = remainder(
			azimuth - photos[k].front_rad - c->stage.azimuth_zero_rad, 2 * G_PI);
		double weight = weight_at(off, spacing);
		if (weight > 0)
			total += add_photo(&photos[k], c, point, weight, sum);
		if (fabs(off) < nearest) {
			nearest = fabs(off);
			near = &photos[k];
		}
	}
	if (total == 0 && near)
		total = add_photo(near, c, point, 1, sum);
	for (int k = 0; k < 3 && total > 0; k++)
		p->rgb[3 * i + k] = (uint8_t)CLAMP(lrintf(sum[k] / (float)total), 0, 255);
}

void colour_panorama(panorama *p, const struct photo *photos, uint32_t count,
	const struct calibration *calibration)
{
	if (count == 0)
		return;
	g_free(p->rgb);
	p->rgb = g_malloc0((size_t)p->desc.columns * p->desc.rows * 3);
#pragma omp parallel for schedule(dynamic, 8)
	for (uint32_t row = 0; row < p->desc.rows; row++)
		for (uint32_t column = 0; column < p->desc.columns; column++)
			colour_cell(p, row, column, photos, count, calibration);
}
