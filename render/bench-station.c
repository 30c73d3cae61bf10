#include "render/bench-station.h"
#include "acquire/cli.h"
#include "firmware-io/files.h"
#include "process/bench-run.h"
#include "process/bench-sites.h"
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define SIZE "1280x800"

struct figures {
	double develop_s, look_s, draw_s; /* up to the first picture */
	double process_s;                 /* all else */
	JsonArray *stages;                /* of pleinair process, both times */
};

/* ---- the site before ---- */

static bool copy_scans(const char *from, const char *to, GError **error)
{
	g_autofree char *about = g_build_filename(from, "site.json", NULL),
			*own_about = g_build_filename(to, "site.json", NULL),
			*own_scans = g_build_filename(to, "scans", NULL), *text = NULL;
	size_t length;
	if (!files_make_folder(to, error) || !files_make_folder(own_scans, error) ||
		!g_file_get_contents(about, &text, &length, error) ||
		!files_write(own_about, text, length, error))
		return false;
	for (uint32_t n = 1; n < BENCH_STATIONS; n++) {
		g_autofree char *name = g_strdup_printf("%04u", n),
				*scan = g_build_filename(from, "scans", name, NULL);
		struct bench_run run = { 0 };
		bool good = bench_run(
			(const char *[]){ "cp", "-R", "--", scan, own_scans, NULL }, &run, error);
		g_free(run.output);
		if (!good)
			return false;
	}
	return true;
}

/* pleinair process up to a stage, the last one, and what it said. */
static bool process(
	const char *path, const char *last, double *ret_s, JsonNode **ret_said, GError **error)
{
	g_autofree char *program = bench_program("process");
	struct bench_run run = { 0 };
	if (!bench_run(
		    (const char *[]){ program, path, "--to", last, "--json", NULL }, &run, error))
		return false;
	g_autofree char *output = run.output;
	*ret_s = run.seconds;
	*ret_said = json_from_string(output, error);
	return *ret_said != NULL;
}

static bool make_site(
	const struct bench_station_options *o, const char *work, const char *to, GError **error)
{
	const struct preset *preset = preset_find(o->preset ? o->preset : "fine");
	struct bench_scene court = { .name = "court", .seed = o->seed };
	g_autofree char *name = g_strdup_printf(
				"court-%" G_GUINT64_FORMAT "-%s", (guint64)o->seed, preset->name),
			*from = g_build_filename(o->keep ? o->keep : work, name, NULL);
	g_autoptr(JsonNode) said = NULL;
	double took_s;
	return (!o->keep || files_make_folder(o->keep, error)) &&
	       bench_scene_scan(&court, from, preset, error) && copy_scans(from, to, error) &&
	       process(to, "model", &took_s, &said, error);
}

/* ---- one more ---- */

static bool scan(const struct bench_station_options *o, const char *path, double *ret_develop_s,
	GError **error)
{
	struct bench_scene court = { .name = "court", .seed = o->seed };
	g_autofree char *place = bench_scene_station(&court, BENCH_STATIONS),
			*device = g_strconcat("sim:", place, NULL),
			*program = bench_program("scan"),
			*name = g_strdup_printf("%04u", BENCH_STATIONS),
			*record = g_build_filename(path, "scans", name, "raw.rec", NULL);
	const char *argv[] = { program, path, "--device", device, "--preset",
		o->preset ? o->preset : "fine", NULL };
	struct bench_run run = { 0 };
	struct stat s;
	if (!bench_run(argv, &run, error))
		return false;
	double ended_s = (double)g_get_real_time() * 1e-6;
	g_free(run.output);
	if (stat(record, &s) < 0)
		return files_fail(error, record, "read");
	*ret_develop_s = ended_s - ((double)s.st_mtim.tv_sec + 1e-9 * (double)s.st_mtim.tv_nsec);
	return true;
}

static bool is_placed(JsonArray *stages)
{
	for (guint n = 0; n < json_array_get_length(stages); n++) {
		JsonObject *done = json_array_get_object_element(stages, n);
		if (json_object_has_member(done, "placed"))
			return json_object_get_int_member(done, "placed") == BENCH_STATIONS;
	}
	return false;
}

static JsonArray *stages_of(JsonNode *said)
{
	return JSON_NODE_HOLDS_OBJECT(said) &&
			       json_object_has_member(json_node_get_object(said), "stages")
		       ? json_object_get_array_member(json_node_get_object(said), "stages")
		       : NULL;
}

