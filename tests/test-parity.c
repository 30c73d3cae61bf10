/* One picture, two backends: a small scene by every kind of step, on the processor and by whatever OpenGL ES there is. And the same frame twice by gles: the same bytes. */
#include "render/gles-shaders.h"
#include "render/painter.h"
#include "tests/parity-drawn.h"
#include <string.h>

/* sections: others than the paper; may be NULL. */
static void compare_whole(gles_draw *d, const char *name, const char *sections, const char *steps)
{
	g_autofree char *text = g_strdup_printf("{\"schema\":1,\"paper\":{\"grain\":0.3,"
						"\"colour\":\"#f4ecd8\"},%s\"segments\":{%s}}",
		sections ? sections : "", steps);
	g_autoptr(style) how = style_of(text);
	compare(d, name, how);
}

static void compare_text(gles_draw *d, const char *name, const char *steps)
{
	compare_whole(d, name, NULL, steps);
}

/* ---- tests ---- */

/* Every row as its fallbacks have it; what only changes others, upon points. */
static void test_step(gconstpointer data)
{
	const struct step_kind *kind = data;
	g_assert_nonnull(gles_shader_find(kind->glsl));
	g_autoptr(gles_draw) d = gles_here_draw();
	if (!d)
		return;
	if (strcmp(kind->name, "composite") != 0) {
		g_autofree char *steps = g_strdup_printf(
			"\"site\":{\"steps\":[%s{\"step\":\"%s\"}]}",
			kind->stage == STEP_LAYER ? "" : "{\"step\":\"points\"},", kind->name);
		compare_text(d, kind->name, steps);
	}
	if (strcmp(kind->name, "inpaint") == 0 ||
		(kind->stage != STEP_FILTER && kind->stage != STEP_COMPOSITE))
		return;
	g_autofree char *picture = g_strdup_printf(
		"\"site\":{\"steps\":[{\"step\":\"points\"}]},\"building\":{\"add\":[{\"step\":"
		"\"gaussian\"}]},\"picture\":{\"steps\":[{\"step\":\"%s\"}]}",
		kind->name);
	compare_text(d, kind->name, picture);
}

#define LIGHT "\"light\":{\"amount\":0.8,\"azimuth_deg\":200,\"elevation_deg\":40},"
#define FOCUS                                                                                      \
	"\"focus\":{\"amount\":0.9,\"abstraction\":1.5,\"radius_m\":0.5,\"falloff_m\":2,"          \
	"\"x_m\":999.5,\"y_m\":1,\"z_m\":1},"
