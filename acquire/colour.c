#include "acquire/colour.h"
#include <math.h>

#define SKY_RANGE_M 2000.0
/* A photo's weight is full within the first share of the way to its neighbour, and none beyond the
 * second; the two lie evenly about the middle. */
#define FULL_SHARE 0.35
#define NONE_SHARE 0.65
#define DEGREE     (G_PI / 180)
/* What is nearer is seen from beside: it may be in the picture wherever it is. */
#define NEAR_M 0.5

/* Beyond some angle a distortion may fold back, so that a point far outside falls into the picture.
 * Up to there the distorted radius grows. */
static bool folds(const double *k, double r2)
{
	/* Most lie where the terms together are too small for it. */
	if (r2 * (3 * fabs(k[0]) + r2 * (5 * fabs(k[1]) + r2 * 7 * fabs(k[4]))) < 0.9)
		return false;
	for (int i = 1; i <= 8; i++) {
		double x = r2 * i / 8;
		if (1 + x * (3 * k[0] + x * (5 * k[1] + x * 7 * k[4])) <= 0)
			return true;
	}
	return false;
}

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
	return r2 < 16 && *ret_u >= 0 && *ret_v >= 0 && *ret_u <= c->width - 1 &&
	       *ret_v <= c->height - 1 && !folds(k, r2);
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

/* A photo, with what is the same for all cells. */
struct turned {
	const struct photo *photo;
	double front_rad;    /* within a turn */
	double sine, cosine; /* of where the head was turned */
};

/* 0 to a whole turn. */
static double within_turn(double rad)
{
	double off = remainder(rad, 2 * G_PI);
	return off < 0 ? off + 2 * G_PI : off;
}

static struct turned turned_of(const struct photo *photo, const struct calibration *c)
{
	double head_rad = photo->front_rad + c->stage.azimuth_zero_rad;
	return (struct turned){ photo, within_turn(photo->front_rad), sin(head_rad),
		cos(head_rad) };
}

static void to_head_frame(const double point_m[3], const struct turned *t, double ret_m[3])
{
	ret_m[0] = point_m[0] * t->cosine - point_m[1] * t->sine;
	ret_m[1] = point_m[0] * t->sine + point_m[1] * t->cosine;
	ret_m[2] = point_m[2];
}

/* share: of the way from the photo to its neighbour. The two photos' weights sum to one. */
static double weight_at(double share)
{
	double t = CLAMP((NONE_SHARE - share) / (NONE_SHARE - FULL_SHARE), 0.0, 1.0);
	return t * t * (3 - 2 * t);
}

/* Adds one photo's view of the point; the weight that it was given. */
static double add_photo(const struct turned *photo, const struct calibration *c,
	const double point_m[3], double weight, float sum[3])
{
	double head[3], u, v;
	float rgb[3];
	to_head_frame(point_m, photo, head);
	if (!colour_project(&c->camera, head, &u, &v))
		return 0;
	sample_photo(photo->photo, u, v, rgb);
	for (int k = 0; k < 3; k++)
		sum[k] += (float)weight * rgb[k];
	return weight;
}

/* The photos before and after an azimuth, clockwise. There may be several of one angle (a scan that
 * was resumed or went back for photos), so nothing can be said from their number. */
struct neighbours {
	const struct turned *before, *after;
	double before_rad, after_rad; /* how far off */
};

static struct neighbours find_neighbours(
	double front_rad, const struct turned *photos, uint32_t count)
{
	struct neighbours n = { .before_rad = INFINITY, .after_rad = INFINITY };
	double here = within_turn(front_rad);
	for (uint32_t k = 0; k < count; k++) {
		double off = here - photos[k].front_rad, behind = off < 0 ? off + 2 * G_PI : off,
		       ahead = 2 * G_PI - behind;
		if (behind < n.before_rad) {
			n.before_rad = behind;
			n.before = &photos[k];
		}
		if (ahead < n.after_rad) {
			n.after_rad = ahead;
			n.after = &photos[k];
		}
	}
	return n;
}

static void find_point(const panorama *p, uint32_t row, uint32_t column, double ret_m[3])
{
	float measured = p->range_m[panorama_index(p, row, column)];
	double azimuth = panorama_azimuth_rad(p, row, column),
	       elevation = panorama_elevation_rad(p, row, column),
	       range = measured > 0 ? measured : SKY_RANGE_M;
	ret_m[0] = range * cos(elevation) * sin(azimuth);
	ret_m[1] = range * cos(elevation) * cos(azimuth);
	ret_m[2] = range * sin(elevation);
}

static void set_rgb(panorama *p, uint32_t row, uint32_t column, const float sum[3], double total)
{
	uint8_t *rgb = p->rgb + 3 * panorama_index(p, row, column);
	for (int k = 0; k < 3 && total > 0; k++)
		rgb[k] = (uint8_t)CLAMP(lrintf(sum[k] / (float)total), 0, 255);
}

