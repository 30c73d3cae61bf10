#ifndef TESTS_SEGMENT_DESK_H
#define TESTS_SEGMENT_DESK_H
/* A simulated site of two drafts, processed to its segments, and the desk at which a person changes them: a copy for each test. */
#include "process/register-site.h"
#include "process/scan-geometry.h"
#include "process/segment-editor.h"
#include "process/segment-site.h"
#include "tests/simulated.h"
#include <gio/gio.h>
#include <string.h>

/* A site with two drafts, processed to its segments; each test gets a copy. */
static inline char *processed_site(void)
{
	static char *path;
	g_autoptr(GError) error = NULL;
	if (path)
		return path;
	g_autofree char *folder = simulated_folder();
	path = g_build_filename(folder, "site", NULL);
	for (int station = 1; station <= 2; station++) {
		g_autofree char *description = g_strdup_printf(
			"court?seed=5&station=%d&ares=720&camera=none&divergence_mrad=0", station);
		simulated_draft(path, description);
	}
	g_autoptr(site) s = site_open_existing(path, &error);
	g_assert_no_error(error);
	struct segment_site_result found;
	bool stopped;
	g_autoptr(scan_graph) g = register_site(s, NULL, &stopped, &error);
	g_assert_no_error(error);
	geometry_site(s, g, NULL, NULL, &error);
	g_assert_no_error(error);
	segment_site(s, g, NULL, &found, &error);
	g_assert_no_error(error);
	return path;
}

struct desk {
	char *path;
	site *site;
	scan_graph *graph;
	segment_editor *editor;
};

static inline void sit_down(struct desk *d)
{
	g_autoptr(GError) error = NULL;
	d->site = site_open_existing(d->path, &error);
	g_assert_no_error(error);
	d->graph = scan_graph_load(d->site, &error);
	d->editor = segment_editor_new(d->site, d->graph, &error);
	g_assert_no_error(error);
}

static inline void stand_up(struct desk *d)
{
	segment_editor_free(d->editor);
	scan_graph_free(d->graph);
	site_free(d->site);
}

static inline void set_up(struct desk *d, gconstpointer data)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *from = g_build_filename(processed_site(), ".", NULL);
	g_autoptr(GError) error = NULL;
	(void)data;
	d->path = g_build_filename(folder, "copy", NULL);
	const char *copy[] = { "cp", "-r", from, d->path, NULL };
	g_spawn_sync(NULL, (char **)copy, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, NULL, NULL, NULL,
		&error);
	g_assert_no_error(error);
	sit_down(d);
}

static inline void tear_down(struct desk *d, gconstpointer data)
{
	(void)data;
	stand_up(d);
	g_free(d->path);
}

/* ---- what holds always ---- */

static inline const struct segment *node_of(const struct desk *d, uint32_t id)
{
	return segments_find(segment_editor_tree(d->editor), id);
}

/* Every point is in one leaf of the tree, and the tree counts them right. */
static inline void check_whole(const struct desk *d)
{
	const segments *tree = segment_editor_tree(d->editor);
	g_autofree uint64_t *in_leaf = g_new0(uint64_t, SEGMENTS_MAX + 1);
	for (uint32_t scan = 1; scan <= 2; scan++) {
		uint64_t count;
		const uint16_t *leaf = segment_editor_leaves(d->editor, scan, &count);
		g_autoptr(scan_data) data = scan_data_load(d->site, scan, NULL);
		g_assert_cmpuint(count, ==, range_grid_cells(data->grid));
		for (uint64_t i = 0; i < count; i++) {
			g_assert_cmpint(data->grid->range_m[i] > 0, ==, leaf[i] != SEGMENT_NONE);
			in_leaf[leaf[i]]++;
		}
	}
	uint64_t sum = 0;
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		bool is_leaf = segments_is_leaf(tree, node->id);
		g_assert_cmpuint(in_leaf[node->id], ==, is_leaf ? node->points : 0);
		g_assert_true(node->points || node->id < SEGMENT_FIRST);
		sum += in_leaf[node->id];
		in_leaf[node->id] = 0;
	}
	g_assert_cmpuint(sum, ==, segments_find(tree, SEGMENT_SITE)->points);
	for (uint32_t id = 1; id <= SEGMENTS_MAX; id++)
		g_assert_cmpuint(in_leaf[id], ==, 0);
}

/* The largest leaf of a class; skip: how many larger ones to pass over. */
static inline uint32_t large_leaf(const struct desk *d, enum segment_class class, unsigned skip)
{
	const segments *tree = segment_editor_tree(d->editor);
	uint64_t less_than = G_MAXUINT64;
	uint32_t best = 0;
	for (unsigned k = 0; k <= skip; k++) {
		best = 0;
		for (guint i = 0; i < tree->nodes->len; i++) {
			const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
			if (node->id >= SEGMENT_FIRST && node->class == class &&
				segments_is_leaf(tree, node->id) && node->points < less_than &&
				(!best || node->points > node_of(d, best)->points))
				best = node->id;
		}
		g_assert_cmpuint(best, !=, 0);
		less_than = node_of(d, best)->points;
	}
	return best;
}

static inline bool change(struct desk *d, segment_edit *e, const char *refused)
{
	g_autoptr(GError) error = NULL;
	bool good = segment_editor_change(d->editor, e, &error);
	if (refused) {
		g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
		g_assert_true(g_pattern_match_simple(refused, error->message));
	} else {
		g_assert_no_error(error);
	}
	check_whole(d);
	return good;
}

static inline segment_edit *edit_of(
	struct desk *d, enum segment_op op, uint32_t first, uint32_t second)
{
	g_autoptr(GError) error = NULL;
	segment_edit *e = segment_edit_new(op);
	segment_editor_refer(d->editor, e, first, &error);
	if (second)
		segment_editor_refer(d->editor, e, second, &error);
	g_assert_no_error(error);
	return e;
}

static inline void process_segments(struct desk *d)
{
	g_autoptr(GError) error = NULL;
	struct segment_site_result result;
	segment_site(d->site, d->graph, NULL, &result, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(result.changes_left_out, ==, 0);
}

#define ADD_AT_DESK(name, function) g_test_add(name, struct desk, NULL, set_up, function, tear_down)

#endif
