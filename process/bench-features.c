#include "process/bench-features.h"
#include "acquire/cli.h"
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/feature-score.h"
#include "process/normals.h"
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#define STATIONS 4
#define PLANTS   2 /* their class in the truth */

static const char *const scenes[] = { "court", "street", "bridge", NULL };

struct station {
	range_grid *grid;
	struct pose pose;
	struct feature_truth *truth;
	features *features;
};

/* ---- the truth, as pleinair-sim writes it (sim/truth.h) ---- */

struct truth_header {
	char magic[8];
	uint32_t columns, rows;
	double elevation_max_rad, elevation_min_rad, position_m[3], rotation[9];
};
struct truth_record {
	float range_m, normal[3];
	uint16_t instance;
	uint8_t class, optics;
};
_Static_assert(sizeof(struct truth_header) == 128 && sizeof(struct truth_record) == 20,
	"the file's own layout");

static char *find_simulator(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : ".");
	char *beside = g_build_filename(folder, "pleinair-sim", NULL);
	if (g_file_test(beside, G_FILE_TEST_IS_EXECUTABLE))
		return beside;
	g_free(beside);
	return g_strdup("pleinair-sim");
}

/* The file that the simulator writes, of so many bytes; caller frees. */
static char *ask(const range_grid *g, const char *what, const char *description, const char *path,
	size_t bytes, GError **error)
{
	g_autofree char *simulator = find_simulator();
	g_autofree char *columns = g_strdup_printf("--columns=%u", g->columns);
	g_autofree char *rows = g_strdup_printf("--rows=%u", g->rows);
	size_t length = 0;
	g_autoptr(GSubprocess) p = g_subprocess_new(G_SUBPROCESS_FLAGS_NONE, error, simulator, what,
		columns, rows, "-o", path, description, NULL);
	if (!p || !g_subprocess_wait_check(p, NULL, error))
		return NULL;
	char *ret = files_read(path, bytes, &length, error);
	if (ret && length == bytes)
		return ret;
	if (ret)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"%s: is not the truth of this scan", path);
	g_free(ret);
	return NULL;
}

static bool read_truth(struct station *s, const char *description, const char *path, GError **error)
{
	const size_t cells = range_grid_cells(s->grid);
	g_autofree char *seen = ask(s->grid, "--truth", description, path,
		sizeof(struct truth_header) + cells * sizeof(struct truth_record), error);
	g_autofree char *lit =
		seen ? ask(s->grid, "--light", description, path, 16 + cells * 12, error) : NULL;
	if (!lit)
		return false;
	const struct truth_header *h = (const struct truth_header *)seen;
	const struct truth_record *t = (const struct truth_record *)(seen + sizeof *h);
	memcpy(s->pose.translation_m, h->position_m, sizeof h->position_m);
	memcpy(s->pose.rotation, h->rotation, sizeof h->rotation);
	s->truth = g_new0(struct feature_truth, cells);
	for (size_t i = 0; i < cells; i++) {
		s->truth[i].range_m = t[i].range_m;
		memcpy(s->truth[i].normal, t[i].normal, sizeof t[i].normal);
		memcpy(s->truth[i].rgb, lit + 16 + 12 * i, 12);
		s->truth[i].instance = t[i].instance;
		s->truth[i].is_plant = t[i].class == PLANTS;
		s->truth[i].is_glass = t[i].optics != 0;
	}
	return true;
}

/* ---- scans ---- */

static bool scan_missing(
	const char *path, const char *scene, const struct bench_features_options *o, GError **error)
{
	g_autoptr(site) s = site_open_for_writing(path, error);
	uint32_t cut_off = 0;
	if (!s || !site_find_partial(s, &cut_off, error) ||
		(cut_off && !site_discard_partial(s, cut_off, error)))
		return false;
	g_autoptr(GArray) there = site_scans(s, error);
	for (uint32_t i = there ? there->len : 0; there && i < STATIONS; i++) {
		g_autofree char *device =
			g_strdup_printf("sim:%s?seed=%" G_GUINT64_FORMAT "&station=%u&speed=max",
				scene, (guint64)o->seed, i + 1);
		struct scan_options options = { .device = device,
			.preset = preset_find(o->preset ? o->preset : "standard") };
		struct scan_result result;
		uint32_t partial;
		if (!scan_record(s, &options, &result, &partial, error))
			return false;
	}
	return there;
}

