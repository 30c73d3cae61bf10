/* Any text as a graph of scans: what is accepted solves, and is written so that it reads back the same. */
#include "process/scan-graph.h"
#include <glib/gstdio.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static scan_graph *through_a_file(const scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_strdup_printf("%s/fuzz-poses.%d.json", g_get_tmp_dir(), getpid());
	g_assert_true(scan_graph_save_file(g, path, &error));
	scan_graph *again = scan_graph_load_file(path, &error);
	g_assert_no_error(error);
	g_remove(path);
	return again;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_graph) g = scan_graph_parse((const char *)data, size, "x", &error);
	g_assert_true((g == NULL) == (error != NULL));
	if (!g)
		return 0;
	g_autoptr(scan_graph) again = through_a_file(g);
	g_assert_true(scan_graph_equal(g, again));
	if (g->scans->len > 50 || g->edges->len > 200)
		return 0;
	g_autofree struct scan_given *given = g_new0(struct scan_given, g->scans->len + 1);
	for (guint i = 0; i < g->scans->len; i++)
		given[i].number = g_array_index(g->scans, struct placed_scan, i).number;
	scan_graph_solve(again, given, g->scans->len);
	return 0;
}
