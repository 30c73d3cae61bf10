#include "process/bench-segments.h"
#include "acquire/cli.h"
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/bench-run.h"
#include "process/bench-truth.h"
#include "process/scan-cache.h"
#include "process/scan-geometry.h"
#include "process/segmentation.h"
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <string.h>

#define STATIONS    4
#define RANGE_OFF_M 0.15
#define CELLS_LEAST 100 /* of a class that counts */
#define TREE_CELLS  200
#define TREE_HIGH_M 2.5
#define INSTANCES   65536

static const char *const scenes[] = { "court", "street", "bridge" };

/* Rows: what it is, as bench-truth.h numbers it, or segment-class.h with --site. */
struct tally {
	double cells[BENCH_TRUTH_CLASSES][SEGMENT_CLASSES];
	double of_leaf[SEGMENTS_MAX + 1]; /* cells with a truth */
	struct {
		double cells;
		float low_m, high_m;
	} instance[INSTANCES]; /* of vegetation */
	GHashTable *pairs;     /* instance << 16 | leaf: cells */
	unsigned trees, trees_found;
	double seconds, peak_mib, points;
};

static struct tally *tally_new(void)
{
	struct tally *t = g_new0(struct tally, 1);
	t->pairs = g_hash_table_new(NULL, NULL);
	return t;
}

static void tally_free(struct tally *t)
{
	g_hash_table_unref(t->pairs);
	g_free(t);
}

/* ---- the segments ---- */

struct frame {
	site *site;
	const scan_graph *graph;
	scan_cache *cache;
	scan_geometry *geometry;
	GArray *placed; /* of guint: scans of the graph */
	segments *tree;
	segmentation *made;
};

static const struct placed_scan *scan_at(const struct frame *r, size_t i)
{
	return &g_array_index(
		r->graph->scans, struct placed_scan, g_array_index(r->placed, guint, i));
}

static bool open_scan(gpointer user_data, size_t i, struct segmentation_scan *ret, GError **error)
{
	struct frame *r = user_data;
	const struct placed_scan *p = scan_at(r, i);
	const scan_data *d = scan_cache_load(r->cache, p->number, error);
	if (!d)
		return false;
	scan_geometry_free(r->geometry);
	r->geometry = scan_geometry_open(r->site, p->number, NULL);
	*ret = (struct segmentation_scan){ .points = scan_points_of(d, r->geometry, &p->pose),
		.has_station = d->grid != NULL };
	memcpy(ret->station_m, p->pose.translation_m, sizeof ret->station_m);
	return true;
}

static struct frame frame_new(site *s, const scan_graph *g)
{
	struct frame r = { .site = s,
		.graph = g,
		.cache = scan_cache_new(s, STATIONS),
		.placed = g_array_new(FALSE, FALSE, sizeof(guint)),
		.tree = segments_new() };
	for (guint i = 0; i < g->scans->len; i++)
		if (g_array_index(g->scans, struct placed_scan, i).group == 1)
			g_array_append_val(r.placed, i);
	return r;
}

static void frame_clear(struct frame *r)
{
	segmentation_free(r->made);
	segments_free(r->tree);
	scan_geometry_free(r->geometry);
	scan_cache_free(r->cache);
	g_array_unref(r->placed);
}

/* counts: of each cell of a scan, given its leaf. */
typedef bool (*count_func)(struct tally *t, const struct frame *r, size_t i,
	const struct scan_points *p, const uint16_t *leaf, gpointer user_data, GError **error);

