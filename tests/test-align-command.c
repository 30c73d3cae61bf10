/* pleinair align as people type it: picked pairs, verdicts, decisions, and what they do to the poses. */
#include "acquire/cli.h"
#include "process/pick-file.h"
#include "process/scan-graph.h"
#include "tests/commands.h"
#include "tests/placed-scans.h"

#define STATIONS 3
#define SCENE    "court?seed=9&ares=1080&camera=none&divergence_mrad=0&station="
#define DEGREE   (G_PI / 180)

static char *description_of(int number)
{
	return g_strdup_printf(SCENE "%d", number);
}

static const struct pose *truth_of(int number)
{
	static struct pose pose[STATIONS + 1];
	static bool known[STATIONS + 1];
	g_autofree char *description = description_of(number);
	if (!known[number])
		pose[number] = simulated_pose(description);
	known[number] = true;
	return &pose[number];
}

/* Three scans, made once. */
static const char *scanned_site(void)
{
	static char *path;
	if (path)
		return path;
	g_autofree char *folder = simulated_folder();
	path = g_build_filename(folder, "site", NULL);
	for (int i = 1; i <= STATIONS; i++) {
		g_autofree char *description = description_of(i);
		simulated_draft(path, description);
	}
	return path;
}

/* A copy of it for one test. */
struct folder {
	char *path, *site;
};

static struct folder folder_new(void)
{
	char *path = simulated_folder();
	struct folder f = { path, g_build_filename(path, "site", NULL) };
	commands_shell("cp -r '%s' '%s'", scanned_site(), f.site);
	return f;
}

static void folder_clear(struct folder *f)
{
	g_free(f->site);
	g_free(f->path);
}

static char *write_file(const struct folder *f, const char *name, const char *text)
{
	char *path = g_build_filename(f->path, name, NULL);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
	return path;
}

/* Six points of the court as seen from two stations, some millimetres off; the one with the number blunder by far. off: how far
 * all of b is off. */
static char *write_pairs(const struct folder *f, int a, int b, int blunder, const struct pose *off)
{
	static const double at[6][3] = { { -6, -5, 0.2 }, { 5, -4, 1.6 }, { 6, 7, 3.1 },
		{ -4, 6, 2.2 }, { 1, 2, 0.9 }, { 3, -7, 4.4 } };
	g_autoptr(GString) text = g_string_new("# the court's corners\n\n");
	struct pose to_a = pose_inverse(truth_of(a)), to_b = pose_inverse(truth_of(b));
	for (int i = 0; i < 6; i++) {
		double p[3], q[3];
		pose_apply(&to_a, at[i], p);
		pose_apply(&to_b, at[i], q);
		if (off)
			pose_apply(off, q, q);
		g_string_append_printf(text, "%.2f %.2f\t%.2f  %.2f %.2f %.2f # %d\n", p[0], p[1],
			p[2], q[0] + (i + 1 == blunder ? 1.2 : 0), q[1], q[2], i + 1);
	}
	return write_file(f, "pairs.txt", text->str);
}

static scan_graph *load(const struct folder *f)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(f->site, &error);
	scan_graph *g = s ? scan_graph_load(s, &error) : NULL;
	g_assert_no_error(error);
	return g;
}

static void assert_true_pose(const struct pose *between, int a, int b)
{
	struct pose right = pose_between(truth_of(a), truth_of(b));
	struct pose d = pose_between(&right, between);
	g_test_message(
		"%.1f mm, %.3f degrees", 1000 * pose_distance_m(&d), pose_angle_rad(&d) / DEGREE);
	g_assert_cmpfloat(pose_distance_m(&d), <, 0.01);
	g_assert_cmpfloat(pose_angle_rad(&d), <, 0.05 * DEGREE);
}

static void assert_placed(const struct folder *f, const char *groups)
{
	g_autoptr(scan_graph) g = load(f);
	g_autoptr(GString) text = g_string_new(NULL);
	for (guint i = 0; i < g->scans->len; i++)
		g_string_append_printf(
			text, "%u", g_array_index(g->scans, struct placed_scan, i).group);
	g_assert_cmpstr(text->str, ==, groups);
}

/* ---- usage ---- */

