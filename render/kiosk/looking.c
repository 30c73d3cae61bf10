#include "render/kiosk/looking.h"
#include <math.h>
#include <string.h>

#define DEGREE        (G_PI / 180)
#define ELEVATION_MAX (88 * DEGREE)
#define DISTANCE_MIN  0.5
#define DISTANCE_MAX  3000.0
#define FOV_MIN_DEG   8.0
#define FOV_MAX_DEG   100.0
#define HEIGHT_MIN_M  0.3
#define HEIGHT_MAX_M  3000.0
/* A finger across the whole height of the screen goes so far round a thing. */
#define ROUND_RAD (150 * DEGREE)

static double wrapped(double rad)
{
	return remainder(rad, 2 * G_PI);
}

static void keep_in_range(struct looking *l)
{
	l->heading_rad = wrapped(l->heading_rad);
	if (l->mode == LOOKING_PARALLEL) {
		l->height_m = CLAMP(l->height_m, HEIGHT_MIN_M, HEIGHT_MAX_M);
		return;
	}
	l->elevation_rad = CLAMP(l->elevation_rad, -ELEVATION_MAX, ELEVATION_MAX);
	l->distance_m = CLAMP(l->distance_m, DISTANCE_MIN, DISTANCE_MAX);
	l->fov_deg = CLAMP(l->fov_deg, FOV_MIN_DEG, FOV_MAX_DEG);
}

static void axis(const struct looking *l, double ret[3])
{
	ret[0] = sin(l->heading_rad) * cos(l->elevation_rad);
	ret[1] = cos(l->heading_rad) * cos(l->elevation_rad);
	ret[2] = sin(l->elevation_rad);
}

void looking_eye(const struct looking *l, double ret_m[3])
{
	double ahead[3];
	axis(l, ahead);
	for (int k = 0; k < 3; k++)
		ret_m[k] = l->focus_m[k] - l->distance_m * ahead[k];
}

/* The focus moves so that the eye stays where it is. */
static void set_eye(struct looking *l, const double eye_m[3])
{
	double ahead[3];
	axis(l, ahead);
	for (int k = 0; k < 3; k++)
		l->focus_m[k] = eye_m[k] + l->distance_m * ahead[k];
}

struct looking looking_from(const double eye_m[3], double heading_rad, double elevation_rad,
	double distance_m, double fov_deg)
{
	struct looking l = { .mode = LOOKING_FROM,
		.heading_rad = heading_rad,
		.elevation_rad = elevation_rad,
		.distance_m = distance_m,
		.fov_deg = fov_deg };
	keep_in_range(&l);
	set_eye(&l, eye_m);
	return l;
}

/* As it is, without what perspective keeps in range; ahead: from eye to target. */
static void make_parallel(struct looking *l, const struct view *v, const double ahead[3])
{
	l->mode = LOOKING_PARALLEL;
	l->elevation_rad = atan2(ahead[2], hypot(ahead[0], ahead[1]));
	l->distance_m = sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1] + ahead[2] * ahead[2]);
	l->height_m = v->height_m;
	l->depth_m = v->depth_m;
	l->cut_m = v->cut_m;
	l->is_cut = v->is_cut;
	set_eye(l, v->eye_m);
	keep_in_range(l);
}

struct looking looking_of_view(const struct view *v)
{
	double d[3];
	for (int k = 0; k < 3; k++)
		d[k] = v->target_m[k] - v->eye_m[k];
	struct looking l = looking_from(v->eye_m, atan2(d[0], d[1]), atan2(d[2], hypot(d[0], d[1])),
		sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), v->fov_deg);
	l.mode = LOOKING_AROUND;
	if (view_is_parallel(v))
		make_parallel(&l, v, d);
	return l;
}

view *looking_view(const struct looking *l, const char *name, const char *title, double aspect)
{
	double eye[3];
	looking_eye(l, eye);
	if (l->mode != LOOKING_PARALLEL)
		return view_new(name, title, eye, l->focus_m, l->fov_deg);
	view *v = view_new_parallel(name, title, eye, l->focus_m, l->height_m);
	v->depth_m = l->depth_m;
	v->is_cut = l->is_cut;
	v->cut_m = l->cut_m;
	v->span_m[0] = l->height_m * aspect;
	return v;
}

struct camera looking_camera(const struct looking *l, uint32_t width, uint32_t height)
{
	double eye[3];
	looking_eye(l, eye);
	struct camera c =
		camera_towards(eye, l->heading_rad, l->elevation_rad, l->fov_deg, width, height);
	c.far_m = fmax(c.far_m, 10 * l->distance_m);
	if (l->mode != LOOKING_PARALLEL)
		return c;
	c = camera_parallel(&c, l->height_m, l->depth_m > 0 ? l->depth_m : c.far_m);
	c.is_cut = l->is_cut;
	c.cut_m = l->cut_m;
	return c;
}

/* Angle of a pixel in the middle of the picture. */
static double pixel_rad(const struct looking *l, double height_px)
{
	return 2 * tan(l->fov_deg * DEGREE / 2) / fmax(height_px, 1);
}

/* At the focus' depth; of a drawing at any. */
static double pixel_m(const struct looking *l, double height_px)
{
	return l->mode == LOOKING_PARALLEL ? l->height_m / fmax(height_px, 1)
					   : l->distance_m * pixel_rad(l, height_px);
}