static const struct look {
	const char *name, *steps, *sections;
} looks[] = {
	{ "coloured", "{\"step\":\"strokes\",\"points\":\"all\",\"colour\":\"point\",\"tooth\":0,"
		      "\"opacity\":0.7,\"spacing_px\":12}" },
	{ "coloured-tooth",
		"{\"step\":\"sprites\",\"points\":\"surface\",\"colour\":\"point\",\"tooth\":0.8,"
		"\"saturation\":2,\"spacing_px\":5,\"length_px\":9}" },
	{ "painted", "{\"step\":\"strokes\",\"points\":\"surface\",\"colour\":\"point\",\"blend\":"
		     "\"paint\","
		     "\"texture\":\"brush\",\"spacing_px\":7,\"length_px\":40,\"width_px\":12}" },
	{ "painted-over",
		"{\"step\":\"lines\",\"id\":\"a\",\"points\":\"all\",\"tone\":\"colour\"},"
		"{\"step\":\"sprites\",\"id\":\"b\",\"points\":\"all\",\"blend\":\"paint\","
		"\"ink\":\"#c04020\",\"tooth\":0.5}" },
	{ "red-ink",
		"{\"step\":\"lines\",\"points\":\"features\",\"ink\":\"#c01010\",\"tooth\":0,"
		"\"direction\":\"edge\",\"fade_m\":5,\"degree\":0.7,\"opacity_variation\":0.8}" },
	{ "adjusted",
		"{\"step\":\"points\",\"exposure\":0.8,\"brightness\":1.2,\"contrast\":1.4,"
		"\"saturation\":0.3,"
		"\"size\":2,\"least_px\":4},{\"step\":\"edl\",\"strength\":2,\"radius_px\":3}" },
	{ "backs", "{\"step\":\"mask\",\"backs\":\"hidden\"},{\"step\":\"points\"},{\"step\":"
		   "\"strokes\","
		   "\"points\":\"all\",\"spacing_px\":9,\"direction\":\"edge\"}" },
	{ "few", "{\"step\":\"sprites\",\"points\":\"surface\",\"tooth\":0,\"spacing_px\":1.5,"
		 "\"length_px\":2,\"grow\":6,\"scatter\":1}" },
	{ "queue",
		"{\"step\":\"lines\",\"points\":\"dithering\",\"tone\":\"colour\",\"spacing_px\":1,"
		"\"length_px\":6,\"width_px\":0.6,\"grow\":3,\"tone_levels\":1}" },
	{ "along",
		"{\"step\":\"strokes\",\"points\":\"all\",\"direction\":\"line\",\"spacing_px\":8,"
		"\"angle_deg\":30,\"angle_variation_deg\":40,\"length_variation\":0.5}" },
	{ "turned", "{\"step\":\"lines\",\"points\":\"features\",\"direction\":\"screen\",\"angle_"
		    "deg\":70,"
		    "\"angle_variation_deg\":90,\"scatter\":0,\"spacing_px\":3}" },
	{ "no-layers", "" },
	{ "lit-points", "{\"step\":\"points\"}", LIGHT },
	{ "lit-tone",
		"{\"step\":\"lines\",\"points\":\"dithering\",\"tone\":\"colour\",\"spacing_px\":2,"
		"\"length_px\":6,\"width_px\":0.8}",
		LIGHT },
	{ "lit-omitted",
		"{\"step\":\"sprites\",\"points\":\"surface\",\"spacing_px\":4,\"length_px\":5}",
		LIGHT },
	{ "lit-paint",
		"{\"step\":\"strokes\",\"points\":\"all\",\"colour\":\"point\",\"blend\":\"paint\","
		"\"texture\":\"brush\",\"spacing_px\":7,\"length_px\":30,\"width_px\":9}",
		LIGHT },
	{ "focus",
		"{\"step\":\"points\"},{\"step\":\"edl\"},{\"step\":\"strokes\",\"points\":\"all\","
		"\"spacing_px\":9,\"direction\":\"edge\"}",
		FOCUS },
	{ "focus-picture", "{\"step\":\"points\"},{\"step\":\"lines\",\"points\":\"all\"}",
		"\"focus\":{\"on\":\"picture\",\"amount\":0.9,\"abstraction\":1.5,\"across\":0.4,"
		"\"down\":0.6,"
		"\"radius_px\":150,\"falloff_px\":400}," },
	{ "focus-lit",
		"{\"step\":\"sprites\",\"points\":\"all\",\"tone\":\"colour\",\"spacing_px\":2,"
		"\"length_px\":4}",
		LIGHT FOCUS },
	{ "hatching-bent",
		"{\"step\":\"mask\",\"backs\":\"hidden\"},{\"step\":\"hatching\",\"cross\":0.7,"
		"\"follows\":\"curvature\",\"curvature\":2,\"shine\":0.7,\"spacing_px\":7}",
		LIGHT },
	{ "hatching-pencils",
		"{\"step\":\"hatching\",\"colouring\":\"blend\",\"exposure\":0.8,\"hue_shift_deg\":"
		"70,"
		"\"pencils\":[\"#e02020\",\"#f0e020\",\"#2030c0\"],\"length_px\":30,"
		"\"width_px\":5,\"texture\":\"charcoal\",\"cross\":0.3,\"spacing_px\":9}",
		LIGHT },
	{ "hatching-deep",
		"{\"step\":\"hatching\",\"xtoon\":[{\"brightness\":0.2,\"depth\":0,"
		"\"colour\":\"#104080\"},{\"brightness\":0.9,\"chance\":0},{\"brightness\":0.4,"
		"\"depth\":1,\"colour\":\"#c06010\",\"chance\":0.6}],\"colouring\":\"xtoon\","
		"\"near_m\":2,\"far_m\":12,\"abstraction\":1.5,\"tone_by\":\"darkness\","
		"\"blend\":\"paint\",\"spacing_px\":5}",
		LIGHT FOCUS },
	{ "hatching-dots",
		"{\"step\":\"hatching\",\"follows\":\"screen\",\"texture\":\"dot\","
		"\"length_px\":6,\"width_px\":6,\"spacing_px\":4,\"copies\":40,\"points\":"
		"\"surface\",\"tooth\":0}" },
	{ "paint-lit",
		"{\"step\":\"paint\",\"length_px\":40,\"width_px\":18,\"fine\":0.15,"
		"\"thickness_px\":4,\"shine\":0.4,\"palette\":[\"#e02020\",\"#f0e020\","
		"\"#2030c0\"],\"warmth\":0.8,\"light_variation\":0.3,\"spill\":0.5}",
		LIGHT FOCUS },
	{ "paint-dabs", "{\"step\":\"paint\",\"texture\":\"dab\",\"lies\":\"screen\",\"wet\":0.8,"
			"\"points\":\"surface\",\"detail\":0,\"follow\":0.4,\"cover\":0.8,"
			"\"exposure\":1,\"contrast\":1.4,\"even\":0.2,\"tooth\":0.6,\"angle_"
			"variation_deg\":90},"
			"{\"step\":\"lines\",\"points\":\"features\"}" },
	{ "profile-hidden",
		"{\"step\":\"profile\",\"hidden\":0.7,\"overshoot_px\":12,\"wobble_px\":3,"
		"\"taper_px\":90,\"tooth\":0.5,\"width_px\":9,\"ink\":\"#803020\","
		"\"room_px\":9}" },
	{ "profile-covering",
		"{\"step\":\"points\"},{\"step\":\"profile\",\"blend\":\"paint\","
		"\"ink\":\"#ffffff\",\"width_px\":14,\"opacity\":0.7,\"pressure\":1}",
		FOCUS },
	{ "contours-all",
		"{\"step\":\"points\"},{\"step\":\"contours\",\"band_px\":8,\"slant_least\":1,"
		"\"ink\":\"#802010\"}",
		FOCUS },
	{ "contours-broad", "{\"step\":\"contours\",\"outlines\":0,\"steps\":1,\"band_px\":40}" },
	{ "stipple-lit", "{\"step\":\"stipple\",\"length_px\":5,\"level\":7,\"epsilon\":0.1}",
		LIGHT },
	{ "stipple-lamp",
		"{\"step\":\"stipple\",\"length_px\":6,\"level\":6,\"light_distance\":1.5,"
		"\"ink\":\"#a02010\",\"tooth\":0.6,\"grow\":3},{\"step\":\"stipple\",\"id\":\"b\","
		"\"passes\":1,\"most_points\":12,\"opacity\":0.4}",
		LIGHT FOCUS },
	{ "stipple-over",
		"{\"step\":\"points\"},{\"step\":\"stipple\",\"passes\":3,"
		"\"level\":8,\"epsilon\":0},{\"step\":\"lines\"}",
		LIGHT },
};

