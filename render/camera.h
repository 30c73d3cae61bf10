#ifndef RENDER_CAMERA_H
#define RENDER_CAMERA_H
/* A camera in the frame of a site: where it stands, how it is turned, and how large its picture is.
 * Without distortion; its axis meets the picture in the middle (and a window of it anywhere).
 *
 *         forward (z, ahead)        The picture's left upper corner is (0, 0); the middle of pixel
 *        /                          (i, j) is (i + 0.5, j + 0.5); the axis is at (width / 2,
 *       +---- right (x)             height / 2). Depth is along forward, not along the ray.
 *       |
 *       down (y)
 *
 * A pinhole camera sees along rays that meet in its eye. A parallel one sees along its axis
 * everywhere (an orthographic projection): things are as large at any depth, focal_px / parallel_m
 * pixels a metre, as a pinhole camera in the same place would show them at the depth of parallel_m.
 * Its eye stands so far behind what it draws that depths are as deep, and told apart as well, as
 * those of a pinhole camera whose picture has the same things in it.
 *
 * Directions are told as those of a map: heading clockwise from the site's y axis seen from above,
 * elevation upwards from the horizon. Cameras made here have no roll: right is level. One that
 * looks straight up or down has its heading left to say what is up in the picture.
 *
 * Plain values; all functions are pure. */
#include "process/pose.h"
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define CAMERA_SIDE_MAX    32768u
#define CAMERA_FOV_MIN_DEG 1.0 /* vertical */
#define CAMERA_FOV_MAX_DEG 170.0
#define CAMERA_NEAR_M      0.1
#define CAMERA_FAR_M       1e4
/* Of the pinhole camera that a parallel one is compared with. */
#define CAMERA_PARALLEL_FOV_DEG 60.0

/* Of a camera that draws a window of a picture, which is too large to be drawn at once: how large that picture is, and where in it the
 * window begins. width 0: it draws all of it. */
struct camera_whole {
	uint32_t width, height, left, top;
};

struct camera {
	double eye_m[3];
	double right[3], down[3], forward[3]; /* unit, right-handed, in the site's frame */
	double focal_px;
	uint32_t width, height; /* of the picture, or the window */
	double near_m, far_m;   /* depths that are drawn */
	double parallel_m; /* 0: a pinhole camera; else the depth that all things are as large as at */
	bool is_cut; /* its near plane cuts through things, and lines show where (struct cut_step) */
	double cut_m; /* what lies so near it counts as cut; 0: as the style has it */
	struct camera_whole whole;
};

/* fov_deg is from the upper to the lower edge. near_m and far_m are CAMERA_NEAR_M and CAMERA_FAR_M.
 * What makes no camera (sizes of 0, a fov of 180 degrees) is for camera_validate to find. */
struct camera camera_towards(const double eye_m[3], double heading_rad, double elevation_rad,
	double fov_deg, uint32_t width, uint32_t height);
/* The target is in the middle of the picture. One straight above or below is seen with a heading of
 * 0, so the site's y axis is up in a plan. With the target at the eye the axes are no numbers. */
struct camera camera_look_at(const double eye_m[3], const double target_m[3], double fov_deg,
	uint32_t width, uint32_t height);
/* What a scanner saw from where it stood; azimuth and elevation are those of its own panorama. */
struct camera camera_at_station(const struct pose *scan_to_site, double azimuth_rad,
	double elevation_rad, double fov_deg, uint32_t width, uint32_t height);
/* A parallel camera that looks the same way, with what lies that far right and left, above and below the
 * eye in its picture, which is height_m high. It draws what lies before the eye, to the last bit: there
 * its near plane is; and no farther than depth_m from there. */
struct camera camera_parallel(const struct camera *c, double height_m, double depth_m);
/* Turned about the vertical through the eye, clockwise seen from above. */
struct camera camera_turned(const struct camera *c, double angle_rad);
/* Turned about the eye by so much of a pixel that the picture shows what was so far right and below of each place;
 * a parallel one is moved. */
struct camera camera_shifted(const struct camera *c, double right_px, double down_px);
/* The same view in a picture of other size: sides are rounded (at least 1), the focal length is
 * not, so that a pixel is 1/factor of one of before everywhere. */
