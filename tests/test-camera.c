/* Cameras: projection and its inverse, what is up, the planes of what they see, and what is no camera. */
#include "tests/views-made.h"
#include <gio/gio.h>

static struct camera any_camera(void)
{
	double eye[3], target[3];
	for (int k = 0; k < 3; k++) {
		eye[k] = random_between(-50, 50);
		target[k] = random_between(-50, 50);
	}
	return camera_look_at(eye, target, random_between(5, 150), WIDTH, HEIGHT);
}

static struct camera any_parallel_camera(void)
{
	struct camera c = any_camera();
	return camera_parallel(&c, random_between(2, 60), random_between(1, 50));
}

static void test_rays_undo_projection(void)
{
	for (int i = 0; i < 2000; i++) {
		struct camera c = any_camera();
		double px[2] = { random_between(0, WIDTH), random_between(0, HEIGHT) };
		double ray[3], point[3], again[2] = { 0 }, depth = 0, far = random_between(20, 100);
		g_assert_true(camera_validate(&c, NULL));
		camera_ray(&c, px, ray);
		g_assert_cmpfloat_with_epsilon(dot(ray, ray), 1, 1e-14);
		for (int k = 0; k < 3; k++)
			point[k] = c.eye_m[k] + far * ray[k];
		g_assert_true(camera_project(&c, point, again, &depth));
		g_assert_cmpfloat_with_epsilon(again[0], px[0], 1e-9);
		g_assert_cmpfloat_with_epsilon(again[1], px[1], 1e-9);
		g_assert_cmpfloat_with_epsilon(depth, far * dot(ray, c.forward), 1e-9);
	}
}

static void test_the_target_is_in_the_middle(void)
{
	const double eye[3] = { 1, 2, 3 }, target[3] = { 5, -2, 1 }, up[3] = { 5, -2, 1.1 },
		     east[3] = { 4.9, -2.1, 1 }, behind[3] = { 0, 3, 3 };
	struct camera c = camera_look_at(eye, target, 60, WIDTH, HEIGHT);
	double px[2] = { 0 }, depth = 0;
	g_assert_true(camera_project(&c, target, px, &depth));
	g_assert_cmpfloat_with_epsilon(px[0], WIDTH / 2, 1e-9);
	g_assert_cmpfloat_with_epsilon(px[1], HEIGHT / 2, 1e-9);
	g_assert_cmpfloat_with_epsilon(depth, 6, 1e-12);
	g_assert_true(camera_project(&c, up, px, &depth) && px[1] < HEIGHT / 2 - 1);
	g_assert_cmpfloat_with_epsilon(px[0], WIDTH / 2, 1e-9); /* no roll */
	g_assert_true(camera_project(&c, east, px, &depth) && px[0] > WIDTH / 2 + 1);
	px[0] = -7;
	g_assert_false(camera_project(&c, behind, px, &depth));
	g_assert_cmpfloat(px[0], ==, -7);
	g_assert_cmpfloat_with_epsilon(camera_fov_deg(&c), 60, 1e-12);
	g_assert_cmpfloat_with_epsilon(camera_heading_rad(&c), 0.75 * G_PI, 1e-12);
	g_assert_cmpfloat_with_epsilon(camera_elevation_rad(&c), -asin(1.0 / 3), 1e-12);
}

static void test_down_and_up(void)
{
	const double eye[3] = { 3, 4, 50 }, below[3] = { 3, 4, 0 }, above[3] = { 3, 4, 90 },
		     north[3] = { 3, 5, 0 }, east[3] = { 4, 4, 0 }, south[3] = { 3, 3, 90 };
	struct camera down = camera_look_at(eye, below, 30, WIDTH, HEIGHT),
		      up = camera_look_at(eye, above, 30, WIDTH, HEIGHT);
	double px[2] = { 0 }, depth = 0;
	g_assert_true(camera_validate(&down, NULL) && camera_validate(&up, NULL));
	g_assert_true(camera_project(&down, north, px, &depth) && px[1] < HEIGHT / 2 - 1);
	g_assert_cmpfloat_with_epsilon(px[0], WIDTH / 2, 1e-9);
	g_assert_true(camera_project(&down, east, px, &depth) && px[0] > WIDTH / 2 + 1);
	g_assert_true(camera_project(&up, south, px, &depth) && px[1] < HEIGHT / 2 - 1);
	/* Nearly down has its heading from what is left. */
	const double aside[3] = { 3.001, 4, 0 };
	struct camera c = camera_look_at(eye, aside, 30, WIDTH, HEIGHT);
	g_assert_cmpfloat_with_epsilon(camera_heading_rad(&c), G_PI / 2, 1e-9);
}

