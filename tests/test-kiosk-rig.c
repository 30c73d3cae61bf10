/* What a test does with fingers arrives in a GTK program, as what it is: tests of the kiosk stand on this. */
#include "tests/kiosk-rig.h"
#include <math.h>
#include <png.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const double limit_s = 30;
static rig *shared;

static rig *the_rig(void)
{
	if (!shared) {
		g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
		g_autofree char *folder = g_path_get_dirname(self);
		g_autofree char *program = g_build_filename(folder, "rig-app", NULL);
		shared = rig_new(
			&(struct rig_desc){ .program = program, .width = 1000, .height = 700 });
	}
	return shared;
}

static int number(rig *r, const char *key)
{
	g_autofree char *text = rig_state(r, key);
	return text ? atoi(text) : 0;
}

/* Until the program has noticed one more end of such a movement than there were before. */
static void wait_end(rig *r, const char *ends, int before)
{
	for (int polls = 0; number(r, ends) <= before; polls++) {
		g_assert_cmpint(polls, <, 1500);
		g_usleep(20000);
	}
}

static double value(rig *r, const char *key, int word)
{
	g_autofree char *text = rig_state(r, key);
	g_assert_nonnull(text);
	g_auto(GStrv) words = g_strsplit(text, " ", -1);
	g_assert_cmpint(g_strv_length(words), >, word);
	return g_ascii_strtod(words[word], NULL);
}

static struct rig_place area_middle(rig *r)
{
	struct rig_place place = rig_wait_for(r, "area", limit_s);
	place.x += place.width / 2;
	place.y += place.height / 2;
	return place;
}

static void test_tap(void)
{
	rig *r = the_rig();
	rig_tap(r, "press");
	rig_wait_state(r, "presses", "1", limit_s);
	rig_tap(r, "press");
	rig_wait_state(r, "presses", "2", limit_s);
	g_assert_true(rig_runs(r));
}

static void test_text(void)
{
	rig *r = the_rig();
	g_autofree char *label = rig_text(r, "victim"), *button = rig_text(r, "press");
	g_autofree char *told = rig_text(r, "away");
	g_assert_cmpstr(label, ==, "Für kurze Zeit");
	g_assert_cmpstr(button, ==, "Press");
	g_assert_cmpstr(told, ==, "Take the label away");
}

/* Also: what is no longer there, and what may no longer be touched. */
static void test_gone(void)
{
	rig *r = the_rig();
	struct rig_place place;
	g_assert_true(rig_find(r, "victim", &place));
	rig_tap(r, "away");
	rig_wait_gone(r, "victim", limit_s);
	g_assert_true(rig_find(r, "away", &place));
	g_assert_false(place.sensitive);
	g_assert_false(rig_find(r, "nobody", &place));
}

static void test_popover(void)
{
	rig *r = the_rig();
	rig_tap(r, "menu");
	rig_tap(r, "inside");
	rig_wait_state(r, "insides", "1", limit_s);
	rig_tap_at(r, 20, 690);
	rig_wait_gone(r, "inside", limit_s);
}

static void test_type(void)
{
	rig *r = the_rig();
	rig_tap(r, "entry");
	rig_type(r, "Oak 3, \"north\" {~|}x\b!");
	rig_wait_text(r, "entry", "Oak 3, \"north\" {~|}!", limit_s);
}

static void wait_slider(rig *r, double wanted, double tolerance)
{
	for (int polls = 0;; polls++) {
		g_autofree char *text = rig_text(r, "slider");
		if (fabs(g_ascii_strtod(text, NULL) - wanted) <= tolerance)
			return;
		g_assert_cmpint(polls, <, 1500);
		g_usleep(20000);
	}
}

static void test_slider(void)
{
	rig *r = the_rig();
	struct rig_place place = rig_wait_for(r, "slider", limit_s);
	double y = place.y + place.height / 2;
	rig_drag(r, place.x + 10, y, place.x + place.width / 2, y, 0.3);
	wait_slider(r, 50, 4);
	rig_drag(r, place.x + place.width / 2, y, place.x + place.width - 4, y, 0.3);
	wait_slider(r, 100, 0);
}

static void test_drag(void)
{
	rig *r = the_rig();
	struct rig_place middle = area_middle(r);
	int before = number(r, "drags");
	rig_drag(r, middle.x, middle.y, middle.x + 200, middle.y - 90, 0.3);
	wait_end(r, "drags", before);
	g_assert_cmpfloat_with_epsilon(value(r, "drag", 0), 200, 1.5);
	g_assert_cmpfloat_with_epsilon(value(r, "drag", 1), -90, 1.5);
}

static void test_two_finger_pan(void)
{
	rig *r = the_rig();
	struct rig_place middle = area_middle(r);
	int before = number(r, "zooms");
	rig_two_finger_pan(r, middle.x, middle.y, middle.x - 150, middle.y + 60, 0.3);
	wait_end(r, "zooms", before);
	g_assert_cmpfloat_with_epsilon(value(r, "pan", 0), -150, 3);
	g_assert_cmpfloat_with_epsilon(value(r, "pan", 1), 60, 3);
}