static void test_look(gconstpointer data)
{
	const struct look *l = data;
	g_autoptr(gles_draw) d = gles_here_draw();
	if (!d)
		return;
	g_autofree char *steps = g_strdup_printf("\"site\":{\"steps\":[%s]}", l->steps);
	compare_whole(d, l->name, l->sections, steps);
}

#define LINES "{\"step\":\"lines\",\"points\":\"all\"}"
#define OVER  "{\"step\":\"strokes\",\"points\":\"all\",\"spacing_px\":9,\"over\":true}"
#define AWAY                                                                                       \
	"\"focus\":{\"filters\":1,\"amount\":0.6,\"radius_m\":0.5,\"falloff_m\":2,\"x_m\":999.5,"  \
	"\"y_m\":1,\"z_m\":1},"
/* What sheets are of, and how they become one picture. */
static const struct look sheets[] = {
	{ "sheets-inpainted",
		"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"edl\"},{\"step\":\"edges\","
		"\"width_px\":8}]},\"vegetation\":{\"add\":[{\"step\":\"gaussian\",\"sigma_px\":12}"
		"]},\"structure\":{\"steps\":[{\"step\":\"points\"}]}" },
	{ "sheets-depth",
		"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"edges\",\"width_px\":8}]},"
		"\"vegetation\":{\"add\":[{\"step\":\"gaussian\",\"sigma_px\":12}]},"
		"\"structure\":{\"steps\":[" LINES "]},"
		"\"picture\":{\"steps\":[{\"step\":\"composite\",\"by\":\"depth\"}]}" },
	{ "sheets-layers", "\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"edges\"}]},"
			   "\"vegetation\":{\"add\":[{\"step\":\"gaussian\",\"sigma_px\":12}]},"
			   "\"structure\":{\"steps\":[{\"step\":\"points\"}]},"
			   "\"picture\":{\"steps\":[{\"step\":\"composite\",\"by\":\"layers\"}]}" },
	{ "sheets-surface",
		"\"site\":{\"steps\":[{\"step\":\"points\"}]},\"vegetation\":{\"add\":[{\"step\":"
		"\"warp\"}]},\"picture\":{\"steps\":[{\"step\":\"edges\"},{\"step\":\"grade\","
		"\"segments\":0.8}]}" },
	{ "sheets-ink",
		"\"site\":{\"steps\":[{\"step\":\"points\"}," LINES ",{\"step\":\"gaussian\"}]},"
		"\"vegetation\":{\"steps\":[{\"step\":\"stipple\",\"level\":7},{\"step\":\"gaps\"}]"
		"},\"building\":{\"steps\":[{\"step\":\"hatching\"},{\"step\":\"quantise\"}]}",
		LIGHT },
	{ "sheets-over",
		"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"watercolour\"}," OVER
		"]},\"picture\":{\"steps\":[{\"step\":\"occlusion\"}]}",
		LIGHT },
	{ "sheets-away",
		"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"kuwahara\",\"where\":"
		"\"away\",\"passes\":3},{\"step\":\"dog\",\"where\":\"near\"}," OVER "]},"
		"\"picture\":{\"steps\":[{\"step\":\"gaussian\",\"where\":\"away\"}]}",
		AWAY },
	{ "focus-segment", "\"site\":{\"steps\":[{\"step\":\"points\"}," LINES "]}",
		"\"focus\":{\"on\":\"segment\",\"segment\":4,\"amount\":0.7,\"abstraction\":1}," },
	{ "focus-segment-filtered",
		"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"kuwahara\",\"where\":"
		"\"away\"}," OVER "]}",
		"\"focus\":{\"on\":\"segment\",\"segment\":4,\"amount\":0.7,\"filters\":1}," },
};

