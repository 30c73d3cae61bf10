#include "render/bench-all.h"
#include "acquire/cli.h"
#include "firmware-io/files.h"
#include "render/bench-child.h"
#include "render/bench-machine.h"
#include "render/bench-page.h"
#include "render/bench-reach.h"
#include "render/bench-tables.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* One of each kind. */
#define STYLES                                                                                     \
	"--style figure-7a --style figure-7d --style line-drawing --style stippling "              \
	"--style watercolour --style impressionist --style eye-dome"

const struct bench_all_part bench_all_parts[] = {
	{ "acquire", "--seconds 15", 17, false },
	{ "station", "", 110, false },
	{ "process", "--repeats 3", 150, false },
	{ "register", "--trials 100", 330, false },
	{ "render", "--repeats 3 --backend cpu", 80, true },
	{ "filters", "--repeats 3 --million-points 3", 60, true },
	{ "hatching", "--repeats 2", 50, false },
	{ "coherence", "--frames 1 --size 1280x720", 45, true },
	{ "styles", STYLES " --repeats 3 --backend cpu", 60, true },
	{ "model", "--million-points 5", 20, false },
	{ "export", "--million-points 2", 20, false },
	{ "segments", "--preset draft", 140, false },
	{ "features", "--preset draft", 30, false },
	{ "lines", "--preset draft", 90, false },
	{ "paging", "--preset draft --million-points 5 --memory 64 --seconds 10", 30, false },
	{ NULL },
};

struct work {
	const struct bench_all_options *o;
	const struct bench_all_part *parts, *part;
	char *temporary;
	const char *keep;
	double all_s, done_s; /* typical ones */
	JsonObject *machine;
	JsonArray *benches;
	uint32_t failed;
};

/* ---- files ---- */

/* What the benches said, by their names. */
static JsonObject *results_of(JsonArray *benches)
{
	JsonObject *results = json_object_new();
	for (guint n = 0; n < json_array_get_length(benches); n++) {
		JsonObject *bench = json_array_get_object_element(benches, n);
		if (json_object_has_member(bench, "result"))
			json_object_set_object_member(results,
				json_object_get_string_member(bench, "bench"),
				json_object_ref(json_object_get_object_member(bench, "result")));
	}
	return results;
}

JsonObject *bench_all_document(JsonObject *machine, JsonArray *benches, bool whole)
{
	JsonObject *o = json_object_new();
	g_autoptr(JsonObject) results = results_of(benches);
	json_object_set_int_member(o, "pleinair_bench", BENCH_ALL_SCHEMA);
	if (!whole)
		json_object_set_boolean_member(o, "stopped", TRUE);
	json_object_set_object_member(o, "machine", machine);
	json_object_set_array_member(o, "reach", bench_reach_of(results));
	json_object_set_array_member(o, "benches", benches);
	return o;
}

bool bench_all_write(JsonObject *document, const char *folder, GError **error)
{
	g_autoptr(JsonNode) root = json_node_new(JSON_NODE_OBJECT);
	json_node_set_object(root, document);
	g_autofree char *json = json_to_string(root, TRUE), *page = bench_page_of(document),
			*json_path = g_build_filename(folder, "bench.json", NULL),
			*page_path = g_build_filename(folder, "bench.html", NULL);
	return files_make_folder(folder, error) &&
	       files_write(json_path, json, strlen(json), error) &&
	       files_write(page_path, page, strlen(page), error);
}

static JsonObject *document_of(const struct work *w, bool whole)
{
	return bench_all_document(json_object_ref(w->machine), json_array_ref(w->benches), whole);
}

/* ---- one bench ---- */

static void add(GPtrArray *argv, const char *option, const char *value)
{
	g_ptr_array_add(argv, g_strdup(option));
	g_ptr_array_add(argv, g_strdup(value));
}

/* The last of an option counts: what a person asks for stands behind what the part has. */
static GPtrArray *arguments_of(const struct work *w)
{
	GPtrArray *argv = g_ptr_array_new_with_free_func(g_free);
	g_auto(GStrv) own = g_strsplit(w->part->arguments, " ", -1);
	g_autofree char *seed = g_strdup_printf("%" G_GUINT64_FORMAT, (guint64)w->o->seed),
			*repeats = g_strdup_printf("%u", w->o->repeats);
	g_ptr_array_add(argv, g_strdup(w->part->what));
	for (guint n = 0; own[n]; n++)
		if (*own[n])
			g_ptr_array_add(argv, g_strdup(own[n]));
	add(argv, "--seed", seed);
	if (w->o->repeats)
		add(argv, "--repeats", repeats);
	if (w->part->takes_site && w->o->site)
		add(argv, "--site", w->o->site);
	return argv;
}

