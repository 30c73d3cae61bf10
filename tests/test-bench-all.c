/* What pleinair bench makes of all benches: figures out of their JSON, what is reached, the page; benches that fail, crash or are stopped.
 * The benches are scripts here, but for one. */
#include "firmware-io/files.h"
#include "render/bench-all.h"
#include "render/bench-child.h"
#include "render/bench-figure.h"
#include "render/bench-page.h"
#include "render/bench-reach.h"
#include "render/bench-tables.h"
#include "tests/commands.h"
#include <math.h>

static JsonObject *object_of(const char *text)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(JsonNode) root = json_from_string(text, &error);
	g_assert_no_error(error);
	return json_node_dup_object(root);
}

/* ---- figures ---- */

static const char made_up[] =
	"{\"a\":{\"b\":3},\"rows\":[{\"kind\":\"x\",\"of\":\"1\",\"s\":1.5,\"t\":2},"
	"{\"kind\":\"y\",\"of\":\"1\",\"s\":10},{\"kind\":\"x\",\"of\":\"2, 3\",\"s\":100},"
	"{\"kind\":\"z\",\"why_not\":\"not installed (apt install z)\"}],"
	"\"list\":[7,8.5],\"text\":\"no number\"}";

static const struct figure_case {
	const char *path;
	double value; /* NAN: it is not there */
	const char *why_not;
} figures[] = {
	{ "a/b", 3, NULL },
	{ "rows/kind=y/s", 10, NULL },
	{ "rows/kind=x/s+t", 3.5, NULL },
	{ "rows/kind=x;of=2, 3/s", 100, NULL },
	{ "rows/kind=x;#1/s", 100, NULL },
	{ "rows/#1/s", 10, NULL },
	{ "list/#1", 8.5, NULL },
	{ "list/#2", NAN, NULL },
	{ "rows/kind=x;#2/s", NAN, NULL },
	{ "rows/kind=y/s+t", NAN, NULL },
	{ "rows/kind=z/s", NAN, "not installed (apt install z)" },
	{ "rows/s", NAN, NULL },
	{ "text", NAN, NULL },
	{ "text/more", NAN, NULL },
	{ "nothing/at/all", NAN, NULL },
	{ "a", NAN, NULL },
};

static void test_figures(void)
{
	g_autoptr(JsonObject) root = object_of(made_up);
	for (size_t n = 0; n < G_N_ELEMENTS(figures); n++) {
		struct bench_figure f = bench_figure_find(root, figures[n].path);
		g_test_message("%s", figures[n].path);
		g_assert_cmpint(f.there, ==, !isnan(figures[n].value));
		if (f.there)
			g_assert_cmpfloat(f.value, ==, figures[n].value);
		g_assert_cmpstr(f.why_not, ==, figures[n].why_not);
	}
	g_assert_false(bench_figure_find(NULL, "a/b").there);
}

static void test_numbers(void)
{
	static const struct {
		double value;
		const char *text;
	} numbers[] = { { 0, "0" }, { 0.1, "0.1" }, { 0.05812, "0.0581" }, { 2.25, "2.25" },
		{ 20, "20" }, { 10.55, "10.6" }, { 480.4, "480" }, { 1000, "1000" },
		{ 0.0001, "0.0001" } };
	for (size_t n = 0; n < G_N_ELEMENTS(numbers); n++) {
		g_autofree char *text = bench_reach_number(numbers[n].value);
		g_assert_cmpstr(text, ==, numbers[n].text);
	}
}

/* Each row says of which bench it is, and there is such a bench. */
static void test_rows(void)
{
	for (const struct bench_reach *r = bench_reaches; r->work; r++) {
		bool found = false;
		for (const struct bench_all_part *p = bench_all_parts; p->what; p++)
			found |= g_str_equal(p->what, r->bench);
		g_assert_true(found);
		g_assert_nonnull(r->path);
		g_assert_nonnull(r->source);
	}
}

/* ---- the document and its page ---- */