static void test_planes_agree_with_projection(void)
{
	unsigned inside = 0;
	for (int i = 0; i < 20000; i++) {
		struct camera c = i % 2 ? any_parallel_camera() : any_camera();
		struct camera_plane plane[SIDES];
		c.near_m = i % 2 ? c.near_m : 5;
		c.far_m = i % 2 ? c.far_m : 40;
		double point[3] = { random_between(-60, 60), random_between(-60, 60),
			random_between(-60, 60) };
		camera_frustum_planes(&c, plane);
		bool in = true;
		for (int k = 0; k < SIDES; k++) {
			g_assert_cmpfloat_with_epsilon(
				dot(plane[k].inward, plane[k].inward), 1, 1e-12);
			in = in && dot(plane[k].inward, point) + plane[k].offset_m >= 0;
		}
		double px[2] = { 0 }, depth = 0;
		bool seen = camera_project(&c, point, px, &depth) && depth <= c.far_m &&
			    px[0] >= 0 && px[0] <= WIDTH && px[1] >= 0 && px[1] <= HEIGHT;
		g_assert_true(seen == in);
		inside += in;
	}
	g_assert_cmpuint(inside, >, 800);
}

/* A pinhole camera in its place shows as much at one depth. */
static void test_parallel_rays(void)
{
	for (int i = 0; i < 2000; i++) {
		struct camera c = any_parallel_camera();
		double px[2] = { random_between(0, WIDTH), random_between(0, HEIGHT) },
		       again[2] = { 0 };
		double ray[3], point[3], depth = 0, far = c.near_m + random_between(0, 100);
		g_assert_true(camera_validate(&c, NULL));
		camera_ray(&c, px, ray);
		assert_near(ray, c.forward, 0);
		camera_place(&c, px, far, point);
		g_assert_true(camera_project(&c, point, again, &depth));
		g_assert_cmpfloat_with_epsilon(again[0], px[0], 1e-9);
		g_assert_cmpfloat_with_epsilon(again[1], px[1], 1e-9);
		g_assert_cmpfloat_with_epsilon(depth, far, 1e-9);
		struct camera pinhole = c;
		pinhole.parallel_m = 0;
		c.near_m = pinhole.near_m = 1e-3;
		camera_place(&c, px, c.parallel_m, point);
		g_assert_true(camera_project(&pinhole, point, again, &depth));
		g_assert_cmpfloat_with_epsilon(again[0], px[0], 1e-9);
		struct camera moved = camera_shifted(&c, 17, -5), large = camera_scaled(&c, 3);
		g_assert_true(camera_project(&moved, point, again, &depth));
		g_assert_cmpfloat_with_epsilon(again[0], px[0] - 17, 1e-9);
		g_assert_cmpfloat_with_epsilon(again[1], px[1] + 5, 1e-9);
		g_assert_true(camera_project(&large, point, again, &depth));
		g_assert_cmpfloat_with_epsilon(again[1], 3 * px[1], 1e-9);
	}
}

/* 1200 pixels are 60 m: a metre is 20 of them, near and far; what is before the eye is cut off to the last bit. */
static void test_parallel_scale(void)
{
	const double eye[3] = { 100, 200, 3 }, target[3] = { 100, 300, 3 };
	struct camera from = camera_look_at(eye, target, 50, WIDTH, HEIGHT),
		      c = camera_parallel(&from, HEIGHT / 20., 70);
	double px[2] = { 0 }, depth = 0;
	for (int i = 0; i < 1000; i++) {
		double right = random_between(-9, 9), up = random_between(-9, 9),
		       far = random_between(0, 70);
		double at[3] = { eye[0] + right, eye[1] + far, eye[2] + up };
		g_assert_true(camera_project(&c, at, px, &depth));
		g_assert_cmpfloat_with_epsilon(px[0], WIDTH / 2. + 20 * right, 1e-9);
		g_assert_cmpfloat_with_epsilon(px[1], HEIGHT / 2. - 20 * up, 1e-9);
		g_assert_cmpfloat_with_epsilon(depth, c.near_m + far, 1e-9);
		g_assert_cmpfloat(depth, <=, c.far_m);
	}
	const double before[3] = { 101, 200 - 1e-9, 4 };
	g_assert_false(camera_project(&c, before, px, &depth));
}

