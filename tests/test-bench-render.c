/* What pleinair bench render and bench coherence measure with: places reprojected, parts of models, known numbers. */
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include "render/bench-coherence-private.h"
#include "render/bench-subset.h"
#include "render/large.h"
#include "tests/scene-made.h"
#include <json-glib/json-glib.h>
#include <math.h>

#define WIDTH  160u
#define HEIGHT 120u

static struct camera camera_at(double x_m, double heading_rad)
{
	const double eye_m[3] = { x_m, 0, 0 };
	return camera_towards(eye_m, heading_rad, 0, 60, WIDTH, HEIGHT);
}

static visibility_mask *mask_of_depth(float depth_m)
{
	visibility_mask *m = g_new0(visibility_mask, 1);
	m->width = m->pitch = WIDTH;
	m->height = HEIGHT;
	m->key = m->memory = large_new(WIDTH * HEIGHT * sizeof *m->key);
	union {
		float depth_m;
		int32_t bits;
	} u = { depth_m };
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
		m->key[i] = u.bits & ~255;
	return m;
}

static float *plane_of(float depth_m)
{
	float *ret = g_new(float, WIDTH *HEIGHT);
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
		ret[i] = depth_m;
	return ret;
}

static void test_there_and_back(void)
{
	for (int n = 0; n < 100; n++) {
		struct camera a = camera_at(g_test_rand_double_range(-1, 1), 0),
			      b = camera_at(g_test_rand_double_range(-1, 1), 0.2);
		double px[2] = { g_test_rand_double_range(0, WIDTH),
			g_test_rand_double_range(0, HEIGHT) };
		double depth_m = g_test_rand_double_range(3, 50), there[2], there_m, back[2],
		       back_m;
		g_assert_true(reproject_place(&a, px, depth_m, &b, there, &there_m));
		g_assert_true(reproject_place(&b, there, there_m, &a, back, &back_m));
		g_assert_cmpfloat_with_epsilon(back_m, depth_m, 1e-9);
		for (int k = 0; k < 2; k++)
			g_assert_cmpfloat_with_epsilon(back[k], px[k], 1e-8);
	}
}

static void test_shows(void)
{
	struct camera c = camera_at(0, 0);
	g_autoptr(visibility_mask) m = mask_of_depth(5);
	/* y is ahead */
	g_assert_true(reproject_shows(&c, m, (double[]){ 0, 4.9, 0 }));
	g_assert_false(reproject_shows(&c, m, (double[]){ 0, 5.1, 0 }));
	g_assert_false(reproject_shows(&c, m, (double[]){ 0, -4.9, 0 }));
	g_assert_false(reproject_shows(&c, m, (double[]){ 9, 4.9, 0 }));
}

/* A wall with a ramp of light, and the camera a little aside: nothing changed. */
static void test_error(void)
{
	const float depth_m = 5;
	struct camera before = camera_at(0, 0), now = camera_at(0.25, 0);
	float shift = (float)(0.25 * now.focal_px / depth_m);
	g_autofree float *depths_m = plane_of(depth_m);
	g_autoptr(reprojection) r = reprojection_new(&now, depths_m, &before, depths_m);
	g_autofree float *was = g_new(float, WIDTH *HEIGHT), *is = g_new(float, WIDTH *HEIGHT);
	struct reprojection_sums same = { 0 }, lighter = { 0 };
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
		was[i] = (float)(i % WIDTH) / WIDTH;
		is[i] = was[i] + shift / WIDTH;
	}
	reprojection_add(r, is, was, 1, &same);
	g_assert_cmpfloat(reprojection_change(&same), <, 1e-10);
	g_assert_cmpuint(same.places, <, WIDTH * HEIGHT);
	g_assert_cmpuint(same.places, >, (uint64_t)((float)WIDTH - shift - 3) * (HEIGHT - 2));
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
		is[i] += 0.5f;
	reprojection_add(r, is, was, 1, &lighter);
	g_assert_cmpfloat_with_epsilon(reprojection_change(&lighter), 0.25, 1e-5);
}

