/* The segmentation against the simulator's exact truth, against the classes of aerial scans, and on real terrestrial ones.
 *
 * One site is scanned as a draft; with PLEINAIR_SLOW=1 (make check-slow) others at the standard preset too, with and without
 * colour. */
#include "process/import.h"
#include "process/scan-data.h"
#include "process/scan-geometry.h"
#include "process/segment-score.h"
#include "process/segment-site.h"
#include "sim/truth.h"
#include "tests/simulated.h"
#include "tests/support.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <string.h>

#define STATIONS 4

/* ---- sites ---- */

static void scan_site(const char *path, const char *scene, const char *preset, const char *more)
{
	for (int k = 1; k <= STATIONS; k++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *description = g_strdup_printf("%s&station=%d%s", scene, k, more);
		struct scan_options options = { .preset = preset_find(preset) };
		struct scan_result result;
		uint32_t partial;
		simulated_scan(path, description, &options, NULL, NULL, &result, &partial, &error);
		g_assert_no_error(error);
	}
}

static truth *truth_at(const char *scene, int station)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *description = g_strdup_printf("%s&station=%d", scene, station);
	truth *t = truth_new(description, &error);
	g_assert_no_error(error);
	return t;
}

/* Where the simulator says that they stand. */
static scan_graph *true_graph(const char *scene)
{
	scan_graph *g = scan_graph_new();
	for (int k = 1; k <= STATIONS; k++) {
		g_autoptr(truth) t = truth_at(scene, k);
		struct placed_scan p = { .number = (uint32_t)k, .group = 1 };
		memcpy(p.pose.rotation, truth_station(t)->rotation, sizeof p.pose.rotation);
		memcpy(p.pose.translation_m, truth_station(t)->position_m,
			sizeof p.pose.translation_m);
		g_array_append_val(g->scans, p);
	}
	return g;
}

static void segment_all(site *s, const scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	struct segment_site_result result;
	uint32_t made;
	geometry_site(s, g, NULL, &made, &error);
	g_assert_no_error(error);
	segment_site(s, g, NULL, &result, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(result.points, >, 0);
}

/* ---- against the truth ---- */

/* What each beam really met first; caller frees. */
static struct bench_truth_cell *look(const truth *t, const range_grid *g)
{
	struct bench_truth_cell *cells = g_new(struct bench_truth_cell, range_grid_cells(g));
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		double level = hypot((double)g->x_m[i], g->y_m[i]);
		struct truth_cell c =
			truth_look(t, atan2(g->x_m[i], g->y_m[i]), atan2(g->z_m[i], level));
		cells[i] = (struct bench_truth_cell){ .range_m = c.range_m,
			.instance = c.instance,
			.class = c.class,
			.optics = c.optics };
	}
	return cells;
}

static void count_scan(segment_score *score, const segments *tree, site *s,
	const struct placed_scan *p, const truth *t)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_data) d = scan_data_load(s, p->number, &error);
	g_assert_no_error(error);
	g_autoptr(scan_segments) labels = scan_segments_open(s, p->number, &error);
	g_assert_no_error(error);
	struct scan_points all = scan_points_of(d, NULL, &p->pose);
	g_autofree struct bench_truth_cell *cells = look(t, d->grid);
	for (uint64_t i = 0; i < all.count; i++)
		g_assert_true((labels->leaf[i] != SEGMENT_NONE) == scan_points_has(&all, i));
	segment_score_count(score, tree, &all, labels->leaf, cells);
}

static segment_score *score_site(site *s, const scan_graph *g, const char *scene)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = segments_load(site_path(s), &error);
	g_assert_no_error(error);
	segment_score *score = segment_score_new();
	for (guint k = 0; k < g->scans->len; k++) {
		g_autoptr(truth) t = truth_at(scene, (int)k + 1);
		count_scan(score, tree, s, &g_array_index(g->scans, struct placed_scan, k), t);
	}
	segment_score_count_trees(score);
	g_autofree char *table = segment_score_text(score, false);
	g_test_message("%s", table);
	return score;
}

static segment_score *score_of(const char *scene, const char *preset, const char *more)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	scan_site(path, scene, preset, more);
	g_autoptr(site) s = site_open_existing(path, &error);
	g_assert_no_error(error);
	g_autoptr(scan_graph) g = true_graph(scene);
	segment_all(s, g);
	g_test_message("%s%s, %s", scene, more, preset);
	return score_site(s, g, scene);
}

/* A site has few trees; all sites together have enough. Counted by the scenes, which run before: GTest takes suites in their order. */
static unsigned trees, trees_found;

static const struct truth_case {
	const char *scene;
	double mean_iou, grey_mean_iou; /* 0: not asked */
} cases[] = {
	{ "court?seed=411", 0.85, 0.72 },
	{ "street?seed=412", 0.85, 0 },
	{ "bridge?seed=413", 0.85, 0 },
};