static void test_sheets(gconstpointer data)
{
	const struct look *l = data;
	g_autoptr(gles_draw) d = gles_here_draw();
	if (d)
		compare_whole(d, l->name, l->sections, l->steps);
}

static void assert_refuses_paint(gles_draw *d)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(style) how =
		style_of("{\"schema\":1,\"segments\":{\"site\":{\"steps\":[{\"step\":"
			 "\"lines\",\"blend\":\"paint\"}]}}}");
	scene *s = make_scene();
	struct camera c = make_camera(7, WIDTH, HEIGHT);
	drawing *drawn;
	frame *f = frame_of(s, how, &c, &drawn);
	struct picture_buffer p = picture_buffer_new(WIDTH, HEIGHT);
	gles_draw_set_sums(d, false);
	g_assert_false(gles_draw_frame(d, f, &p, NULL, &error));
	g_assert_error(error, GLES_ERROR, GLES_ERROR_LIMIT);
	picture_buffer_clear(&p);
	frame_free(f);
	drawing_free(drawn);
	scene_free(s);
}

/* Without half floats, pictures are kept in bytes; they are coarser, and the same. Paint is refused. */
static void test_bytes(void)
{
	gles_context *c = gles_here();
	if (!c)
		return;
	struct gles_about about = c->about;
	c->about.has_half_float_colour = c->about.has_float_blend = false;
	g_autoptr(gles_draw) d = gles_here_draw();
	assert_refuses_paint(d);
	compare_text(d, "bytes",
		"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"lines\"},{\"step\":"
		"\"sprites\"}]}");
	c->about = about;
}

static void assert_same(gles_draw *d, const frame *f, const struct picture_buffer *before)
{
	struct picture_buffer p = draw_gles(d, f);
	g_assert_cmpmem(
		p.rgba, (size_t)WIDTH * HEIGHT * 4, before->rgba, (size_t)WIDTH * HEIGHT * 4);
	picture_buffer_clear(&p);
}

#define SAME_STROKES                                                                               \
	"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"strokes\",\"points\":\"all\","     \
	"\"colour\":\"point\",\"spacing_px\":2},{\"step\":\"sprites\",\"points\":\"all\","         \
	"\"blend\":\"paint\",\"spacing_px\":3,\"length_px\":9},{\"step\":\"paint\"}]}"