static const struct usage {
	const char *path;
	const char *arguments[8];
	int status;
	const char *names;
} usages[] = {
	{ "no-site", { "align" }, 2, "which site" },
	{ "no-scans", { "align", "x" }, 2, "which two scans" },
	{ "one-scan", { "align", "x", "1" }, 2, "which two scans" },
	{ "three-scans", { "align", "x", "1", "2", "3" }, 2, "which two scans" },
	{ "word", { "align", "x", "1", "two" }, 2, "'two'" },
	{ "zero", { "align", "x", "0", "2" }, 2, "'0'" },
	{ "same", { "align", "x", "2", "2" }, 2, "itself" },
	{ "both", { "align", "x", "1", "2", "--accept", "--refuse" }, 2, "only one" },
	{ "undo-scans", { "align", "x", "1", "2", "--undo" }, 2, "whole site" },
	{ "list-scans", { "align", "x", "1", "2", "--list" }, 2, "whole site" },
	{ "pairs-refuse", { "align", "x", "1", "2", "--refuse", "--pairs", "p" }, 2, "--pairs" },
	{ "option", { "align", "x", "1", "2", "--frob" }, 2, "--frob" },
	{ "missing", { "align", "no/x", "1", "2" }, 1, "no/x" },
	{ "missing-list", { "align", "no/x", "--list" }, 1, "no/x" },
};

static void test_usage(gconstpointer data)
{
	const struct usage *u = data;
	g_autofree char *folder = simulated_folder(), *here = g_get_current_dir();
	g_assert_cmpint(g_chdir(folder), ==, 0);
	g_auto(answer) a = commands_run_in(NULL, u->arguments);
	g_assert_cmpint(g_chdir(here), ==, 0);
	commands_assert_refused(&a, u->status, u->names);
	g_autofree char *names = commands_names(folder);
	g_assert_cmpstr(names, ==, "");
}

/* What is refused changes nothing. */
static void test_refusals(void)
{
	struct folder f = folder_new();
	g_autofree char *before = commands_snapshot(f.site);
	g_auto(answer) a = commands_run("align", f.site, "1", "7");
	commands_assert_refused(&a, 1, "there is no scan 7");
	g_auto(answer) b = commands_run("align", f.site, "1", "2", "--accept");
	commands_assert_refused(&b, 1, "scans 1 and 2 have not been aligned yet");
	g_auto(answer) c = commands_run("align", f.site, "--undo", "--json");
	commands_assert_refused(&c, 1, "no alignment left to undo");
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	folder_clear(&f);
}

static const struct bad_file {
	const char *path, *text, *names;
} bad_files[] = {
	{ "word", "1 2 3 4 5 6\n1 2 3 4 5 six\n", "bad.txt: line 2: 'six' is no number" },
	{ "few-numbers", "1 2 3 4 5\n", "bad.txt: line 1: the point in scan B is not whole" },
	{ "one-number", "#\n\n1\n", "bad.txt: line 3: the point in scan A is not whole" },
	{ "many-numbers", "1 2 3 4 5 6 7\n", "bad.txt: line 1: '7' is one word too many" },
	{ "nan", "1 2 3 4 5 nan\n", "bad.txt: line 1: 'nan' is no place" },
	{ "far", "1 2 3 4 1e300 6\n", "bad.txt: line 1: '1e300' is no place" },
	{ "cell", "c:1 c:2,3\n", "bad.txt: line 1: 'c:1' is no cell" },
	{ "cell-negative", "c:1,-1 c:2,3\n", "bad.txt: line 1: 'c:1,-1' is no cell" },
	{ "cell-large", "c:1,99999999999 c:2,3\n", "is no cell" },
	{ "cell-outside", "1 2 3 4 5 6\nc:0,100 c:750,3\n",
		"bad.txt: line 2: cell 750,3 is outside" },
	{ "terminal", "1 2 3 4 5 \033[2J\n", "'?[2J' is no number" },
	{ "empty", "", "bad.txt: 0 pairs of points" },
	{ "two", "1 2 3 4 5 6\n2 3 4 5 6 7\n", "bad.txt: 2 pairs of points" },
	{ "line", "1 0 0 1 0 0\n2 0 0 2 0 0\n3 0 0 3 0 0\n4 0 0 4 0 0\n", "on a line" },
	{ "disagree", "0 0 0 0 0 0\n1 0 0 5 0 0\n0 1 0 9 9 9\n0 0 1 0 -4 2\n", "agree" },
};

