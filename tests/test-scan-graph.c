/* The graph of scans: edges, groups, given poses, loops that do not close, files and their revisions. */
#include "firmware-io/files.h"
#include "process/scan-graph.h"
#include "tests/support.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static struct pose true_pose(uint32_t number)
{
	double at[3] = { 6.0 * cos(number), 4.0 * sin(number), 0.1 * number };
	return pose_from_yaw(0.7 * number, at);
}

static struct edge edge_between(uint32_t a, uint32_t b, const double wrong[6])
{
	static const double none[6];
	struct pose at_a = true_pose(a), at_b = true_pose(b), between = pose_between(&at_a, &at_b);
	struct edge e = { .a = a, .b = b, .pose = pose_perturb(&between, wrong ? wrong : none) };
	for (int i = 0; i < 6; i++)
		e.covariance[i][i] = i < 3 ? 1e-10 : 1e-8;
	e.verification.verdict = VERDICT_ACCEPTED;
	g_strlcpy(e.verification.reason, "fits", sizeof e.verification.reason);
	e.verification.overlap = 0.5;
	e.inputs = g_strdup_printf("%u+%u", a, b);
	return e;
}

static void set(scan_graph *g, uint32_t a, uint32_t b, const double wrong[6])
{
	struct edge e = edge_between(a, b, wrong);
	scan_graph_set_edge(g, &e);
}

static void solve(scan_graph *g, uint32_t count)
{
	struct scan_given given[20] = { 0 };
	for (uint32_t i = 0; i < count; i++)
		given[i].number = i + 1;
	scan_graph_solve(g, given, count);
}

/* Scan b, seen from a, stands where it really does. */
static void assert_true_pose(const scan_graph *g, uint32_t a, uint32_t b, double tolerance_m)
{
	struct pose at_a = true_pose(a), at_b = true_pose(b), want = pose_between(&at_a, &at_b);
	struct pose got = pose_between(&scan_graph_scan(g, a)->pose, &scan_graph_scan(g, b)->pose);
	struct pose off = pose_between(&want, &got);
	g_assert_cmpfloat(pose_distance_m(&off), <, tolerance_m);
	g_assert_cmpfloat(pose_angle_rad(&off), <, tolerance_m);
}

static void test_edges(void)
{
	g_autoptr(scan_graph) g = scan_graph_new();
	set(g, 2, 5, NULL), set(g, 1, 9, NULL), set(g, 2, 3, NULL), set(g, 2, 3, NULL);
	g_assert_cmpuint(g->edges->len, ==, 3);
	g_assert_cmpuint(g_array_index(g->edges, struct edge, 0).b, ==, 9);
	g_assert_cmpuint(g_array_index(g->edges, struct edge, 1).b, ==, 3);
	g_assert_cmpuint(scan_graph_edge(g, 5, 2)->b, ==, 5);
	g_assert_null(scan_graph_edge(g, 3, 5));
	scan_graph_remove_edge(g, 5, 2);
	g_assert_cmpuint(g->edges->len, ==, 2);
	g_assert_null(scan_graph_edge(g, 2, 5));
}

static void test_groups(void)
{
	g_autoptr(scan_graph) g = scan_graph_new();
	solve(g, 2);
	g_assert_cmpuint(scan_graph_scan(g, 1)->group, ==, 1);
	g_assert_cmpuint(scan_graph_scan(g, 2)->group, ==, 0);
	set(g, 1, 2, NULL), set(g, 3, 4, NULL), set(g, 4, 5, NULL);
	solve(g, 6);
	static const uint32_t groups[] = { 2, 2, 1, 1, 1, 0 };
	for (uint32_t i = 0; i < 6; i++)
		g_assert_cmpuint(scan_graph_scan(g, i + 1)->group, ==, groups[i]);
	assert_true_pose(g, 1, 2, 1e-6);
	assert_true_pose(g, 3, 5, 1e-6);
	scan_graph_edge(g, 3, 4)->verification.verdict = VERDICT_CONFLICT;
	solve(g, 6);
	g_assert_cmpuint(scan_graph_scan(g, 3)->group, ==, 0);
	scan_graph_edge(g, 3, 4)->decision = DECISION_ACCEPTED;
	scan_graph_edge(g, 4, 5)->decision = DECISION_REFUSED;
	solve(g, 6);
	g_assert_cmpuint(scan_graph_scan(g, 3)->group, ==, 2);
	g_assert_cmpuint(scan_graph_scan(g, 5)->group, ==, 0);
}

