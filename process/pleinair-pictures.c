/* pleinair pictures SITE: what was computed of the scans as pictures, and a page that shows them. */
#include "acquire/cli.h"
#include "process/scan-data.h"
#include "process/scan-pictures.h"
#include <errno.h>
#include <stdio.h>

#define COMMAND "pictures"

static char *output;
static gboolean json;

static const GOptionEntry entries[] = {
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"Where the pictures go (default SITE/exports/pictures)", "FOLDER" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print what was written as JSON", NULL },
	{ NULL },
};

struct drawing {
	site *site;
	const char *folder;
	struct segment_colour *colour;
	GArray *drawn; /* of uint32_t */
	uint32_t clouds;
};

static bool save_all(const struct drawing *d, uint32_t number, const struct scan_picture_input *of,
	GError **error)
{
	for (const struct scan_picture *p = scan_pictures; p->name; p++) {
		g_autofree char *name = g_strdup_printf("%04u-%s.png", number, p->name);
		g_autofree char *path = g_build_filename(d->folder, name, NULL);
		if (!scan_picture_save(p, of, path, error))
			return false;
	}
	return true;
}

static bool check_count(const product *file, uint64_t count, const range_grid *g, GError **error)
{
	if (count == range_grid_cells(g))
		return product_verify(file, error);
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED, "%s: is not of this scan",
		product_path(file));
	return false;
}

static bool draw(struct drawing *d, uint32_t number, GError **error)
{
	g_autoptr(scan_data) data = scan_data_load(d->site, number, error);
	if (!data)
		return false;
	if (!data->grid) {
		d->clouds++;
		return true;
	}
	g_autoptr(scan_features) f = scan_features_open(d->site, number, error);
	if (!f)
		return false;
	g_autoptr(scan_segments) l = scan_segments_open(d->site, number, error);
	if (!l)
		return false;
	struct scan_picture_input of = { data->grid, f, l, d->colour };
	if (!check_count(f->file, f->count, data->grid, error) ||
		!check_count(l->file, l->count, data->grid, error))
		return false;
	g_array_append_val(d->drawn, number);
	return save_all(d, number, &of, error);
}

static bool draw_all(struct drawing *d, GError **error)
{
	g_autoptr(GArray) numbers = site_scans(d->site, error);
	if (!numbers)
		return false;
	if (!numbers->len) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT, "%s: has no scans yet",
			site_path(d->site));
		return false;
	}
	if (g_mkdir_with_parents(d->folder, 0777) != 0) {
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s",
			d->folder, g_strerror(errno));
		return false;
	}
	struct cli_bar bar = cli_bar_begin(COMMAND);
	bool good = true;
	for (guint i = 0; i < numbers->len && good; i++) {
		cli_bar_update(&bar, (double)i / numbers->len, "drawing");
		good = draw(d, g_array_index(numbers, uint32_t, i), error);
	}
	cli_bar_end(&bar);
	return good &&
	       scan_pictures_write_page(d->folder,
		       manifest_get_string(site_manifest(d->site), "name", NULL), d->drawn, error);
}

static void print_result(const struct drawing *d)
{
	g_autofree char *index = g_build_filename(d->folder, "index.html", NULL);
	g_autofree char *text = g_filename_display_name(index);
	if (!json) {
		if (d->clouds)
			printf("%u %s without a grid: no pictures\n", d->clouds,
				d->clouds == 1 ? "scan" : "scans");
		printf("%u %s: %s\n", d->drawn->len, d->drawn->len == 1 ? "scan" : "scans", text);
		return;
	}
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "scans", d->drawn->len);
	json_object_set_int_member(o, "without_picture", d->clouds);
	json_object_set_string_member(o, "page", text);
	cli_print_json(o);
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	if (!cli_parse(COMMAND, "SITE",
		    "Writes what was computed of a site's scans as PNG pictures, and one HTML page "
		    "that shows them.",
		    "'pleinair process SITE' must have computed segments and features.\n", entries,
		    &argc, &argv, &status))
		return status;
	if (argc != 2 || !*argv[1])
		return cli_misuse(COMMAND, argc <= 2 ? "which site?" : "one site at a time");
	g_autoptr(site) s = site_open(argv[1], &error);
	g_autofree char *folder =
		output ? g_strdup(output) : g_build_filename(argv[1], "exports", "pictures", NULL);
	g_autoptr(GArray) drawn = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g_autoptr(segments) tree = s ? segments_load(argv[1], &error) : NULL;
	g_autofree struct segment_colour *colour = tree ? segment_colours(tree) : NULL;
	struct drawing d = { .site = s, .folder = folder, .colour = colour, .drawn = drawn };
	if (!tree || !draw_all(&d, &error))
		return cli_fail(COMMAND, error);
	print_result(&d);
	return cli_done(COMMAND);
}
