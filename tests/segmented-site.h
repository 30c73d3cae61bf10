#ifndef TESTS_SEGMENTED_SITE_H
#define TESTS_SEGMENTED_SITE_H
/* A simulated site of some drafts (STATIONS, which may be defined before), where they truly stand, and its segments. */
#include "process/scan-geometry.h"
#include "process/scan-points.h"
#include "process/segment-site.h"
#include "tests/placed-scans.h"
#include <json-glib/json-glib.h>
#include <stdlib.h>

#ifndef STATIONS
#define STATIONS 3
#endif
#define SCENE "court?seed=21&ares=360&camera=none&divergence_mrad=0&station=%d"

/* ---- sites ---- */

static struct pose true_pose[STATIONS + 1];

static inline void scan_station(const char *path, int station)
{
	g_autofree char *description = g_strdup_printf(SCENE, station);
	simulated_draft(path, description);
	true_pose[station] = simulated_pose(description);
}

/* After the site was made: it tells the poses. */
static inline scan_graph *graph_of(int scans)
{
	g_assert_cmpfloat(true_pose[1].rotation[2][2], >, 0);
	scan_graph *g = scan_graph_new();
	for (int k = 1; k <= scans; k++) {
		struct placed_scan p = { .number = (uint32_t)k,
			.group = 1,
			.pose = k <= STATIONS ? true_pose[k] : POSE_IDENTITY };
		g_array_append_val(g->scans, p);
	}
	return g;
}

static inline char *copy_of(const char *path)
{
	g_autofree char *folder = simulated_folder();
	char *copy = g_build_filename(folder, "site", NULL);
	g_autofree char *command = g_strdup_printf("cp -a '%s' '%s'", path, copy);
	g_assert_cmpint(system(command), ==, 0);
	return copy;
}

/* A copy of a site with STATIONS scans and their geometry; caller frees. */
static inline char *fresh_site(void)
{
	static char *made;
	if (!made) {
		g_autoptr(GError) error = NULL;
		g_autofree char *folder = simulated_folder();
		made = g_build_filename(folder, "site", NULL);
		for (int k = 1; k <= STATIONS; k++)
			scan_station(made, k);
		g_autoptr(site) s = site_open_existing(made, &error);
		g_autoptr(scan_graph) g = graph_of(STATIONS);
		uint32_t count;
		geometry_site(s, g, NULL, &count, &error);
		g_assert_no_error(error);
	}
	return copy_of(made);
}

static inline struct segment_site_result segment(const char *path, const scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	g_assert_no_error(error);
	struct segment_site_result result = { 0 };
	g_assert_true(segment_site(s, g, NULL, &result, &error));
	g_assert_no_error(error);
	return result;
}

static inline void expect_why(const char *path, const scan_graph *g, const char *wanted)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *why = NULL;
	g_autoptr(site) s = site_open(path, &error);
	bool due = false;
	g_assert_true(segment_site_is_due(s, g, &due, &why, &error));
	g_assert_no_error(error);
	g_assert_cmpstr(why, ==, wanted);
	g_assert_true(due == (why != NULL));
}

static inline void set(const char *path, const char *key, const char *value)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	site_set(s, key, value ? json_from_string(value, NULL) : NULL, &error);
	g_assert_no_error(error);
}

/* ---- what is in them ---- */

struct checked {
	uint64_t *points; /* by leaf */
	const segments *tree;
};

static inline void check_point(
	struct checked *c, const struct scan_points *p, uint64_t i, uint32_t leaf)
{
	double at[3];
	const struct segment *node = segments_find(c->tree, leaf);
	g_assert_true(node && segments_is_leaf(c->tree, leaf));
	scan_points_position(p, i, at);
	for (int k = 0; k < 3; k++) /* the file has millimetres */
		g_assert_true(at[k] > node->low_m[k] - 0.001 && at[k] < node->high_m[k] + 0.001);
	c->points[leaf]++;
}

/* Every point has exactly one leaf that exists, in its box; the sums are right all the way up. */
static inline void check_leaves(const char *path, const scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(segments) tree = segments_load(path, &error);
	g_assert_no_error(error);
	g_autofree uint64_t *sum = g_new0(uint64_t, SEGMENTS_MAX + 1);
	struct checked c = { sum, tree };
	uint64_t all = 0;
	for (guint n = 0; n < g->scans->len; n++) {
		const struct placed_scan *placed = &g_array_index(g->scans, struct placed_scan, n);
		g_autoptr(scan_data) d = scan_data_load(s, placed->number, &error);
		g_autoptr(scan_segments) labels = scan_segments_open(s, placed->number, &error);
		g_assert_no_error(error);
		g_assert_true(product_verify(labels->file, &error));
		struct scan_points p =
			scan_points_of(d, NULL, placed->group ? &placed->pose : &POSE_IDENTITY);
		g_assert_cmpuint(labels->count, ==, p.count);
		g_assert_cmpmem(labels->leaf, 2 * p.count, labels->automatic, 2 * p.count);
		for (uint64_t i = 0; i < p.count; i++) {
			g_assert_true((labels->leaf[i] != SEGMENT_NONE) == scan_points_has(&p, i));
			if (labels->leaf[i] == SEGMENT_NONE)
				continue;
			all++;
			check_point(&c, &p, i, labels->leaf[i]);
		}
	}
	g_assert_cmpuint(segments_find(tree, SEGMENT_SITE)->points, ==, all);
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		uint64_t below = 0;
		for (uint32_t leaf = 1; leaf <= SEGMENTS_MAX; leaf++)
			if (sum[leaf] && segments_is_above(tree, node->id, leaf))
				below += sum[leaf];
		g_assert_cmpuint(node->points, ==, below);
		g_assert_true(node->id < SEGMENT_FIRST || node->points);
	}
}

/* The labels of a scan; caller frees. */
static inline uint16_t *labels_in(const char *path, uint32_t scan, uint64_t *ret_count)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(scan_segments) l = scan_segments_open(s, scan, &error);
	g_assert_no_error(error);
	*ret_count = l->count;
	return g_memdup2(l->leaf, l->count * sizeof *l->leaf);
}

#endif
