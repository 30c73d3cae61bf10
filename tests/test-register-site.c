/* A simulated site of ten scans, from nothing to one frame; then stopped, changed, decided upon by a person. */
#include "firmware-io/files.h"
#include "process/register-site.h"
#include "tests/simulated.h"
#include <glib/gstdio.h>
#include <string.h>

#define SCANS 10

static char *path; /* of the site */
static struct pose truths[SCANS];

static void scan_station(uint32_t station)
{
	g_autofree char *description = g_strdup_printf(
		"court?seed=23&ares=720&camera=none&divergence_mrad=0&station=%u", station);
	simulated_draft(path, description);
	truths[station - 1] = simulated_pose(description);
}

static site *open_site(void)
{
	g_autoptr(GError) error = NULL;
	site *s = site_open_existing(path, &error);
	g_assert_no_error(error);
	return s;
}

static char *why_due(const site *s)
{
	g_autoptr(GError) error = NULL;
	bool due;
	char *why = NULL;
	g_assert_true(register_site_is_due(s, &due, &why, &error));
	g_assert_true(due == (why != NULL));
	return why;
}

static scan_graph *register_all(site *s, const struct register_options *options, bool want_stopped)
{
	g_autoptr(GError) error = NULL;
	bool stopped = false;
	scan_graph *g = register_site(s, options, &stopped, &error);
	g_assert_no_error(error);
	g_assert_true(stopped == want_stopped);
	return g;
}

/* Truth to a draft's own accuracy: its heading is good to some thousandths of a degree. */
static void assert_true_poses(const scan_graph *g, uint32_t scans)
{
	for (uint32_t k = 2; k <= scans; k++) {
		struct pose want = pose_between(&truths[0], &truths[k - 1]);
		struct pose got =
			pose_between(&scan_graph_scan(g, 1)->pose, &scan_graph_scan(g, k)->pose);
		struct pose off = pose_between(&want, &got);
		g_assert_cmpuint(scan_graph_scan(g, k)->group, ==, 1);
		g_assert_cmpfloat(pose_distance_m(&off), <, 8e-3);
		g_assert_cmpfloat(pose_angle_rad(&off), <, 0.02 * G_PI / 180);
	}
}

struct stopping {
	int calls, stop_after;
	double fraction;
};

static bool stop_soon(double fraction, const char *doing, gpointer user_data)
{
	struct stopping *s = user_data;
	g_assert_cmpfloat(fraction, >=, s->fraction);
	g_assert_cmpfloat(fraction, <=, 1);
	g_assert_nonnull(doing);
	s->fraction = fraction;
	return ++s->calls < s->stop_after;
}

static char *unfinished(void)
{
	return g_build_filename(path, "poses", ".unfinished.json", NULL);
}

/* What was found before it was stopped is not looked for again. */
static void test_stopped(void)
{
	struct stopping stopping = { .stop_after = 12 };
	struct register_options options = { stop_soon, &stopping };
	g_autoptr(site) s = open_site();
	g_autofree char *why = why_due(s), *kept = unfinished();
	g_assert_cmpstr(why, ==, "for the first time");
	g_autoptr(scan_graph) g = register_all(s, &options, true);
	g_assert_true(g_file_test(kept, G_FILE_TEST_EXISTS));
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_graph) before = scan_graph_load_file(kept, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(before->edges->len, >, 0);
	g_autoptr(scan_graph) none = scan_graph_load(s, &error);
	g_assert_cmpuint(none->revision, ==, 0);
}

static void test_whole(void)
{
	g_autoptr(site) s = open_site();
	g_autofree char *kept = unfinished();
	g_autoptr(scan_graph) g = register_all(s, NULL, false);
	g_assert_cmpuint(g->revision, ==, 1);
	g_assert_false(g_file_test(kept, G_FILE_TEST_EXISTS));
	assert_true_poses(g, SCANS - 1);
	/* More edges than a tree has: loops, and all of them close. */
	uint32_t used = 0;
	for (guint i = 0; i < g->edges->len; i++) {
		const struct edge *e = &g_array_index(g->edges, struct edge, i);
		used += edge_is_used(e);
		g_assert_false(e->outlier);
		g_assert_cmpfloat(e->loop_m, <, 5e-3);
	}
	g_assert_cmpuint(used, >, 2 * SCANS - 6);
	g_autofree char *why = why_due(s);
	g_assert_cmpstr(why, ==, NULL);
	/* Once more there is nothing new: no revision. */
	g_autoptr(scan_graph) again = register_all(s, NULL, false);
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_graph) last = scan_graph_load(s, &error);
	g_assert_cmpuint(last->revision, ==, 1);
}

static void test_added(void)
{
	scan_station(SCANS);
	g_autoptr(site) s = open_site();
	g_autofree char *why = why_due(s);
	g_assert_cmpstr(why, ==, "scan 10 is new");
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_graph) before = scan_graph_load(s, &error);
	struct edge *first = &g_array_index(before->edges, struct edge, 0);
	first->decision = DECISION_REFUSED;
	g_assert_true(scan_graph_save(before, s, "refused", &error));
	g_autoptr(scan_graph) g = register_all(s, NULL, false);
	assert_true_poses(g, SCANS);
	g_assert_cmpint(scan_graph_edge(g, first->a, first->b)->decision, ==, DECISION_REFUSED);
	/* What was known is as it was. */
	for (guint i = 0; i < before->edges->len; i++) {
		const struct edge *e = &g_array_index(before->edges, struct edge, i);
		const struct edge *same = scan_graph_edge(g, e->a, e->b);
		g_assert_cmpmem(&e->pose, sizeof e->pose, &same->pose, sizeof same->pose);
	}
}

static void test_gone(void)
{
	g_autofree char *folder = g_build_filename(path, "scans", "0010", NULL);
	g_assert_true(files_remove_tree(folder, NULL));
	g_autoptr(site) s = open_site();
	g_autofree char *why = why_due(s);
	g_assert_cmpstr(why, ==, "scan 10 is gone");
	g_autoptr(scan_graph) g = register_all(s, NULL, false);
	g_assert_cmpuint(g->scans->len, ==, SCANS - 1);
	g_assert_null(scan_graph_edge(g, 9, 10));
}

static void test_damaged_scan(void)
{
	g_autofree char *file = g_build_filename(path, "scans", "0002", "range.tiff", NULL);
	g_autofree char *poses = g_build_filename(path, "poses", NULL);
	g_autoptr(GError) error = NULL;
	bool stopped;
	files_remove_tree(poses, NULL);
	g_assert_true(g_file_set_contents(file, "II*", 3, NULL));
	g_autoptr(site) s = open_site();
	g_assert_null(register_site(s, NULL, &stopped, &error));
	g_assert_nonnull(strstr(error->message, "scans/0002"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_autofree char *folder = simulated_folder();
	path = g_build_filename(folder, "site", NULL);
	for (uint32_t station = 1; station < SCANS; station++)
		scan_station(station);
	g_test_add_func("/register-site/stopped", test_stopped);
	g_test_add_func("/register-site/whole", test_whole);
	g_test_add_func("/register-site/added", test_added);
	g_test_add_func("/register-site/gone", test_gone);
	g_test_add_func("/register-site/damaged-scan", test_damaged_scan);
	return g_test_run();
}