/* Ink on the wall: lines about 8 pixels apart, a third of them black; or others in each frame. */
static float ink_at(double x, double y, int of)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(
		(guint32)(1000 * floor(x / 8) + 77 * floor(y / 8)) + 1000003u * (guint32)of);
	return g_rand_double(chance) < 1 / 3. ? 0 : 1;
}

static void draw_ink(float *to, double shift_px, int of, float contrast)
{
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			to[y * WIDTH + x] =
				1 - contrast * (1 - ink_at(x + 0.5 + shift_px, y + 0.5, of));
}

/* Ink that stays on the wall changes nothing, but pixel by pixel it seems to; ink that is another in each frame, or that moves with the
 * picture, changes all of it, however faint it is. */
static void test_share(void)
{
	const float depth_m = 5;
	struct camera before = camera_at(0, 0), now = camera_at(0.2503, 0);
	double shift = 0.2503 * now.focal_px / (double)depth_m;
	g_autofree float *depths_m = plane_of(depth_m);
	g_autoptr(reprojection) r = reprojection_new(&now, depths_m, &before, depths_m);
	g_autofree float *was = g_new(float, WIDTH *HEIGHT), *is = g_new(float, WIDTH *HEIGHT);
	for (float contrast = 1; contrast > 0.2f; contrast -= 0.7f) {
		struct reprojection_sums fixed = { 0 }, by_pixels = { 0 }, boils = { 0 },
					 slides = { 0 };
		draw_ink(was, 0, 1, contrast);
		draw_ink(is, shift, 1, contrast);
		reprojection_add(r, is, was, 1, &by_pixels);
		reprojection_add(r, is, was, 4, &fixed);
		draw_ink(is, shift, 2, contrast);
		reprojection_add(r, is, was, 4, &boils);
		reprojection_add(r, was, was, 4, &slides);
		g_test_message("fixed %.3f (%.3f by pixels), boils %.2f, slides %.2f",
			reprojection_share(&fixed), reprojection_share(&by_pixels),
			reprojection_share(&boils), reprojection_share(&slides));
		g_assert_cmpfloat(reprojection_share(&fixed), <, 0.01);
		g_assert_cmpfloat(
			reprojection_share(&by_pixels), >, 2 * reprojection_share(&fixed));
		g_assert_cmpfloat(reprojection_share(&boils), >, 1.5);
		g_assert_cmpfloat(reprojection_share(&slides), >, 0.5);
	}
}

/* What a mask pushes back is where it was. */
static void test_pushed_back(void)
{
	struct pipeline pushed[2] = { { .mask = { .offset_m = 0.1f } },
		{ .mask = { .offset_m = 0.05f, .offset_relative = 0.004f } } };
	g_autoptr(GArray) pipelines = g_array_new(FALSE, FALSE, sizeof *pushed);
	g_array_append_vals(pipelines, pushed, 2);
	drawing d = { .pipelines = pipelines };
	frame f = { .drawing = &d };
	union {
		float depth_m;
		int32_t bits;
	} u = { 5.07f };
	int32_t key = u.bits & ~((1 << MASK_PIPELINE_BITS) - 1);
	g_assert_cmpfloat_with_epsilon(reproject_depth(&f, key), 4.97, 1e-3);
	g_assert_cmpfloat_with_epsilon(reproject_depth(&f, key | 1), 5, 1e-3);
}

/* A metre before the wall, whose points are centimetres apart: by as much the mask lies behind it. Between discs it has what it fills in. */
static void test_depths(void)
{
	const double eye[3] = { 103, 204, 4 }, target[3] = { 103, 205, 4 };
	struct camera c = camera_look_at(eye, target, 40, 400, 300);
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	uint32_t count;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	g_autoptr(visibility_mask) m = visibility_mask_new(f, views, count);
	g_autofree float *depth_m = reproject_depths(f, m, views, count);
	size_t pixels = (size_t)c.width * c.height, covered = 0, filled = 0, wrong = 0,
	       wrong_mask = 0;
	for (size_t at = 0; at < pixels; at++) {
		int32_t key = mask_key(m, (int32_t)(at % c.width), (int32_t)(at / c.width));
		if (key == MASK_EMPTY)
			continue;
		covered++;
		double by_mask_m = reproject_depth(f, key);
		bool is_filled = fabs((double)depth_m[at] - by_mask_m) < 1e-6;
		filled += is_filled;
		wrong += !is_filled && fabs((double)depth_m[at] - 1) > 1e-3;
		wrong_mask += fabs(by_mask_m - 1) > 5e-3;
	}
	g_test_message("%zu of %zu covered, %zu filled, %zu wrong, %zu by the mask", covered,
		pixels, filled, wrong, wrong_mask);
	g_assert_cmpuint(covered, >, pixels * 9 / 10);
	g_assert_cmpuint(filled, <, covered / 20);
	g_assert_cmpuint(wrong, <, covered / 1000);
	g_assert_cmpuint(wrong_mask, >, covered / 2);
}