#define SAME_FILTERS                                                                               \
	"\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"gaps\"},{\"step\":\"edges\","      \
	"\"wobble_px\":1}]},\"vegetation\":{\"add\":[{\"step\":\"warp\"},{\"step\":\"kuwahara\"}]" \
	"},"                                                                                       \
	"\"picture\":{\"steps\":[{\"step\":\"watercolour\"},{\"step\":\"oil\"},{\"step\":"         \
	"\"edges\"}]}"

/* Also where another frame was drawn between, and with buffers of its own. */
static void assert_same_bytes(const char *steps, bool sums_ink)
{
	g_autoptr(gles_draw) d = gles_here_draw();
	if (!d)
		return;
	g_autoptr(gles_draw) other = gles_here_draw();
	gles_draw_set_sums(d, sums_ink);
	gles_draw_set_sums(other, sums_ink);
	g_autofree char *text = g_strdup_printf("{\"schema\":1,\"segments\":{%s}}", steps);
	g_autoptr(style) how = style_of(text);
	scene *s = make_scene();
	struct camera c = make_camera(7, WIDTH, HEIGHT), near = make_camera(2, WIDTH, HEIGHT);
	drawing *drawn;
	frame *f = frame_of(s, how, &c, &drawn);
	struct picture_buffer first = draw_gles(d, f);
	assert_same(d, f, &first);
	g_assert_true(frame_move(f, &near, NULL));
	struct picture_buffer moved = draw_gles(d, f);
	picture_buffer_clear(&moved);
	g_assert_true(frame_move(f, &c, NULL));
	assert_same(d, f, &first);
	assert_same(other, f, &first);
	picture_buffer_clear(&first);
	frame_free(f);
	drawing_free(drawn);
	scene_free(s);
}

static void test_same_bytes(gconstpointer steps)
{
	assert_same_bytes(steps, false);
	if (strcmp(steps, SAME_STROKES) == 0)
		assert_same_bytes(steps, true);
}

/* More strokes than a layer has room for at first, and points in several strips and slabs. */
static void test_limits(void)
{
	gles_context *c = gles_here();
	if (!c)
		return;
	struct gles_about about = c->about;
	c->about.limits.storage_block_bytes = 160 * 1024 * 16;
	g_autoptr(gles_draw) d = gles_here_draw();
	/* Strokes would not fit: no cut. */
	c->about.limits.storage_block_bytes = WIDTH * HEIGHT * 4;
	g_autoptr(style) how = style_of(
		"{\"schema\":1,\"segments\":{\"site\":{\"steps\":[{\"step\":\"points\"}]}}}");
	compare_some(d, "small-blocks", how, CAMERAS - 1);
	c->about = about;
	compare_text(d, "many",
		"\"site\":{\"steps\":[{\"step\":\"sprites\",\"points\":\"all\",\"spacing_px\":0.5,"
		"\"length_px\":1}]}");
}

/* It says what is too much, and draws the next frame as if nothing had been. */
static void test_too_large(void)
{
	gles_context *c = gles_here();
	g_autoptr(gles_draw) d = gles_here_draw();
	if (!d)
		return;
	struct gles_about about = c->about;
	g_autoptr(GError) error = NULL;
	g_autoptr(style) how = style_of(
		"{\"schema\":1,\"segments\":{\"site\":{\"steps\":[{\"step\":\"points\"}]}}}");
	scene *s = make_scene();
	struct camera camera = make_camera(7, WIDTH, HEIGHT);
	drawing *drawn;
	frame *f = frame_of(s, how, &camera, &drawn);
	struct picture_buffer p = picture_buffer_new(WIDTH, HEIGHT);
	c->about.limits.texture_size = 300;
	g_assert_false(gles_draw_frame(d, f, &p, NULL, &error));
	g_assert_error(error, GLES_ERROR, GLES_ERROR_LIMIT);
	g_assert_cmpstr(error->message, ==,
		"a picture of 320 x 240 pixels is larger than the GPU draws, 300 a side");
	g_clear_error(&error);
	c->about = about;
	c->about.limits.storage_block_bytes = 1000;
	g_assert_false(gles_draw_frame(d, f, &p, NULL, &error));
	g_assert_error(error, GLES_ERROR, GLES_ERROR_LIMIT);
	c->about = about;
	picture_buffer_clear(&p);
	p = draw_gles(d, f);
	struct picture_buffer cpu = draw_cpu(f);
	assert_alike(&cpu, &p, "after-errors");
	picture_buffer_clear(&cpu);
	picture_buffer_clear(&p);
	frame_free(f);
	drawing_free(drawn);
	scene_free(s);
}