static void test_bad_files(void)
{
	struct folder f = folder_new();
	g_autofree char *before = commands_snapshot(f.site);
	for (size_t i = 0; i < G_N_ELEMENTS(bad_files); i++) {
		const struct bad_file *b = &bad_files[i];
		g_autofree char *path = write_file(&f, "bad.txt", b->text);
		g_test_message("%s", b->path);
		g_auto(answer) a = commands_run("align", f.site, "1", "2", "--pairs", path);
		commands_assert_refused(&a, 1, b->names);
	}
	g_autofree char *path = g_build_filename(f.path, "bad.txt", NULL);
	g_assert_true(g_file_set_contents(path, "a\0b", 3, NULL));
	g_auto(answer) binary = commands_run("align", f.site, "1", "2", "--pairs", path);
	commands_assert_refused(&binary, 1, "is no text");
	g_auto(answer) gone = commands_run("align", f.site, "1", "2", "--pairs", "/no/pairs");
	commands_assert_refused(&gone, 1, "/no/pairs");
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	folder_clear(&f);
}

/* ---- aligning ---- */

static void test_pairs(void)
{
	struct folder f = folder_new();
	g_autofree char *pairs = write_pairs(&f, 1, 2, 3, NULL);
	g_auto(answer) a = commands_run("align", f.site, "1", "2", "--pairs", pairs);
	commands_assert_done(&a);
	g_test_message("%s", a.out);
	g_assert_nonnull(strstr(a.out, "pair 3 (line 5): "));
	g_auto(GStrv) out = g_strsplit(a.out, "left out", -1);
	g_assert_cmpuint(g_strv_length(out), ==, 2); /* one */
	g_assert_nonnull(strstr(a.out, "5 of 6 pairs fit to "));
	g_assert_nonnull(strstr(a.out, "scans 1 and 2: accepted (picked)"));
	g_assert_nonnull(strstr(a.out, "scan 2 is placed now"));
	g_assert_nonnull(strstr(a.out, "revision 1: scans 1 and 2 aligned from 5 picked pairs"));
	g_assert_nonnull(strstr(a.out, "2 of 3 scans are placed"));
	assert_placed(&f, "110");
	g_autoptr(scan_graph) g = load(&f);
	const struct edge *e = scan_graph_edge(g, 1, 2);
	g_assert_cmpint(e->origin, ==, EDGE_PICKED);
	assert_true_pose(&e->pose, 1, 2);
	struct pose between =
		pose_between(&scan_graph_scan(g, 1)->pose, &scan_graph_scan(g, 2)->pose);
	assert_true_pose(&between, 1, 2);
	folder_clear(&f);
}

/* The other way round it is the same pair. */
static void test_swapped(void)
{
	struct folder f = folder_new();
	g_autofree char *pairs = write_pairs(&f, 3, 2, 0, NULL);
	g_auto(answer) a = commands_run("align", f.site, "3", "2", "--pairs", pairs, "--json");
	commands_assert_done(&a);
	g_autoptr(JsonNode) node = commands_json(&a);
	JsonObject *o = json_node_get_object(node);
	JsonArray *told = json_object_get_array_member(o, "pairs");
	g_assert_cmpuint(json_array_get_length(told), ==, 6);
	JsonObject *last = json_array_get_object_element(told, 5);
	g_assert_cmpint(json_object_get_int_member(last, "line"), ==, 8);
	g_assert_false(json_object_get_boolean_member(last, "blunder"));
	g_assert_cmpfloat(json_object_get_double_member(last, "residual_mm"), <, 20);
	g_assert_cmpfloat(json_object_get_double_member(o, "refined_mm"), <, 100);
	JsonObject *edge = json_object_get_object_member(o, "edge");
	g_assert_cmpint(json_object_get_int_member(edge, "a"), ==, 2);
	g_assert_cmpstr(json_object_get_string_member(edge, "standing"), ==, "accepted");
	g_assert_cmpfloat(json_object_get_double_member(edge, "overlap"), >, 0.2);
	g_autoptr(scan_graph) g = load(&f);
	assert_true_pose(&scan_graph_edge(g, 2, 3)->pose, 2, 3);
	folder_clear(&f);
}

