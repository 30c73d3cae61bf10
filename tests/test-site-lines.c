/* Profile lines as a product of a site: made when they are due, whole or not at all, and nothing else is taken for them. */
#include "process/segments.h"
#include "process/site-lines.h"
#include "tests/built-model.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>

/* A hall that all before lines is done of; never removed before the end. */
static const char *hall(void)
{
	static char *path;
	if (path)
		return path;
	path = fresh_site();
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	scan_graph *g = graph_of(SCANS);
	uint32_t count;
	g_assert_true(geometry_site(s, g, NULL, &count, &error));
	g_assert_true(features_site(s, g, NULL, &count, &error));
	scan_graph_free(g);
	build_some(path, SCANS);
	return path;
}

static char *hall_copy(void)
{
	g_autofree char *folder = simulated_folder();
	char *copy = g_build_filename(folder, "site", NULL);
	g_autofree char *command = g_strdup_printf("cp -a '%s' '%s'", hall(), copy);
	g_assert_cmpint(system(command), ==, 0);
	return copy;
}

static char *lines_why(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	bool due;
	char *why;
	g_assert_true(site_lines_is_due(s, &due, &why, &error));
	g_assert_no_error(error);
	g_assert_true(due == (why != NULL));
	return why;
}

static void expect_lines_why(const char *path, const char *expected)
{
	g_autofree char *why = lines_why(path);
	g_assert_cmpstr(why, ==, expected);
}

static profile_lines *make(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	profile_lines *p = site_lines_make(s, NULL, &error);
	g_assert_no_error(error);
	return p;
}

static char *bytes_of(const char *path, gsize *ret_length)
{
	g_autofree char *file = site_lines_path(path);
	char *bytes;
	g_assert_true(g_file_get_contents(file, &bytes, ret_length, NULL));
	return bytes;
}

