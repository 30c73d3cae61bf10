#include "process/bench-segments.h"
#include "acquire/cli.h"
#include "process/bench-run.h"
#include "process/bench-sites.h"
#include "process/scan-cache.h"
#include "process/segment-score.h"
#include "process/segmentation.h"
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <string.h>

struct measured {
	segment_score *score;
	double seconds, peak_mib;
};

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
		.cache = scan_cache_new(s, BENCH_STATIONS),
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

/* Of all scans at once. truth: of each; NULL: classes that points came with. */
static bool segment_and_count(
	struct frame *r, struct measured *m, const struct bench_truth_scan *truth, GError **error)
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
	m->seconds = (double)(g_get_monotonic_time() - began_us) * 1e-6;
	m->peak_mib = bench_peak_mib(false);
	for (size_t i = 0; r->made && good && i < r->placed->len; i++) {
		good = open_scan(r, i, &scan, error);
		if (good && truth)
			segment_score_count(
				m->score, r->tree, &scan.points, leaf[i], truth[i].cell);
		else if (good)
			segment_score_count_told(m->score, r->tree, &scan.points, leaf[i]);
	}
	segment_score_count_trees(m->score);
	for (size_t i = 0; i < r->placed->len; i++)
		g_free(leaf[i]);
	return r->made && good;
}

/* ---- against the truth ---- */

static bool ask_truth(const struct bench_scene *scene, site *s, scan_graph *g,
	struct bench_truth_scan *truth, GError **error)
{
	g_autofree char *path = g_build_filename(scene->work, "truth", NULL);
	for (uint32_t k = 1; k <= BENCH_STATIONS; k++) {
		g_autofree char *description = bench_scene_station(scene, k);
		g_autoptr(scan_data) d = scan_data_load(s, k, error);
		if (!d || !bench_truth_ask(description, d->grid->columns, d->grid->rows, path,
				  &truth[k - 1], error))
			return false;
		struct placed_scan p = { .number = k, .group = 1, .pose = truth[k - 1].pose };
		pose_orthonormalise(&p.pose);
		g_array_append_val(g->scans, p);
	}
	return true;
}

static bool measure_scene(struct measured *m, const struct bench_scene *scene, GError **error)
{
	struct bench_truth_scan truth[BENCH_STATIONS] = { 0 };
	g_autoptr(site) s = site_open_for_writing(scene->path, error);
	g_autoptr(scan_graph) g = scan_graph_new();
	uint32_t made;
	bool good = s && ask_truth(scene, s, g, truth, error) &&
		    geometry_site(s, g, NULL, &made, error);
	if (good) {
		struct frame r = frame_new(s, g);
		good = segment_and_count(&r, m, truth, error);
		frame_clear(&r);
	}
	for (int k = 0; k < BENCH_STATIONS; k++)
		g_free(truth[k].cell);
	return good;
}

/* ---- against classes of a file ---- */

static bool measure_site(struct measured *m, const char *path, GError **error)
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
	good = good && segment_and_count(&r, m, NULL, error);
	frame_clear(&r);
	return good;
}

/* ---- what comes out ---- */

static void print(const struct measured *m, const char *title, bool is_site)
{
	g_autofree char *table = segment_score_text(m->score, is_site);
	printf("%s: %.2f million points, %.2f s, %.0f MiB\n%s\n", title, m->score->points * 1e-6,
		m->seconds, m->peak_mib, table);
	fflush(stdout);
}

static JsonObject *json_of(const struct measured *m, const char *title, bool is_site)
{
	const segment_score *s = m->score;
	JsonObject *j = json_object_new(), *score = json_object_new(),
		   *confusion = json_object_new();
	for (int c = 0; c < (is_site ? SEGMENT_CLASSES : BENCH_TRUTH_CLASSES); c++) {
		JsonObject *row = json_object_new();
		for (int k = 0; k < SEGMENT_CLASSES; k++)
			json_object_set_int_member(
				row, segment_classes[k].name, (gint64)s->cells[c][k]);
		json_object_set_object_member(confusion, segment_score_row(c, is_site), row);
		if (c && c < SEGMENT_CLASSES && !isnan(segment_score_of(s, c, is_site)))
			json_object_set_double_member(score, segment_score_row(c, is_site),
				segment_score_of(s, c, is_site));
	}
	json_object_set_string_member(j, is_site ? "site" : "scene", title);
	json_object_set_object_member(j, "confusion", confusion);
	json_object_set_object_member(j, is_site ? "f1" : "iou", score);
	double mean = segment_score_mean(s, is_site);
	if (!isnan(mean))
		json_object_set_double_member(j, is_site ? "mean_f1" : "mean_iou", mean);
	if (!is_site) {
		json_object_set_int_member(j, "trees", s->trees);
		json_object_set_int_member(j, "trees_found", s->trees_found);
	}
	json_object_set_int_member(j, "points", (gint64)s->points);
	json_object_set_double_member(j, "seconds", m->seconds);
	json_object_set_double_member(j, "peak_mib", m->peak_mib);
	return j;
}

/* scene: NULL: the site of this path. rows: NULL: printed. */
static bool measure(
	const struct bench_scene *scene, const char *site_path, JsonArray *rows, GError **error)
{
	g_autoptr(segment_score) score = segment_score_new();
	struct measured m = { score, 0, 0 };
	const char *title = scene ? scene->name : site_path;
	if (!(scene ? measure_scene(&m, scene, error) : measure_site(&m, site_path, error)))
		return false;
	if (rows)
		json_array_add_object_element(rows, json_of(&m, title, !scene));
	else
		print(&m, title, !scene);
	return true;
}

static bool measure_each(const struct bench_scene *scene, gpointer rows, GError **error)
{
	return measure(scene, NULL, rows, error);
}

bool bench_segments(const struct bench_segments_options *o, GError **error)
{
	JsonArray *rows = o->json ? json_array_new() : NULL;
	struct bench_scenes scenes = { o->seed, o->preset, o->keep, measure_each, rows };
	bool good = o->site ? measure(NULL, o->site, rows, error)
			    : bench_scenes_measure(&scenes, error);
	if (!rows)
		return good;
	JsonObject *json = json_object_new();
	json_object_set_array_member(json, "rows", rows);
	if (good)
		cli_print_json(json);
	else
		json_object_unref(json);
	return good;
}