/* Cells that look at the same places. */
static void test_cells(void)
{
	struct folder f = folder_new();
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(f.site, &error);
	g_autoptr(scan_data) a = scan_data_load(s, 1, &error);
	g_autoptr(scan_data) b = scan_data_load(s, 2, &error);
	g_assert_no_error(error);
	struct pose between = pose_between(truth_of(1), truth_of(2)), back = pose_inverse(&between);
	g_autoptr(GString) text = g_string_new(NULL);
	int found = 0;
	for (uint32_t i = 0; i < range_grid_cells(a->grid) && found < 8; i += 2203) {
		double p[3] = { a->grid->x_m[i], a->grid->y_m[i], a->grid->z_m[i] }, q[3];
		pose_apply(&back, p, q);
		uint32_t j = range_grid_find(b->grid, q[0], q[1], q[2]);
		if (!(a->grid->range_m[i] > 0) || j == RANGE_GRID_NONE)
			continue;
		double d[3] = { b->grid->x_m[j] - q[0], b->grid->y_m[j] - q[1],
			b->grid->z_m[j] - q[2] };
		if (hypot(hypot(d[0], d[1]), d[2]) > 0.06)
			continue;
		found++;
		g_string_append_printf(text, "c:%u,%u c:%u,%u\n", i % a->grid->columns,
			i / a->grid->columns, j % b->grid->columns, j / b->grid->columns);
	}
	g_assert_cmpint(found, >=, 6);
	g_autofree char *path = write_file(&f, "cells.txt", text->str);
	g_auto(answer) done = commands_run("align", f.site, "1", "2", "--pairs", path);
	commands_assert_done(&done);
	g_test_message("%s", done.out);
	g_autoptr(scan_graph) g = load(&f);
	assert_true_pose(&scan_graph_edge(g, 1, 2)->pose, 1, 2);
	folder_clear(&f);
}

/* Pairs that agree with each other, but tell a wrong pose: kept as refused, unless a person vouches for them. */
static void test_wrong_pairs(void)
{
	struct folder f = folder_new();
	double twist[6] = { 0, 0, 50 * DEGREE, 4, -3, 0 };
	struct pose off = pose_perturb(&POSE_IDENTITY, twist);
	g_autofree char *pairs = write_pairs(&f, 1, 2, 0, &off);
	g_auto(answer) a = commands_run("align", f.site, "1", "2", "--pairs", pairs);
	g_test_message("%s%s", a.out, a.err);
	g_assert_cmpint(a.status, ==, 1);
	g_assert_true(g_str_has_prefix(a.err, "pleinair align: scans 1 and 2: refused ("));
	g_assert_nonnull(strstr(a.out, "6 of 6 pairs fit to "));
	g_assert_nonnull(strstr(a.err, "Another pose, "));
	assert_placed(&f, "100");
	{
		g_autoptr(scan_graph) g = load(&f);
		const struct edge *e = scan_graph_edge(g, 1, 2);
		g_assert_cmpint(e->verification.verdict, !=, VERDICT_ACCEPTED);
		g_assert_cmpint(e->decision, ==, DECISION_NONE);
	}
	g_auto(answer) b = commands_run("align", f.site, "1", "2", "--accept");
	commands_assert_done(&b);
	g_assert_nonnull(strstr(b.out, "accepted by hand (picked)"));
	assert_placed(&f, "110");
	g_autoptr(scan_graph) g = load(&f);
	struct pose right = pose_between(truth_of(1), truth_of(2));
	struct pose d = pose_between(&right, &scan_graph_edge(g, 1, 2)->pose);
	g_assert_cmpfloat(pose_angle_rad(&d), >, 45 * DEGREE);
	folder_clear(&f);
}

/* ---- decisions ---- */

static JsonArray *list_member(JsonNode *node, const char *key, guint length)
{
	JsonArray *array = json_object_get_array_member(json_node_get_object(node), key);
	g_assert_cmpuint(json_array_get_length(array), ==, length);
	return array;
}

