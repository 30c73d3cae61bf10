#include "process/bench-features.h"
#include "acquire/cli.h"
#include "acquire/scan.h"
#include "process/bench-run.h"
#include "process/bench-sites.h"
#include "process/bench-truth.h"
#include "process/feature-score.h"
#include "process/normals.h"
#include <stdio.h>
#include <string.h>

/* Line by line. */
static const char *const heading[] = { "features, in percent: edges within a cell of a feature "
				       "point (>= 90; depth edges, creases);",
	"feature points on even surface (<= 10); at straight edges directional, off by degrees",
	"(median, p90 <= 3), the same of creases and of silhouettes; on leaves directional (<= "
	"10);",
	"dithering points per m2 of black by range in m, of 60 wanted",
	"scene      edges    depth    crease     false  directed   p50    p90    crease    p90  "
	"silhouette p90    leaves  dithering",
	NULL };

struct station {
	range_grid *grid;
	struct pose pose;
	struct feature_truth *truth;
	features *features;
};

/* ---- scans ---- */

static bool read_truth(struct station *s, const char *description, const char *path, GError **error)
{
	const range_grid *g = s->grid;
	struct bench_truth_scan seen = { 0 };
	bool good = bench_truth_ask(description, g->columns, g->rows, path, &seen, error);
	g_autofree struct bench_truth_cell *cell = seen.cell;
	g_autofree float *light =
		good ? bench_truth_light(description, g->columns, g->rows, path, error) : NULL;
	if (!light)
		return false;
	s->pose = seen.pose;
	s->truth = g_new0(struct feature_truth, range_grid_cells(g));
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		s->truth[i].range_m = cell[i].range_m;
		memcpy(s->truth[i].normal, cell[i].normal, sizeof cell[i].normal);
		memcpy(s->truth[i].rgb, &light[3 * i], sizeof s->truth[i].rgb);
		s->truth[i].instance = cell[i].instance;
		s->truth[i].is_plant = cell[i].class == BENCH_TRUTH_VEGETATION;
		s->truth[i].is_glass = cell[i].optics != 0;
	}
	return true;
}

static bool load_stations(struct station *stations, const struct bench_scene *scene, GError **error)
{
	g_autoptr(site) s = site_open(scene->path, error);
	g_autofree char *truth = g_build_filename(scene->work, "truth", NULL);
	for (uint32_t i = 0; s && i < BENCH_STATIONS; i++) {
		g_autofree char *description = bench_scene_station(scene, i + 1);
		g_autoptr(panorama) p = scan_load(s, i + 1, false, error);
		if (!p)
			return false;
		stations[i].grid = range_grid_from_panorama(p);
		if (!read_truth(&stations[i], description, truth, error))
			return false;
	}
	return s;
}

/* ---- what a person waits for ---- */

/* From scans whose planes are known to features, by pleinair process as a program of its own. */
struct everything {
	double seconds, peak_mib;      /* of the program */
	double segments_s, features_s; /* of its stages */
};

/* Stages that were due, from what pleinair process --json says. */
static bool read_stages(const char *text, struct everything *ret, GError **error)
{
	g_autoptr(JsonParser) parser = json_parser_new();
	if (!json_parser_load_from_data(parser, text, -1, error))
		return false;
	JsonArray *rows = json_object_get_array_member(
		json_node_get_object(json_parser_get_root(parser)), "stages");
	for (guint i = 0; i < json_array_get_length(rows); i++) {
		JsonObject *row = json_array_get_object_element(rows, i);
		const char *name = json_object_get_string_member(row, "stage");
		double seconds = json_object_get_double_member_with_default(row, "seconds", 0);
		if (strcmp(name, "segments") == 0)
			ret->segments_s = seconds;
		if (strcmp(name, "features") == 0)
			ret->features_s = seconds;
	}
	return true;
}

static bool measure_everything(const char *path, struct everything *ret, GError **error)
{
	g_autofree char *program = bench_program("process");
	struct bench_run before = { 0 }, after = { 0 };
	bool good = bench_run((const char *[]){ program, path, "--to=geometry", "--json", NULL },
			    &before, error) &&
		    bench_run((const char *[]){ program, path, "--to=features", "--json", NULL },
			    &after, error);
	*ret = (struct everything){ .seconds = after.seconds, .peak_mib = after.peak_mib };
	good = good && read_stages(after.output, ret, error);
	g_free(before.output);
	g_free(after.output);
	return good;
}

/* ---- measuring ---- */

/* Of all stations, each with the feature points of all; seconds on the clock. */
static double compute(struct station *stations)
{
	struct features_view views[BENCH_STATIONS];
	gint64 start_us = g_get_monotonic_time();
	for (int i = 0; i < BENCH_STATIONS; i++) {
		struct features_input of = { .grid = stations[i].grid, .pose = stations[i].pose };
		stations[i].features = features_estimate(&of, NULL);
		views[i] = (struct features_view){ of,
			features_ridges_new(&of, stations[i].features, NULL) };
	}
	for (int i = 0; i < BENCH_STATIONS; i++)
		features_fit_lines(
			stations[i].features, &views[i].scan, views, BENCH_STATIONS, NULL);
	for (int i = 0; i < BENCH_STATIONS; i++)
		features_ridges_free((features_ridges *)views[i].ridges);
	return (double)(g_get_monotonic_time() - start_us) * 1e-6;
}

static double percent(uint64_t part, uint64_t all)
{
	return all ? 100.0 * (double)part / (double)all : NAN;
}

