/* pleinair styles [SITE]: which styles there are, what they are made of, and whether files are good ones. */
#include "acquire/cli.h"
#include "acquire/site.h"
#include "render/gallery.h"
#include "render/sweep-draw.h"
#include <stdio.h>
#include <string.h>

#define COMMAND "styles"

static gboolean json, schema, steps, check;
static char *thumbnails, *view_name, *size_text, *output, *title;
static char **sweep_texts, **with;

static const GOptionEntry entries[] = {
	{ "check", 'c', 0, G_OPTION_ARG_NONE, &check,
		"Say what is wrong with these files (instead of SITE), or with sweeps, and draw "
		"nothing",
		NULL },
	{ "steps", 's', 0, G_OPTION_ARG_NONE, &steps,
		"List the steps that styles are made of, and their parameters", NULL },
	{ "thumbnails", 't', 0, G_OPTION_ARG_FILENAME, &thumbnails,
		"Draw SITE in each style, into this folder, with a page that shows all", "FOLDER" },
	{ "sweep", 0, 0, G_OPTION_ARG_STRING_ARRAY, &sweep_texts,
		"Draw SITE once for each value, with a sheet that shows all; may be repeated",
		"STYLE:STEP.PARAMETER=VALUE,..." },
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"sweeps: into this folder (default SITE/exports/sweeps)", "FOLDER" },
	{ "view", 'v', 0, G_OPTION_ARG_STRING, &view_name,
		"thumbnails, sweeps: from where, as in pleinair render (default walk, else "
		"overview)",
		"VIEW" },
	{ "size", 0, 0, G_OPTION_ARG_STRING, &size_text,
		"thumbnails, sweeps: of each picture (default 800x600, of sweeps 600x450)", "WxH" },
	{ "title", 0, 0, G_OPTION_ARG_STRING, &title, "thumbnails, sweeps: of the page", "TEXT" },
	{ "with", 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &with,
		"thumbnails, sweeps: a film, picture or page that the page shows too; may be "
		"repeated",
		"FILE" },
	{ "schema", 0, 0, G_OPTION_ARG_NONE, &schema,
		"Print the JSON Schema of styles, for editors", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the list as JSON", NULL },
	{ NULL },
};

/* ---- the list ---- */

static JsonObject *style_json(const style *s)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "name", s->name);
	json_object_set_string_member(o, "title", s->title);
	json_object_set_string_member(o, "source", s->source);
	json_object_set_string_member(o, "description", s->description);
	json_object_set_string_member(o, "path", s->path);
	return o;
}

/* Filled up to columns of a terminal, not to bytes. */
static void print_cell(const char *text, glong columns)
{
	printf("%s%*s", text, (int)MAX(columns - g_utf8_strlen(text, -1), 0) + 2, "");
}

static void print_style(const style *s, const glong widths[2])
{
	print_cell(s->name, widths[0]);
	print_cell(s->title, widths[1]);
	printf("%s\n", s->source);
	if (*s->description)
		printf("    %s\n", s->description);
}

static void print_list(const GPtrArray *list)
{
	glong widths[2] = { 0 };
	JsonArray *array = json ? json_array_new() : NULL;
	for (guint i = 0; i < list->len; i++) {
		const style *s = list->pdata[i];
		widths[0] = MAX(widths[0], g_utf8_strlen(s->name, -1));
		widths[1] = MAX(widths[1], g_utf8_strlen(s->title, -1));
		if (array)
			json_array_add_object_element(array, style_json(s));
	}
	if (array)
		cli_print_json_array(array);
	for (guint i = 0; !json && i < list->len; i++)
		print_style(list->pdata[i], widths);
}

/* A style that cannot be read does not hide the others. */
static int list_styles(const char *site_path)
{
	g_auto(GStrv) names = style_names(site_path);
	g_autoptr(GPtrArray) list = g_ptr_array_new_with_free_func((GDestroyNotify)style_free);
	int status = CLI_DONE;
	for (char **name = names; *name; name++) {
		g_autoptr(GError) error = NULL;
		style *s = style_find(*name, site_path, &error);
		if (s)
			g_ptr_array_add(list, s);
		else
			status = cli_fail(COMMAND, error);
	}
	print_list(list);
	return status ? status : cli_done(COMMAND);
}