static void test_scene(gconstpointer data)
{
	const struct truth_case *c = data;
	g_autoptr(segment_score) s = score_of(c->scene, "standard", "&camera=360x640");
	trees += s->trees;
	trees_found += s->trees_found;
	g_assert_cmpfloat(segment_score_mean(s, false), >=, c->mean_iou);
}

static void test_trees(void)
{
	g_test_message("%u of %u trees", trees_found, trees);
	g_assert_cmpuint(trees, >=, 10);
	g_assert_cmpfloat(trees_found, >=, 0.9 * trees);
}

static void test_without_colour(gconstpointer data)
{
	const struct truth_case *c = data;
	g_autoptr(segment_score) s = score_of(c->scene, "standard", "&camera=none");
	g_assert_cmpfloat(segment_score_mean(s, false), >=, c->grey_mean_iou);
}

static void test_draft(void)
{
	g_autoptr(segment_score) s =
		score_of("court?seed=411", "draft", "&camera=144x256&ares=1056");
	g_assert_cmpfloat(segment_score_mean(s, false), >=, 0.85);
	g_assert_cmpuint(s->trees_found * 2, >=, s->trees);
}

/* ---- against labels, and real scans ---- */

/* A site with the scans of a file. NULL: the file is not there. */
static site *import_shared(const char *relative, bool labels)
{
	g_autoptr(GError) error = NULL;
	const char *file = shared_path(relative);
	if (!file) {
		g_test_skip("the shared scans are not there");
		return NULL;
	}
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	{
		g_autoptr(site) s = site_open_for_writing(path, &error);
		g_assert_no_error(error);
		GArray *scans = import_file(s, file, &(struct import_options){ 0 }, &error);
		g_assert_no_error(error);
		g_array_unref(scans);
	}
	g_autofree char *json = g_build_filename(path, "site.json", NULL);
	g_autoptr(manifest) m = manifest_load(json, 1, &error);
	g_assert_no_error(error);
	manifest_set_node(
		m, "segmentation.labels", json_node_init_boolean(json_node_alloc(), labels));
	manifest_save(m, &error);
	g_assert_no_error(error);
	site *s = site_open_existing(path, &error);
	g_assert_no_error(error);
	return s;
}

static scan_graph *graph_of_given(site *s)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GArray) given = scan_graph_given(s, &error);
	g_assert_no_error(error);
	scan_graph *g = scan_graph_new();
	for (guint i = 0; i < given->len; i++) {
		const struct scan_given *at = &g_array_index(given, struct scan_given, i);
		struct placed_scan p = { .number = at->number,
			.group = at->has_pose || i == 0,
			.pose = at->has_pose ? at->pose : POSE_IDENTITY };
		g_array_append_val(g->scans, p);
	}
	return g;
}

/* Every point has one leaf of the tree, and the tree counts as many. Rows: what the file tells, SEGMENT_CLASSES: nothing. */
static void count_labels(site *s, double cells[SEGMENT_CLASSES + 1][SEGMENT_CLASSES])
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = segments_load(site_path(s), &error);
	g_assert_no_error(error);
	g_autoptr(GArray) numbers = site_scans(s, &error);
	g_autofree uint64_t *sum = g_new0(uint64_t, SEGMENTS_MAX + 1);
	for (guint k = 0; k < numbers->len; k++) {
		uint32_t number = g_array_index(numbers, uint32_t, k);
		g_autoptr(scan_data) d = scan_data_load(s, number, &error);
		g_assert_no_error(error);
		g_autoptr(scan_segments) labels = scan_segments_open(s, number, &error);
		g_assert_no_error(error);
		struct scan_points p = scan_points_of(d, NULL, &POSE_IDENTITY);
		g_assert_cmpuint(labels->count, ==, p.count);
		for (uint64_t i = 0; i < p.count; i++) {
			uint16_t leaf = labels->leaf[i];
			g_assert_true((leaf != SEGMENT_NONE) == scan_points_has(&p, i));
			if (leaf == SEGMENT_NONE)
				continue;
			int told = segment_class_from_las(scan_points_classification(&p, i));
			sum[leaf]++;
			cells[told < 0 ? SEGMENT_CLASSES : told]
			     [segments_find(tree, leaf)->class]++;
		}
	}
	for (uint32_t id = 0; id <= SEGMENTS_MAX; id++) {
		const struct segment *node = segments_find(tree, id);
		g_assert_true(!sum[id] || (node && segments_is_leaf(tree, id)));
		if (node && segments_is_leaf(tree, id))
			g_assert_cmpuint(node->points, ==, sum[id]);
	}
}

static const struct aerial {
	const char *file;
	double f1[SEGMENT_CLASSES]; /* least; 0: not asked */
} aerials[] = {
	{ "data/aerial-town/ign-77050-627755.las",
		{ [CLASS_TERRAIN] = 0.9, [CLASS_BUILDING] = 0.8, [CLASS_VEGETATION] = 0.8 } },
	{ "data/aerial-town/ign-77050-627760.las",
		{ [CLASS_TERRAIN] = 0.9, [CLASS_BUILDING] = 0.8, [CLASS_VEGETATION] = 0.8 } },
	{ "data/aerial-water/ahn3.las", { [CLASS_TERRAIN] = 0.9, [CLASS_WATER] = 0.95 } },
};

