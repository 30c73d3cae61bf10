/* The ball that a finger turns the light by: a place and back, and what its sides mean. */
#include "render/kiosk/light-ball.h"
#include <math.h>

static struct camera make_camera(GRand *chance)
{
	static const double eye[3] = { 3, 4, 5 };
	return camera_towards(eye, g_rand_double_range(chance, -G_PI, G_PI),
		g_rand_double_range(chance, -1.4, 1.4), 50, 640, 480);
}

static void test_there_and_back(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(7);
	for (int n = 0; n < 10000; n++) {
		struct camera c = make_camera(chance);
		double turn = g_rand_double_range(chance, -G_PI, G_PI),
		       away = g_rand_double_range(chance, 0, LIGHT_BALL_MOST), back[2];
		double place[2] = { away * cos(turn), away * sin(turn) };
		struct style_light light = { 1, 0, 0 };
		light_ball_light(&c, place, &light);
		g_assert_cmpfloat(light.azimuth_deg, >=, 0);
		g_assert_cmpfloat(light.azimuth_deg, <=, 360);
		light_ball_place(&c, &light, back);
		g_assert_cmpfloat(hypot(back[0] - place[0], back[1] - place[1]), <, 1e-3);
	}
}

/* Looking north: from the east at the right edge, from above at the upper one, from behind the person in the middle. */
static void test_sides(void)
{
	static const double eye[3] = { 0, 0, 0 };
	static const struct {
		double place[2];
		float azimuth_deg, elevation_deg;
	} sides[] = { { { 1, 0 }, 90, 0 }, { { -1, 0 }, 270, 0 }, { { 0.5, 0 }, 135, 0 },
		{ { 0, 0 }, 180, 0 }, { { 0, -0.5 }, 180, 45 }, { { 1.5, 0 }, 45, 0 } };
	struct camera c = camera_towards(eye, 0, 0, 50, 640, 480);
	for (size_t n = 0; n < G_N_ELEMENTS(sides); n++) {
		struct style_light light;
		light_ball_light(&c, sides[n].place, &light);
		g_assert_cmpfloat(fabsf(light.azimuth_deg - sides[n].azimuth_deg), <, 0.01f);
		g_assert_cmpfloat(fabsf(light.elevation_deg - sides[n].elevation_deg), <, 0.01f);
	}
	struct style_light above;
	light_ball_light(&c, (double[2]){ 0, -1 }, &above);
	g_assert_cmpfloat(fabsf(above.elevation_deg - 90), <, 0.1f);
}

/* What is farther away than the ball goes is as far as it goes. */
static void test_ends(void)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(8);
	struct camera c = make_camera(chance);
	struct style_light light = { 1, 0, 0 };
	double back[2];
	light_ball_light(&c, (double[2]){ 30, -40 }, &light);
	light_ball_place(&c, &light, back);
	g_assert_cmpfloat(fabs(hypot(back[0], back[1]) - LIGHT_BALL_MOST), <, 1e-3);
	g_assert_cmpfloat(fabs(back[1] / back[0] + 4. / 3), <, 1e-2);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/light-ball/there-and-back", test_there_and_back);
	g_test_add_func("/light-ball/sides", test_sides);
	g_test_add_func("/light-ball/ends", test_ends);
	return g_test_run();
}
