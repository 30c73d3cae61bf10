#ifndef TESTS_IMPORT_MADE_H
#define TESTS_IMPORT_MADE_H
/* Files made by tests, imported into sites of their own. */
#include "acquire/panorama.h"
#include "process/import.h"
#include "process/scan-data.h"
#include "tests/commands.h"
#include "tests/simulated.h"
#include <math.h>

/* A site, and what it held before a file was tried. */
struct place {
	char *folder, *site_path;
	site *site;
};

static inline struct place place_new(void)
{
	g_autoptr(GError) error = NULL;
	char *folder = simulated_folder();
	struct place p = { folder, g_build_filename(folder, "site", NULL), NULL };
	p.site = site_open_for_writing(p.site_path, &error);
	g_assert_no_error(error);
	return p;
}

static inline void place_clear(struct place *p)
{
	site_free(p->site);
	g_free(p->site_path);
	g_free(p->folder);
}

static inline char *place_write(
	const struct place *p, const char *name, const void *bytes, size_t length)
{
	g_autoptr(GError) error = NULL;
	char *path = g_build_filename(p->folder, name, NULL);
	g_file_set_contents(path, bytes, (gssize)length, &error);
	g_assert_no_error(error);
	return path;
}

static inline GArray *place_import(const struct place *p, const char *path)
{
	g_autoptr(GError) error = NULL;
	struct import_options options = { 0 };
	GArray *scans = import_file(p->site, path, &options, &error);
	g_assert_no_error(error);
	g_assert_nonnull(scans);
	return scans;
}

/* The file is refused with a sentence that begins with its path and has the words, and the site is as it was. */
static inline void place_assert_refused(
	const struct place *p, const char *path, int code, const char *words)
{
	g_autoptr(GError) error = NULL;
	struct import_options options = { 0 };
	g_autofree char *before = commands_snapshot(p->site_path);
	GArray *scans = import_file(p->site, path, &options, &error);
	g_assert_null(scans);
	g_autofree char *after = commands_snapshot(p->site_path);
	if (!strstr(error->message, words))
		g_test_message("\"%s\" has not \"%s\"", error->message, words);
	g_assert_error(error, G_IO_ERROR, code);
	g_assert_true(g_str_has_prefix(error->message, path));
	g_assert_nonnull(strstr(error->message, words));
	g_assert_true(g_utf8_validate(error->message, -1, NULL));
	g_assert_null(strchr(error->message, '\n'));
	g_assert_cmpstr(before, ==, after);
}

static inline points *place_points(const struct place *p, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = site_scan_path(p->site, number);
	g_autofree char *path = g_build_filename(folder, "points.ply", NULL);
	points *all = points_open(path, &error);
	g_assert_no_error(error);
	return all;
}

static inline manifest *place_manifest(const struct place *p, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = site_scan_path(p->site, number);
	g_autofree char *path = g_build_filename(folder, "scan.json", NULL);
	manifest *m = manifest_load(path, 1, &error);
	g_assert_no_error(error);
	return m;
}

static inline void manifest_assert_string(const manifest *m, const char *key, const char *value)
{
	g_assert_cmpstr(manifest_get_string(m, key, NULL), ==, value);
}

static inline void manifest_assert_numbers(
	const manifest *m, const char *key, double x, double y, double z)
{
	JsonNode *node = manifest_get_node(m, key);
	g_assert_nonnull(node);
	JsonArray *array = json_node_get_array(node);
	g_assert_cmpfloat(json_array_get_double_element(array, 0), ==, x);
	g_assert_cmpfloat(json_array_get_double_element(array, 1), ==, y);
	g_assert_cmpfloat(json_array_get_double_element(array, 2), ==, z);
}

#endif