static void test_decisions(void)
{
	struct folder f = folder_new();
	g_auto(answer) one = commands_run("align", f.site, "1", "2"),
		       two = commands_run("align", f.site, "2", "3", "--json");
	commands_assert_done(&one);
	commands_assert_done(&two);
	g_assert_nonnull(strstr(one.out, "scans 1 and 2: accepted (automatic)"));
	assert_placed(&f, "111");
	g_auto(answer) refused = commands_run("align", f.site, "3", "2", "--refuse");
	commands_assert_done(&refused);
	g_assert_nonnull(strstr(refused.out, "scan 3 is not placed any more"));
	g_assert_nonnull(strstr(refused.out, "2 of 3 scans are placed"));
	assert_placed(&f, "110");
	g_auto(answer) undone = commands_run("align", f.site, "--undo");
	commands_assert_done(&undone);
	g_assert_nonnull(strstr(undone.out, "scan 3 is placed now"));
	g_assert_nonnull(strstr(undone.out, "revision 4: undone: "));
	assert_placed(&f, "111");
	g_auto(answer) accepted = commands_run("align", f.site, "2", "3", "--accept");
	commands_assert_done(&accepted);
	g_assert_nonnull(strstr(accepted.out, "accepted by hand (automatic)"));
	g_assert_nonnull(strstr(accepted.out, "no scan moved"));
	g_autofree char *before = commands_snapshot(f.site);
	g_auto(answer) list = commands_run("align", f.site, "--list", "--json"),
		       plain = commands_run("align", f.site, "--list");
	commands_assert_done(&list);
	commands_assert_done(&plain);
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	g_assert_nonnull(strstr(plain.out, "2 pairs; 3 of 3 scans are placed"));
	g_assert_nonnull(strstr(plain.out, "revision 5, from 4, "));
	g_autoptr(JsonNode) node = commands_json(&list);
	JsonObject *edge = json_array_get_object_element(list_member(node, "edges", 2), 1);
	g_assert_cmpstr(json_object_get_string_member(edge, "standing"), ==, "accepted by hand");
	JsonObject *first = json_array_get_object_element(list_member(node, "history", 5), 4);
	g_assert_cmpint(json_object_get_int_member(first, "revision"), ==, 1);
	g_assert_cmpstr(json_object_get_string_member(first, "change"), ==,
		"scans 1 and 2 aligned, accepted");
	folder_clear(&f);
}

/* Back to before the first change, and no further. */
static void test_undo_all(void)
{
	struct folder f = folder_new();
	g_auto(answer) one = commands_run("align", f.site, "1", "2");
	commands_assert_done(&one);
	g_auto(answer) undone = commands_run("align", f.site, "--undo", "--json");
	commands_assert_done(&undone);
	g_autoptr(JsonNode) node = commands_json(&undone);
	JsonObject *move = json_array_get_object_element(list_member(node, "moves", 2), 1);
	g_assert_cmpint(json_object_get_int_member(move, "scan"), ==, 2);
	g_assert_cmpstr(json_object_get_string_member(move, "what"), ==, "not placed");
	JsonObject *o = json_node_get_object(node);
	g_assert_cmpint(json_object_get_int_member(o, "placed"), ==, 0);
	g_assert_cmpint(json_object_get_int_member(o, "scans"), ==, 3);
	g_auto(answer) again = commands_run("align", f.site, "--undo");
	commands_assert_refused(&again, 1, "no alignment left to undo");
	folder_clear(&f);
}

/* A list of nothing is no error. */
static void test_empty_list(void)
{
	struct folder f = folder_new();
	g_auto(answer) a = commands_run("align", f.site, "--list");
	commands_assert_done(&a);
	g_assert_cmpstr(a.out, ==, "0 pairs; 0 of 3 scans are placed\n");
	folder_clear(&f);
}

static void test_locked(void)
{
	struct folder f = folder_new();
	g_autoptr(site) s = site_open_existing(f.site, NULL);
	g_auto(answer) a = commands_run("align", f.site, "1", "2");
	commands_assert_refused(&a, 1, "another program is writing");
	g_auto(answer) list = commands_run("align", f.site, "--list");
	commands_assert_done(&list);
	folder_clear(&f);
}

