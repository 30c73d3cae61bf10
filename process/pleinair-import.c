/* pleinair import SITE FILE...: scans of other scanners into a site. */
#include "acquire/cli.h"
#include "process/import.h"
#include <stdio.h>
#include <string.h>

#define COMMAND "import"

static gboolean again, json;
static gint64 point_count;
static char *spacing_text, *sampling = "blue-noise", *unit = "m", *up = "z";

static const GOptionEntry entries[] = {
	{ "again", 0, 0, G_OPTION_ARG_NONE, &again, "Import also what the site has already", NULL },
	{ "points", 0, 0, G_OPTION_ARG_INT64, &point_count,
		"Of a mesh: how many points are made of it, about [500000]", "N" },
	{ "samples", 0, 0, G_OPTION_ARG_INT64, &point_count, "The same as --points", "N" },
	{ "spacing", 0, 0, G_OPTION_ARG_STRING, &spacing_text,
		"Of a mesh: how far its points are from each other", "METRES" },
	{ "sampling", 0, 0, G_OPTION_ARG_STRING, &sampling,
		"Of a mesh: blue-noise (evenly spread) or uniform (by chance) [blue-noise]",
		"HOW" },
	{ "unit", 0, 0, G_OPTION_ARG_STRING, &unit, "Of a mesh: m, cm, mm, in or ft [m]", "UNIT" },
	{ "up", 0, 0, G_OPTION_ARG_STRING, &up, "Of a mesh: which axis looks up, z or y [z]",
		"AXIS" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print what was imported as JSON", NULL },
	{ NULL },
};

struct doing {
	struct cli_bar bar;
	int file, files;
};

static bool show_progress(double fraction, const char *what, gpointer user_data)
{
	struct doing *d = user_data;
	cli_bar_update(&d->bar, (d->file + fraction) / d->files, what);
	return !cli_interrupted();
}

/* ---- results ---- */

static char *extras(const struct imported *i)
{
	g_autoptr(GString) text = g_string_new(NULL);
	if (i->have & POINTS_HAVE_INTENSITY)
		g_string_append(text, ", intensity");
	if (i->have & POINTS_HAVE_COLOUR)
		g_string_append(text, ", colour");
	if (i->have & POINTS_HAVE_CLASSIFICATION)
		g_string_append(text, ", classes");
	return g_strdup(text->str);
}

static char *grid_text(const struct imported *i)
{
	return i->columns ? g_strdup_printf("a grid of %u x %u (%s in the file)", i->columns,
				    i->rows, i->grid)
	       : i->grid  ? g_strdup_printf("no grid (%s)", i->grid)
			  : g_strdup("no grid");
}

static void print_line(const site *s, const struct imported *i, const char *file)
{
	g_autofree char *path = site_scan_path(s, i->number),
			*folder = g_filename_display_name(path), *grid = grid_text(i),
			*more = extras(i);
	printf("%s: scan %u of %s, %" G_GUINT64_FORMAT " points, %s%s", folder, i->in_file, file,
		i->points, grid, more);
	if (i->has_pose)
		printf(", at %.3f %.3f %.3f", i->position_m[0], i->position_m[1], i->position_m[2]);
	if (i->left_out)
		printf(", %" G_GUINT64_FORMAT " left out", i->left_out);
	printf("\n");
}

static void add_json(JsonArray *into, const site *s, const struct imported *i, const char *file)
{
	JsonObject *o = json_object_new();
	g_autofree char *path = site_scan_path(s, i->number),
			*folder = g_filename_display_name(path);
	json_object_set_int_member(o, "scan", i->number);
	json_object_set_string_member(o, "folder", folder);
	json_object_set_string_member(o, "file", file);
	json_object_set_int_member(o, "scan_in_file", i->in_file);
	json_object_set_int_member(o, "points", (int64_t)i->points);
	json_object_set_int_member(o, "left_out", (int64_t)i->left_out);
	json_object_set_int_member(o, "columns", i->columns);
	json_object_set_int_member(o, "rows", i->rows);
	if (i->grid)
		json_object_set_string_member(o, "grid", i->grid);
	json_object_set_boolean_member(o, "intensity", i->have & POINTS_HAVE_INTENSITY);
	json_object_set_boolean_member(o, "colour", (i->have & POINTS_HAVE_COLOUR) != 0);
	json_object_set_boolean_member(o, "classes", (i->have & POINTS_HAVE_CLASSIFICATION) != 0);
	if (i->note)
		json_object_set_string_member(o, "note", i->note);
	if (i->has_pose) {
		JsonArray *position = json_array_new();
		for (int k = 0; k < 3; k++)
			json_array_add_double_element(position, i->position_m[k]);
		json_object_set_array_member(o, "position_m", position);
	}
	json_array_add_object_element(into, o);
}

static void say(const site *s, const GArray *scans, const char *path, JsonArray *into)
{
	g_autofree char *file = g_filename_display_name(path);
	for (guint k = 0; k < scans->len; k++) {
		const struct imported *i = &g_array_index(scans, struct imported, k);
		if (json)
			add_json(into, s, i, file);
		else
			print_line(s, i, file);
		if (i->note)
			g_printerr("pleinair import: %s, scan %u: %s\n", file, i->in_file, i->note);
	}
}

/* ---- the command ---- */

/* What came before a bad file stays, and is told. */
static bool import_all(site *s, char **files, const struct import_mesh_options *of_mesh,
	JsonArray *into, GError **error)
{
	struct doing d = { cli_bar_begin(COMMAND), 0, (int)g_strv_length(files) };
	struct import_options options = { again, *of_mesh, show_progress, &d };
	for (; files[d.file]; d.file++) {
		g_autoptr(GArray) scans = import_file(s, files[d.file], &options, error);
		cli_bar_end(&d.bar);
		if (!scans)
			return false;
		say(s, scans, files[d.file], into);
	}
	return true;
}

static int fail(const GError *error)
{
	if (!g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return cli_fail(COMMAND, error);
	g_printerr("pleinair import: stopped: nothing of the file that was being read is in the "
		   "site\n");
	return CLI_FAILED;
}

static int import_into(const char *path, char **files, const struct import_mesh_options *of_mesh)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_for_writing(path, &error);
	if (!s)
		return cli_fail(COMMAND, error);
	JsonObject *o = json_object_new();
	JsonArray *scans = json_array_new();
	json_object_set_array_member(o, "scans", scans);
	bool good = import_all(s, files, of_mesh, scans, &error);
	bool any = json_array_get_length(scans);
	if (json && (good || any))
		cli_print_json(json_object_ref(o));
	json_object_unref(o);
	if (good)
		return cli_done(COMMAND);
	site_discard_new(s); /* unless scans came into it */
	return fail(error);
}

/* ---- options of meshes ---- */

static bool read_unit(double *ret)
{
	static const struct {
		const char *name;
		double metres;
	} units[] = { { "m", 1 }, { "cm", 0.01 }, { "mm", 0.001 }, { "in", 0.0254 },
		{ "ft", 0.3048 } };
	for (size_t i = 0; i < G_N_ELEMENTS(units); i++)
		if (!strcmp(unit, units[i].name)) {
			*ret = units[i].metres;
			return true;
		}
	return false;
}

static bool read_spacing(double *ret)
{
	char *end;
	if (!spacing_text)
		return true;
	*ret = g_ascii_strtod(spacing_text, &end);
	return end != spacing_text && !*end && *ret >= 1e-6 && *ret <= 1000;
}

/* CLI_DONE, or what was said. */
static int read_mesh_options(struct import_mesh_options *ret)
{
	if (point_count < 0 || point_count > 1000000000)
		return cli_misuse(COMMAND, "points go from 1 to 1000000000");
	if (!read_spacing(&ret->spacing_m))
		return cli_misuse(COMMAND, "a spacing is from 0.000001 to 1000 metres, not '%s'",
			spacing_text);
	if (point_count && spacing_text)
		return cli_misuse(
			COMMAND, "--points and --spacing say the same in two ways: take one");
	if (strcmp(sampling, "blue-noise") && strcmp(sampling, "uniform"))
		return cli_misuse(
			COMMAND, "there is no sampling '%s': blue-noise or uniform", sampling);
	if (!read_unit(&ret->metres_a_unit))
		return cli_misuse(COMMAND, "there is no unit '%s': m, cm, mm, in or ft", unit);
	if (strcmp(up, "z") && strcmp(up, "y"))
		return cli_misuse(COMMAND, "'%s' is no axis that looks up: z or y", up);
	ret->points = (uint64_t)point_count;
	ret->uniform = !strcmp(sampling, "uniform");
	ret->y_up = !strcmp(up, "y");
	return CLI_DONE;
}

int main(int argc, char **argv)
{
	int status;
	struct import_mesh_options of_mesh = { 0 };
	if (!cli_parse(COMMAND, "SITE FILE...",
		    "Imports scans of other scanners into a site, which is made when it is not "
		    "there.",
		    "E57 and PTX keep their grids and poses, E57 its pictures, PLY and PCD the "
		    "grid of "
		    "one scan; LAS 1.0 to 1.4 and tables in ASCII come as points, meshes (OFF, "
		    "OBJ, PLY, "
		    "STL) are sampled to points. Of each file all "
		    "scans "
		    "are "
		    "imported or none.\n\nExamples:\n"
		    "  pleinair import oak pump.e57\n"
		    "  pleinair import town tile-1.las tile-2.las --json\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc < 2 || !*argv[1])
		return cli_misuse(COMMAND, "which site?");
	if (argc < 3)
		return cli_misuse(COMMAND, "which files?");
	for (int i = 2; i < argc; i++)
		if (!*argv[i])
			return cli_misuse(COMMAND, "a file has no name");
	status = read_mesh_options(&of_mesh);
	if (status != CLI_DONE)
		return status;
	cli_catch_interrupts();
	return import_into(argv[1], argv + 2, &of_mesh);
}
