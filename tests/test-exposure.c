/* Dark sites as if photographed for longer: how much, and that points and paint show it. */
#include "render/bands.h"
#include "tests/scene-made.h"

#define SIDE 200u

/* Beside each other, seen from the south: the left one is dark, the right one so light. */
static made walls_of(uint8_t light)
{
	made m = made_new();
	for (int n = 0; n < 2; n++) {
		uint8_t grey = n ? light : 40;
		struct made_plane wall = { .corner_m = { 100 + 2 * n, 205, 3 },
			.a_m = { 2, 0, 0 },
			.b_m = { 0, 0, 4 },
			.apart_m = 0.02,
			.order = MADE_JITTERED,
			.rgba = { grey, grey, grey, 255 } };
		made_add_plane(&m, &wall);
	}
	made_read(&m);
	return m;
}

/* What a step makes of the middles of the two. */
static void draw_walls(const made *m, const char *step, int ret_grey[2])
{
	static const double eye[3] = { 102, 201, 5 }, target[3] = { 102, 205, 5 };
	struct camera c = camera_look_at(eye, target, 50, SIDE, SIDE);
	g_autofree char *nodes = g_strdup_printf("\"site\":{\"steps\":[%s]}", step);
	g_autoptr(drawing) d = made_drawing(nodes);
	g_autoptr(frame) f = made_frame(m->scene, d, &c);
	struct picture_buffer p = made_picture(f);
	for (int n = 0; n < 2; n++) {
		int sum = 0;
		for (uint32_t y = SIDE / 2 - 20; y < SIDE / 2 + 20; y++)
			for (uint32_t x = 0; x < 40; x++)
				sum += p.rgba[y * SIDE + (n ? SIDE - 60 : 20) + x][1];
		ret_grey[n] = (sum + 800) / 1600;
	}
	picture_buffer_clear(&p);
}

/* As it is, and exposed; format: of the step, what exposes it goes in at %s. */
static void draw_exposed(const made *m, const char *format, int ret_before[2], int ret_after[2])
{
	g_autofree char *plain = g_strdup_printf(format, ""),
			*exposed = g_strdup_printf(format, ",\"exposure\":1");
	draw_walls(m, plain, ret_before);
	draw_walls(m, exposed, ret_after);
	g_test_message(
		"%d %d become %d %d", ret_before[0], ret_before[1], ret_after[0], ret_after[1]);
}

static void test_how_much(void)
{
	scene s = { .lightest = 0.9f };
	g_assert_cmpfloat(scene_exposure_of(&s, 1), ==, 1);
	s.lightest = 0.3f;
	g_assert_cmpfloat(scene_exposure_of(&s, 0), ==, 1);
	float all = scene_exposure_of(&s, 1);
	g_assert_cmpfloat(all, >, 3);
	g_assert_cmpfloat_with_epsilon(scene_exposed(all, 0.3f), 0.62f, 1e-4f);
	g_assert_cmpfloat_with_epsilon(
		scene_exposure_of(&s, 0.5f) * scene_exposure_of(&s, 0.5f), all, 1e-4f);
	g_assert_cmpfloat(scene_exposed(all, 0), ==, 0);
	g_assert_cmpfloat_with_epsilon(scene_exposed(all, 1), 1, 1e-6f);
	s.lightest = 0; /* as few as there are: not without end */
	g_assert_true(isfinite(scene_exposure_of(&s, 1)));
}

static void test_points(void)
{
	g_auto(made) m = walls_of(90);
	int before[2], after[2];
	draw_exposed(&m, "{\"step\":\"points\"%s}", before, after);
	g_assert_cmpint(abs(before[0] - 40), <=, 1);
	g_assert_cmpint(abs(before[1] - 90), <=, 1);
	g_assert_cmpint(abs(after[1] - (int)(0.62 * 255 + 0.5)), <=, 1);
	/* 0.62 of 0.353 is 2.99 times as much, where that is little; 40 / 255 * 2.99 / (1 + 1.99 * 40 / 255) */
	g_assert_cmpint(abs(after[0] - 91), <=, 1);
}

static void test_light_enough(void)
{
	g_auto(made) m = walls_of(200);
	int before[2], after[2];
	draw_exposed(&m, "{\"step\":\"points\"%s}", before, after);
	g_assert_cmpint(before[0], ==, after[0]);
	g_assert_cmpint(before[1], ==, after[1]);
}

static void test_paint(void)
{
	const char *even = "{\"step\":\"paint\",\"tooth\":0,\"shine\":0,\"thickness_px\":0,"
			   "\"warmth\":0,\"light_variation\":0,\"hue_variation_deg\":0%s}";
	g_auto(made) m = walls_of(90);
	int before[2], after[2];
	draw_exposed(&m, even, before, after);
	g_assert_cmpint(abs(before[1] - 90), <=, 4);
	g_assert_cmpint(abs(after[1] - 158), <=, 4);
	g_assert_cmpint(abs(after[0] - before[0] - 51), <=, 6);
}

/* Strokes of points' colours, with paper between them. */
static void test_hatching(void)
{
	const char *own =
		"{\"step\":\"hatching\",\"colouring\":\"point\",\"xtoon\":[{\"brightness\":0},"
		"{\"brightness\":1}],\"spacing_px\":2,\"length_px\":12,\"width_px\":6,"
		"\"blend\":\"paint\",\"tooth\":0,\"pressure\":0,\"opacity\":1%s}";
	g_auto(made) m = walls_of(90);
	int before[2], after[2];
	draw_exposed(&m, own, before, after);
	g_assert_cmpint(after[0] - before[0], >, 8);
	g_assert_cmpint(after[1] - before[1], >, 20);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/exposure/how-much", test_how_much);
	g_test_add_func("/exposure/points", test_points);
	g_test_add_func("/exposure/light-enough", test_light_enough);
	g_test_add_func("/exposure/paint", test_paint);
	g_test_add_func("/exposure/hatching", test_hatching);
	return g_test_run();
}