static bool load_stations(struct station *stations, const char *path, const char *scene,
	const struct bench_features_options *o, GError **error)
{
	g_autoptr(site) s = site_open(path, error);
	g_autofree char *truth = g_strconcat(path, ".truth", NULL);
	for (uint32_t i = 0; s && i < STATIONS; i++) {
		g_autofree char *description = g_strdup_printf(
			"%s?seed=%" G_GUINT64_FORMAT "&station=%u", scene, (guint64)o->seed, i + 1);
		g_autoptr(panorama) p = scan_load(s, i + 1, false, error);
		if (!p)
			return false;
		stations[i].grid = range_grid_from_panorama(p);
		if (!read_truth(&stations[i], description, truth, error))
			return false;
	}
	return s;
}

/* ---- measuring ---- */

/* Of all stations, each with the feature points of all; seconds on the clock. */
static double compute(struct station *stations)
{
	struct features_view views[STATIONS];
	gint64 start_us = g_get_monotonic_time();
	for (int i = 0; i < STATIONS; i++) {
		struct features_input of = { .grid = stations[i].grid, .pose = stations[i].pose };
		stations[i].features = features_estimate(&of, NULL);
		views[i] = (struct features_view){ of, stations[i].features->degree,
			stations[i].features->cuts };
	}
	for (int i = 0; i < STATIONS; i++)
		features_fit_lines(stations[i].features, &views[i].scan, views, STATIONS, NULL);
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

static void report(const char *scene, struct station *stations, double seconds, JsonArray *json)
{
	for (int i = 0; i < STATIONS; i++) {
		struct feature_score score;
		feature_score_make(stations[i].features, stations[i].grid, stations[i].truth,
			normals_range_noise_m(stations[i].grid), NULL, &score);
		if (json)
			json_array_add_object_element(json, score_to_json(scene, i + 1, &score));
		else
			print_score(scene, i + 1, &score);
	}
	if (!json)
		printf("%-7s    %.1f s for all four\n", scene, seconds);
}

static bool run_scene(const char *folder, const char *scene, const struct bench_features_options *o,
	double *ret_seconds, JsonArray *json, GError **error)
{
	struct station stations[STATIONS] = { 0 };
	g_autofree char *name = g_strdup_printf("%s-%" G_GUINT64_FORMAT "-%s", scene,
		(guint64)o->seed, o->preset ? o->preset : "standard");
	g_autofree char *path = g_build_filename(folder, name, NULL);
	bool good = scan_missing(path, scene, o, error) &&
		    load_stations(stations, path, scene, o, error);
	if (good) {
		*ret_seconds = fmax(*ret_seconds, compute(stations));
		report(scene, stations, *ret_seconds, json);
	}
	for (int i = 0; i < STATIONS; i++) {
		range_grid_free(stations[i].grid);
		features_free(stations[i].features);
		g_free(stations[i].truth);
	}
	return good;
}

static double peak_mib(void)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	return (double)usage.ru_maxrss / 1024;
}

bool bench_features(const struct bench_features_options *o, GError **error)
{
	g_autofree char *own = o->keep ? NULL : g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	const char *folder = o->keep ? o->keep : own;
	JsonArray *stations = o->json ? json_array_new() : NULL;
	double seconds = 0;
	bool good = folder && g_mkdir_with_parents(folder, 0777) == 0;
	if (good && !o->json)
		puts("features, in percent: edges within a cell of a feature point (>= 90; depth "
		     "edges, creases); feature "
		     "points on even surface (<= 10);\nat straight edges directional (>= 60), off "
		     "by "
		     "degrees (median, p90 <= 3), the same of creases and of silhouettes; "
		     "on leaves directional (<= 10);\ndithering points per m2 of black by range in "
		     "m, of 60 wanted\n"
		     "scene      edges    depth    crease     false  directed   p50    p90    "
		     "crease    p90  silhouette p90    leaves  dithering");
	for (int i = 0; good && scenes[i]; i++)
		good = run_scene(folder, scenes[i], o, &seconds, stations, error);
	if (own && !files_remove_tree(own, good ? error : NULL))
		good = false;
	if (good && !o->json)
		printf("at most %.1f s for four scans, %.0f MiB with the truth\n", seconds,
			peak_mib());
	JsonObject *json = o->json ? json_object_new() : NULL;
	if (json) {
		json_object_set_array_member(json, "stations", stations);
		json_object_set_double_member(json, "seconds", seconds);
		json_object_set_double_member(json, "peak_mib", peak_mib());
	}
	if (json && good)
		cli_print_json(json);
	else if (json)
		json_object_unref(json);
	return good;
}