static void test_pinch(void)
{
	rig *r = the_rig();
	struct rig_place middle = area_middle(r);
	int before = number(r, "zooms");
	rig_pinch(r, middle.x, middle.y, 120, 300, 0.3);
	wait_end(r, "zooms", before);
	g_assert_cmpfloat_with_epsilon(value(r, "zoom", 0), 2.5, 0.08);
	rig_pinch(r, middle.x, middle.y, 300, 150, 0.3);
	wait_end(r, "zooms", before + 1);
	g_assert_cmpfloat_with_epsilon(value(r, "zoom", 0), 0.5, 0.04);
}

static void test_twist(void)
{
	rig *r = the_rig();
	struct rig_place middle = area_middle(r);
	int before = number(r, "twists");
	rig_twist(r, middle.x, middle.y, 260, 0.8, 0.4);
	wait_end(r, "twists", before);
	g_assert_cmpfloat_with_epsilon(value(r, "angle", 0), 0.8, 0.06);
}

static void test_double_tap(void)
{
	rig *r = the_rig();
	rig_double_tap(r, "area");
	rig_wait_state(r, "clicks", "2", limit_s);
}

/* A drag over buttons scrolls and presses none. */
static void test_scroll(void)
{
	rig *r = the_rig();
	struct rig_place place;
	g_assert_true(rig_find(r, "row-50", &place));
	g_assert_false(place.reachable);
	rig_scroll_to(r, "list", "row-50");
	rig_scroll_to(r, "list", "row-3");
	g_assert_cmpint(number(r, "rows"), ==, 0);
	rig_tap(r, "row-3");
	rig_wait_state(r, "rows", "1", limit_s);
}

/* A tap is no hold, however slow the machine is. */
static void test_hold(void)
{
	rig *r = the_rig();
	rig_tap(r, "area");
	rig_wait_state(r, "clicks", "1", limit_s);
	g_autofree char *before = rig_state(r, "holds");
	g_assert_null(before);
	rig_hold(r, "area", 1.5);
	rig_wait_state(r, "holds", "1", limit_s);
}

struct picture {
	png_image image;
	uint8_t *pixels; /* RGB */
};

static void read_picture(const char *path, struct picture *picture)
{
	picture->image = (png_image){ .version = PNG_IMAGE_VERSION };
	g_assert_true(png_image_begin_read_from_file(&picture->image, path));
	picture->image.format = PNG_FORMAT_RGB;
	picture->pixels = g_malloc(PNG_IMAGE_SIZE(picture->image));
	g_assert_true(png_image_finish_read(&picture->image, NULL, picture->pixels, 0, NULL));
}

/* Three different channels tell whether they are in order, the place tells whether the rows are. */
static void test_shot(void)
{
	rig *r = the_rig();
	struct rig_place middle = area_middle(r);
	g_autofree char *path = g_build_filename(rig_folder(r), "shot.png", NULL);
	struct picture picture;
	rig_shot(r, path);
	read_picture(path, &picture);
	g_assert_cmpuint(picture.image.width, ==, 1000);
	g_assert_cmpuint(picture.image.height, ==, 700);
	const uint8_t *blue = picture.pixels + 3 * ((size_t)middle.y * 1000 + (size_t)middle.x);
	const uint8_t *low =
		picture.pixels + 3 * ((size_t)(middle.y + middle.height / 2 - 4) * 1000 + 4);
	const uint8_t *high = picture.pixels + 3 * ((size_t)4 * 1000 + 995);
	g_assert_cmpmem(blue, 3, ((uint8_t[]){ 51, 102, 204 }), 3);
	g_assert_cmpmem(low, 3, blue, 3);
	g_assert_cmpint(memcmp(high, blue, 3), !=, 0);
	g_free(picture.pixels);
}

static void test_kill(void)
{
	rig *r = the_rig();
	rig_kill(r);
	g_assert_false(rig_runs(r));
	rig_start(r);
	g_autofree char *presses = rig_state(r, "presses");
	g_assert_null(presses);
	rig_tap(r, "press");
	rig_wait_state(r, "presses", "1", limit_s);
	g_assert_cmpuint(rig_frames(r), >, 0);
}

static void skip(void)
{
	g_test_skip(rig_missing());
}

static const struct {
	const char *path;
	void (*run)(void);
} cases[] = {
	{ "/kiosk-rig/tap", test_tap },
	{ "/kiosk-rig/text", test_text },
	{ "/kiosk-rig/gone", test_gone },
	{ "/kiosk-rig/popover", test_popover },
	{ "/kiosk-rig/type", test_type },
	{ "/kiosk-rig/slider", test_slider },
	{ "/kiosk-rig/drag", test_drag },
	{ "/kiosk-rig/two-finger-pan", test_two_finger_pan },
	{ "/kiosk-rig/pinch", test_pinch },
	{ "/kiosk-rig/twist", test_twist },
	{ "/kiosk-rig/scroll", test_scroll },
	{ "/kiosk-rig/hold", test_hold },
	{ "/kiosk-rig/double-tap", test_double_tap },
	{ "/kiosk-rig/shot", test_shot },
	{ "/kiosk-rig/kill", test_kill },
};

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
		g_test_add_func(cases[i].path, rig_missing() ? skip : cases[i].run);
	int status = g_test_run();
	rig_free(shared);
	return status;
}
