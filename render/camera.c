#include "render/camera.h"
#include <gio/gio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise(double v[3])
{
	double length = sqrt(dot(v, v));
	for (int k = 0; k < 3; k++)
		v[k] /= length;
}

static void cross(const double a[3], const double b[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* ---- making ---- */

/* Forward is given; east and north are those of its heading. */
static struct camera make(const double eye_m[3], const double forward[3], double east, double north,
	double fov_deg, uint32_t width, uint32_t height)
{
	struct camera c = { .right = { north, -east, 0 },
		.focal_px = height / 2.0 / tan(fov_deg * G_PI / 360),
		.width = width,
		.height = height,
		.near_m = CAMERA_NEAR_M,
		.far_m = CAMERA_FAR_M };
	memcpy(c.eye_m, eye_m, sizeof c.eye_m);
	memcpy(c.forward, forward, sizeof c.forward);
	cross(c.forward, c.right, c.down);
	return c;
}

struct camera camera_towards(const double eye_m[3], double heading_rad, double elevation_rad,
	double fov_deg, uint32_t width, uint32_t height)
{
	double east = sin(heading_rad), north = cos(heading_rad), level = cos(elevation_rad);
	double forward[3] = { level * east, level * north, sin(elevation_rad) };
	return make(eye_m, forward, east, north, fov_deg, width, height);
}

static struct camera look_along(const double eye_m[3], const double direction[3], double fov_deg,
	uint32_t width, uint32_t height)
{
	double forward[3] = { direction[0], direction[1], direction[2] };
	normalise(forward);
	double level = hypot(forward[0], forward[1]);
	if (level < 1e-9) /* what is left is rounding, and no heading */
		return make(eye_m, forward, 0, 1, fov_deg, width, height);
	return make(eye_m, forward, forward[0] / level, forward[1] / level, fov_deg, width, height);
}

struct camera camera_look_at(const double eye_m[3], const double target_m[3], double fov_deg,
	uint32_t width, uint32_t height)
{
	double direction[3];
	for (int k = 0; k < 3; k++)
		direction[k] = target_m[k] - eye_m[k];
	return look_along(eye_m, direction, fov_deg, width, height);
}

struct camera camera_at_station(const struct pose *scan_to_site, double azimuth_rad,
	double elevation_rad, double fov_deg, uint32_t width, uint32_t height)
{
	double level = cos(elevation_rad);
	double direction[3] = { level * sin(azimuth_rad), level * cos(azimuth_rad),
		sin(elevation_rad) };
	pose_rotate(scan_to_site, direction, direction);
	return look_along(scan_to_site->translation_m, direction, fov_deg, width, height);
}

struct camera camera_parallel(const struct camera *c, double height_m, double depth_m)
{
	struct camera p = *c;
	p.focal_px = c->height / 2.0 / tan(CAMERA_PARALLEL_FOV_DEG * G_PI / 360);
	p.parallel_m = height_m * p.focal_px / c->height;
	p.near_m = p.parallel_m;
	p.far_m = p.near_m + depth_m;
	for (int k = 0; k < 3; k++)
		p.eye_m[k] -= p.near_m * c->forward[k];
	return p;
}

static void turn(double v[3], double sine, double cosine)
{
	double x = v[0], y = v[1];
	v[0] = cosine * x + sine * y;
	v[1] = cosine * y - sine * x;
}

struct camera camera_turned(const struct camera *c, double angle_rad)
{
	struct camera t = *c;
	double sine = sin(angle_rad), cosine = cos(angle_rad);
	turn(t.right, sine, cosine);
	turn(t.down, sine, cosine);
	turn(t.forward, sine, cosine);
	return t;
}

struct camera camera_shifted(const struct camera *c, double right_px, double down_px)
{
	struct camera s = *c;
	if (c->parallel_m > 0) {
		double px[2] = { camera_middle_x(c) + right_px, camera_middle_y(c) + down_px };
		camera_place(c, px, 0, s.eye_m);
		return s;
	}
	double x = right_px / c->focal_px, y = down_px / c->focal_px;
	double z = 1 / sqrt(1 + x * x + y * y), level = 1 / sqrt(1 + x * x);
	for (int k = 0; k < 3; k++) {
		s.forward[k] = z * (c->forward[k] + x * c->right[k] + y * c->down[k]);
		s.right[k] = level * (c->right[k] - x * c->forward[k]);
	}
	for (int k = 0; k < 3; k++) {
		int m = (k + 1) % 3, n = (k + 2) % 3;
		s.down[k] = s.forward[m] * s.right[n] - s.forward[n] * s.right[m];
	}
	return s;
}

static uint32_t scaled_side(uint32_t side, double factor)
{
	return (uint32_t)CLAMP(round(side * factor), 1, (double)UINT32_MAX);
}

struct camera camera_scaled(const struct camera *c, double factor)
{
	struct camera s = *c;
	s.width = scaled_side(c->width, factor);
	s.height = scaled_side(c->height, factor);
	s.focal_px *= factor;
	return s;
}

struct camera camera_window(
	const struct camera *c, uint32_t left, uint32_t top, uint32_t width, uint32_t height)
{
	struct camera w = *c;
	g_assert(!camera_is_window(c));
	w.whole = (struct camera_whole){ c->width, c->height, left, top };
	w.width = width;
	w.height = height;
	return w;
}

struct camera camera_whole(const struct camera *c)
{
	struct camera w = *c;
	w.width = camera_whole_width(c);
	w.height = camera_whole_height(c);
	w.whole = (struct camera_whole){ 0 };
	return w;
}

/* ---- asking ---- */

double camera_fov_deg(const struct camera *c)
{
	return 360 / G_PI * atan2(camera_whole_height(c) / 2.0, c->focal_px);
}

double camera_heading_rad(const struct camera *c)
{
	return atan2(-c->right[1], c->right[0]);
}

double camera_elevation_rad(const struct camera *c)
{
	return atan2(c->forward[2], hypot(c->forward[0], c->forward[1]));
}

void camera_place(const struct camera *c, const double px[2], double depth_m, double ret_m[3])
{
	double scale_m = camera_scale_m(c, depth_m) / c->focal_px;
	double right_m = (px[0] - camera_middle_x(c)) * scale_m,
	       down_m = (px[1] - camera_middle_y(c)) * scale_m;
	for (int k = 0; k < 3; k++)
		ret_m[k] = c->eye_m[k] + right_m * c->right[k] + down_m * c->down[k] +
			   depth_m * c->forward[k];
}

void camera_ray(const struct camera *c, const double px[2], double ret[3])
{
	if (c->parallel_m > 0) {
		memcpy(ret, c->forward, sizeof c->forward);
		return;
	}
	double x = px[0] - camera_middle_x(c), y = px[1] - camera_middle_y(c);
	for (int k = 0; k < 3; k++)
		ret[k] = c->forward[k] * c->focal_px + c->right[k] * x + c->down[k] * y;
	normalise(ret);
}

static struct camera_plane plane_through(const double inward[3], const double point_m[3])
{
	struct camera_plane p;
	memcpy(p.inward, inward, sizeof p.inward);
	normalise(p.inward);
	p.offset_m = -dot(p.inward, point_m);
	return p;
}

/* Through the eye and an edge of the picture, or along the rays at that edge; along: from there towards the middle, so many pixels. */
static struct camera_plane side_plane(
	const struct camera *c, const double along[3], double sign, double away_px)
{
	double inward[3], point[3];
	double out_m = c->parallel_m > 0 ? away_px * c->parallel_m / c->focal_px : 0;
	for (int k = 0; k < 3; k++) {
		inward[k] = sign * c->focal_px * along[k] +
			    (c->parallel_m > 0 ? 0 : away_px * c->forward[k]);
		point[k] = c->eye_m[k] - sign * out_m * along[k];
	}
	return plane_through(inward, point);
}

static struct camera_plane depth_plane(const struct camera *c, double depth_m, double sign)
{
	double inward[3], point[3];
	for (int k = 0; k < 3; k++) {
		inward[k] = sign * c->forward[k];
		point[k] = c->eye_m[k] + depth_m * c->forward[k];
	}
	return plane_through(inward, point);
}

void camera_frustum_planes(const struct camera *c, struct camera_plane ret[SIDES])
{
	ret[SIDE_NEAR] = depth_plane(c, c->near_m, 1);
	ret[SIDE_LEFT] = side_plane(c, c->right, 1, camera_middle_x(c));
	ret[SIDE_RIGHT] = side_plane(c, c->right, -1, c->width - camera_middle_x(c));
	ret[SIDE_TOP] = side_plane(c, c->down, 1, camera_middle_y(c));
	ret[SIDE_BOTTOM] = side_plane(c, c->down, -1, c->height - camera_middle_y(c));
	ret[SIDE_FAR] = depth_plane(c, c->far_m, -1);
}

/* ---- checking ---- */

static bool refuse(GError **error, const char *format, ...) G_GNUC_PRINTF(2, 3);

static bool refuse(GError **error, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "camera: %s", what);
	return false;
}

static bool are_axes(const struct camera *c)
{
	struct pose axes = POSE_IDENTITY;
	for (int k = 0; k < 3; k++) {
		axes.rotation[k][0] = c->right[k];
		axes.rotation[k][1] = c->down[k];
		axes.rotation[k][2] = c->forward[k];
	}
	return pose_is_rigid(&axes, 1e-9);
}

static bool check_window(const struct camera *c, GError **error)
{
	const struct camera_whole *w = &c->whole;
	if ((uint64_t)w->left + c->width <= w->width && (uint64_t)w->top + c->height <= w->height)
		return true;
	return refuse(error, "a window of %u x %u pixels at %u %u is not in a picture of %u x %u",
		c->width, c->height, w->left, w->top, w->width, w->height);
}

static bool check_size(const struct camera *c, GError **error)
{
	uint32_t width = camera_whole_width(c), height = camera_whole_height(c);
	if (c->width >= 1 && width <= CAMERA_SIDE_MAX && c->height >= 1 &&
		height <= CAMERA_SIDE_MAX)
		return !camera_is_window(c) || check_window(c, error);
	return refuse(error, "a picture of %u x %u pixels; each side must be 1 to %u", width,
		height, CAMERA_SIDE_MAX);
}

static bool check_fov(const struct camera *c, GError **error)
{
	double fov_deg = camera_fov_deg(c);
	if (isfinite(c->focal_px) && fov_deg > CAMERA_FOV_MIN_DEG - 1e-9 &&
		fov_deg < CAMERA_FOV_MAX_DEG + 1e-9)
		return true;
	return refuse(error, "a vertical field of view of %g degrees; it must be %g to %g", fov_deg,
		CAMERA_FOV_MIN_DEG, CAMERA_FOV_MAX_DEG);
}

bool camera_validate(const struct camera *c, GError **error)
{
	if (!check_size(c, error))
		return false;
	for (int k = 0; k < 3; k++)
		if (!isfinite(c->eye_m[k]))
			return refuse(error, "its place is no number");
	if (!are_axes(c))
		return refuse(error, "it looks in no direction; is its target where it stands?");
	if (!check_fov(c, error))
		return false;
	if (!(c->parallel_m >= 0) || !isfinite(c->parallel_m))
		return refuse(error, "a metre is no number of pixels in its parallel picture");
	if (c->is_cut && (!(c->parallel_m > 0) || !(c->cut_m >= 0) || !isfinite(c->cut_m)))
		return refuse(
			error, "only a parallel one cuts, and what it cuts is 0 m thick or more");
	if (c->near_m > 0 && c->far_m > c->near_m && isfinite(c->far_m))
		return true;
	return refuse(error, "it draws from %g to %g m; that must rise from above 0", c->near_m,
		c->far_m);
}

bool camera_size_parse(const char *text, uint32_t *ret_width, uint32_t *ret_height)
{
	unsigned width, height;
	char rest;
	if (sscanf(text, "%5ux%5u%c", &width, &height, &rest) != 2 || width < 1 || height < 1 ||
		width > CAMERA_SIDE_MAX || height > CAMERA_SIDE_MAX)
		return false;
	*ret_width = width;
	*ret_height = height;
	return true;
}