/* Of all scans at once. */
static bool segment_and_count(
	struct frame *r, struct tally *t, count_func count, gpointer user_data, GError **error)
{
	struct segmentation_source source = { r->placed->len, open_scan, r };
	g_autofree uint16_t **leaf = g_new0(uint16_t *, r->placed->len + 1);
	struct segmentation_scan scan;
	bool good = true;
	bench_peak_mib(true);
	gint64 began_us = g_get_monotonic_time();
	r->made = segmentation_new(&source, NULL, r->tree, error);
	for (size_t i = 0; r->made && good && i < r->placed->len; i++)
		if ((good = open_scan(r, i, &scan, error))) {
			leaf[i] = g_new(uint16_t, scan.points.count + 1);
			segmentation_label(r->made, i, &scan, leaf[i]);
		}
	t->seconds = (double)(g_get_monotonic_time() - began_us) * 1e-6;
	t->peak_mib = bench_peak_mib(false);
	for (size_t i = 0; r->made && good && i < r->placed->len; i++)
		good = open_scan(r, i, &scan, error) &&
		       count(t, r, i, &scan.points, leaf[i], user_data, error);
	for (size_t i = 0; i < r->placed->len; i++)
		g_free(leaf[i]);
	return r->made && good;
}

/* ---- against the truth ---- */

static void count_plant(struct tally *t, uint32_t instance, uint32_t leaf, float z_m)
{
	gpointer key = GUINT_TO_POINTER(instance << 16 | leaf);
	gsize cells = GPOINTER_TO_SIZE(g_hash_table_lookup(t->pairs, key));
	g_hash_table_insert(t->pairs, key, GSIZE_TO_POINTER(cells + 1));
	if (!t->instance[instance].cells++)
		t->instance[instance].low_m = t->instance[instance].high_m = z_m;
	t->instance[instance].low_m = fminf(t->instance[instance].low_m, z_m);
	t->instance[instance].high_m = fmaxf(t->instance[instance].high_m, z_m);
}

static bool count_true(struct tally *t, const struct frame *r, size_t i,
	const struct scan_points *p, const uint16_t *leaf, gpointer user_data, GError **error)
{
	const struct bench_truth_scan *truth = (const struct bench_truth_scan *)user_data + i;
	(void)error;
	for (uint64_t k = 0; k < p->count; k++) {
		const struct bench_truth_cell *c = &truth->cell[k];
		double at[3];
		t->points += leaf[k] != SEGMENT_NONE;
		bool behind_glass =
			c->optics == BENCH_TRUTH_GLASS && c->class == BENCH_TRUTH_BUILDING;
		if (leaf[k] == SEGMENT_NONE || !c->class || c->class >= BENCH_TRUTH_CLASSES ||
			(!behind_glass &&
				fabsf(c->range_m - p->data->grid->range_m[k]) > RANGE_OFF_M))
			continue;
		scan_points_position(p, k, at);
		t->cells[c->class][segments_find(r->tree, leaf[k])->class]++;
		t->of_leaf[leaf[k]]++;
		if (c->class == BENCH_TRUTH_VEGETATION)
			count_plant(t, c->instance, leaf[k], (float)at[2]);
	}
	return true;
}

/* A tree is found when one segment and it have half of what either has in common. */
static void count_trees(struct tally *t)
{
	g_autofree double *best = g_new0(double, INSTANCES);
	GHashTableIter iter;
	gpointer key, value;
	g_hash_table_iter_init(&iter, t->pairs);
	while (g_hash_table_iter_next(&iter, &key, &value)) {
		uint32_t instance = GPOINTER_TO_UINT(key) >> 16,
			 leaf = GPOINTER_TO_UINT(key) & 0xFFFF;
		double both = (double)GPOINTER_TO_SIZE(value);
		double iou = both / (t->instance[instance].cells + t->of_leaf[leaf] - both);
		best[instance] = fmax(best[instance], iou);
	}
	for (uint32_t i = 0; i < INSTANCES; i++)
		if (t->instance[i].cells >= TREE_CELLS &&
			t->instance[i].high_m - t->instance[i].low_m > TREE_HIGH_M) {
			t->trees++;
			t->trees_found += best[i] >= 0.5;
		}
}