/* Of a ring with its diagonals, one edge is wrong by a metre. */
static void test_loop(void)
{
	static const double wrong[6] = { 0, 0, 0.05, 1, 0.3, 0 };
	g_autoptr(scan_graph) g = scan_graph_new();
	for (uint32_t a = 1; a <= 6; a++)
		for (uint32_t b = a + 1; b <= 6; b++)
			set(g, a, b, a == 2 && b == 4 ? wrong : NULL);
	solve(g, 6);
	for (uint32_t a = 1; a <= 6; a++)
		for (uint32_t b = a + 1; b <= 6; b++)
			g_assert_true(scan_graph_edge(g, a, b)->outlier == (a == 2 && b == 4));
	g_assert_cmpfloat(scan_graph_edge(g, 2, 4)->loop_m, >, 0.9);
	g_assert_cmpfloat(scan_graph_edge(g, 1, 2)->loop_m, <, 1e-6);
	for (uint32_t b = 2; b <= 6; b++)
		assert_true_pose(g, 1, b, 1e-6);
	g_assert_cmpfloat(scan_graph_scan(g, 1)->deviation_m, ==, 0);
	g_assert_cmpfloat(scan_graph_scan(g, 4)->deviation_m, >, 1e-4);
	g_assert_cmpfloat(scan_graph_scan(g, 4)->deviation_m, <, 5e-3);
}

static void test_given(void)
{
	g_autoptr(scan_graph) g = scan_graph_new();
	struct scan_given given[] = { { 1, false, POSE_IDENTITY }, { 2, true, true_pose(2) },
		{ 3, true, true_pose(3) } };
	set(g, 1, 2, NULL);
	scan_graph_solve(g, given, 3);
	g_assert_cmpuint(scan_graph_scan(g, 3)->group, ==, 1);
	for (uint32_t k = 1; k <= 3; k++) {
		struct pose want = true_pose(k), *got = &scan_graph_scan(g, k)->pose;
		struct pose off = pose_between(&want, got);
		g_assert_cmpuint(scan_graph_scan(g, k)->group, ==, 1);
		g_assert_cmpfloat(pose_distance_m(&off), <, 1e-6);
	}
	/* The scans say that the given poses of 2 and 3 are wrong. */
	static const double wrong[6] = { 0, 0, 0, 2, 0, 0 };
	given[2].pose = pose_perturb(&given[2].pose, wrong);
	set(g, 2, 3, wrong);
	scan_graph_edge(g, 2, 3)->origin = EDGE_GIVEN;
	scan_graph_edge(g, 2, 3)->verification.verdict = VERDICT_CONFLICT;
	set(g, 1, 3, NULL);
	scan_graph_solve(g, given, 3);
	assert_true_pose(g, 1, 2, 1e-6);
	assert_true_pose(g, 2, 3, 1e-6);
}