static const struct {
	const char *bench, *result, *error;
} benches[] = {
	{ "process",
		"{\"columns\":3000,\"normals\":[{\"method\":\"pleinair\",\"cpu_s\":0.05,"
		"\"smooth_median_deg\":0.9},{\"method\":\"PCL AVERAGE_3D_GRADIENT\",\"cpu_s\":0.2},"
		"{\"method\":\"Open3D k = 20\",\"why_not\":\"not installed (apt install "
		"python3-open3d)\"}]}",
		NULL },
	{ "register",
		"{\"trials\":40,\"rows\":[{\"scene\":\"all\",\"kind\":\"all\",\"coarse_s\":0.1,"
		"\"fine_s\":0.2,\"verify_s\":0.1,\"accepted_though_wrong\":1}],\"others\":["
		"{\"method\":\"open3d_fpfh_ransac\",\"pairs\":3,\"cpu_s\":50}]}",
		"1 wrong poses were accepted; none <may> be" },
	{ "acquire", NULL, "it was ended by the signal 11 (Segmentation fault)" },
};

static JsonObject *made_document(bool whole)
{
	JsonArray *all = json_array_new();
	for (size_t n = 0; n < G_N_ELEMENTS(benches); n++) {
		JsonObject *o = json_object_new();
		json_object_set_string_member(o, "bench", benches[n].bench);
		json_object_set_string_member(o, "command", "pleinair bench <&> --repeats 3");
		json_object_set_double_member(o, "seconds", 12.5);
		if (benches[n].result)
			json_object_set_object_member(o, "result", object_of(benches[n].result));
		if (benches[n].error)
			json_object_set_string_member(o, "error", benches[n].error);
		json_array_add_object_element(all, o);
	}
	return bench_all_document(
		object_of("{\"processor\":\"A & B\",\"cores\":2,\"load\":9.5}"), all, whole);
}

static JsonObject *row_of(JsonObject *document, const char *work, const char *what)
{
	JsonArray *reach = json_object_get_array_member(document, "reach");
	for (guint n = 0; n < json_array_get_length(reach); n++) {
		JsonObject *row = json_array_get_object_element(reach, n);
		if (strstr(json_object_get_string_member(row, "work"), work) &&
			strstr(json_object_get_string_member(row, "what"), what))
			return row;
	}
	g_assert_not_reached();
}

static JsonObject *peer_of(JsonObject *row, guint number)
{
	return json_array_get_object_element(json_object_get_array_member(row, "peers"), number);
}

static void test_reach(void)
{
	g_autoptr(JsonObject) d = made_document(true);
	JsonObject *row = row_of(d, "Normals", "processor time");
	g_assert_true(json_object_get_boolean_member(row, "reached"));
	g_assert_cmpfloat(json_object_get_double_member(row, "measured"), ==, 0.05);
	g_assert_cmpfloat(json_object_get_double_member(peer_of(row, 0), "measured"), ==, 0.2);
	g_assert_cmpstr(json_object_get_string_member(peer_of(row, 1), "why_not"), ==,
		"it was not measured");
	g_assert_cmpstr(json_object_get_string_member(peer_of(row, 2), "why_not"), ==,
		"not installed (apt install python3-open3d)");
	g_assert_false(json_object_get_boolean_member(row_of(d, "Normals", "error"), "reached"));
	row = row_of(d, "Coarse", "processor time");
	g_assert_cmpfloat_with_epsilon(json_object_get_double_member(row, "measured"), 0.4, 1e-9);
	g_assert_cmpstr(json_object_get_string_member(row, "of"), ==, "40 pairs");
	g_assert_cmpstr(json_object_get_string_member(peer_of(row, 0), "of"), ==, "3 pairs");
	g_assert_false(json_object_get_boolean_member(row_of(d, "Coarse", "wrong"), "reached"));
	row = row_of(d, "Acquisition", "lost");
	g_assert_false(json_object_has_member(row, "measured"));
	g_assert_false(json_object_has_member(row, "reached"));
	g_autofree char *sum = bench_reach_sum(json_object_get_array_member(d, "reach")),
			*wanted = g_strdup_printf("2 of %u figures are reached, 2 are not, %u were "
						  "not measured",
				json_array_get_length(json_object_get_array_member(d, "reach")),
				json_array_get_length(json_object_get_array_member(d, "reach")) -
					4);
	g_assert_cmpstr(sum, ==, wanted);
}

struct seen {
	guint svg, hatched, full;
};

static void see(GMarkupParseContext *context, const char *name, const char **names,
	const char **values, gpointer user_data, GError **error)
{
	struct seen *s = user_data;
	(void)context;
	(void)error;
	s->svg += g_str_equal(name, "svg");
	g_assert_cmpstr(name, !=, "script");
	for (int n = 0; names[n]; n++) {
		bool is_fill = g_str_equal(name, "rect") && g_str_equal(names[n], "fill");
		s->hatched += is_fill && g_str_has_prefix(values[n], "url(#hatch");
		s->full += is_fill && g_str_equal(values[n], "#1f5fa8");
	}
}