/* ---- thumbnails ---- */

static bool show_progress(double fraction, const char *doing, gpointer user_data)
{
	cli_bar_update(user_data, fraction, doing);
	return !cli_interrupted();
}

static bool draw_thumbnails(const char *site_path, const struct gallery_options *o, GError **error)
{
	g_auto(GStrv) names = style_names(site_path);
	g_autoptr(drawn_site) d = drawn_site_new(site_path, (double)o->width / o->height, error);
	g_autoptr(painter) p = d ? painter_new(BACKEND_WISH_AUTO, error) : NULL;
	return p && drawn_site_load(d, error) && gallery_write(d, p, names, o, error);
}

/* CLI_DONE, or what was said. */
static int read_size(struct gallery_options *o)
{
	if (!size_text || camera_size_parse(size_text, &o->width, &o->height))
		return CLI_DONE;
	return cli_misuse(COMMAND, "--size is WIDTHxHEIGHT, each from 1 to %u, not '%s'",
		CAMERA_SIDE_MAX / 2, size_text);
}

static int tell_page(bool good, const char *in, const GError *error)
{
	if (!good)
		return cli_fail(COMMAND, error);
	printf("%s/index.html\n", in);
	return cli_done(COMMAND);
}

static int make_thumbnails(const char *site_path)
{
	g_autoptr(GError) error = NULL;
	struct cli_bar bar;
	struct gallery_options o = { .folder = thumbnails,
		.view = view_name,
		.title = title,
		.with = with,
		.width = 800,
		.height = 600,
		.progress = show_progress,
		.user_data = &bar };
	int status = read_size(&o);
	if (status != CLI_DONE)
		return status;
	cli_catch_interrupts();
	bar = cli_bar_begin(COMMAND);
	bool good = draw_thumbnails(site_path, &o, &error);
	cli_bar_end(&bar);
	return tell_page(good, thumbnails, error);
}

/* ---- sweeps ---- */

/* NULL: it was said what is wrong. */
static GPtrArray *read_sweeps(void)
{
	g_autoptr(GPtrArray) sweeps = g_ptr_array_new_with_free_func((GDestroyNotify)sweep_free);
	for (char **text = sweep_texts; *text; text++) {
		g_autoptr(GError) error = NULL;
		sweep *s = sweep_new(*text, &error);
		if (!s)
			return cli_misuse(COMMAND, "--sweep: %s", error->message), NULL;
		g_ptr_array_add(sweeps, s);
	}
	return g_steal_pointer(&sweeps);
}

static int make_sweeps(char **paths)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *usual = g_build_filename(paths[0], "exports", "sweeps", NULL);
	struct cli_bar bar;
	struct gallery_options o = { .folder = output ? output : usual,
		.view = view_name,
		.title = title,
		.with = with,
		.width = 600,
		.height = 450,
		.supersample = 2,
		.progress = show_progress,
		.user_data = &bar };
	g_autoptr(GPtrArray) sweeps = read_sweeps();
	int status = sweeps ? read_size(&o) : CLI_WRONG_USAGE;
	if (status != CLI_DONE)
		return status;
	cli_catch_interrupts();
	bar = cli_bar_begin(COMMAND);
	bool good = sweeps_draw_sites(paths, sweeps, &o, &error);
	cli_bar_end(&bar);
	return tell_page(good, o.folder, error);
}

/* The first thing that is wrong with each, as far as it does not take a site to know. */
static int check_sweeps(void)
{
	g_autoptr(GPtrArray) sweeps = read_sweeps();
	int status = sweeps ? CLI_DONE : CLI_WRONG_USAGE;
	for (guint n = 0; sweeps && n < sweeps->len; n++) {
		const sweep *s = sweeps->pdata[n];
		g_autoptr(GError) error = NULL;
		for (guint i = 0; i < s->count && !error; i++)
			style_free(sweep_style(s, i, NULL, &error));
		if (error)
			status = cli_fail(COMMAND, error);
	}
	return status;
}

