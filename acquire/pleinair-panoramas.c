/* pleinair panoramas SITE: the scans as pictures, and a page that shows them. */
#include "acquire/cli.h"
#include "acquire/imported.h"
#include "acquire/page.h"
#include "acquire/picture.h"
#include "acquire/scan.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define COMMAND   "panoramas"
#define ALL_SCANS G_MININT

static char *output;
static int only_scan = ALL_SCANS;
static gboolean verify, again, json;

static const GOptionEntry entries[] = {
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"Where the pictures go (default SITE/exports/panoramas)", "FOLDER" },
	{ "scan", 's', 0, G_OPTION_ARG_INT, &only_scan, "Only this scan", "NUMBER" },
	{ "verify", 0, 0, G_OPTION_ARG_NONE, &verify,
		"Check sizes and SHA-256 of all files first, also of the records", NULL },
	{ "develop", 0, 0, G_OPTION_ARG_NONE, &again,
		"Compute the panoramas again from their records first", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print what was written as JSON", NULL },
	{ NULL },
};

struct showing {
	site *site;
	GArray *numbers; /* of uint32_t */
	const char *folder;
	page *html;
	uint32_t passed_over; /* clouds */
};

/* Imported scans have no record. */
static bool check_record(struct showing *w, uint32_t number, GError **error)
{
	bool imported;
	return imported_is(w->site, number, &imported, error) &&
	       (imported || scan_check_record(w->site, number, error));
}

static bool develop_again(struct showing *w, uint32_t number, GError **error)
{
	bool imported;
	return imported_is(w->site, number, &imported, error) &&
	       (imported || scan_develop_again(w->site, number, error));
}

/* *ret is NULL for a scan that has no grid to draw. */
static bool load_scan(
	struct showing *w, uint32_t number, bool check, panorama **ret, GError **error)
{
	bool imported;
	*ret = NULL;
	if (!imported_is(w->site, number, &imported, error))
		return false;
	if (imported)
		return imported_panorama(w->site, number, ret, error);
	*ret = scan_load(w->site, number, check, error);
	return *ret;
}

static bool check_planes(struct showing *w, uint32_t number, GError **error)
{
	g_autoptr(panorama) p = NULL;
	return load_scan(w, number, verify, &p, error);
}

/* All pictures of one scan; the page gets their names. */
static bool draw(struct showing *w, uint32_t number, GError **error)
{
	g_autoptr(panorama) p = NULL;
	if (!load_scan(w, number, false, &p, error))
		return false;
	if (!p)
		return w->passed_over++, true;
	page_begin_scan(w->html, number, p);
	bool hdr = scan_hdr_photos(w->site, number) > 0;
	for (int kind = 0; kind < PICTURES; kind++) {
		g_autofree char *name = g_strdup_printf("%04u-%s.png", number, picture_names[kind]);
		g_autofree char *path = g_build_filename(w->folder, name, NULL);
		if (kind == PICTURE_COLOUR && !p->rgb)
			continue;
		if (!picture_save(p, kind, path, error))
			return false;
		page_add_picture(w->html,
			kind == PICTURE_COLOUR && hdr ? "colour, HDR" : picture_names[kind], name);
	}
	return true;
}

static bool for_each_scan(struct showing *w, const char *doing,
	bool (*step)(struct showing *, uint32_t, GError **), GError **error)
{
	struct cli_bar bar = cli_bar_begin(COMMAND);
	bool good = true;
	for (guint i = 0; i < w->numbers->len && good; i++) {
		cli_bar_update(&bar, (double)i / w->numbers->len, doing);
		good = step(w, g_array_index(w->numbers, uint32_t, i), error);
	}
	cli_bar_end(&bar);
	return good;
}

static bool make_folder(const char *folder, GError **error)
{
	if (g_mkdir_with_parents(folder, 0777) == 0)
		return true;
	g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", folder,
		g_strerror(errno));
	return false;
}

/* All scans are looked at before anything is written, so that a damaged one leaves all as it was.
 */
static bool show_scans(struct showing *w, GError **error)
{
	return (!again ||
		       (for_each_scan(w, "checking records", check_record, error) &&
			       for_each_scan(w, "developing panoramas", develop_again, error))) &&
	       for_each_scan(w, "reading panoramas", check_planes, error) &&
	       make_folder(w->folder, error) && for_each_scan(w, "drawing panoramas", draw, error);
}

/* The scans to show: all, or the one that was asked for. Caller frees. */
static GArray *choose_scans(const site *s, GError **error)
{
	g_autoptr(GArray) all = site_scans(s, error);
	if (!all)
		return NULL;
	g_autoptr(GArray) chosen = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	for (guint i = 0; i < all->len; i++) {
		uint32_t number = g_array_index(all, uint32_t, i);
		if (only_scan == ALL_SCANS || number == (uint32_t)only_scan)
			g_array_append_val(chosen, number);
	}
	if (chosen->len)
		return g_steal_pointer(&chosen);
	if (only_scan == ALL_SCANS)
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT, "%s: has no scans yet",
			site_path(s));
	else
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT, "%s: has no scan %04d",
			site_path(s), only_scan);
	return NULL;
}

static void print_result(const page *html, uint32_t passed_over, const char *index)
{
	if (!json) {
		if (passed_over)
			printf("%u %s without a grid: no picture\n", passed_over,
				passed_over == 1 ? "scan" : "scans");
		printf("%u %s: %s\n", page_scans(html), page_scans(html) == 1 ? "scan" : "scans",
			index);
		return;
	}
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "scans", page_scans(html));
	json_object_set_int_member(o, "without_picture", passed_over);
	g_autofree char *text = g_filename_display_name(index);
	json_object_set_string_member(o, "page", text);
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
	if (argc != 2 || !*argv[1])
		return cli_misuse(COMMAND, argc <= 2 ? "which site?" : "one site at a time");
	if (only_scan != ALL_SCANS && (only_scan < 1 || only_scan > (int)SITE_SCANS_MAX))
		return cli_misuse(COMMAND, "--scan=%d: scans have numbers from 1 to %u", only_scan,
			SITE_SCANS_MAX);
	g_autoptr(site) s =
		again ? site_open_existing(argv[1], &error) : site_open(argv[1], &error);
	g_autoptr(GArray) numbers = s ? choose_scans(s, &error) : NULL;
	if (!numbers)
		return cli_fail(COMMAND, error);
	g_autofree char *folder =
		output ? g_strdup(output) : g_build_filename(argv[1], "exports", "panoramas", NULL);
	g_autoptr(page) html = page_new(manifest_get_string(site_manifest(s), "name", NULL));
	g_autofree char *index = g_build_filename(folder, "index.html", NULL);
	struct showing w = { .site = s, .numbers = numbers, .folder = folder, .html = html };
	if (!show_scans(&w, &error) || !page_save(html, index, &error))
		return cli_fail(COMMAND, error);
	print_result(html, w.passed_over, index);
	return cli_done(COMMAND);
}
