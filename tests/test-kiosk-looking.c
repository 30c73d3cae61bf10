/* How fingers turn a view: what stays where it was, whatever they do. */
#include "render/kiosk/looking.h"
#include <math.h>

#define WIDTH  1280u
#define HEIGHT 577u

static struct looking any_looking(GRand *chance, enum looking_mode mode)
{
	double eye[3];
	for (int k = 0; k < 3; k++)
		eye[k] = g_rand_double_range(chance, -50, 50);
	struct looking l = looking_from(eye, g_rand_double_range(chance, -3, 3),
		g_rand_double_range(chance, -1, 1), g_rand_double_range(chance, 2, 60),
		g_rand_double_range(chance, 25, 70));
	l.mode = mode;
	return l;
}

static double distance(const double a[3], const double b[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (a[k] - b[k]) * (a[k] - b[k]);
	return sqrt(sum);
}

/* Of a place, in the picture of this view. */
static void project(const struct looking *l, const double at_m[3], double ret_px[2])
{
	struct camera c = looking_camera(l, WIDTH, HEIGHT);
	double depth_m;
	g_assert_true(camera_project(&c, at_m, ret_px, &depth_m));
}

/* The place at the focus' depth that a pixel shows. */
static void under(const struct looking *l, const double px[2], double ret_m[3])
{
	struct camera c = looking_camera(l, WIDTH, HEIGHT);
	for (int k = 0; k < 3; k++)
		ret_m[k] = c.eye_m[k] +
			   l->distance_m *
				   (c.forward[k] + (px[0] - WIDTH / 2.) / c.focal_px * c.right[k] +
					   (px[1] - HEIGHT / 2.) / c.focal_px * c.down[k]);
}

#define TIMES 1000

static void test_drag(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(1);
	for (int n = 0; n < TIMES; n++) {
		struct looking round = any_looking(chance, LOOKING_AROUND), was = round;
		double right = g_rand_double_range(chance, -200, 200), eye[3], before[3];
		looking_drag(&round, right, 30, HEIGHT);
		looking_eye(&round, eye);
		g_assert_cmpfloat(distance(round.focus_m, was.focus_m), ==, 0);
		g_assert_cmpfloat(fabs(distance(eye, round.focus_m) - was.distance_m), <, 1e-9);
		/* The picture goes with the finger: the eye goes round the other way. */
		double turned = remainder(round.heading_rad - was.heading_rad, 2 * G_PI);
		g_assert_true((turned > 0) == (right > 0));
		struct looking from = any_looking(chance, LOOKING_FROM);
		looking_eye(&from, before);
		looking_drag(&from, right, -30, HEIGHT);
		looking_eye(&from, eye);
		g_assert_cmpfloat(distance(eye, before), <, 1e-9);
	}
}

/* Standing still and looking about, what was in the middle goes as far as the finger. */
static void test_look_about(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(2);
	for (int n = 0; n < TIMES; n++) {
		struct looking l = any_looking(chance, LOOKING_FROM), was = l;
		double px[2];
		looking_drag(&l, 0, 8, HEIGHT);
		project(&l, was.focus_m, px);
		g_assert_cmpfloat(fabs(px[0] - WIDTH / 2.), <, 0.1);
		g_assert_cmpfloat(fabs(px[1] - HEIGHT / 2. - 8), <, 0.1);
	}
}

/* What lies under two fingers stays under them. */
static void test_pan_and_zoom(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(3);
	for (int n = 0; n < TIMES; n++) {
		struct looking l = any_looking(chance, LOOKING_AROUND);
		double px[2] = { g_rand_double_range(chance, 100, WIDTH - 100),
			g_rand_double_range(chance, 100, HEIGHT - 100) },
		       place[3], now[2];
		under(&l, px, place);
		looking_pan(&l, 40, -25, HEIGHT);
		project(&l, place, now);
		g_assert_cmpfloat(hypot(now[0] - px[0] - 40, now[1] - px[1] + 25), <, 1e-6);
		under(&l, px, place);
		looking_zoom(&l, g_rand_double_range(chance, 0.5, 2), px[0] - WIDTH / 2.,
			px[1] - HEIGHT / 2., HEIGHT);
		project(&l, place, now);
		g_assert_cmpfloat(hypot(now[0] - px[0], now[1] - px[1]), <, 1e-6);
	}
}

static void test_twist(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(4);
	for (int n = 0; n < TIMES; n++) {
		struct looking from = any_looking(chance, LOOKING_FROM);
		double before[3], after[3];
		looking_eye(&from, before);
		looking_twist(&from, 0.3);
		looking_eye(&from, after);
		g_assert_cmpfloat(distance(before, after), <, 1e-9);
	}
}

/* Whatever comes from fingers that are wild, the view is one that can be drawn. */
static void test_stays_a_view(void)
{
	static const double factors[] = { 0, -1, 1e-9, 1e9, NAN, INFINITY };
	g_autoptr(GRand) chance = g_rand_new_with_seed(5);
	for (int n = 0; n < TIMES; n++) {
		struct looking l =
			any_looking(chance, g_rand_boolean(chance) ? LOOKING_FROM : LOOKING_AROUND);
		for (int k = 0; k < 20; k++) {
			g_autoptr(GError) error = NULL;
			looking_drag(&l, g_rand_double_range(chance, -5000, 5000),
				g_rand_double_range(chance, -5000, 5000), HEIGHT);
			looking_zoom(&l, factors[g_rand_int_range(chance, 0, 6)], 10, 10, HEIGHT);
			looking_zoom(&l, g_rand_double_range(chance, 0.1, 10), 0, 0, HEIGHT);
			looking_twist(&l, g_rand_double_range(chance, -9, 9));
			struct camera c = looking_camera(&l, WIDTH, HEIGHT);
			g_assert_true(camera_validate(&c, &error));
			g_assert_no_error(error);
		}
	}
}

static void test_goes_there(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(6);
	for (int n = 0; n < TIMES; n++) {
		struct looking a = any_looking(chance, LOOKING_AROUND),
			       b = any_looking(chance, LOOKING_AROUND);
		double place[3] = { a.focus_m[0] + 1, a.focus_m[1] - 2, a.focus_m[2] + 0.5 }, px[2];
		struct looking at = looking_at(&a, place, 2);
		project(&at, place, px);
		g_assert_cmpfloat(hypot(px[0] - WIDTH / 2., px[1] - HEIGHT / 2.), <, 1e-6);
		struct looking end = looking_between(&a, &b, 1), begin = looking_between(&a, &b, 0);
		g_assert_cmpfloat(distance(end.focus_m, b.focus_m), <, 1e-9);
		g_assert_cmpfloat(distance(begin.focus_m, a.focus_m), <, 1e-9);
		/* Never more than half a turn. */
		double last = a.heading_rad, all = 0;
		for (int k = 1; k <= 50; k++) {
			struct looking l = looking_between(&a, &b, k / 50.);
			all += fabs(remainder(l.heading_rad - last, 2 * G_PI));
			last = l.heading_rad;
		}
		g_assert_cmpfloat(all, <, G_PI + 1e-6);
	}
}

/* ---- drawings ---- */

static view *any_section(GRand *chance)
{
	double eye[3], target[3], heading = g_rand_double_range(chance, -3, 3);
	for (int k = 0; k < 3; k++)
		eye[k] = g_rand_double_range(chance, -50, 50);
	target[0] = eye[0] + 5 * sin(heading);
	target[1] = eye[1] + 5 * cos(heading);
	target[2] = eye[2];
	view *v = view_new_parallel("x", "x", eye, target, g_rand_double_range(chance, 3, 60));
	v->is_cut = true;
	v->depth_m = 12;
	return v;
}

static double plane_of(const struct looking *l)
{
	struct camera c = looking_camera(l, WIDTH, HEIGHT);
	double at = c.near_m;
	for (int k = 0; k < 3; k++)
		at += c.eye_m[k] * c.forward[k];
	return at;
}

/* A place on it stays under the finger, whatever moves or scales it; the cut stays where it is, and so does its direction. */
static void test_drawings_follow_fingers(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(17);
	for (int n = 0; n < TIMES; n++) {
		g_autoptr(view) v = any_section(chance);
		struct looking l = looking_of_view(v), was = l;
		double px[2] = { g_rand_double_range(chance, 0, WIDTH),
			g_rand_double_range(chance, 0, HEIGHT) },
		       at[3], now[2];
		struct camera c = looking_camera(&l, WIDTH, HEIGHT);
		camera_place(&c, px, c.near_m + 1, at);
		looking_drag(&l, 40, -25, HEIGHT);
		project(&l, at, now);
		g_assert_cmpfloat(hypot(now[0] - px[0] - 40, now[1] - px[1] + 25), <, 1e-6);
		looking_pan(&l, -40, 25, HEIGHT);
		looking_zoom(&l, g_rand_double_range(chance, 0.5, 2), px[0] - WIDTH / 2.,
			px[1] - HEIGHT / 2., HEIGHT);
		looking_twist(&l, 0.5);
		project(&l, at, now);
		g_assert_cmpfloat(hypot(now[0] - px[0], now[1] - px[1]), <, 1e-6);
		struct looking there = looking_at(&l, at, 2);
		project(&there, at, now);
		g_assert_cmpfloat(hypot(now[0] - WIDTH / 2., now[1] - HEIGHT / 2.), <, 1e-6);
		g_assert_cmpfloat(fabs(plane_of(&there) - plane_of(&was)), <, 1e-9);
		g_assert_cmpfloat(there.heading_rad, ==, was.heading_rad);
	}
}

static void test_drawings_are_kept(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(18);
	const double above[3] = { 4, 5, 6 }, below[3] = { 4, 5, 0 };
	g_autoptr(view) plan = view_new_parallel("p", "P", above, below, 20);
	struct looking down = looking_of_view(plan);
	g_assert_cmpfloat(down.elevation_rad, ==, -G_PI / 2);
	for (int n = 0; n < TIMES; n++) {
		g_autoptr(view) v = any_section(chance);
		struct looking l = looking_of_view(v);
		g_autoptr(view) kept = looking_view(&l, "k", "K", 1.5);
		g_assert_cmpfloat(distance(kept->eye_m, v->eye_m), <, 1e-9);
		g_assert_cmpfloat(distance(kept->target_m, v->target_m), <, 1e-9);
		g_assert_true(kept->height_m == v->height_m && kept->is_cut && kept->depth_m == 12);
		/* On the way from a walk all is in perspective until it is there. */
		struct looking from = any_looking(chance, LOOKING_FROM),
			       end = looking_between(&from, &l, 1);
		g_assert_cmpint(end.mode, ==, LOOKING_PARALLEL);
		for (int k = 0; k < 20; k++) {
			struct looking at = looking_between(&from, &l, k / 20.);
			struct camera c = looking_camera(&at, WIDTH, HEIGHT);
			g_assert_true(camera_validate(&c, NULL) && c.parallel_m == 0);
		}
		struct looking both = looking_between(&down, &l, 0.5);
		struct camera c = looking_camera(&both, WIDTH, HEIGHT);
		g_assert_true(camera_validate(&c, NULL) && c.parallel_m > 0);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/looking/drag", test_drag);
	g_test_add_func("/looking/look-about", test_look_about);
	g_test_add_func("/looking/pan-and-zoom", test_pan_and_zoom);
	g_test_add_func("/looking/twist", test_twist);
	g_test_add_func("/looking/stays-a-view", test_stays_a_view);
	g_test_add_func("/looking/goes-there", test_goes_there);
	g_test_add_func("/looking/drawings/fingers", test_drawings_follow_fingers);
	g_test_add_func("/looking/drawings/kept", test_drawings_are_kept);
	return g_test_run();
}
