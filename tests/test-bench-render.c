/* What pleinair bench render measures with: parts of models. */
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include "render/bench-subset.h"

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
	g_test_add_func("/bench-render/subset", test_subset);
	return g_test_run();
}
