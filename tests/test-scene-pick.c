/* What a finger means: against going through all points. */
#include "render/scene-pick.h"
#include "tests/strokes-made.h"

#define RADIUS_PX 12.

static struct camera court_camera(void)
{
	static const double eye[3] = { 102, 195, 5.5 }, target[3] = { 103, 204, 4 };
	return camera_look_at(eye, target, 60, 640, 480);
}

/* The least depth of all points within the radius; HUGE_VAL: there is none. */
static double nearest_m(const scene *s, const struct camera *c, const double px[2])
{
	double least = HUGE_VAL;
	for (uint32_t n = 0; n < s->chunks; n++)
		for (uint32_t i = 0; i < s->chunk[n].count; i++) {
			double at_m[3], at[2], depth_m;
			scene_position(s, &s->chunk[n], i, at_m);
			if (camera_project(c, at_m, at, &depth_m) &&
				hypot(at[0] - px[0], at[1] - px[1]) <= RADIUS_PX)
				least = fmin(least, depth_m);
		}
	return least;
}

static void test_front(void)
{
	const scene *s = made_shared_court();
	struct camera c = court_camera();
	guint met = 0;
	for (double y = 30; y < 480; y += 40)
		for (double x = 30; x < 640; x += 40) {
			double px[2] = { x, y }, at[2] = { 0 }, depth_m = 0;
			double least = nearest_m(s, &c, px);
			struct scene_picked picked;
			bool there = scene_pick(s, &c, NULL, px, RADIUS_PX, &picked);
			g_assert_true(there == isfinite(least));
			if (!there)
				continue;
			met++;
			g_assert_true(camera_project(&c, picked.place_m, at, &depth_m));
			g_assert_cmpfloat(hypot(at[0] - x, at[1] - y), <=, RADIUS_PX + 0.1);
			g_assert_cmpfloat(fabs(depth_m - picked.depth_m), <, 0.01);
			/* Of what is in front: not behind a surface that is. */
			g_assert_cmpfloat(picked.depth_m, <, least * 1.2);
		}
	g_assert_cmpuint(met, >, 20);
}

/* The ball of leaves, where it is; the wall, where nothing else is; and what is asked for alone. */
static void test_leaves(void)
{
	static const double ball_m[3] = { 102, 203, 4.2 }, wall_m[3] = { 105, 205, 4.5 };
	const scene *s = made_shared_court();
	struct camera c = court_camera();
	struct scene_picked picked;
	double px[2] = { 0 }, depth_m = 0;
	g_assert_true(camera_project(&c, ball_m, px, &depth_m));
	g_assert_true(scene_pick(s, &c, NULL, px, RADIUS_PX, &picked));
	g_assert_cmpuint(picked.leaf, ==, MADE_LEAF + 1);
	g_assert_cmpfloat(picked.depth_m, <, depth_m);
	/* Without the ball the wall behind it is met. */
	g_autofree uint8_t *leaves = g_new0(uint8_t, SEGMENTS_MAX + 1);
	leaves[MADE_LEAF] = 1;
	g_assert_true(scene_pick(s, &c, leaves, px, RADIUS_PX, &picked));
	g_assert_cmpuint(picked.leaf, ==, MADE_LEAF);
	g_assert_cmpfloat(picked.depth_m, >, depth_m + 1);
	g_assert_true(camera_project(&c, wall_m, px, &depth_m));
	g_assert_true(scene_pick(s, &c, NULL, px, RADIUS_PX, &picked));
	g_assert_cmpuint(picked.leaf, ==, MADE_LEAF);
	g_assert_cmpfloat(fabs(picked.place_m[1] - 205), <, 0.05);
}

/* By parallel rays, from y_m on and so deep: the ball, and what is there once it is cut off. */
static bool pick_cut(double y_m, double depth_m, const double place_m[3], struct scene_picked *ret)
{
	const double eye[3] = { 103, y_m, 4.2 }, target[3] = { 103, y_m + 1, 4.2 };
	struct camera from = camera_look_at(eye, target, 60, 640, 480),
		      c = camera_parallel(&from, 5, depth_m);
	double at[3] = { place_m[0], y_m + 0.5, place_m[2] }, px[2] = { 0 }, depth = 0;
	g_assert_true(camera_project(&c, at, px, &depth));
	return scene_pick(made_shared_court(), &c, NULL, px, RADIUS_PX, ret);
}

static void test_parallel(void)
{
	static const double ball_m[3] = { 102, 203, 4.2 };
	struct scene_picked picked;
	g_assert_true(pick_cut(200, 10, ball_m, &picked));
	g_assert_cmpuint(picked.leaf, ==, MADE_LEAF + 1);
	g_assert_cmpfloat(hypot(picked.place_m[0] - 102, picked.place_m[2] - 4.2), <, 0.2);
	g_assert_true(pick_cut(203.7, 10, ball_m, &picked));
	g_assert_cmpuint(picked.leaf, ==, MADE_LEAF);
	g_assert_cmpfloat(fabs(picked.place_m[1] - 205), <, 0.05);
	g_assert_false(pick_cut(203.7, 1, ball_m, &picked));
}

static void test_nothing(void)
{
	const scene *s = made_shared_court();
	static const double eye[3] = { 102, 195, 5.5 };
	struct camera away = camera_towards(eye, G_PI, 0.5, 60, 640, 480);
	struct scene_picked picked;
	g_assert_false(scene_pick(s, &away, NULL, (double[2]){ 320, 240 }, RADIUS_PX, &picked));
	struct camera c = court_camera();
	g_assert_false(scene_pick(s, &c, NULL, (double[2]){ -900, -900 }, RADIUS_PX, &picked));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/scene-pick/front", test_front);
	g_test_add_func("/scene-pick/leaves", test_leaves);
	g_test_add_func("/scene-pick/parallel", test_parallel);
	g_test_add_func("/scene-pick/nothing", test_nothing);
	return g_test_run();
}