static void colour_cell(panorama *p, uint32_t row, uint32_t column, const struct turned *photos,
	uint32_t count, const struct calibration *c)
{
	double azimuth = panorama_azimuth_rad(p, row, column), point[3];
	find_point(p, row, column, point);
	struct neighbours n = find_neighbours(azimuth - c->stage.azimuth_zero_rad, photos, count);
	double gap = n.before_rad + n.after_rad, before = weight_at(n.before_rad / gap), total = 0;
	float sum[3] = { 0 };
	if (before > 0)
		total += add_photo(n.before, c, point, before, sum);
	if (before < 1)
		total += add_photo(n.after, c, point, 1 - before, sum);
	/* The one that has no weight here may yet see what the other does not. */
	if (total == 0)
		total = add_photo(before > 0.5 ? n.after : n.before, c, point, 1, sum);
	set_rgb(p, row, column, sum, total);
}

void colour_panorama(panorama *p, const struct photo *photos, uint32_t count,
	const struct calibration *calibration)
{
	if (count == 0)
		return;
	g_autofree struct turned *turned = g_new(struct turned, count);
	for (uint32_t k = 0; k < count; k++)
		turned[k] = turned_of(&photos[k], calibration);
	g_free(p->rgb);
	p->rgb = g_malloc0((size_t)p->desc.columns * p->desc.rows * 3);
#pragma omp parallel for schedule(dynamic, 8)
	for (uint32_t row = 0; row < p->desc.rows; row++)
		for (uint32_t column = 0; column < p->desc.columns; column++)
			colour_cell(p, row, column, turned, count, calibration);
}

/* ---- one photo ---- */

/* How far off the axis of view anything is in the picture; a step more, for what lies between. */
static double find_reach_rad(const struct camera_calibration *c)
{
	for (int off = 0; off <= 90; off++) {
		bool seen = off == 0;
		for (int around = 0; around < 360 && !seen; around += 5) {
			double s = sin(off * DEGREE), point[3], u, v,
			       view[3] = { s * cos(around * DEGREE), s * sin(around * DEGREE),
				       cos(off * DEGREE) };
			for (int k = 0; k < 3; k++)
				point[k] = c->translation_m[k] + view[0] * c->rotation[0][k] +
					   view[1] * c->rotation[1][k] +
					   view[2] * c->rotation[2][k];
			seen = colour_project(c, point, &u, &v);
		}
		if (!seen)
			return (off + 1) * DEGREE;
	}
	return G_PI;
}

/* Up to which angle beside the azimuth of the axis of view something that is not near can be within
 * its reach. */
static double find_azimuth_reach_rad(const struct camera_calibration *c)
{
	const double *axis = c->rotation[2], *t = c->translation_m;
	double reach = find_reach_rad(c) + asin(fmin(hypot(hypot(t[0], t[1]), t[2]) / NEAR_M, 1)),
	       level = hypot(axis[0], axis[1]);
	/* A cone that does not reach the zenith or the nadir. */
	return reach < G_PI / 2 && sin(reach) < level ? asin(sin(reach) / level) : G_PI;
}

/* By column: it lies so near to the axis of view that the photo may show it. */
static bool *reach_of(const panorama *p, const struct photo *photo, const struct calibration *c)
{
	const double *axis = c->camera.rotation[2];
	double middle = photo->front_rad + c->stage.azimuth_zero_rad + atan2(axis[0], axis[1]),
	       reach = find_azimuth_reach_rad(&c->camera) + p->column_rad;
	bool *may = g_new(bool, p->desc.columns);
	for (uint32_t column = 0; column < p->desc.columns; column++)
		may[column] =
			fabs(remainder((column + 0.5) * p->column_rad - middle, 2 * G_PI)) <= reach;
	return may;
}

void colour_one_photo(panorama *p, const struct photo *photo, const struct calibration *c)
{
	g_autofree bool *may = reach_of(p, photo, c);
	const struct turned turned = turned_of(photo, c);
	if (!p->rgb)
		p->rgb = g_malloc0((size_t)p->desc.columns * p->desc.rows * 3);
#pragma omp parallel for schedule(dynamic, 8)
	for (uint32_t row = 0; row < p->desc.rows; row++)
		for (uint32_t column = 0; column < p->desc.columns; column++) {
			double point[3];
			float sum[3] = { 0 }, range = p->range_m[panorama_index(p, row, column)];
			if (!may[column] && !(range > 0 && range < NEAR_M))
				continue;
			find_point(p, row, column, point);
			set_rgb(p, row, column, sum, add_photo(&turned, c, point, 1, sum));
		}
}
