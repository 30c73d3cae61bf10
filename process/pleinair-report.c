/* pleinair report SITE: what was scanned, how well it fits, what was refused and why. */
#include "acquire/cli.h"
#include "firmware-io/files.h"
#include "process/report.h"
#include <stdio.h>
#include <string.h>

#define COMMAND "report"

static char *output;
static gboolean no_maps, json;

static const GOptionEntry entries[] = {
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"Where the page goes (default SITE/exports/report.html)", "FILE" },
	{ "no-maps", 0, 0, G_OPTION_ARG_NONE, &no_maps,
		"Without the difference maps, which take most of the time", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the report as JSON too", NULL },
	{ NULL },
};

static bool show_progress(double fraction, const char *doing, gpointer user_data)
{
	cli_bar_update(user_data, fraction, doing);
	return !cli_interrupted();
}

static report *collect(const site *s, const scan_graph *g, GError **error)
{
	struct cli_bar bar = cli_bar_begin(COMMAND);
	struct report_options options = {
		.no_maps = no_maps, .progress = show_progress, .user_data = &bar
	};
	report *r = report_new(s, g, &options, error);
	cli_bar_end(&bar);
	return r;
}

/* R.html and R.json. Caller frees. */
static char *json_beside(const char *html)
{
	size_t length = strlen(html);
	if (g_str_has_suffix(html, ".html"))
		length -= strlen(".html");
	return g_strdup_printf("%.*s.json", (int)length, html);
}

static char *default_output(const site *s, GError **error)
{
	g_autofree char *folder = g_build_filename(site_path(s), "exports", NULL);
	return files_make_folder(folder, error) ? g_build_filename(folder, "report.html", NULL)
						: NULL;
}

static bool save(const report *r, const char *path, JsonObject *object, GError **error)
{
	g_autofree char *html = report_html(r), *beside = json_beside(path);
	g_autoptr(JsonNode) node = json_node_init_object(json_node_alloc(), object);
	g_autofree char *text = json_to_string(node, TRUE);
	return files_write(path, html, strlen(html), error) &&
	       files_write(beside, text, strlen(text), error);
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "SITE",
		    "Writes a page that shows how the scans of a site fit together.",
		    "A plan of the stations, each pair with its verdict and a map of its "
		    "differences, in one HTML file; the same facts as JSON beside it.\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc != 2 || !*argv[1])
		return cli_misuse(COMMAND, argc <= 2 ? "which site?" : "one site at a time");
	g_autoptr(site) s = site_open(argv[1], &error);
	g_autoptr(scan_graph) g = s ? scan_graph_load(s, &error) : NULL;
	if (!g)
		return cli_fail(COMMAND, error);
	if (!g->revision) {
		g_set_error(&error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"%s: its scans are not registered yet; pleinair process does that",
			argv[1]);
		return cli_fail(COMMAND, error);
	}
	cli_catch_interrupts();
	g_autoptr(report) r = collect(s, g, &error);
	g_autofree char *path = !r ? NULL : output ? g_strdup(output) : default_output(s, &error);
	g_autoptr(JsonObject) object = path ? report_json(r) : NULL;
	if (!path || !save(r, path, object, &error))
		return cli_fail(COMMAND, error);
	if (json)
		cli_print_json(json_object_ref(object));
	else
		printf("%s\n", path);
	return cli_done(COMMAND);
}