void looking_drag(struct looking *l, double right_px, double down_px, double height_px)
{
	double eye[3];
	if (l->mode == LOOKING_PARALLEL) {
		looking_pan(l, right_px, down_px, height_px);
		return;
	}
	looking_eye(l, eye);
	double turn =
		l->mode == LOOKING_FROM ? pixel_rad(l, height_px) : ROUND_RAD / fmax(height_px, 1);
	/* The picture goes with the finger: outside the eye goes the other way round, inside the head turns against it. */
	l->heading_rad += (l->mode == LOOKING_FROM ? -1 : 1) * turn * right_px;
	l->elevation_rad += (l->mode == LOOKING_FROM ? 1 : -1) * turn * down_px;
	keep_in_range(l);
	if (l->mode == LOOKING_FROM)
		set_eye(l, eye);
}

void looking_pan(struct looking *l, double right_px, double down_px, double height_px)
{
	struct camera c = looking_camera(l, 16, 16);
	double metres = pixel_m(l, height_px);
	for (int k = 0; k < 3; k++)
		l->focus_m[k] -= metres * (right_px * c.right[k] + down_px * c.down[k]);
}

void looking_zoom(
	struct looking *l, double factor, double right_px, double down_px, double height_px)
{
	bool is_parallel = l->mode == LOOKING_PARALLEL;
	double *scale = is_parallel ? &l->height_m : &l->distance_m, before = *scale;
	if (!(factor > 0) || !isfinite(factor))
		return;
	if (l->mode == LOOKING_FROM) {
		l->fov_deg /= factor;
		keep_in_range(l);
		return;
	}
	*scale /= factor;
	keep_in_range(l);
	/* What is under the fingers at the focus' depth stays there. */
	double aside = before / *scale - 1;
	looking_pan(l, -right_px * aside, -down_px * aside, height_px);
}

void looking_twist(struct looking *l, double angle_rad)
{
	double eye[3];
	if (l->mode == LOOKING_PARALLEL)
		return;
	looking_eye(l, eye);
	l->heading_rad -= angle_rad;
	keep_in_range(l);
	if (l->mode == LOOKING_FROM)
		set_eye(l, eye);
}

/* In the plane of the picture, so that the cut stays where it is. */
static void go_aside(struct looking *l, const double place_m[3])
{
	struct camera c = looking_camera(l, 16, 16);
	double right = 0, down = 0;
	for (int k = 0; k < 3; k++) {
		right += (place_m[k] - l->focus_m[k]) * c.right[k];
		down += (place_m[k] - l->focus_m[k]) * c.down[k];
	}
	for (int k = 0; k < 3; k++)
		l->focus_m[k] += right * c.right[k] + down * c.down[k];
}

struct looking looking_at(const struct looking *l, const double place_m[3], double nearer)
{
	struct looking to = *l;
	if (l->mode == LOOKING_PARALLEL) {
		go_aside(&to, place_m);
		to.height_m /= fmax(nearer, 1e-3);
		keep_in_range(&to);
		return to;
	}
	if (l->mode == LOOKING_FROM) {
		double eye[3], d[3];
		looking_eye(l, eye);
		for (int k = 0; k < 3; k++)
			d[k] = place_m[k] - eye[k];
		return looking_from(eye, atan2(d[0], d[1]), atan2(d[2], hypot(d[0], d[1])),
			sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), l->fov_deg);
	}
	memcpy(to.focus_m, place_m, sizeof to.focus_m);
	to.distance_m /= fmax(nearer, 1e-3);
	keep_in_range(&to);
	return to;
}

static double mixed(double a, double b, double t)
{
	return a + (b - a) * t;
}

/* From so far that its focus is as large; others as they are. */
static struct looking in_perspective(const struct looking *l)
{
	struct looking p = *l;
	if (l->mode != LOOKING_PARALLEL)
		return p;
	p.mode = LOOKING_AROUND;
	p.fov_deg = CAMERA_PARALLEL_FOV_DEG;
	p.distance_m = l->height_m / (2 * tan(p.fov_deg * DEGREE / 2));
	keep_in_range(&p);
	return p;
}

struct looking looking_between(const struct looking *a, const struct looking *b, double part)
{
	double p = CLAMP(part, 0, 1), t = p * p * (3 - 2 * p), ea[3], eb[3], eye[3];
	struct looking l = *b, from = *a;
	if (p >= 1)
		return l;
	if ((a->mode == LOOKING_PARALLEL) != (b->mode == LOOKING_PARALLEL)) {
		from = in_perspective(a);
		l = in_perspective(b);
		return looking_between(&from, &l, part);
	}
	looking_eye(a, ea);
	looking_eye(b, eb);
	for (int k = 0; k < 3; k++) {
		l.focus_m[k] = mixed(a->focus_m[k], b->focus_m[k], t);
		eye[k] = mixed(ea[k], eb[k], t);
	}
	l.heading_rad = a->heading_rad + t * wrapped(b->heading_rad - a->heading_rad);
	l.elevation_rad = mixed(a->elevation_rad, b->elevation_rad, t);
	l.distance_m = a->distance_m * pow(b->distance_m / a->distance_m, t);
	l.fov_deg = mixed(a->fov_deg, b->fov_deg, t);
	if (l.mode == LOOKING_PARALLEL)
		l.height_m = a->height_m * pow(b->height_m / a->height_m, t);
	keep_in_range(&l);
	if (b->mode == LOOKING_FROM)
		set_eye(&l, eye);
	return l;
}
