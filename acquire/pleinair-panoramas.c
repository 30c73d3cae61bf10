/* pleinair panoramas SITE: the scans as pictures, and a page that shows them. */
#include "acquire/cli.h"
#include "acquire/page.h"
#include "acquire/picture.h"
#include "acquire/scan.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define COMMAND "panoramas"

static char *output;
static int only_scan;
static gboolean verify, again, json;

static const GOptionEntry entries[] = {
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"Where the pictures go (default SITE/exports/panoramas)", "FOLDER" },
	{ "scan", 's', 0, G_OPTION_ARG_INT, &only_scan, "Only this scan", "NUMBER" },
	{ "verify", 0, 0, G_OPTION_ARG_NONE, &verify, "Check sizes and SHA-256 of all files first",
		NULL },
	{ "develop", 0, 0, G_OPTION_ARG_NONE, &again,
		"Compute the panoramas again from their records first", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print what was written as JSON", NULL },
	{ NULL },
};

/* All pictures of one scan; the page gets their names. */
static bool show_scan(
	const site *s, uint32_t number, const char *folder, page *html, GError **error)
{
	g_autoptr(panorama) p = scan_load(s, number, verify, error);
	if (!p)
		return false;
	page_begin_scan(html, number, p);
	for (int kind = 0; kind < PICTURES; kind++) {
		g_autofree char *name = g_strdup_printf("%04u-%s.png", number, picture_names[kind]);
		g_autofree char *path = g_build_filename(folder, name, NULL);
		if (kind == PICTURE_COLOUR && !p->rgb)
			continue;
		if (!picture_save(p, kind, path, error))
			return false;
		page_add_picture(html, picture_names[kind], name);
	}
	return true;
}

static bool show_scans(site *s, GArray *numbers, const char *folder, page *html, GError **error)
{
	struct cli_bar bar = cli_bar_begin(COMMAND);
	bool good = true;
	for (guint i = 0; i < numbers->len && good; i++) {
		uint32_t number = g_array_index(numbers, uint32_t, i);
		if (only_scan && number != (uint32_t)only_scan)
			continue;
		cli_bar_update(&bar, (double)i / numbers->len, "drawing panoramas");
		good = (!again || scan_develop_again(s, number, error)) &&
		       show_scan(s, number, folder, html, error);
	}
	cli_bar_end(&bar);
	if (good && page_scans(html) == 0)
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT,
			only_scan ? "%s: has no scan %04d" : "%s: has no scans yet", site_path(s),
			only_scan);
	return good && page_scans(html) > 0;
}

static void print_result(const page *html, const char *index)
{
	if (!json) {
		printf("%u %s: %s\n", page_scans(html), page_scans(html) == 1 ? "scan" : "scans",
			index);
		return;
	}
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "scans", page_scans(html));
	json_object_set_string_member(o, "page", index);
	cli_print_json(o);
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "SITE",
		    "Writes the panoramas of a site as PNG pictures, and one HTML page that shows "
		    "them.",
		    "Each scan gives range in false colour, intensity, colour, and which cells "
		    "were measured.\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc != 2)
		return cli_misuse(COMMAND, argc < 2 ? "which site?" : "one site at a time");
	g_autoptr(site) s =
		again ? site_open_for_writing(argv[1], &error) : site_open(argv[1], &error);
	g_autoptr(GArray) numbers = s ? site_scans(s, &error) : NULL;
	if (!numbers)
		return cli_fail(COMMAND, error);
	g_autofree char *folder =
		output ? g_strdup(output) : g_build_filename(argv[1], "exports", "panoramas", NULL);
	if (g_mkdir_with_parents(folder, 0777) < 0) {
		g_set_error(&error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", folder,
			g_strerror(errno));
		return cli_fail(COMMAND, error);
	}
	g_autoptr(page) html = page_new(manifest_get_string(site_manifest(s), "name", NULL));
	g_autofree char *index = g_build_filename(folder, "index.html", NULL);
	if (!show_scans(s, numbers, folder, html, &error) || !page_save(html, index, &error))
		return cli_fail(COMMAND, error);
	print_result(html, index);
	return CLI_DONE;
}
