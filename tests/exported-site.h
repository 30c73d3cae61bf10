#ifndef TESTS_EXPORTED_SITE_H
#define TESTS_EXPORTED_SITE_H
/* A site of two simulated scans of a hall, placed where they stood, to be exported; and files that came of it, imported again. */
#include "process/export.h"
#include "process/scan-data.h"
#include "process/scan-graph.h"
#include "tests/import-made.h"
#include <math.h>
#include <stdlib.h>

#define EXPORTED_SCENE "hall?seed=3&ares=360&camera=64x96&divergence_mrad=0&station="

typedef struct exported {
	char *folder, *path; /* the site is path */
	site *site;
} exported;

static inline void exported_clear(exported *e)
{
	site_free(e->site);
	g_free(e->path);
	g_free(e->folder);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(exported, exported_clear)

static inline void exported_place(site *s, uint32_t scans, bool tied)
{
	g_autoptr(GError) error = NULL;
	scan_graph *g = scan_graph_new();
	for (uint32_t k = 1; k <= scans; k++) {
		g_autofree char *description = g_strdup_printf(EXPORTED_SCENE "%u", k);
		struct placed_scan p = {
			.number = k, .group = tied || k == 1, .pose = simulated_pose(description)
		};
		if (!p.group)
			p.pose = POSE_IDENTITY;
		g_array_append_val(g->scans, p);
	}
	g_assert_true(scan_graph_save(g, s, "placed", &error));
	g_assert_no_error(error);
	scan_graph_free(g);
}

/* Each test has a copy of its own. */
static inline exported exported_new(void)
{
	static char *made;
	g_autoptr(GError) error = NULL;
	if (!made) {
		g_autofree char *folder = simulated_folder();
		made = g_build_filename(folder, "hall", NULL);
		simulated_draft(made, EXPORTED_SCENE "1");
		simulated_draft(made, EXPORTED_SCENE "2");
	}
	exported e = { .folder = simulated_folder() };
	e.path = g_build_filename(e.folder, "hall", NULL);
	g_autofree char *command = g_strdup_printf("cp -a '%s' '%s'", made, e.path);
	g_assert_cmpint(system(command), ==, 0);
	e.site = site_open_for_writing(e.path, &error);
	g_assert_no_error(error);
	exported_place(e.site, 2, true);
	return e;
}

static inline char *exported_file(const exported *e, const char *name)
{
	return g_build_filename(e->folder, name, NULL);
}

/* The file's path; caller frees. */
static inline char *exported_write(const exported *e, const char *name,
	const struct export_options *options, struct export_result *ret)
{
	g_autoptr(GError) error = NULL;
	char *path = exported_file(e, name);
	bool good = export_site(e->site, path, options, ret, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	return path;
}

/* It is refused with a sentence that has the words, and nothing is left behind. */
static inline void exported_assert_refused(const exported *e, const char *name,
	const struct export_options *options, const char *words)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = exported_file(e, name), *before = commands_snapshot(e->folder);
	struct export_result r;
	g_assert_false(export_site(e->site, path, options, &r, &error));
	g_assert_nonnull(error);
	if (!strstr(error->message, words))
		g_test_message("\"%s\" has not \"%s\"", error->message, words);
	g_assert_nonnull(strstr(error->message, words));
	g_autofree char *after = commands_snapshot(e->folder);
	g_assert_cmpstr(before, ==, after);
}

/* All scans of the file, in a site of their own. */
static inline struct place exported_import(const char *path, GArray **ret_scans)
{
	struct place p = place_new();
	*ret_scans = place_import(&p, path);
	return p;
}

#endif
