/* pleinair export SITE -o FILE: the points of a site in a file that other programs open. */
#include "acquire/cli.h"
#include "acquire/site.h"
#include "process/export.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define COMMAND "export"

static char *output, *chosen, *spacing_text;
static gboolean raw, json;

static const GOptionEntry entries[] = {
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"The file; its name says the format: .e57, .ptx, .las, .ply or .pcd", "FILE" },
	{ "scans", 's', 0, G_OPTION_ARG_STRING, &chosen, "Only these scans, as 1,3-5 [all]",
		"LIST" },
	{ "spacing", 0, 0, G_OPTION_ARG_STRING, &spacing_text,
		"Thin out: no two points nearer than this [0: all points]", "METRES" },
	{ "raw", 0, 0, G_OPTION_ARG_NONE, &raw,
		"Each scan as its scanner saw it, without the poses that were found", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the result as JSON", NULL },
	{ NULL },
};

static bool show_progress(double fraction, const char *doing, gpointer user_data)
{
	cli_bar_update(user_data, fraction, doing);
	return !cli_interrupted();
}

/* ---- options ---- */

static bool read_number(const char **at, uint32_t *ret)
{
	char *end;
	guint64 value = g_ascii_strtoull(*at, &end, 10);
	bool good = g_ascii_isdigit(**at) && value >= 1 && value <= SITE_SCANS_MAX;
	*ret = (uint32_t)value;
	*at = end;
	return good;
}

/* "1,3-5"; NULL: that is none. */
static GArray *read_list(const char *text)
{
	g_autoptr(GArray) list = g_array_new(false, false, sizeof(uint32_t));
	for (const char *at = text;; at++) {
		uint32_t first, last;
		if (!read_number(&at, &first))
			return NULL;
		last = first;
		if (*at == '-' && (at++, !read_number(&at, &last)))
			return NULL;
		for (uint32_t i = first; i <= last; i++)
			g_array_append_val(list, i);
		if (last < first || (*at && *at != ','))
			return NULL;
		if (!*at)
			return g_steal_pointer(&list);
	}
}

static bool read_spacing(double *ret)
{
	char *end;
	*ret = 0;
	if (!spacing_text)
		return true;
	*ret = g_ascii_strtod(spacing_text, &end);
	return end != spacing_text && !*end && isfinite(*ret) &&
	       (*ret == 0 || (*ret >= 1e-4 && *ret <= 1000));
}

/* ---- the result ---- */

static void print_line(const struct export_result *r)
{
	g_autofree char *size = g_format_size(r->bytes), *file = g_filename_display_name(output);
	printf("%s: %s, %" G_GUINT64_FORMAT
	       " points of %u scan%s, %s, to %.3g mm, read back and compared",
		file, r->format, r->points, r->stations, r->stations == 1 ? "" : "s", size,
		r->resolution_m * 1000);
	if (r->left_out)
		printf("; %" G_GUINT64_FORMAT " left out for the spacing", r->left_out);
	printf("\n");
	for (guint i = 0; i < r->notes->len; i++)
		g_printerr("pleinair export: %s: %s\n", file, (const char *)r->notes->pdata[i]);
}

static void print_json(const struct export_result *r)
{
	g_autofree char *file = g_filename_display_name(output);
	JsonObject *o = json_object_new();
	JsonArray *notes = json_array_new();
	for (guint i = 0; i < r->notes->len; i++)
		json_array_add_string_element(notes, r->notes->pdata[i]);
	json_object_set_string_member(o, "file", file);
	json_object_set_string_member(o, "format", r->format);
	json_object_set_int_member(o, "scans", r->stations);
	json_object_set_int_member(o, "points", (int64_t)r->points);
	json_object_set_int_member(o, "left_out", (int64_t)r->left_out);
	json_object_set_int_member(o, "bytes", (int64_t)r->bytes);
	json_object_set_double_member(o, "resolution_m", r->resolution_m);
	json_object_set_boolean_member(o, "verified", true);
	json_object_set_array_member(o, "notes", notes);
	cli_print_json(o);
}

static int fail(const GError *error)
{
	if (!g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return cli_fail(COMMAND, error);
	g_printerr(
		"pleinair export: stopped: there is no file, or the one that was there before\n");
	return CLI_FAILED;
}

static int export_from(const char *path, const struct export_options *options, struct cli_bar *bar)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	struct export_result r;
	bool good = s && export_site(s, output, options, &r, &error);
	cli_bar_end(bar);
	if (!good)
		return fail(error);
	if (json)
		print_json(&r);
	else
		print_line(&r);
	export_result_clear(&r);
	return cli_done(COMMAND);
}

int main(int argc, char **argv)
{
	int status;
	double spacing_m;
	if (!cli_parse(COMMAND, "SITE",
		    "Writes the points of a site into a file that other programs open.",
		    "E57 keeps each scan with its pose, its rows and columns, its panorama and "
		    "classes; "
		    "PTX each scan with a grid and its pose; LAS 1.4 all points with classes and "
		    "the "
		    "number of their scan; PLY and PCD all points, or one scan with its grid. The "
		    "file is "
		    "read back and compared before it gets its name.\n\nExamples:\n"
		    "  pleinair export oak -o oak.e57\n"
		    "  pleinair export oak -o oak.las --spacing 0.01\n"
		    "  pleinair export oak -o third.pcd --scans 3 --raw\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc != 2 || !*argv[1])
		return cli_misuse(COMMAND, argc <= 2 ? "which site?" : "one site at a time");
	if (!output || !*output)
		return cli_misuse(
			COMMAND, "into which file? -o FILE.e57, .ptx, .las, .ply or .pcd");
	if (!export_knows(output))
		return cli_misuse(COMMAND,
			"the name of '%s' must end in .e57, .ptx, .las, .ply or .pcd", output);
	if (!read_spacing(&spacing_m))
		return cli_misuse(
			COMMAND, "a spacing is from 0.0001 to 1000 metres, not '%s'", spacing_text);
	g_autoptr(GArray) list = chosen ? read_list(chosen) : NULL;
	if (chosen && !list)
		return cli_misuse(COMMAND, "'%s' is no list of scans, as 1,3-5", chosen);
	cli_catch_interrupts();
	struct cli_bar bar = cli_bar_begin(COMMAND);
	struct export_options options = { list ? (const uint32_t *)(gpointer)list->data : NULL,
		list ? list->len : 0, raw, spacing_m, show_progress, &bar };
	return export_from(argv[1], &options, &bar);
}