static struct seen parse_page(const char *page)
{
	struct seen s = { 0 };
	const GMarkupParser parser = { .start_element = see };
	g_autoptr(GError) error = NULL;
	g_autoptr(GMarkupParseContext) context = g_markup_parse_context_new(&parser, 0, &s, NULL);
	g_markup_parse_context_parse(context, page, -1, &error);
	g_assert_no_error(error);
	g_markup_parse_context_end_parse(context, &error);
	g_assert_no_error(error);
	return s;
}

static guint count_of(const char *text, const char *what)
{
	guint count = 0;
	for (const char *at = text; (at = strstr(at, what)); at++)
		count++;
	return count;
}

static void test_page(void)
{
	g_autoptr(JsonObject) d = made_document(false);
	g_autofree char *page = bench_page_of(d);
	struct seen s = parse_page(page);
	guint rows = json_array_get_length(json_object_get_array_member(d, "reach"));
	g_assert_cmpuint(s.svg, ==, rows);
	g_assert_cmpuint(s.hatched, ==, 2);
	/* Each plot has one more of this colour, in its pattern. */
	g_assert_cmpuint(s.full, ==, rows + 2);
	g_assert_cmpuint(count_of(page, "\u2713 reached"), ==, 2);
	g_assert_cmpuint(count_of(page, "\u2717 not reached"), ==, 2);
	g_assert_cmpuint(count_of(page, "? not measured"), ==, rows - 4);
	g_assert_nonnull(strstr(page, "log scale"));
	g_assert_nonnull(strstr(page, "stopped before its end"));
	g_assert_nonnull(strstr(page, "was busy"));
	g_assert_nonnull(strstr(page, "A &amp; B, 2 cores"));
	g_assert_nonnull(strstr(page, "none &lt;may&gt; be"));
	g_assert_nonnull(strstr(page, "Segmentation fault"));
	g_assert_nonnull(strstr(page, "apt install python3-open3d"));
}

static void test_tables(void)
{
	g_autoptr(JsonObject) o = object_of(
		"{\"width\":640,\"list\":[1,2.5],\"rows\":[{\"scene_name\":\"A\",\"iou\":{\"tree\":"
		"0.25},\"frames\":[{\"fps\":10}]},{\"scene_name\":\"B\",\"frames\":[{\"fps\":11}],"
		"\"good\":true}]}");
	g_autoptr(GPtrArray) all = bench_tables_of(o);
	g_assert_cmpuint(all->len, ==, 3);
	const bench_tables_table *plain = all->pdata[0], *rows = all->pdata[1],
				 *frames = all->pdata[2];
	g_assert_cmpuint(plain->rows->len, ==, 2);
	g_assert_cmpstr(((GPtrArray *)plain->rows->pdata[1])->pdata[1], ==, "1, 2.500");
	g_assert_cmpuint(rows->columns->len, ==, 3);
	g_assert_cmpstr(rows->columns->pdata[0], ==, "scene name");
	g_assert_cmpstr(rows->columns->pdata[1], ==, "iou tree");
	g_assert_true(g_array_index(rows->numbers, bool, 1));
	g_assert_cmpstr(((GPtrArray *)rows->rows->pdata[1])->pdata[1], ==, "");
	g_assert_cmpstr(frames->title, ==, "rows, frames");
	g_assert_cmpuint(frames->rows->len, ==, 2);
	g_assert_cmpstr(((GPtrArray *)frames->rows->pdata[1])->pdata[0], ==, "B");
	g_assert_cmpstr(((GPtrArray *)frames->rows->pdata[1])->pdata[1], ==, "11");
}

/* ---- children ---- */

static const char script[] =
	"#!/bin/sh\n"
	"echo \"$*\" >> \"${0%/*}/called\"\n"
	"case $1 in\n"
	"good) echo '{\"all_s\":4}';;\n"
	"fails) echo 'noise' >&2; echo 'pleinair bench: there is no disk' >&2; exit 1;;\n"
	"both) echo '{\"trials\":5}'; echo 'pleinair bench: one was wrong' >&2; exit 1;;\n"
	"crashes) kill -SEGV $$;;\n"
	"silent) exit 3;;\n"
	"garbled) echo 'no JSON';;\n"
	"temporary) touch \"$TMPDIR/left\"; echo \"{\\\"a\\\":\\\"$TMPDIR\\\"}\";;\n"
	"hangs) sleep 60 & echo $! > \"${0%/*}/pid\"; wait;;\n"
	"esac\n";