static void take_stages(JsonArray *stages, JsonArray *to)
{
	for (guint n = 0; stages && n < json_array_get_length(stages); n++) {
		JsonObject *done = json_array_get_object_element(stages, n), *o;
		if (!json_object_has_member(done, "seconds")) /* it was up to date */
			continue;
		o = json_object_new();
		json_object_set_string_member(
			o, "stage", json_object_get_string_member(done, "stage"));
		json_object_set_double_member(
			o, "seconds", json_object_get_double_member(done, "seconds"));
		json_array_add_object_element(to, o);
	}
}

static bool draw(const char *path, const char *to, double *ret_s, GError **error)
{
	g_autofree char *program = bench_program("render");
	struct bench_run run = { 0 };
	const char *argv[] = { program, path, "--size", SIZE, "-o", to, NULL };
	if (!bench_run(argv, &run, error))
		return false;
	g_free(run.output);
	*ret_s = run.seconds;
	return true;
}

static bool measure(
	const struct bench_station_options *o, const char *work, struct figures *f, GError **error)
{
	g_autofree char *path = g_build_filename(work, "site", NULL),
			*picture = g_build_filename(work, "picture.png", NULL);
	g_autoptr(JsonNode) look = NULL, all = NULL;
	if (!make_site(o, work, path, error) || !scan(o, path, &f->develop_s, error) ||
		!process(path, "look", &f->look_s, &look, error))
		return false;
	JsonArray *stages = stages_of(look);
	if (!stages || !is_placed(stages)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED,
			"the scan from the last place was not placed");
		return false;
	}
	if (!draw(path, picture, &f->draw_s, error) ||
		!process(path, "model", &f->process_s, &all, error))
		return false;
	f->stages = json_array_new();
	take_stages(stages, f->stages);
	take_stages(stages_of(all), f->stages);
	return true;
}

/* ---- what comes out ---- */

static void print_stages(const struct figures *f, bool before)
{
	bool is_before = true;
	for (guint n = 0; n < json_array_get_length(f->stages); n++) {
		JsonObject *s = json_array_get_object_element(f->stages, n);
		const char *name = json_object_get_string_member(s, "stage");
		if (is_before == before)
			printf("    %-26s %10.2f s\n", name,
				json_object_get_double_member(s, "seconds"));
		is_before &= strcmp(name, "look") != 0;
	}
}

static void print(const struct bench_station_options *o, const struct figures *f)
{
	double first_s = f->develop_s + f->look_s + f->draw_s, all_s = first_s + f->process_s;
	if (!o->json) {
		printf("station: from the last beam of scan %d to a picture of " SIZE "\n"
		       "  %-28s %10.2f s\n  %-28s %10.2f s\n",
			BENCH_STATIONS, "developed", f->develop_s, "placed and looked at",
			f->look_s);
		print_stages(f, true);
		printf("  %-28s %10.2f s\n  %-28s %10.2f s  (reach: <= 5)\n", "drawn", f->draw_s,
			"first picture", first_s);
		printf("  %-28s %10.2f s\n", "processed to the model", f->process_s);
		print_stages(f, false);
		printf("  %-28s %10.2f s\n", "all", all_s);
		return;
	}
	JsonObject *j = json_object_new();
	json_object_set_string_member(j, "preset", o->preset ? o->preset : "fine");
	json_object_set_int_member(j, "scans", BENCH_STATIONS);
	json_object_set_double_member(j, "develop_s", f->develop_s);
	json_object_set_double_member(j, "look_s", f->look_s);
	json_object_set_double_member(j, "render_s", f->draw_s);
	json_object_set_double_member(j, "first_s", first_s);
	json_object_set_double_member(j, "process_s", f->process_s);
	json_object_set_double_member(j, "all_s", all_s);
	json_object_set_array_member(j, "stages", json_array_ref(f->stages));
	cli_print_json(j);
}

bool bench_station(const struct bench_station_options *o, GError **error)
{
	struct figures f = { 0 };
	g_autofree char *work = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	if (!work)
		return false;
	bool good = measure(o, work, &f, error);
	good = files_remove_tree(work, good ? error : NULL) && good;
	if (good)
		print(o, &f);
	g_clear_pointer(&f.stages, json_array_unref);
	return good;
}