/* ---- the painter ---- */

/* In a process of its own, for EGL is asked before the first context is opened. */
static bool is_child(void)
{
	if (g_test_subprocess())
		return true;
	g_test_trap_subprocess(NULL, 0, G_TEST_SUBPROCESS_INHERIT_STDERR);
	g_test_trap_assert_passed();
	return false;
}

static void test_none(void)
{
	if (!is_child())
		return;
	g_autoptr(GError) error = NULL;
	g_setenv("PLEINAIR_EGL", "none", TRUE);
	g_autoptr(painter) p = painter_new(BACKEND_WISH_AUTO, &error);
	g_assert_no_error(error);
	g_assert_true(g_str_has_prefix(painter_why(p), "cpu: "));
	g_assert_null(strchr(painter_why(p), '\n'));
	g_assert_null(painter_new(BACKEND_WISH_GLES, &error));
	g_assert_error(error, GLES_ERROR, GLES_ERROR_NONE);
}

static void draw_by(painter *p, const frame *f)
{
	g_autoptr(GError) error = NULL;
	struct picture_buffer gles = picture_buffer_new(WIDTH, HEIGHT), cpu = draw_cpu(f);
	struct draw_times t;
	g_assert_true(painter_draw(p, f, &gles, &t, &error));
	g_assert_no_error(error);
	g_assert_true(g_str_has_prefix(painter_why(p), "gles: "));
	g_assert_cmpuint(t.strokes, >, 100);
	g_assert_cmpuint(t.points_in_view, >, 10000);
	g_assert_cmpuint(t.chunks_in_view, >, 5);
	g_assert_cmpfloat(t.all_s, >=, t.cull_s + t.mask_s + t.choose_s);
	assert_alike(&cpu, &gles, "painter");
	picture_buffer_clear(&cpu);
	picture_buffer_clear(&gles);
}

static void test_painter(void)
{
	if (!is_child())
		return;
	g_autoptr(GError) error = NULL;
	g_autoptr(painter) p = painter_new(BACKEND_WISH_GLES, &error);
	if (!p) /* which /painter/none is about */
		return;
	g_autoptr(style) how = style_of(
		"{\"schema\":1,\"segments\":{\"site\":{\"steps\":[{\"step\":\"lines\"}]}}}");
	scene *s = make_scene();
	struct camera camera = make_camera(7, WIDTH, HEIGHT);
	drawing *drawn;
	frame *f = frame_of(s, how, &camera, &drawn);
	draw_by(p, f);
	frame_free(f);
	drawing_free(drawn);
	scene_free(s);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (const struct step_kind *k = step_kinds; k->name; k++) {
		g_autofree char *test = g_strdup_printf("/parity/step/%s", k->name);
		if (k->glsl)
			g_test_add_data_func(test, k, test_step);
	}
	for (size_t n = 0; n < G_N_ELEMENTS(looks); n++) {
		g_autofree char *test = g_strdup_printf("/parity/look/%s", looks[n].name);
		g_test_add_data_func(test, &looks[n], test_look);
	}
	for (size_t n = 0; n < G_N_ELEMENTS(sheets); n++) {
		g_autofree char *test = g_strdup_printf("/parity/sheets/%s", sheets[n].name);
		g_test_add_data_func(test, &sheets[n], test_sheets);
	}
	g_test_add_func("/parity/bytes", test_bytes);
	g_test_add_data_func("/parity/same-bytes/strokes", SAME_STROKES, test_same_bytes);
	g_test_add_data_func("/parity/same-bytes/filters", SAME_FILTERS, test_same_bytes);
	g_test_add_func("/parity/limits", test_limits);
	g_test_add_func("/parity/too-large", test_too_large);
	g_test_add_func("/painter/none", test_none);
	g_test_add_func("/painter/gles", test_painter);
	int status = g_test_run();
	gles_context_free(gles_here_context);
	return status;
}
