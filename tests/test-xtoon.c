/* X-Toon textures of stops and of pictures, boxes of pencils, and what becomes of curvatures in a byte. */
#include "firmware-io/files.h"
#include "render/bench-statue.h"
#include "render/pencil-box.h"
#include "render/scene-bend.h"
#include "render/xtoon.h"
#include <math.h>
#include <png.h>
#include <string.h>

static const uint8_t ink[3] = { 10, 20, 30 };

static xtoon *xtoon_of(const char *source)
{
	g_autoptr(GError) error = NULL;
	xtoon *x = xtoon_new(source, ink, &error);
	g_assert_no_error(error);
	return x;
}

static void assert_texel(const xtoon *x, uint32_t row, uint32_t column, const int rgba[4])
{
	for (int k = 0; k < 4; k++)
		g_assert_cmpint(ABS(x->rgba[row * XTOON_COLUMNS + column][k] - rgba[k]), <=, 1);
}

/* ---- stops ---- */

static void test_stops(void)
{
	g_autoptr(xtoon) x = xtoon_of("[{\"brightness\":0.8,\"colour\":\"#ffffff\",\"chance\":0},"
				      "{\"brightness\":0.2}]");
	g_assert_cmpuint(x->rows, ==, 1);
	assert_texel(x, 0, 0, (const int[]){ 10, 20, 30, 255 }); /* the ink, surely */
	assert_texel(x, 0, 51, (const int[]){ 10, 20, 30, 255 });
	assert_texel(x, 0, 255, (const int[]){ 255, 255, 255, 0 });
	for (uint32_t n = 52; n < 204; n++) {
		float part = ((float)n / 255 - 0.2f) / 0.6f;
		g_assert_cmpfloat(fabsf(x->rgba[n][3] - 255 * (1 - part)), <=, 1);
		g_assert_cmpfloat(fabsf(x->rgba[n][0] - (10 + 245 * part)), <=, 1);
	}
}

/* A stop without a depth is of all of them. */
static void test_depths(void)
{
	g_autoptr(xtoon) x = xtoon_of("[{\"brightness\":0,\"depth\":0,\"chance\":1},"
				      "{\"brightness\":0,\"depth\":1,\"chance\":0},"
				      "{\"brightness\":1,\"chance\":0.5}]");
	g_assert_cmpuint(x->rows, ==, XTOON_ROWS_MOST);
	for (uint32_t y = 0; y < x->rows; y++) {
		float depth = (float)y / (float)(x->rows - 1);
		const uint8_t(*row)[4] = x->rgba + (size_t)y * XTOON_COLUMNS;
		g_assert_cmpfloat(fabsf(row[0][3] - 255 * (1 - depth)), <=, 1);
		g_assert_cmpfloat(fabsf(row[255][3] - 127.5f), <=, 1);
	}
}

/* ---- pictures ---- */

static void save_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height)
{
	png_image image = { .version = PNG_IMAGE_VERSION,
		.width = width,
		.height = height,
		.format = PNG_FORMAT_RGBA };
	g_assert_true(png_image_write_to_file(&image, path, 0, rgba, 0, NULL));
}

static void test_picture(void)
{
	static const uint8_t four[] = { 0, 0, 0, 255, 255, 0, 0, 0, 0, 0, 255, 255, 255, 255, 255,
		51 };
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = g_dir_make_tmp("test-xtoon-XXXXXX", &error);
	g_assert_no_error(error);
	g_autofree char *path = g_build_filename(folder, "x.png", NULL),
			*none = g_build_filename(folder, "none.png", NULL);
	save_png(path, four, 2, 2);
	g_autoptr(xtoon) x = xtoon_of(path);
	g_assert_cmpuint(x->rows, ==, 2);
	assert_texel(x, 0, 0, (const int[]){ 0, 0, 0, 255 });
	assert_texel(x, 0, 255, (const int[]){ 255, 0, 0, 0 });
	assert_texel(x, 1, 0, (const int[]){ 0, 0, 255, 255 });
	assert_texel(x, 1, 255, (const int[]){ 255, 255, 255, 51 });
	assert_texel(x, 1, 128, (const int[]){ 128, 128, 255, 153 });
	g_assert_null(xtoon_new(none, ink, &error));
	g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
	g_assert_nonnull(strstr(error->message, "none.png"));
	files_remove_tree(folder, NULL);
}

/* ---- pencils ---- */

#define BOX "[\"#ff0000\",\"#ffff00\",\"#808080\",\"#0000ff\"]"

static void test_hues(void)
{
	for (int n = 0; n < 512; n++) {
		float rgb[3] = { (float)(n & 7) / 7, (float)(n >> 3 & 7) / 7, (float)(n >> 6) / 7 },
		      again[3];
		struct hsv c = hsv_of(rgb);
		g_assert_true(c.hue >= 0 && c.hue < 6);
		hsv_to_rgb(&c, again);
		for (int k = 0; k < 3; k++)
			g_assert_cmpfloat(fabsf(again[k] - rgb[k]), <=, 1e-5f);
	}
}

