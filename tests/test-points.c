/* points.ply: what is written is read back, and a header that lies is refused. */
#include "acquire/points.h"
#include "tests/simulated.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <unistd.h>

static struct point_record record(int i)
{
	return (struct point_record){ 0.1 * i + 1e-13, -1.0 / (i + 1), 1e5 + i, (uint16_t)(i * 7),
		{ (uint8_t)i, 2, 3 }, (uint8_t)(i % 20), 1, 1 };
}

static char *write_points(const char *folder, uint32_t columns, uint32_t rows, int count)
{
	g_autoptr(GError) error = NULL;
	char *path = g_build_filename(folder, "points.ply", NULL);
	g_autoptr(points_writer) w = points_writer_new(path, columns, rows, &error);
	g_assert_no_error(error);
	for (int i = 0; i < count; i++) {
		struct point_record r = record(i);
		g_assert_true(points_writer_append(w, &r, 1, &error));
	}
	g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS)); /* not before it is whole */
	g_assert_true(points_writer_finish(w, &error));
	g_assert_no_error(error);
	return path;
}

static void test_round_trip(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = write_points(folder, 4, 3, 12);
	g_autoptr(points) p = points_open(path, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(p->count, ==, 12);
	g_assert_cmpuint(p->columns, ==, 4);
	g_assert_cmpuint(p->rows, ==, 3);
	g_assert_cmpuint(p->have, ==,
		POINTS_HAVE_INTENSITY | POINTS_HAVE_COLOUR | POINTS_HAVE_CLASSIFICATION);
	for (int i = 0; i < 12; i++) {
		struct point_record r = record(i);
		g_assert_cmpmem(&p->record[i], sizeof r, &r, sizeof r);
	}
}

static void test_have(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder(), *path = g_build_filename(folder, "p", NULL);
	struct point_record plain = { .x_m = 1, .cell = 1, .return_number = 1 };
	struct point_record green = { .x_m = 1, .cell = 1, .rgb = { 0, 9, 0 } };
	g_autoptr(points_writer) w = points_writer_new(path, 0, 0, &error);
	g_assert_true(points_writer_append(w, &plain, 1, &error));
	g_assert_true(points_writer_append(w, &green, 1, &error));
	g_assert_true(points_writer_finish(w, &error));
	g_autoptr(points) p = points_open(path, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(p->have, ==, POINTS_HAVE_COLOUR);
	g_assert_cmpuint(p->columns, ==, 0);
}

static void test_empty(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = write_points(folder, 0, 0, 0);
	g_autoptr(points) p = points_open(path, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(p->count, ==, 0);
}

static void test_unfinished(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder(), *path = g_build_filename(folder, "p", NULL);
	points_writer *w = points_writer_new(path, 2, 2, &error);
	struct point_record r = record(1);
	g_assert_true(points_writer_append(w, &r, 1, &error));
	g_assert_false(points_writer_finish(w, &error)); /* 1 of 4 cells */
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA);
	points_writer_free(w);
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	g_assert_null(g_dir_read_name(dir));
}

static void assert_refused(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_assert_null(points_open(path, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA);
	g_assert_true(g_str_has_prefix(error->message, path));
}

static void replace(const char *path, const char *what, const char *by)
{
	g_autofree char *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	char *at = memmem(bytes, length, what, strlen(what));
	g_assert_nonnull(at);
	memcpy(at, by, strlen(by));
	g_assert_true(g_file_set_contents(path, bytes, (gssize)length, NULL));
}

static void test_lies(void)
{
	static const char *const lies[][2] = { { "vertex 12", "vertex 13" },
		{ "vertex 12", "vertex 11" }, { "num_cols 4", "num_cols 5" },
		{ "num_cols 4", "num_cols 0" }, { "double x", "double q" }, { "ply\n", "pla\n" },
		{ "end_header", "END_header" }, { "have 7", "have x" },
		{ "vertex 12\n", "vertex 1e9" } };
	for (size_t i = 0; i < G_N_ELEMENTS(lies); i++) {
		g_autofree char *folder = simulated_folder();
		g_autofree char *path = write_points(folder, 4, 3, 12);
		replace(path, lies[i][0], lies[i][1]);
		assert_refused(path);
	}
}

static void test_cut(void)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = write_points(folder, 0, 0, 12);
	for (int length = 512 + 12 * 32 - 1; length >= 0; length -= length > 520 ? 1 : 13) {
		g_assert_cmpint(truncate(path, length), ==, 0);
		assert_refused(path);
	}
}

/* 2^59 * 32 bytes is 0 in 64 bits. */
static void test_overflow(void)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = write_points(folder, 0, 0, 0);
	g_autofree char *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	g_autofree char *beginning = g_strndup(bytes, length);
	char *at = strstr(beginning, "vertex 0\n"), *pad = strstr(beginning, "comment ");
	g_autoptr(GString) text = g_string_new_len(beginning, at - beginning);
	g_string_append(text, "vertex 576460752303423488\n");
	g_string_append_len(
		text, at + strlen("vertex 0\n"), pad - at - (gssize)strlen("vertex 0\n"));
	g_string_append(text, "comment ");
	while (text->len < 512 - strlen("\nend_header\n"))
		g_string_append_c(text, '.');
	g_string_append(text, "\nend_header\n");
	g_assert_true(g_file_set_contents(path, text->str, (gssize)text->len, NULL));
	assert_refused(path);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/points/round-trip", test_round_trip);
	g_test_add_func("/points/have", test_have);
	g_test_add_func("/points/empty", test_empty);
	g_test_add_func("/points/unfinished", test_unfinished);
	g_test_add_func("/points/lies", test_lies);
	g_test_add_func("/points/cut", test_cut);
	g_test_add_func("/points/overflow", test_overflow);
	return g_test_run();
}