static void test_revisions(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = g_dir_make_tmp("scan-graph-XXXXXX", NULL);
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	g_autoptr(site) s = site_open_for_writing(path, &error);
	g_assert_no_error(error);
	g_autoptr(scan_graph) g = scan_graph_load(s, &error);
	g_assert_cmpuint(g->revision, ==, 0);
	g_assert_null(scan_graph_undo(s, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_clear_error(&error);
	for (uint32_t k = 1; k <= 3; k++) {
		set(g, k, k + 1, NULL);
		solve(g, k + 1);
		g_autofree char *change = g_strdup_printf("change %u", k);
		g_assert_true(scan_graph_save(g, s, change, &error));
		g_assert_cmpuint(g->revision, ==, k);
		g_autoptr(scan_graph) again = scan_graph_load(s, &error);
		g_assert_no_error(error);
		g_assert_true(scan_graph_equal(g, again));
		g_assert_cmpstr(again->change, ==, change);
		g_assert_cmpuint(again->parent, ==, k - 1);
	}
	g_autoptr(scan_graph) second = scan_graph_undo(s, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(second->revision, ==, 4);
	g_assert_cmpuint(second->edges->len, ==, 2);
	/* A change after an undo, undone, gives what the undo gave. */
	set(second, 1, 4, NULL);
	g_assert_true(scan_graph_save(second, s, "another", &error));
	g_autoptr(scan_graph) third = scan_graph_undo(s, &error);
	g_assert_cmpuint(third->edges->len, ==, 2);
	g_autoptr(scan_graph) fourth = scan_graph_undo(s, &error);
	g_assert_cmpuint(fourth->edges->len, ==, 1);
	g_assert_cmpstr(fourth->change, ==, "undone: change 2");
	g_autoptr(scan_graph) empty = scan_graph_undo(s, &error);
	g_assert_cmpuint(empty->edges->len + empty->scans->len, ==, 0);
	g_assert_null(scan_graph_undo(s, &error));
	g_assert_nonnull(error);
	files_remove_tree(folder, NULL);
}

static void assert_refused(const char *text, const char *old, const char *new, const char *want)
{
	g_autoptr(GError) error = NULL;
	const char *at = strstr(text, old);
	if (!at)
		g_error("there is no '%s' in %s", old, text);
	g_autofree char *bad =
		g_strdup_printf("%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
	g_assert_null(scan_graph_parse(bad, strlen(bad), "poses/0001.json", &error));
	if (!strstr(error->message, want))
		g_error("'%s' does not tell of '%s'", error->message, want);
	g_assert_true(g_str_has_prefix(error->message, "poses/0001.json"));
}

static void test_damaged(void)
{
	g_autoptr(scan_graph) g = scan_graph_new();
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = g_dir_make_tmp("scan-graph-XXXXXX", NULL);
	g_autofree char *path = g_build_filename(folder, "0001.json", NULL), *text = NULL;
	set(g, 1, 2, NULL), set(g, 2, 3, NULL);
	solve(g, 3);
	g_assert_true(scan_graph_save_file(g, path, &error));
	g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
	assert_refused(text, "\"a\": 1", "\"a\": 2", "'edges', entry 1: 'a' must be below 'b'");
	assert_refused(text, "\"a\": 1", "\"a\": 1.5", "'a' is no number of a scan");
	assert_refused(text, "\"a\": 2,\n      \"b\": 3", "\"a\": 1, \"b\": 2",
		"'edges', entry 2: is there twice");
	assert_refused(text, "\"automatic\"", "\"by magic\"", "'origin'");
	assert_refused(text, "\"accepted\"", "7", "'verdict'");
	assert_refused(text, "\"outlier\": false", "\"outlier\": 0", "'outlier'");
	assert_refused(text, "\"covariance\": [", "\"covariance\": [ 3,", "'covariance'");
	assert_refused(text, "\"rotation\": [", "\"rotation\": [ [1, 0, 0],", "'pose'");
	assert_refused(text, "\"number\": 2", "\"number\": 1", "'scans', entry 2");
	assert_refused(text, "\"scans\"", "\"scan\"", "'scans' is missing");
	assert_refused(text, "\"revision\"", "\"vision\"", "'revision'");
	files_remove_tree(folder, NULL);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/scan-graph/edges", test_edges);
	g_test_add_func("/scan-graph/groups", test_groups);
	g_test_add_func("/scan-graph/loop", test_loop);
	g_test_add_func("/scan-graph/given", test_given);
	g_test_add_func("/scan-graph/revisions", test_revisions);
	g_test_add_func("/scan-graph/damaged", test_damaged);
	return g_test_run();
}