struct desk {
	char *folder, *program, *output;
};

static void desk_begin(struct desk *d)
{
	g_autoptr(GError) error = NULL;
	d->folder = g_dir_make_tmp("bench-all-XXXXXX", &error);
	g_assert_no_error(error);
	d->program = g_build_filename(d->folder, "program", NULL);
	d->output = g_build_filename(d->folder, "out", NULL);
	g_file_set_contents_full(d->program, script, -1, G_FILE_SET_CONTENTS_NONE, 0755, &error);
	g_assert_no_error(error);
}

static void desk_end(struct desk *d)
{
	g_assert_true(files_remove_tree(d->folder, NULL));
	g_free(d->folder);
	g_free(d->program);
	g_free(d->output);
}

static JsonObject *read_document(const struct desk *d)
{
	g_autofree char *path = g_build_filename(d->output, "bench.json", NULL),
			*page_path = g_build_filename(d->output, "bench.html", NULL), *text = NULL,
			*page = NULL;
	g_autoptr(GError) error = NULL;
	g_file_get_contents(page_path, &page, NULL, &error);
	g_assert_no_error(error);
	parse_page(page);
	g_file_get_contents(path, &text, NULL, &error);
	g_assert_no_error(error);
	return object_of(text);
}

static const char *error_of(JsonObject *document, guint bench)
{
	JsonArray *all = json_object_get_array_member(document, "benches");
	return json_object_get_string_member_with_default(
		json_array_get_object_element(all, bench), "error", NULL);
}

static void test_failures(void)
{
	static const struct bench_all_part parts[] = { { "good", "--a 1", 1, true },
		{ "fails", "", 1, false }, { "both", "", 1, false }, { "crashes", "", 1, false },
		{ "silent", "", 1, false }, { "garbled", "", 1, false },
		{ "temporary", "", 1, false }, { NULL } };
	struct desk d;
	desk_begin(&d);
	struct bench_all_options o = { .program = d.program,
		.parts = parts,
		.output = d.output,
		.site = "some-site",
		.seed = 7 };
	g_autoptr(GError) error = NULL;
	g_assert_false(bench_all(&o, &error));
	g_assert_cmpstr(error->message, ==, "5 of 7 benches failed");
	g_autoptr(JsonObject) document = read_document(&d);
	g_assert_false(json_object_has_member(document, "stopped"));
	g_assert_cmpstr(error_of(document, 0), ==, NULL);
	g_assert_cmpstr(error_of(document, 1), ==, "there is no disk");
	g_assert_cmpstr(error_of(document, 2), ==, "one was wrong");
	g_assert_nonnull(strstr(error_of(document, 3), "signal 11"));
	g_assert_nonnull(strstr(error_of(document, 4), "status 3"));
	g_assert_nonnull(strstr(error_of(document, 5), "no JSON"));
	JsonArray *all = json_object_get_array_member(document, "benches");
	g_assert_true(json_object_has_member(json_array_get_object_element(all, 2), "result"));
	g_assert_cmpstr(
		json_object_get_string_member(json_array_get_object_element(all, 0), "command"), ==,
		"pleinair bench good --a 1 --seed 7 --site some-site");
	/* What they left behind is gone. */
	g_assert_false(g_file_test(json_object_get_string_member(
					   json_object_get_object_member(
						   json_array_get_object_element(all, 6), "result"),
					   "a"),
		G_FILE_TEST_EXISTS));
	desk_end(&d);
}

static gint64 stop_at_us;

static bool is_time(void)
{
	return g_get_monotonic_time() > stop_at_us;
}

static bool runs(const char *pid)
{
	g_autofree char *path = g_strdup_printf("/proc/%d/stat", atoi(pid)), *text = NULL;
	return g_file_get_contents(path, &text, NULL, NULL) && !strstr(text, ") Z ");
}