static double f1_of(const double cells[SEGMENT_CLASSES + 1][SEGMENT_CLASSES], int class)
{
	double told = 0, found = 0;
	for (int k = 0; k < SEGMENT_CLASSES; k++) {
		told += cells[class][k];
		found += cells[k][class];
	}
	return 2 * cells[class][class] / (told + found);
}

static void segment_shared(
	const char *file, bool labels, double cells[SEGMENT_CLASSES + 1][SEGMENT_CLASSES])
{
	g_autoptr(site) s = import_shared(file, labels);
	if (!s)
		return;
	g_autoptr(scan_graph) g = graph_of_given(s);
	segment_all(s, g);
	count_labels(s, cells);
}

static void test_aerial(gconstpointer data)
{
	const struct aerial *a = data;
	double cells[SEGMENT_CLASSES + 1][SEGMENT_CLASSES] = { 0 };
	if (!shared_path(a->file)) {
		g_test_skip("the shared scans are not there");
		return;
	}
	segment_shared(a->file, false, cells);
	g_test_message("%s", a->file);
	for (int c = 0; c < SEGMENT_CLASSES; c++)
		g_test_message("%-11s %9.0f %9.0f %9.0f %9.0f %9.0f %9.0f   F1 %.3f",
			segment_classes[c].name, cells[c][0], cells[c][1], cells[c][2], cells[c][3],
			cells[c][4], cells[c][5], f1_of(cells, c));
	for (int c = 0; c < SEGMENT_CLASSES; c++)
		if (a->f1[c] > 0)
			g_assert_cmpfloat(f1_of(cells, c), >=, a->f1[c]);
}

static void test_aerial_labels(gconstpointer data)
{
	const struct aerial *a = data;
	double cells[SEGMENT_CLASSES + 1][SEGMENT_CLASSES] = { 0 }, told = 0;
	if (!shared_path(a->file)) {
		g_test_skip("the shared scans are not there");
		return;
	}
	segment_shared(a->file, true, cells);
	for (int c = 0; c < SEGMENT_CLASSES; c++)
		for (int k = 0; k < SEGMENT_CLASSES; k++) {
			told += cells[c][k];
			if (c != k)
				g_assert_cmpfloat(cells[c][k], ==, 0);
		}
	g_assert_cmpfloat(told, >, 10000);
}

/* The first is large. */
static const char *const real[] = { "data/forest/lpine1-every-3rd.las", "data/pump/pump.ptx",
	"data/office/office1.pcd", "data/ouster-os2/os2.ptx", "data/ptx-conformance/no-color.ptx",
	"data/ptx-conformance/multiple-and-transform.ptx",
	"data/ptx-conformance/complex-transform.ptx", "data/vlp-pair/source.ply",
	"data/aerial-colour/autzen_trim.las" };

static void test_real(gconstpointer data)
{
	double cells[SEGMENT_CLASSES + 1][SEGMENT_CLASSES] = { 0 };
	if (!shared_path(data)) {
		g_test_skip("the shared scans are not there");
		return;
	}
	segment_shared(data, true, cells);
	double of[SEGMENT_CLASSES] = { 0 };
	for (int c = 0; c <= SEGMENT_CLASSES; c++)
		for (int k = 0; k < SEGMENT_CLASSES; k++)
			of[k] += cells[c][k];
	g_test_message("%s: other %.0f, building %.0f, vegetation %.0f, terrain %.0f, structure "
		       "%.0f, water %.0f",
		(const char *)data, of[0], of[1], of[2], of[3], of[4], of[5]);
}

static void add(const char *group, const char *name, gconstpointer data, GTestDataFunc test)
{
	g_autofree char *noun = g_strdup(name);
	g_autofree char *path =
		g_strdup_printf("/segmentation-truth/%s/%s", group, g_strdelimit(noun, "/?=", '-'));
	g_test_add_data_func(path, data, test);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	bool is_slow = g_getenv("PLEINAIR_SLOW");
	for (size_t i = 0; i < G_N_ELEMENTS(cases) && is_slow; i++) {
		add("scene", cases[i].scene, &cases[i], test_scene);
		if (cases[i].grey_mean_iou > 0)
			add("without-colour", cases[i].scene, &cases[i], test_without_colour);
	}
	if (is_slow)
		g_test_add_func("/segmentation-truth/trees/all", test_trees);
	g_test_add_func("/segmentation-truth/draft", test_draft);
	for (size_t i = 0; i < G_N_ELEMENTS(aerials); i++) {
		add("aerial", aerials[i].file, &aerials[i], test_aerial);
		add("aerial-labels", aerials[i].file, &aerials[i], test_aerial_labels);
	}
	for (size_t i = is_slow ? 0 : 1; i < G_N_ELEMENTS(real); i++)
		add("real", real[i], real[i], test_real);
	return g_test_run();
}