static bool scan_stations(site *s, const char *scene, const char *preset, uint64_t seed,
	const char *folder, scan_graph *g, struct bench_truth_scan *truth, GError **error)
{
	g_autofree char *path = g_build_filename(folder, "truth", NULL);
	for (int k = 0; k < STATIONS; k++) {
		g_autofree char *description = g_strdup_printf(
			"%s?seed=%" G_GUINT64_FORMAT "&station=%d", scene, seed, k + 1);
		g_autofree char *device = g_strconcat("sim:", description, NULL);
		struct scan_options options = { .device = device, .preset = preset_find(preset) };
		struct scan_result result;
		uint32_t partial;
		if (!scan_record(s, &options, &result, &partial, error))
			return false;
		g_autoptr(scan_data) d = scan_data_load(s, result.number, error);
		if (!d || !bench_truth_ask(description, d->grid->columns, d->grid->rows, path,
				  &truth[k], error))
			return false;
		struct placed_scan p = {
			.number = result.number, .group = 1, .pose = truth[k].pose
		};
		pose_orthonormalise(&p.pose);
		g_array_append_val(g->scans, p);
	}
	return true;
}

static bool measure_scene(struct tally *t, const char *scene,
	const struct bench_segments_options *o, const char *folder, GError **error)
{
	struct bench_truth_scan truth[STATIONS] = { 0 };
	g_autofree char *path = g_build_filename(folder, scene, NULL);
	g_autoptr(site) s = site_open_for_writing(path, error);
	g_autoptr(scan_graph) g = scan_graph_new();
	uint32_t made;
	bool good = s &&
		    scan_stations(s, scene, o->preset ? o->preset : "standard", o->seed, folder, g,
			    truth, error) &&
		    geometry_site(s, g, NULL, &made, error);
	if (good) {
		struct frame r = frame_new(s, g);
		good = segment_and_count(&r, t, count_true, truth, error);
		frame_clear(&r);
	}
	for (int k = 0; k < STATIONS; k++)
		g_free(truth[k].cell);
	if (good)
		count_trees(t);
	return good;
}

/* ---- against classes of a file ---- */

static bool count_told(struct tally *t, const struct frame *r, size_t i,
	const struct scan_points *p, const uint16_t *leaf, gpointer user_data, GError **error)
{
	(void)i, (void)user_data, (void)error;
	for (uint64_t k = 0; k < p->count; k++) {
		int told = segment_class_from_las(scan_points_classification(p, k));
		t->points += leaf[k] != SEGMENT_NONE;
		if (leaf[k] != SEGMENT_NONE && told >= 0)
			t->cells[told][segments_find(r->tree, leaf[k])->class]++;
	}
	return true;
}

static bool measure_site(struct tally *t, const char *path, GError **error)
{
	g_autoptr(site) s = site_open(path, error);
	g_autoptr(scan_graph) g = s ? scan_graph_load(s, error) : NULL;
	if (!g)
		return false;
	struct frame r = frame_new(s, g);
	bool good = r.placed->len;
	if (!good)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"%s: has no placed scan; pleinair process places them", path);
	good = good && segment_and_count(&r, t, count_told, NULL, error);
	frame_clear(&r);
	return good;
}

/* ---- what comes out ---- */

/* NAN: too little of the class is there. */
static double score_of(const struct tally *t, int class, bool f1)
{
	double both = t->cells[class][class], is = 0, told = 0;
	for (int k = 0; k < SEGMENT_CLASSES; k++)
		is += t->cells[class][k];
	for (int k = 0; k < BENCH_TRUTH_CLASSES; k++)
		told += t->cells[k][class];
	if (is < CELLS_LEAST)
		return NAN;
	return f1 ? 2 * both / (is + told) : both / (is + told - both);
}

static double mean_score(const struct tally *t, bool f1)
{
	double sum = 0, classes = 0;
	for (int c = 1; c < SEGMENT_CLASSES; c++)
		if (!isnan(score_of(t, c, f1))) {
			sum += score_of(t, c, f1);
			classes++;
		}
	return sum / classes;
}

static const char *row_name(int row, bool is_site)
{
	return is_site && row < SEGMENT_CLASSES ? segment_classes[row].name
						: bench_truth_names[row];
}

