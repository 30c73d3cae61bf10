/* pleinair process SITE: what is out of date between the scans and the model. */
#include "acquire/cli.h"
#include "process/scan-data.h"
#include "process/stages.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define COMMAND "process"

/* Each stage goes through the scans. Some ten fine ones, but of a small machine's memory no more than this part. */
#define KEPT_BYTES ((uint64_t)512 << 20)
#define KEPT_PART  16

static char *to;
static gboolean dry_run, json;

static const GOptionEntry entries[] = {
	{ "to", 0, 0, G_OPTION_ARG_STRING, &to, "Go no further than this stage", "STAGE" },
	{ "dry-run", 'n', 0, G_OPTION_ARG_NONE, &dry_run, "Only say what would be done", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print what was done as JSON", NULL },
	{ NULL },
};

struct processing {
	struct cli_bar bar;
	const struct stage *stage;
};

static bool show_progress(double fraction, const char *doing, gpointer user_data)
{
	struct processing *p = user_data;
	g_autofree char *text = g_strdup_printf("%s: %s", p->stage->name, doing);
	cli_bar_update(&p->bar, fraction, text);
	return !cli_interrupted();
}

/* One line a stage on stdout; with --json an element of the document. */
static void tell(const struct stage *stage, const char *what)
{
	if (!json)
		printf("%s: %s\n", stage->name, what);
}

static bool run_stage(
	site *s, const struct stage *stage, const char *why, JsonObject *done, GError **error)
{
	struct processing p = { .bar = cli_bar_begin(COMMAND), .stage = stage };
	struct stage_progress progress = { show_progress, &p };
	g_autofree char *summary = NULL;
	int64_t started_us = g_get_monotonic_time();
	bool good = stage->run(s, &progress, &summary, done, error);
	double seconds = (double)(g_get_monotonic_time() - started_us) / 1e6;
	cli_bar_end(&p.bar);
	if (!good) {
		g_prefix_error(error, "%s: ", stage->name);
		return false;
	}
	g_autofree char *took = cli_duration(seconds);
	g_autofree char *line = g_strdup_printf("%s (%s; %s)", summary, why, took);
	tell(stage, line);
	json_object_set_string_member(done, "summary", summary);
	json_object_set_double_member(done, "seconds", seconds);
	return true;
}

static bool do_stage(
	site *s, const struct stage *stage, JsonArray *report, bool *due_before, GError **error)
{
	bool due = false;
	g_autofree char *why = NULL;
	if (!stage->is_due(s, &due, &why, error))
		return false;
	JsonObject *done = json_object_new();
	json_array_add_object_element(report, done);
	json_object_set_string_member(done, "stage", stage->name);
	json_object_set_boolean_member(done, "due", due || (dry_run && *due_before));
	if (due)
		json_object_set_string_member(done, "why", why);
	if (dry_run) {
		if (!due && *due_before)
			tell(stage, "may be due after that");
		else
			tell(stage, due ? why : "up to date");
		*due_before |= due;
		return true;
	}
	if (due)
		return run_stage(s, stage, why, done, error);
	tell(stage, "up to date");
	return true;
}

static bool do_stages(site *s, JsonArray *report, GError **error)
{
	bool due_before = false;
	for (const struct stage *stage = stages; stage->name; stage++) {
		const bool is_last = to && strcmp(to, stage->name) == 0;
		if ((is_last || !stage->only_asked) &&
			!do_stage(s, stage, report, &due_before, error))
			return false;
		fflush(stdout);
		if (is_last)
			break;
	}
	return true;
}

static int fail(GError *error)
{
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED)) {
		g_printerr("pleinair " COMMAND ": stopped; what was done is kept, the same command "
			   "goes on from there\n");
		return CLI_FAILED;
	}
	return cli_fail(COMMAND, error);
}

static char *stage_names(void)
{
	g_autoptr(GPtrArray) names = g_ptr_array_new();
	for (const struct stage *stage = stages; stage->name; stage++)
		g_ptr_array_add(names, (gpointer)stage->name);
	g_ptr_array_add(names, NULL);
	return g_strjoinv(", ", (char **)names->pdata);
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	g_autofree char *names = stage_names();
	g_autofree char *help =
		g_strdup_printf("Stages, in order: %s. Only what is out of date is done. It can be "
				"stopped (Ctrl-C) or cut off at any time; the same command goes on "
				"from there.\n",
			names);
	if (!cli_parse(COMMAND, "SITE",
		    "Registers the scans of a site, finds their normals, builds its point model.",
		    help, entries, &argc, &argv, &status))
		return status;
	if (argc != 2 || !*argv[1])
		return cli_misuse(COMMAND, argc <= 2 ? "which site?" : "one site at a time");
	if (to && !stage_find(to))
		return cli_misuse(
			COMMAND, "--to=%s: there is no such stage; the stages are %s", to, names);
	g_autoptr(site) s =
		dry_run ? site_open(argv[1], &error) : site_open_existing(argv[1], &error);
	if (!s)
		return cli_fail(COMMAND, error);
	cli_catch_interrupts();
	uint64_t memory_bytes = (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
	scan_data_keep(MIN(KEPT_BYTES, memory_bytes / KEPT_PART));
	g_autoptr(JsonArray) report = json_array_new();
	if (!do_stages(s, report, &error))
		return fail(error);
	if (json) {
		JsonObject *o = json_object_new();
		json_object_set_array_member(o, "stages", g_steal_pointer(&report));
		cli_print_json(o);
	}
	return cli_done(COMMAND);
}