/* ---- the steps ---- */

static void print_parameter(const struct step_parameter *p)
{
	g_autofree char *choices = p->choices ? g_strjoinv(", ", (char **)p->choices) : NULL;
	printf("    %-20s ", p->name);
	switch (p->type) {
	case PARAMETER_NUMBER:
		printf("%g to %g%s%s, else %g", p->least, p->most, *p->unit ? " " : "", p->unit,
			p->fallback);
		break;
	case PARAMETER_CHOICE:
		printf("%s, else %s", choices, p->choices[(size_t)p->fallback]);
		break;
	case PARAMETER_BOOLEAN:
		printf("true or false, else %s", p->fallback != 0 ? "true" : "false");
		break;
	case PARAMETER_COLOUR: printf("\"#rrggbb\", else #%06x", (unsigned)p->fallback); break;
	case PARAMETER_TEXTURE: printf("name or PNG, else %s", p->fallback_name); break;
	case PARAMETER_XTOON: printf("stops or PNG, else %s", p->fallback_name); break;
	case PARAMETER_MODEL: printf("path of an ONNX file"); break;
	case PARAMETER_PENCILS: printf("colours, else %s", p->fallback_name); break;
	}
	printf("\n    %-20s   %s\n", "", p->help);
}

static int list_steps(void)
{
	static const char *const stages[] = { [STEP_MASK] = "mask",
		[STEP_LAYER] = "layer",
		[STEP_FILTER] = "filter",
		[STEP_COMPOSITE] = "composition" };
	for (const struct step_kind *k = step_kinds; k->name; k++) {
		printf("%s%s (%s): %s\n", k == step_kinds ? "" : "\n", k->name, stages[k->stage],
			k->help);
		for (const struct step_parameter *p = k->parameters; p->name; p++)
			print_parameter(p);
	}
	for (const struct style_section *n = style_sections; n->name; n++) {
		printf("\n%s: %s\n", n->name, n->help);
		for (const struct step_parameter *p = n->parameters; p->name; p++)
			print_parameter(p);
	}
	return cli_done(COMMAND);
}

static int print_schema(void)
{
	g_autofree char *text = style_schema();
	fputs(text, stdout);
	return cli_done(COMMAND);
}

/* ---- files ---- */

static int check_files(char **paths)
{
	int status = CLI_DONE;
	for (char **path = paths; *path; path++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(style) s = style_load(*path, &error);
		if (!s)
			status = cli_fail(COMMAND, error);
	}
	return status;
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "[SITE... | FILE...]",
		    "Lists the styles that a site can be drawn in.",
		    "With a SITE, its own styles too. How a style is written: pleinair-style(5).\n",
		    entries, &argc, &argv, &status))
		return status;
	if (check + steps + schema + json > 1)
		return cli_misuse(
			COMMAND, "--check, --steps, --schema and --json are one at a time");
	if (check && argc < 2 && !sweep_texts)
		return cli_misuse(COMMAND, "which files?");
	if (check && argc > 1 && sweep_texts)
		return cli_misuse(COMMAND, "--check takes files or sweeps, not both");
	if (check)
		return sweep_texts ? check_sweeps() : check_files(argv + 1);
	if (sweep_texts && argc < 2)
		return cli_misuse(COMMAND, "sweeps of which site?");
	if (sweep_texts && thumbnails)
		return cli_misuse(COMMAND, "--sweep and --thumbnails are one at a time");
	if (sweep_texts)
		return make_sweeps(argv + 1);
	if (argc > 2 || (argc == 2 && (steps || schema)))
		return cli_misuse(COMMAND, "'%s' is too much here", argv[argc - 1]);
	if (steps)
		return list_steps();
	if (schema)
		return print_schema();
	if (thumbnails && argc < 2)
		return cli_misuse(COMMAND, "thumbnails of which site?");
	if (thumbnails)
		return make_thumbnails(argv[1]);
	if (argc < 2)
		return list_styles(NULL);
	g_autoptr(site) s = site_open(argv[1], &error);
	return s ? list_styles(argv[1]) : cli_fail(COMMAND, error);
}