static void print_tally(const struct tally *t, const char *title, bool is_site)
{
	printf("%s: %.2f million points, %.2f s, %.0f MiB\n%-12s", title, t->points * 1e-6,
		t->seconds, t->peak_mib, "");
	for (int k = 0; k < SEGMENT_CLASSES; k++)
		printf(" %10s", segment_classes[k].name);
	printf(" %6s\n", is_site ? "F1" : "IoU");
	for (int c = is_site ? 0 : 1; c < (is_site ? SEGMENT_CLASSES : BENCH_TRUTH_CLASSES); c++) {
		printf("  %-10s", row_name(c, is_site));
		for (int k = 0; k < SEGMENT_CLASSES; k++)
			printf(" %10.0f", t->cells[c][k]);
		if (c < SEGMENT_CLASSES && !isnan(score_of(t, c, is_site)))
			printf(" %6.3f", score_of(t, c, is_site));
		puts("");
	}
	if (is_site)
		printf("  mean F1 %.3f\n", mean_score(t, true));
	else
		printf("  mean IoU %.3f (reach: >= 0.85), trees %u of %u (>= 90 %%)\n",
			mean_score(t, false), t->trees_found, t->trees);
}

static JsonObject *json_of(const struct tally *t, const char *title, bool is_site)
{
	JsonObject *j = json_object_new(), *score = json_object_new(),
		   *confusion = json_object_new();
	for (int c = 0; c < (is_site ? SEGMENT_CLASSES : BENCH_TRUTH_CLASSES); c++) {
		JsonObject *row = json_object_new();
		for (int k = 0; k < SEGMENT_CLASSES; k++)
			json_object_set_int_member(
				row, segment_classes[k].name, (gint64)t->cells[c][k]);
		json_object_set_object_member(confusion, row_name(c, is_site), row);
		if (c && c < SEGMENT_CLASSES && !isnan(score_of(t, c, is_site)))
			json_object_set_double_member(
				score, row_name(c, is_site), score_of(t, c, is_site));
	}
	json_object_set_string_member(j, is_site ? "site" : "scene", title);
	json_object_set_object_member(j, "confusion", confusion);
	json_object_set_object_member(j, is_site ? "f1" : "iou", score);
	double mean = mean_score(t, is_site);
	if (!isnan(mean))
		json_object_set_double_member(j, is_site ? "mean_f1" : "mean_iou", mean);
	if (!is_site) {
		json_object_set_int_member(j, "trees", t->trees);
		json_object_set_int_member(j, "trees_found", t->trees_found);
	}
	json_object_set_int_member(j, "points", (gint64)t->points);
	json_object_set_double_member(j, "seconds", t->seconds);
	json_object_set_double_member(j, "peak_mib", t->peak_mib);
	return j;
}

static bool measure_one(const struct bench_segments_options *o, const char *scene,
	const char *folder, JsonArray *rows, GError **error)
{
	struct tally *t = tally_new();
	const char *title = o->site ? o->site : scene;
	bool good = o->site ? measure_site(t, o->site, error)
			    : measure_scene(t, scene, o, folder, error);
	if (good && o->json)
		json_array_add_object_element(rows, json_of(t, title, o->site));
	else if (good)
		print_tally(t, title, o->site);
	tally_free(t);
	return good;
}

bool bench_segments(const struct bench_segments_options *o, GError **error)
{
	JsonArray *rows = json_array_new();
	g_autofree char *folder = o->site ? NULL : g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	bool good = o->site || folder;
	for (size_t i = 0; good && i < (o->site ? 1 : G_N_ELEMENTS(scenes)); i++)
		good = measure_one(o, scenes[i], folder, rows, error);
	if (folder)
		good = files_remove_tree(folder, good ? error : NULL) && good;
	JsonObject *json = json_object_new();
	json_object_set_array_member(json, "rows", rows);
	if (good && o->json)
		cli_print_json(json);
	else
		json_object_unref(json);
	return good;
}