static void test_stopped(void)
{
	static const struct bench_all_part parts[] = { { "good", "", 1, false },
		{ "hangs", "", 1, false }, { "never", "", 1, false }, { NULL } };
	struct desk d;
	desk_begin(&d);
	struct bench_all_options o = {
		.program = d.program, .parts = parts, .output = d.output, .stop = is_time
	};
	g_autoptr(GError) error = NULL;
	gint64 began_us = g_get_monotonic_time();
	stop_at_us = began_us + 2 * G_USEC_PER_SEC;
	g_assert_false(bench_all(&o, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
	g_assert_cmpint(g_get_monotonic_time() - began_us, <, 15 * G_USEC_PER_SEC);
	g_autoptr(JsonObject) document = read_document(&d);
	g_assert_true(json_object_get_boolean_member(document, "stopped"));
	g_assert_cmpuint(
		json_array_get_length(json_object_get_array_member(document, "benches")), ==, 1);
	g_autofree char *path = g_build_filename(d.folder, "pid", NULL), *pid = NULL;
	g_assert_true(g_file_get_contents(path, &pid, NULL, NULL));
	for (int n = 0; n < 100 && runs(pid); n++)
		g_usleep(50000);
	g_assert_false(runs(pid));
	desk_end(&d);
}

static void test_stopped_at_once(void)
{
	static const struct bench_all_part parts[] = { { "hangs", "", 1, false }, { NULL } };
	struct desk d;
	desk_begin(&d);
	struct bench_all_options o = {
		.program = d.program, .parts = parts, .output = d.output, .stop = is_time
	};
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(d.output, "bench.json", NULL);
	stop_at_us = 0;
	g_assert_false(bench_all(&o, &error));
	g_assert_cmpstr(error->message, ==, "stopped");
	g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
	desk_end(&d);
}

static void test_no_program(void)
{
	static const struct bench_all_part parts[] = { { "good", "", 1, false }, { NULL } };
	struct desk d;
	desk_begin(&d);
	struct bench_all_options o = {
		.program = "/nowhere/at-all", .parts = parts, .output = d.output
	};
	g_autoptr(GError) error = NULL;
	g_assert_false(bench_all(&o, &error));
	g_assert_cmpstr(error->message, ==, "1 of 1 benches failed");
	desk_end(&d);
}

/* ---- a real one ---- */

static void test_real(void)
{
	static const struct bench_all_part parts[] = { { "acquire", "--seconds 1", 2, false },
		{ "render", "--size nonsense", 1, false }, { NULL } };
	struct desk d;
	desk_begin(&d);
	g_autofree char *program = commands_program("pleinair-bench");
	struct bench_all_options o = {
		.program = program, .parts = parts, .output = d.output, .seed = 1
	};
	g_autoptr(GError) error = NULL;
	g_assert_false(bench_all(&o, &error));
	g_assert_cmpstr(error->message, ==, "1 of 2 benches failed");
	g_autoptr(JsonObject) document = read_document(&d);
	g_assert_cmpstr(error_of(document, 0), ==, NULL);
	g_assert_nonnull(strstr(error_of(document, 1), "sizes go from"));
	JsonObject *row = row_of(document, "Acquisition", "of one core");
	g_assert_cmpfloat(json_object_get_double_member(row, "measured"), >, 0);
	desk_end(&d);
}

static void test_usage(void)
{
	g_auto(answer) one = commands_run("bench", "--seconds", "3", NULL);
	g_assert_cmpint(one.status, ==, 2);
	g_assert_nonnull(strstr(one.err, "name it"));
	g_auto(answer) two = commands_run("bench", "nonsense", NULL);
	g_assert_cmpint(two.status, ==, 2);
	g_assert_nonnull(strstr(two.err, "station"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	g_test_add_func("/bench-all/figures", test_figures);
	g_test_add_func("/bench-all/numbers", test_numbers);
	g_test_add_func("/bench-all/rows", test_rows);
	g_test_add_func("/bench-all/reach", test_reach);
	g_test_add_func("/bench-all/page", test_page);
	g_test_add_func("/bench-all/tables", test_tables);
	g_test_add_func("/bench-all/failures", test_failures);
	g_test_add_func("/bench-all/stopped", test_stopped);
	g_test_add_func("/bench-all/stopped-at-once", test_stopped_at_once);
	g_test_add_func("/bench-all/no-program", test_no_program);
	g_test_add_func("/bench-all/real", test_real);
	g_test_add_func("/bench-all/usage", test_usage);
	return g_test_run();
}