/* As a person types it, without what only this run has. */
static char *command_of(const GPtrArray *arguments)
{
	GString *text = g_string_new("pleinair bench");
	for (guint n = 0; n < arguments->len; n++)
		g_string_append_printf(text, " %s", (char *)arguments->pdata[n]);
	return g_string_free(text, FALSE);
}

static void show_waiting(double seconds, gpointer user_data)
{
	const struct work *w = user_data;
	double part_s = w->part->typical_s;
	if (w->o->progress)
		w->o->progress(
			(w->done_s + fmin(seconds, 0.95 * part_s)) / w->all_s, w->part->what);
}

static void tell(struct work *w, const char *command, const struct bench_child *c)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "bench", w->part->what);
	json_object_set_string_member(o, "command", command);
	json_object_set_double_member(o, "seconds", c->seconds);
	if (c->error)
		json_object_set_string_member(o, "error", c->error);
	if (c->result)
		json_object_set_object_member(o, "result", json_object_ref(c->result));
	json_array_add_object_element(w->benches, o);
	if (w->o->progress)
		w->o->progress(0, NULL);
	if (c->error)
		g_printerr("pleinair bench: %s: %s\n", w->part->what, c->error);
	if (w->o->json || !c->result)
		return;
	printf("%s (%.0f s)\n", command, c->seconds);
	bench_tables_print(c->result);
	puts("");
	fflush(stdout);
}

/* false: it was stopped. */
static bool run_part(struct work *w)
{
	g_autoptr(GPtrArray) arguments = arguments_of(w);
	g_autofree char *command = command_of(arguments);
	struct bench_child child;
	g_ptr_array_insert(arguments, 0, g_strdup(w->o->program));
	add(arguments, "--keep", w->keep);
	g_ptr_array_add(arguments, g_strdup("--json"));
	g_ptr_array_add(arguments, NULL);
	struct bench_child_desc desc = { .argv = (char **)arguments->pdata,
		.temporary = w->temporary,
		.stop = w->o->stop,
		.waits = show_waiting,
		.user_data = w };
	bench_child_run(&desc, &child);
	bool stopped = w->o->stop && w->o->stop();
	if (!stopped || child.result)
		tell(w, command, &child);
	w->failed += !stopped && child.error;
	w->done_s += w->part->typical_s;
	bench_child_clear(&child);
	return !stopped;
}

/* ---- all of them ---- */

/* Leaves files of what was measured. */
static bool write_files(const struct work *w, bool whole, GError **error)
{
	if (!json_array_get_length(w->benches))
		return true;
	g_autoptr(JsonObject) document = document_of(w, whole);
	return bench_all_write(document, w->o->output, error);
}

static bool run_parts(struct work *w, GError **error)
{
	for (w->part = w->parts; w->part->what; w->part++) {
		bool goes_on = run_part(w);
		if (!write_files(w, goes_on && !w->part[1].what, error))
			return false;
		if (!goes_on) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped%s%s",
				json_array_get_length(w->benches)
					? "; what was measured till then is in "
					: "",
				json_array_get_length(w->benches) ? w->o->output : "");
			return false;
		}
	}
	return true;
}

static void say(const struct work *w)
{
	JsonObject *document = document_of(w, true);
	if (w->o->json) {
		cli_print_json(document);
		return;
	}
	g_autofree char *machine = bench_machine_line(w->machine);
	bench_reach_print(json_object_get_array_member(document, "reach"));
	printf("on: %s\nwritten: %s/bench.html, %s/bench.json\n", machine, w->o->output,
		w->o->output);
	json_object_unref(document);
}

bool bench_all(const struct bench_all_options *o, GError **error)
{
	struct work w = { .o = o, .parts = o->parts ? o->parts : bench_all_parts };
	w.temporary = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	if (!w.temporary)
		return false;
	g_autofree char *own = g_build_filename(w.temporary, "keep", NULL);
	w.keep = o->keep ? o->keep : own;
	w.machine = bench_machine();
	w.benches = json_array_new();
	for (const struct bench_all_part *p = w.parts; p->what; p++)
		w.all_s += p->typical_s;
	bool good = files_make_folder(o->output, error) && run_parts(&w, error);
	if (o->progress)
		o->progress(1, NULL);
	if (good)
		say(&w);
	if (good && w.failed) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%u of %u benches failed",
			w.failed, json_array_get_length(w.benches));
		good = false;
	}
	good = files_remove_tree(w.temporary, good ? error : NULL) && good;
	json_array_unref(w.benches);
	json_object_unref(w.machine);
	g_free(w.temporary);
	return good;
}