struct camera camera_scaled(const struct camera *c, double factor);
/* A window of its picture, which must be in it: what the camera shows there, in places that are told from the window's left upper corner.
 * Of windows there are none. */
struct camera camera_window(
	const struct camera *c, uint32_t left, uint32_t top, uint32_t width, uint32_t height);
/* The camera that it is a window of, or itself. */
struct camera camera_whole(const struct camera *c);
static inline bool camera_is_window(const struct camera *c)
{
	return c->whole.width > 0;
}
static inline uint32_t camera_whole_width(const struct camera *c)
{
	return camera_is_window(c) ? c->whole.width : c->width;
}
static inline uint32_t camera_whole_height(const struct camera *c)
{
	return camera_is_window(c) ? c->whole.height : c->height;
}
/* Where its axis meets the picture. */
static inline double camera_middle_x(const struct camera *c)
{
	return camera_whole_width(c) / 2.0 - c->whole.left;
}
static inline double camera_middle_y(const struct camera *c)
{
	return camera_whole_height(c) / 2.0 - c->whole.top;
}

/* One sentence (G_IO_ERROR_INVALID_ARGUMENT) when something is not finite, the axes are none, a side
 * is not 1..CAMERA_SIDE_MAX, a window is not in its picture, the fov is out of its range, near and far are not 0 < near < far, parallel_m
 * or cut_m is less than 0, or a pinhole camera cuts. */
bool camera_validate(const struct camera *c, GError **error);
/* "1600x1200": sides from 1 to CAMERA_SIDE_MAX. false: it is none, and both are left as they were. */
bool camera_size_parse(const char *text, uint32_t *ret_width, uint32_t *ret_height);
double camera_fov_deg(const struct camera *c);
double camera_heading_rad(const struct camera *c); /* -pi..pi */
double camera_elevation_rad(const struct camera *c);
/* The depth at which a pinhole camera shows things as large as they are seen at this one: px per metre
 * are focal_px / that. */
static inline double camera_scale_m(const struct camera *c, double depth_m)
{
	return c->parallel_m > 0 ? c->parallel_m : depth_m;
}
static inline float camera_scale_f(const struct camera *c, float depth_m)
{
	return (float)camera_scale_m(c, (double)depth_m);
}
/* The place at a depth that is seen at a place of the picture. */
void camera_place(const struct camera *c, const double px[2], double depth_m, double ret_m[3]);

/* false: nearer than near_m, or behind the eye; *ret_px is untouched then. Places outside the
 * picture are told as others, and those beyond far_m too. */
static inline bool camera_project(
	const struct camera *c, const double point_m[3], double ret_px[2], double *ret_depth_m)
{
	double v[3] = { point_m[0] - c->eye_m[0], point_m[1] - c->eye_m[1],
		point_m[2] - c->eye_m[2] };
	double z = v[0] * c->forward[0] + v[1] * c->forward[1] + v[2] * c->forward[2];
	if (!(z >= c->near_m))
		return false;
	double x = v[0] * c->right[0] + v[1] * c->right[1] + v[2] * c->right[2];
	double y = v[0] * c->down[0] + v[1] * c->down[1] + v[2] * c->down[2];
	double scale_m = camera_scale_m(c, z);
	ret_px[0] = camera_middle_x(c) + c->focal_px * x / scale_m;
	ret_px[1] = camera_middle_y(c) + c->focal_px * y / scale_m;
	*ret_depth_m = z;
	return true;
}

/* The unit direction that is looked along at a place of the picture. */
void camera_ray(const struct camera *c, const double px[2], double ret[3]);

/* A point is on the inner side when the dot product of inward with it, plus offset_m, is not
 * negative; that is its distance from the plane. */
struct camera_plane {
	double inward[3]; /* unit, in the site's frame */
	double offset_m;
};
enum camera_side { SIDE_NEAR, SIDE_LEFT, SIDE_RIGHT, SIDE_TOP, SIDE_BOTTOM, SIDE_FAR, SIDES };
/* All that the picture shows is inside of all of them. */
void camera_frustum_planes(const struct camera *c, struct camera_plane ret[SIDES]);

#endif
