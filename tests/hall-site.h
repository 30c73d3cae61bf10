#ifndef TESTS_HALL_SITE_H
#define TESTS_HALL_SITE_H
/* A fixture: two draft scans of a simulated hall in a site of the test's own, placed where they stand. */
#include "process/import.h"
#include "process/scan-graph.h"
#include "tests/simulated.h"
#include <stdlib.h>
#include <string.h>

#define SCENE "hall?seed=3&ares=360&camera=none&divergence_mrad=0&station="

struct fixture {
	char *path;
	site *site;
	scan_graph graph;
};

static inline void scan(const char *path, uint32_t station)
{
	g_autofree char *description = g_strdup_printf(SCENE "%u", station);
	simulated_draft(path, description);
}

/* Where the simulator says that they stand. */
static inline void place(struct fixture *f, uint32_t number)
{
	g_autofree char *description = g_strdup_printf(SCENE "%u", number);
	struct placed_scan p = {
		.number = number, .group = 1, .pose = simulated_pose(description)
	};
	g_array_append_val(f->graph.scans, p);
}

/* A table that nobody ordered, as a PLY. */
static inline void import_cloud(struct fixture *f)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GRand) chance = g_rand_new_with_seed(1);
	g_autoptr(GString) text =
		g_string_new("ply\nformat ascii 1.0\nelement vertex 3000\nproperty double x\n"
			     "property double y\nproperty double z\nend_header\n");
	g_autofree char *file = g_build_filename(f->path, "table.ply", NULL);
	for (int i = 0; i < 3000; i++)
		g_string_append_printf(text, "%.4f %.4f %.4f\n", g_rand_double(chance),
			g_rand_double(chance), 1 + 0.1 * g_rand_double(chance) * 0.01);
	g_assert_true(g_file_set_contents(file, text->str, (gssize)text->len, &error));
	GArray *scans = import_file(f->site, file, &(struct import_options){ 0 }, &error);
	g_assert_no_error(error);
	g_array_unref(scans);
}

static inline void set_up(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	static char *scanned; /* once for all of them */
	if (!scanned) {
		scanned = simulated_folder();
		scan(scanned, 1);
		scan(scanned, 2);
	}
	f->path = simulated_folder();
	g_autofree char *copy = g_strdup_printf("cp -r '%s'/. '%s'", scanned, f->path);
	g_assert_cmpint(system(copy), ==, 0);
	f->graph.scans = g_array_new(FALSE, TRUE, sizeof(struct placed_scan));
	f->graph.edges = g_array_new(FALSE, TRUE, sizeof(struct edge));
	place(f, 1);
	place(f, 2);
	f->site = site_open_existing(f->path, &error);
	g_assert_no_error(error);
}

static inline void tear_down(struct fixture *f, gconstpointer data)
{
	(void)data;
	site_free(f->site);
	g_array_unref(f->graph.scans);
	g_array_unref(f->graph.edges);
	g_free(f->path);
}

#endif