static void test_a_station_sees_by_its_azimuth(void)
{
	const double at[3] = { 7, -3, 1.5 };
	struct pose scan = pose_from_yaw(0.4, at);
	struct camera c = camera_at_station(&scan, 0.3, 0.1, 60, WIDTH, HEIGHT),
		      same = camera_towards(at, 0.7, 0.1, 60, WIDTH, HEIGHT);
	assert_near(c.eye_m, at, 0);
	assert_near(c.forward, same.forward, 1e-12);
	assert_near(c.right, same.right, 1e-12);
	assert_near(c.down, same.down, 1e-12);
}

static void test_scaled(void)
{
	for (int i = 0; i < 100; i++) {
		struct camera c = any_camera(), s = camera_scaled(&c, 3);
		double point[3], ray[3], px[2] = { 0 }, more[2] = { 0 }, depth;
		double from[2] = { random_between(0, WIDTH), random_between(0, HEIGHT) };
		g_assert_true(s.width == 3 * WIDTH && s.height == 3 * HEIGHT);
		camera_ray(&c, from, ray);
		for (int k = 0; k < 3; k++)
			point[k] = c.eye_m[k] + 9 * ray[k];
		c.near_m = s.near_m = 1e-3;
		g_assert_true(camera_project(&c, point, px, &depth));
		g_assert_true(camera_project(&s, point, more, &depth));
		g_assert_cmpfloat_with_epsilon(more[0], 3 * px[0], 1e-8);
		g_assert_cmpfloat_with_epsilon(more[1], 3 * px[1], 1e-8);
	}
}

static void assert_refused(const struct camera *c, const char *message)
{
	g_autoptr(GError) error = NULL;
	g_assert_false(camera_validate(c, &error));
	g_assert_cmpstr(error->message, ==, message);
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
}

static void test_bad_cameras(void)
{
	const double eye[3] = { 1, 2, 3 }, target[3] = { 4, 5, 6 }, nowhere[3] = { NAN, 0, 0 };
	struct camera good = camera_look_at(eye, target, 60, 800, 600), c = good;
	g_assert_true(camera_validate(&good, NULL));
	c.width = 0;
	assert_refused(&c, "camera: a picture of 0 x 600 pixels; each side must be 1 to 32768");
	c.width = 40000;
	assert_refused(&c, "camera: a picture of 40000 x 600 pixels; each side must be 1 to 32768");
	c = camera_look_at(eye, eye, 60, 800, 600);
	assert_refused(&c, "camera: it looks in no direction; is its target where it stands?");
	c = camera_look_at(nowhere, target, 60, 800, 600);
	assert_refused(&c, "camera: its place is no number");
	c = camera_look_at(eye, target, 175, 800, 600);
	assert_refused(&c, "camera: a vertical field of view of 175 degrees; it must be 1 to 170");
	c = camera_look_at(eye, target, 0.5, 800, 600);
	assert_refused(&c, "camera: a vertical field of view of 0.5 degrees; it must be 1 to 170");
	c = camera_look_at(eye, target, NAN, 800, 600);
	g_assert_false(camera_validate(&c, NULL));
	c = good;
	c.far_m = c.near_m;
	assert_refused(&c, "camera: it draws from 0.1 to 0.1 m; that must rise from above 0");
	c = good;
	c.down[2] = -c.down[2];
	assert_refused(&c, "camera: it looks in no direction; is its target where it stands?");
	c = camera_look_at(eye, target, 170, 800, 600);
	g_assert_true(camera_validate(&c, NULL));
	c = camera_look_at(eye, target, 1, 32768, 1);
	g_assert_true(camera_validate(&c, NULL));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/camera/rays", test_rays_undo_projection);
	g_test_add_func("/camera/look-at", test_the_target_is_in_the_middle);
	g_test_add_func("/camera/down-and-up", test_down_and_up);
	g_test_add_func("/camera/planes", test_planes_agree_with_projection);
	g_test_add_func("/camera/parallel/rays", test_parallel_rays);
	g_test_add_func("/camera/parallel/scale", test_parallel_scale);
	g_test_add_func("/camera/station", test_a_station_sees_by_its_azimuth);
	g_test_add_func("/camera/scaled", test_scaled);
	g_test_add_func("/camera/refused", test_bad_cameras);
	return g_test_run();
}