static void test_made(void)
{
	g_autofree char *path = hall_copy(), *of_points = model_path(path);
	g_autoptr(GError) error = NULL;
	expect_lines_why(path, "the model has no lines yet");
	g_assert_null(site_lines_load(path, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_clear_error(&error);
	g_autoptr(profile_lines) made = make(path);
	g_assert_cmpuint(made->line->len, >, 20);
	expect_lines_why(path, NULL);
	g_autoptr(profile_lines) read = site_lines_load(path, &error);
	g_assert_no_error(error);
	g_assert_cmpmem(made->line->data, made->line->len * sizeof(struct profile_line),
		read->line->data, read->line->len * sizeof(struct profile_line));
	g_assert_cmpmem(made->vertex->data, made->vertex->len * sizeof(struct profile_vertex),
		read->vertex->data, read->vertex->len * sizeof(struct profile_vertex));
	g_assert_cmpmem(
		made->origin_m, sizeof made->origin_m, read->origin_m, sizeof read->origin_m);
	gsize length, again_length;
	g_autofree char *bytes = bytes_of(path, &length);
	omp_set_num_threads(1);
	profile_lines_free(make(path));
	omp_set_num_threads(omp_get_num_procs());
	g_autofree char *again = bytes_of(path, &again_length);
	g_assert_cmpmem(bytes, length, again, again_length);
	g_assert_cmpint(g_remove(of_points), ==, 0);
	expect_lines_why(path, NULL); /* of no model there are none to be made */
}

/* Other classes of leaves, another model. */
static void test_due(void)
{
	g_autofree char *path = hall_copy();
	profile_lines_free(make(path));
	g_autoptr(GError) error = NULL;
	g_autofree char *tree = segments_path(path), *folder = g_path_get_dirname(tree);
	g_assert_cmpint(g_mkdir_with_parents(folder, 0700), ==, 0);
	g_autoptr(segments) s = segments_new();
	g_assert_cmpuint(segments_add(s, segment_of_class(CLASS_STRUCTURE), "Post", "user"), >, 0);
	g_assert_true(segments_save(s, path, &error));
	expect_lines_why(path, "the model that the lines are of has changed");
	profile_lines_free(make(path));
	expect_lines_why(path, NULL);
	build_some(path, 2);
	expect_lines_why(path, "the model that the lines are of has changed");
}

static bool stop_at_once(double fraction, const char *doing, gpointer user_data)
{
	(void)doing;
	(void)user_data;
	return fraction < 0;
}

static void test_stopped(void)
{
	g_autofree char *path = hall_copy();
	profile_lines_free(make(path));
	gsize length, again_length;
	g_autofree char *bytes = bytes_of(path, &length);
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	const struct site_lines_options options = { .progress = stop_at_once };
	g_assert_null(site_lines_make(s, &options, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
	g_autofree char *again = bytes_of(path, &again_length);
	g_assert_cmpmem(bytes, length, again, again_length);
}

/* ---- what is no such file ---- */

struct wrong {
	const char *name, *says;
	void (*make)(profile_lines *p);
};

static struct profile_line *first_of(profile_lines *p)
{
	return &g_array_index(p->line, struct profile_line, 0);
}

static void short_one(profile_lines *p)
{
	first_of(p)->count = 1;
}
static void beyond(profile_lines *p)
{
	first_of(p)->first = p->vertex->len - 1;
}
static void far_beyond(profile_lines *p)
{
	first_of(p)->count = G_MAXUINT32;
}
static void shared(profile_lines *p)
{
	first_of(p)->first = 2;
}
static void no_kind(profile_lines *p)
{
	first_of(p)->kind = PROFILE_KINDS;
}
static void half_closed(profile_lines *p)
{
	first_of(p)->closed = 2;
}
static void too_sure(profile_lines *p)
{
	first_of(p)->confidence = 1.5f;
}
static void no_length(profile_lines *p)
{
	first_of(p)->length_m = NAN;
}
static void no_origin(profile_lines *p)
{
	p->origin_m[1] = INFINITY;
}
static void no_place(profile_lines *p)
{
	g_array_index(p->vertex, struct profile_vertex, 3).at_m[2] = NAN;
}

static const struct wrong wrongs[] = {
	{ "short", "lines and vertices do not belong together", short_one },
	{ "beyond", "lines and vertices do not belong together", beyond },
	{ "far-beyond", "lines and vertices do not belong together", far_beyond },
	{ "shared", "lines and vertices do not belong together", shared },
	{ "no-kind", "a line is of no kind that there is", no_kind },
	{ "half-closed", "a line is of no kind that there is", half_closed },
	{ "too-sure", "a line is of no kind that there is", too_sure },
	{ "no-length", "a line is of no kind that there is", no_length },
	{ "no-origin", "a line's place is not a number", no_origin },
	{ "no-place", "a line's place is not a number", no_place },
};

static void put(product_writer *w, const char *name, uint32_t bytes, const void *from, guint count)
{
	g_assert_true(product_writer_begin(w, name, bytes, NULL));
	g_assert_true(product_writer_append(w, from, count, NULL));
}

static void save(const char *path, const profile_lines *p)
{
	g_autoptr(product_writer) w = product_writer_new(path, NULL);
	put(w, "lines", sizeof(struct profile_line), p->line->data, p->line->len);
	put(w, "vertices", sizeof(struct profile_vertex), p->vertex->data, p->vertex->len);
	put(w, "origin", sizeof(double), p->origin_m, 3);
	g_assert_true(product_writer_finish(
		w, SITE_LINES_KIND, SITE_LINES_VERSION, json_object_new(), NULL));
}

/* Two lines of two vertices. */
static profile_lines *made_lines(void)
{
	profile_lines *p = profile_lines_new();
	for (uint32_t n = 0; n < 4; n++) {
		struct profile_vertex v = { .at_m = { (float)n, 1, 2 } };
		g_array_append_val(p->vertex, v);
	}
	for (uint32_t n = 0; n < 2; n++) {
		struct profile_line l = {
			.first = 2 * n, .count = 2, .length_m = 1, .confidence = 1
		};
		g_array_append_val(p->line, l);
	}
	return p;
}

static void test_wrong(gconstpointer data)
{
	const struct wrong *w = data;
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "x.lines", NULL);
	g_autoptr(GError) error = NULL;
	g_autoptr(profile_lines) p = made_lines();
	save(path, p);
	g_autoptr(profile_lines) good = site_lines_load_file(path, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(good->line->len, ==, 2);
	w->make(p);
	save(path, p);
	g_assert_null(site_lines_load_file(path, &error));
	g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	g_autofree char *says = g_strdup_printf("%s: %s", path, w->says);
	g_assert_cmpstr(error->message, ==, says);
}

/* Any byte of it. */
static void test_damaged(void)
{
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "x.lines", NULL), *bytes = NULL;
	g_autoptr(profile_lines) p = made_lines();
	gsize length;
	uint32_t taken = 0;
	save(path, p);
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	for (gsize n = 0; n < length; n++) {
		g_autoptr(GError) error = NULL;
		bytes[n] ^= 1;
		g_assert_true(g_file_set_contents(path, bytes, (gssize)length, NULL));
		bytes[n] ^= 1;
		g_autoptr(profile_lines) read = site_lines_load_file(path, &error);
		g_assert_true((read == NULL) == (error != NULL));
		taken += read != NULL; /* what lies between sections has no checksum */
	}
	g_test_message("%u of %zu bytes do not matter", taken, length);
	g_assert_cmpuint(taken, <, length / 2);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/site-lines/made", test_made);
	g_test_add_func("/site-lines/due", test_due);
	g_test_add_func("/site-lines/stopped", test_stopped);
	for (size_t n = 0; n < G_N_ELEMENTS(wrongs); n++) {
		g_autofree char *path = g_strdup_printf("/site-lines/wrong/%s", wrongs[n].name);
		g_test_add_data_func(path, &wrongs[n], test_wrong);
	}
	g_test_add_func("/site-lines/damaged", test_damaged);
	return g_test_run();
}