/* Orange is red or yellow, as often as it is near; of violet blue or red. As light and as full as it was. */
static void test_pencils(void)
{
	static const struct {
		float hue, saturation, value, first, part;
	} colours[] = { { 0.25f, 1, 1, 0, 0.75f }, { 0.5f, 0.6f, 0.5f, 0, 0.5f },
		{ 5, 1, 0.8f, 4, 0.5f }, { 2.5f, 0.3f, 0.9f, 1, 0.5f } };
	pencil_box box = pencil_box_of(BOX);
	g_assert_cmpuint(box.count, ==, 3); /* grey has no hue */
	for (size_t n = 0; n < G_N_ELEMENTS(colours); n++) {
		int first = 0;
		for (int k = 0; k < 1000; k++) {
			struct hsv wanted = { colours[n].hue, colours[n].saturation,
				colours[n].value };
			float rgb[3];
			hsv_to_rgb(&wanted, rgb);
			pencil_box_draw(&box, 0, ((float)k + 0.5f) / 1000, rgb);
			struct hsv drawn = hsv_of(rgb);
			g_assert_true(drawn.hue == 0 || fabsf(drawn.hue - 1) < 1e-3f ||
				      fabsf(drawn.hue - 4) < 1e-3f);
			g_assert_cmpfloat(fabsf(drawn.saturation - wanted.saturation), <=, 1e-3f);
			g_assert_cmpfloat(fabsf(drawn.value - wanted.value), <=, 1e-3f);
			first += fabsf(drawn.hue - colours[n].first) < 1e-3f;
		}
		g_assert_cmpfloat_with_epsilon(first / 1000., (double)colours[n].part, 0.01);
	}
}

static void test_hue_shift(void)
{
	pencil_box none = pencil_box_of("[]");
	float rgb[3] = { 1, 0.5f, 0 };
	pencil_box_draw(&none, 120, 0.5f, rgb); /* orange becomes spring green */
	g_assert_cmpfloat(fabsf(rgb[0] - 0) + fabsf(rgb[1] - 1) + fabsf(rgb[2] - 0.5f), <=, 1e-5f);
	pencil_box_draw(&none, -120, 0.5f, rgb);
	g_assert_cmpfloat(fabsf(rgb[0] - 1) + fabsf(rgb[1] - 0.5f) + fabsf(rgb[2]), <=, 1e-5f);
}

/* ---- curvatures ---- */

static void test_bends(void)
{
	const float *table = scene_bend_table();
	g_assert_cmpuint(scene_bend_pack(NAN), ==, 0);
	g_assert_cmpuint(scene_bend_pack(0.01f), ==, 0);
	for (float per_m = 0.07f; per_m < 900; per_m *= 1.03f) {
		g_assert_cmpfloat(fabsf(table[scene_bend_pack(per_m)] / per_m - 1), <=, 0.045f);
		g_assert_cmpfloat(
			table[scene_bend_pack(-per_m)], ==, -table[scene_bend_pack(per_m)]);
	}
	g_assert_cmpfloat(table[scene_bend_pack(1e9f)], >, 1000);
}

/* The thing that is timed: closed, with curvatures of its tube. */
static void test_statue(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = g_dir_make_tmp("test-xtoon-XXXXXX", &error);
	g_autofree char *path = g_build_filename(folder, "statue.model", NULL);
	g_assert_true(bench_statue_write(path, 20000, &error));
	g_assert_no_error(error);
	g_autoptr(model) m = model_open_file(path, &error);
	g_assert_no_error(error);
	g_autoptr(scene) s = scene_new(m, &error);
	g_assert_no_error(error);
	const uint8_t(*bend)[2] = scene_bend(s);
	double mean[3] = { 0 };
	g_assert_cmpuint(s->count, >, 19500);
	for (uint32_t n = 0; n < s->count; n++) {
		float normal[3];
		model_unpack_normal(s->normal[n], normal);
		for (int k = 0; k < 3; k++)
			mean[k] += (double)normal[k] / s->count;
		g_assert_cmpfloat(fabsf(scene_bend_table()[bend[n][0]] - 4.2f), <=, 1.2f);
		g_assert_cmpuint(bend[n][1], ==, 0);
	}
	for (int k = 0; k < 3; k++)
		g_assert_cmpfloat(fabs(mean[k]), <=, 0.1);
	files_remove_tree(folder, NULL);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/xtoon/stops", test_stops);
	g_test_add_func("/xtoon/depths", test_depths);
	g_test_add_func("/xtoon/picture", test_picture);
	g_test_add_func("/pencils/hues", test_hues);
	g_test_add_func("/pencils/box", test_pencils);
	g_test_add_func("/pencils/hue-shift", test_hue_shift);
	g_test_add_func("/bends/bytes", test_bends);
	g_test_add_func("/bends/statue", test_statue);
	return g_test_run();
}
