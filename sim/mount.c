#include "sim/mount.h"
#include <math.h>
#include <string.h>

#define DEGREE (M_PI / 180)

const double camera_pitch_rad = 5 * M_PI / 180;
const struct lidar_mount lidar_mount_drawn = { .rotation = {
						       { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };

struct camera_mount camera_mount_drawn(void)
{
	double c = cos(camera_pitch_rad), s = sin(camera_pitch_rad);

	return (struct camera_mount){ .rotation = { { 1, 0, 0 }, { 0, s, -c }, { 0, c, s } },
		.translation_m = { 0, 0.045, 0.07 } };
}

/* About x, then y, then z. */
static void turn(const double degrees[3], double ret[3][3])
{
	double a = degrees[0] * DEGREE, b = degrees[1] * DEGREE, c = degrees[2] * DEGREE;
	double sa = sin(a), ca = cos(a), sb = sin(b), cb = cos(b), sc = sin(c), cc = cos(c);
	const double m[3][3] = { { cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa },
		{ sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa },
		{ -sb, cb * sa, cb * ca } };

	memcpy(ret, m, sizeof m);
}

struct lidar_mount lidar_mount_of(const sim_options *o)
{
	struct lidar_mount m = lidar_mount_drawn;

	turn(o->lidar_turn_deg, m.rotation);
	for (int k = 0; k < 3; k++)
		m.translation_m[k] = o->lidar_shift_mm[k] * 1e-3;
	m.beam_zero_rad = o->beam_zero_deg * DEGREE;
	m.range_offset_m = o->range_offset_mm * 1e-3;
	m.home_rad = o->home_azimuth_deg * DEGREE;
	return m;
}

/* The camera's body is turned and shifted as it sits there. */
struct camera_mount camera_mount_of(const sim_options *o)
{
	const struct camera_mount drawn = camera_mount_drawn();
	struct camera_mount m = { 0 };
	double body[3][3];

	turn(o->camera_turn_deg, body);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 3; k++)
				m.rotation[i][j] += drawn.rotation[i][k] * body[j][k];
		m.translation_m[i] = drawn.translation_m[i] + o->camera_shift_mm[i] * 1e-3;
	}
	return m;
}

struct lens lens_drawn(const sim_options *o)
{
	return lens_for_size(o->camera_width, o->camera_height, o->distortion);
}

struct lens lens_of(const sim_options *o)
{
	struct lens lens = lens_drawn(o);

	lens.focal_px *= 1 + o->focal_percent / 100;
	lens.cx += o->centre_px[0];
	lens.cy += o->centre_px[1];
	return lens;
}