/* Stopped while it works, or with a disk that is full: what was there stays. */
static void test_stopped(void)
{
	struct folder f = folder_new();
	g_auto(answer) one = commands_run("align", f.site, "1", "2");
	commands_assert_done(&one);
	g_autofree char *before = commands_snapshot(f.site);
	const char *const arguments[] = { "align", f.site, "2", "3", NULL };
	const struct surroundings small = { .file_bytes_max = 1500 };
	g_auto(answer) full = commands_run_in(&small, arguments);
	commands_assert_refused(&full, 1, "File too large");
	g_autofree char *after = commands_snapshot(f.site);
	g_assert_cmpstr(before, ==, after);
	running r = commands_start(arguments);
	g_usleep(300000);
	kill(r.pid, SIGTERM);
	g_auto(answer) a = commands_end(&r);
	if (a.status == CLI_DONE)
		g_test_message("it was done before it could be stopped");
	else if (a.status == 1)
		g_assert_nonnull(strstr(a.err, "stopped; nothing was changed"));
	g_autofree char *last = commands_snapshot(f.site);
	g_assert_true(a.status == CLI_DONE || strcmp(before, last) == 0);
	folder_clear(&f);
}

/* A grid and a cloud without one. */
static void test_cloud(void)
{
	struct folder f = folder_new();
	g_autoptr(GError) error = NULL;
	g_autoptr(GString) text = g_string_new("ply\nformat ascii 1.0\n");
	g_autoptr(GString) rows = g_string_new(NULL);
	{
		g_autoptr(site) s = site_open(f.site, &error);
		g_autoptr(scan_data) d = scan_data_load(s, 2, &error);
		size_t count = 0;
		for (size_t i = 0; i < range_grid_cells(d->grid); i += 4) {
			if (!(d->grid->range_m[i] > 0))
				continue;
			g_string_append_printf(rows, "%.4f %.4f %.4f\n", d->grid->x_m[i],
				d->grid->y_m[i], d->grid->z_m[i]);
			count++;
		}
		g_string_append_printf(text,
			"element vertex %zu\nproperty float x\nproperty float y\n"
			"property float z\nend_header\n%s",
			count, rows->str);
	}
	g_autofree char *file = write_file(&f, "cloud.ply", text->str);
	g_auto(answer) imported = commands_run("import", f.site, file);
	commands_assert_done(&imported);
	g_autofree char *pairs = write_pairs(&f, 1, 2, 0, NULL);
	g_auto(answer) a = commands_run("align", f.site, "1", "4", "--pairs", pairs, "--accept");
	commands_assert_done(&a);
	g_test_message("%s", a.out);
	g_autoptr(scan_graph) g = load(&f);
	struct pose right = pose_between(truth_of(1), truth_of(2));
	struct pose off = pose_between(&right, &scan_graph_edge(g, 1, 4)->pose);
	g_assert_cmpfloat(pose_distance_m(&off), <, 0.05);
	g_autofree char *cells = write_file(&f, "cells.txt", "1 2 3 c:1,1\n");
	g_auto(answer) none = commands_run("align", f.site, "1", "4", "--pairs", cells);
	commands_assert_refused(&none, 1, "scan 4 is a cloud and has no cells");
	folder_clear(&f);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	for (size_t i = 0; i < G_N_ELEMENTS(usages); i++) {
		g_autofree char *path = g_strconcat("/align-command/usage/", usages[i].path, NULL);
		g_test_add_data_func(path, &usages[i], test_usage);
	}
	g_test_add_func("/align-command/refusals", test_refusals);
	g_test_add_func("/align-command/bad-files", test_bad_files);
	g_test_add_func("/align-command/pairs", test_pairs);
	g_test_add_func("/align-command/swapped", test_swapped);
	g_test_add_func("/align-command/cells", test_cells);
	g_test_add_func("/align-command/wrong-pairs", test_wrong_pairs);
	g_test_add_func("/align-command/decisions", test_decisions);
	g_test_add_func("/align-command/undo-all", test_undo_all);
	g_test_add_func("/align-command/empty-list", test_empty_list);
	g_test_add_func("/align-command/locked", test_locked);
	g_test_add_func("/align-command/stopped", test_stopped);
	g_test_add_func("/align-command/cloud", test_cloud);
	return g_test_run();
}