static void print_score(const char *scene, int station, const struct feature_score *s)
{
	printf("%-7s %d  %8.1f %8.1f %8.1f  %8.1f  %8.1f %6.1f %6.1f  %8.1f %6.1f  %8.1f %6.1f  "
	       "%8.1f ",
		scene, station, percent(s->edges_found, s->edges),
		percent(s->depth_found, s->depth_edges), percent(s->creases_found, s->creases),
		percent(s->false_points, s->points),
		percent(s->straight.directed, s->straight.straight), s->straight.p50_deg,
		s->straight.p90_deg,
		percent(s->straight_creases.directed, s->straight_creases.straight),
		s->straight_creases.p90_deg,
		percent(s->straight_silhouettes.directed, s->straight_silhouettes.straight),
		s->straight_silhouettes.p90_deg, percent(s->leaves_directed, s->leaves));
	for (int b = 0; b < FEATURE_BANDS; b++)
		if (s->band_m2[b] >= 5)
			printf(" %.0f:%.0f", s->band_m[b], s->density_per_m2[b]);
	puts("");
}

static void add_number(JsonObject *o, const char *key, double value)
{
	if (isfinite(value))
		json_object_set_double_member(o, key, value);
}

static void add_lines(JsonObject *o, const char *of, const struct feature_lines *l)
{
	g_autofree char *share = g_strconcat(of, "_directed_percent", NULL);
	g_autofree char *median = g_strconcat(of, "_direction_median_deg", NULL);
	g_autofree char *p90 = g_strconcat(of, "_direction_p90_deg", NULL);
	add_number(o, share, percent(l->directed, l->straight));
	add_number(o, median, l->p50_deg);
	add_number(o, p90, l->p90_deg);
}

static JsonObject *score_to_json(const char *scene, int station, const struct feature_score *s)
{
	JsonObject *o = json_object_new();
	JsonArray *bands = json_array_new();
	json_object_set_string_member(o, "scene", scene);
	json_object_set_int_member(o, "station", station);
	add_number(o, "edges_found_percent", percent(s->edges_found, s->edges));
	add_number(o, "depth_edges_found_percent", percent(s->depth_found, s->depth_edges));
	add_number(o, "creases_found_percent", percent(s->creases_found, s->creases));
	add_number(o, "false_percent", percent(s->false_points, s->points));
	add_lines(o, "straight", &s->straight);
	add_lines(o, "crease", &s->straight_creases);
	add_lines(o, "silhouette", &s->straight_silhouettes);
	add_number(o, "leaves_directed_percent", percent(s->leaves_directed, s->leaves));
	for (int b = 0; b < FEATURE_BANDS; b++) {
		JsonObject *band = json_object_new();
		add_number(band, "from_m", s->band_m[b]);
		add_number(band, "to_m", s->band_m[b + 1]);
		add_number(band, "surface_m2", s->band_m2[b]);
		add_number(band, "per_m2", s->density_per_m2[b]);
		json_array_add_object_element(bands, band);
	}
	json_object_set_array_member(o, "dithering", bands);
	return o;
}

static void report_scene(
	const char *scene, double seconds, const struct everything *e, JsonArray *json)
{
	if (!json) {
		printf("%-7s    %.1f s for features of all four; everything from planes on: %.1f s "
		       "(<= 20 of fine scans; segments %.1f, features %.1f), %.0f MiB (<= 2048)\n",
			scene, seconds, e->seconds, e->segments_s, e->features_s, e->peak_mib);
		fflush(stdout);
		return;
	}
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "scene", scene);
	json_object_set_double_member(o, "seconds", seconds);
	json_object_set_double_member(o, "everything_seconds", e->seconds);
	json_object_set_double_member(o, "everything_segments_seconds", e->segments_s);
	json_object_set_double_member(o, "everything_features_seconds", e->features_s);
	json_object_set_double_member(o, "everything_peak_mib", e->peak_mib);
	json_array_add_object_element(json, o);
}

static void report_stations(const char *scene, struct station *stations, JsonArray *json)
{
	for (int i = 0; i < BENCH_STATIONS; i++) {
		struct feature_score score;
		feature_score_make(stations[i].features, stations[i].grid, stations[i].truth,
			normals_range_noise_m(stations[i].grid, NULL), NULL, &score);
		if (json)
			json_array_add_object_element(json, score_to_json(scene, i + 1, &score));
		else
			print_score(scene, i + 1, &score);
	}
}

/* json: "stations" and "scenes" are filled; NULL: printed. */
static bool measure_scene(const struct bench_scene *scene, gpointer json, GError **error)
{
	struct station stations[BENCH_STATIONS] = { 0 };
	struct everything everything;
	bool good = measure_everything(scene->path, &everything, error) &&
		    load_stations(stations, scene, error);
	if (good) {
		double seconds = compute(stations);
		report_stations(scene->name, stations,
			json ? json_object_get_array_member(json, "stations") : NULL);
		report_scene(scene->name, seconds, &everything,
			json ? json_object_get_array_member(json, "scenes") : NULL);
	}
	for (int i = 0; i < BENCH_STATIONS; i++) {
		range_grid_free(stations[i].grid);
		features_free(stations[i].features);
		g_free(stations[i].truth);
	}
	return good;
}

bool bench_features(const struct bench_features_options *o, GError **error)
{
	JsonObject *json = o->json ? json_object_new() : NULL;
	struct bench_scenes scenes = { o->seed, o->preset, o->keep, measure_scene, json };
	if (json) {
		json_object_set_array_member(json, "stations", json_array_new());
		json_object_set_array_member(json, "scenes", json_array_new());
	}
	return bench_scenes_say(&scenes, heading, json, error);
}
