#include "process/bench-lines.h"
#include "acquire/cli.h"
#include "process/bench-run.h"
#include "process/bench-sites.h"
#include "process/line-score.h"
#include "process/scan-graph.h"
#include "process/segments.h"
#include <stdio.h>

static const char *const heading[] = { "profile lines: straight building edges longer than 1 m, of "
				       "their length within 2 cm of one or two lines",
	"(>= 90 %), of any; of the lines' length on no edge (<= 5 %); by distance from the nearest "
	"station in m",
	"scene     edges        m  covered      any    lines        m   astray  seconds  <5  <10  "
	"<20  <40",
	NULL };

static double percent(double part, double all)
{
	return all > 0 ? 100 * part / all : NAN;
}

/* ---- the truth ---- */

/* ret_to_truth: from the site's frame, in which the first scan stands. */
static line_truth *ask_truth(const struct bench_scene *scene, const scan_graph *g, uint32_t columns,
	struct pose *ret_to_truth, GError **error)
{
	g_autoptr(line_truth) t = line_truth_new();
	g_autofree char *path = g_build_filename(scene->work, "truth", NULL);
	for (uint32_t k = 1; k <= BENCH_STATIONS; k++) {
		g_autofree char *description = bench_scene_station(scene, k);
		struct bench_truth_scan seen = { 0 };
		bool good = bench_truth_ask(
			description, LINE_SCORE_COLUMNS, LINE_SCORE_ROWS, path, &seen, error);
		g_autofree struct bench_truth_cell *cell = seen.cell;
		g_autofree float *light = good ? bench_truth_light(description, LINE_SCORE_COLUMNS,
							 LINE_SCORE_ROWS, path, error)
					       : NULL;
		if (!light)
			return NULL;
		struct bench_truth_scan behind = { 0 };
		if (!bench_truth_ask_behind(
			    description, LINE_SCORE_COLUMNS, LINE_SCORE_ROWS, path, &behind, error))
			return NULL;
		line_truth_add(t, &seen, light, columns);
		line_truth_add_behind(t, &seen, &behind);
		g_free(behind.cell);
		if (k == 1) {
			struct pose back = pose_inverse(&scan_graph_scan((scan_graph *)g, 1)->pose);
			*ret_to_truth = pose_compose(&seen.pose, &back);
		}
	}
	return g_steal_pointer(&t);
}

/* ---- the lines ---- */

static profile_lines *find_lines(const char *path, double *ret_seconds, GError **error)
{
	g_autoptr(model) m = model_open(path, error);
	g_autoptr(segments) tree = m ? segments_load(path, error) : NULL;
	if (!tree)
		return NULL;
	g_autofree uint8_t *leaf_class = segments_classes(tree);
	const struct profile_options options = { .leaf_class = leaf_class };
	gint64 start_us = g_get_monotonic_time();
	profile_lines *lines = profile_lines_find(m, &options);
	*ret_seconds = (double)(g_get_monotonic_time() - start_us) * 1e-6;
	return lines;
}

static void print_score(const char *scene, const struct line_score *s, double seconds)
{
	printf("%-7s %7u %8.0f %8.1f %8.1f %8u %8.0f %8.1f %8.1f", scene, s->edges, s->edges_m,
		percent(s->covered_m, s->edges_m), percent(s->any_m, s->edges_m), s->lines,
		s->lines_m, percent(s->astray_m, s->lines_m), seconds);
	for (int b = 0; b < 4; b++)
		printf(" %4.0f", percent(s->band_covered_m[b], s->band_m[b]));
	puts("");
	fflush(stdout);
}

static void add_number(JsonObject *o, const char *key, double value)
{
	if (isfinite(value))
		json_object_set_double_member(o, key, value);
}

static JsonObject *score_to_json(const char *scene, const struct line_score *s, double seconds)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "scene", scene);
	json_object_set_int_member(o, "edges", s->edges);
	add_number(o, "edges_m", s->edges_m);
	add_number(o, "covered_percent", percent(s->covered_m, s->edges_m));
	add_number(o, "covered_by_any_percent", percent(s->any_m, s->edges_m));
	json_object_set_int_member(o, "lines", s->lines);
	add_number(o, "lines_m", s->lines_m);
	add_number(o, "astray_percent", percent(s->astray_m, s->lines_m));
	add_number(o, "seconds", seconds);
	return o;
}

struct measuring {
	JsonArray *json; /* NULL: printed */
	uint32_t columns;
};

static bool measure_scene(const struct bench_scene *scene, gpointer user_data, GError **error)
{
	const struct measuring *m = user_data;
	g_autofree char *program = bench_program("process");
	struct bench_run run = { 0 };
	bool good =
		bench_run((const char *[]){ program, scene->path, "--json", NULL }, &run, error);
	g_free(run.output);
	g_autoptr(site) s = good ? site_open(scene->path, error) : NULL;
	g_autoptr(scan_graph) g = s ? scan_graph_load(s, error) : NULL;
	struct pose to_truth;
	struct line_score score;
	double seconds;
	g_autoptr(line_truth) truth = g ? ask_truth(scene, g, m->columns, &to_truth, error) : NULL;
	g_autoptr(profile_lines) lines = truth ? find_lines(scene->path, &seconds, error) : NULL;
	if (!lines)
		return false;
	line_score_make(truth, lines, &to_truth, &score);
	if (m->json)
		json_array_add_object_element(m->json, score_to_json(scene->name, &score, seconds));
	else
		print_score(scene->name, &score, seconds);
	return true;
}

bool bench_lines(const struct bench_lines_options *o, GError **error)
{
	const struct preset *preset = preset_find(o->preset ? o->preset : "standard");
	JsonObject *json = o->json ? json_object_new() : NULL;
	struct measuring measuring = { .columns = preset->columns };
	struct bench_scenes scenes = { o->seed, o->preset, o->keep, measure_scene, &measuring };
	if (json) {
		measuring.json = json_array_new();
		json_object_set_array_member(json, "scenes", measuring.json);
	}
	return bench_scenes_say(&scenes, heading, json, error);
}