static void test_variation(void)
{
	const double value[] = { 2, 4, 4, 4, 5, 5, 7, 9 };
	g_assert_cmpfloat_with_epsilon(coefficient_of_variation(value, 8), 2 / 5.0, 1e-12);
	g_assert_true(isnan(coefficient_of_variation(value, 1)));
}

/* ---- a part of a model ---- */

#define POINTS 4196u

static void write_model(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autofree struct model_point *point = g_new0(struct model_point, POINTS);
	struct model_chunk chunk[2] = { { .points = 4096 }, { .points = 100, .first = 4096 } };
	JsonObject *about = json_object_new();
	json_object_set_double_member(about, "dither_per_m2", 60);
	for (uint32_t i = 0; i < POINTS; i++)
		point[i] = (struct model_point){ .position_m = { (float)i }, .spacing = 40 };
	for (int n = 0; n < 2; n++)
		chunk[n].crc32c =
			crc32c(0, point + chunk[n].first, chunk[n].points * sizeof *point);
	g_autoptr(product_writer) w = product_writer_new(path, &error);
	g_assert_no_error(error);
	g_assert_true(product_writer_begin(w, "points", sizeof *point, &error) &&
		      product_writer_append(w, point, POINTS, &error) &&
		      product_writer_begin(w, "chunks", sizeof *chunk, &error) &&
		      product_writer_append(w, chunk, 2, &error) &&
		      product_writer_finish(w, MODEL_KIND, MODEL_VERSION, about, &error));
}

static void test_subset(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = g_dir_make_tmp("test-bench-XXXXXX", &error);
	g_autofree char *whole = g_build_filename(folder, "whole.model", NULL);
	g_autofree char *part = g_build_filename(folder, "part.model", NULL);
	uint64_t chunks;
	write_model(whole);
	g_autoptr(model) from = model_open_file(whole, &error);
	g_assert_no_error(error);
	g_assert_true(bench_subset_write(from, POINTS / 4, part, &error));
	g_autoptr(model) to = model_open_file(part, &error);
	g_assert_no_error(error);
	const struct model_chunk *chunk = model_chunks(to, &chunks);
	g_assert_cmpuint(chunks, ==, 2);
	g_assert_cmpuint(chunk[0].points, ==, 1024);
	g_assert_cmpuint(chunk[1].points, ==, 25);
	g_assert_true(model_verify(to, &error));
	/* the first ones of each, and each for four times the surface */
	g_assert_cmpfloat(model_points(to)[1024].position_m[0], ==, 4096);
	g_assert_cmpuint(model_points(to)[7].spacing, ==, 80);
	g_assert_cmpfloat(
		json_object_get_double_member(product_manifest(model_file(to)), "dither_per_m2"),
		==, 15);
	g_assert_true(files_remove_tree(folder, NULL));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/bench-render/there-and-back", test_there_and_back);
	g_test_add_func("/bench-render/shows", test_shows);
	g_test_add_func("/bench-render/error", test_error);
	g_test_add_func("/bench-render/share", test_share);
	g_test_add_func("/bench-render/pushed-back", test_pushed_back);
	g_test_add_func("/bench-render/depths", test_depths);
	g_test_add_func("/bench-render/variation", test_variation);
	g_test_add_func("/bench-render/subset", test_subset);
	return g_test_run();
}
