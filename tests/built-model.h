#ifndef TESTS_BUILT_MODEL_H
#define TESTS_BUILT_MODEL_H
/* Sites of simulated scans of a hall, placed as they stood, and models that are built of them. */
#include "acquire/points.h"
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/build-model.h"
#include "process/model.h"
#include "process/scan-data.h"
#include "process/scan-features.h"
#include "process/scan-geometry.h"
#include "tests/simulated.h"
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SCANS 3

static char *site_folder; /* with SCANS scans of a hall */
static struct pose truths[SCANS];

static inline char *describe(uint32_t station)
{
	return g_strdup_printf(
		"hall?seed=3&ares=360&camera=none&divergence_mrad=0&station=%u", station);
}

static inline void scan_station(const char *path, uint32_t station)
{
	g_autofree char *description = describe(station);
	simulated_draft(path, description);
	truths[station - 1] = simulated_pose(description);
}

/* A copy of the site, so that each test has its own; caller frees. */
static inline char *fresh_site(void)
{
	if (!site_folder) {
		g_autofree char *folder = simulated_folder();
		site_folder = g_build_filename(folder, "site", NULL);
		for (uint32_t k = 1; k <= SCANS; k++)
			scan_station(site_folder, k);
	}
	g_autofree char *folder = simulated_folder();
	char *copy = g_build_filename(folder, "site", NULL);
	g_autofree char *command = g_strdup_printf("cp -a '%s' '%s'", site_folder, copy);
	g_assert_cmpint(system(command), ==, 0);
	return copy;
}

static inline scan_graph *graph_of(uint32_t scans)
{
	scan_graph *g = g_new0(scan_graph, 1);
	g->scans = g_array_new(FALSE, TRUE, sizeof(struct placed_scan));
	g->edges = g_array_new(FALSE, TRUE, sizeof(struct edge));
	for (uint32_t k = 1; k <= scans; k++) {
		struct placed_scan p = { .number = k, .group = 1, .pose = POSE_IDENTITY };
		if (k <= SCANS)
			p.pose = truths[k - 1];
		g_array_append_val(g->scans, p);
	}
	return g;
}

static inline struct placed_scan *placed(scan_graph *g, guint i)
{
	return &g_array_index(g->scans, struct placed_scan, i);
}

static inline struct build_result build(
	const char *path, scan_graph *g, const struct build_options *o)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	struct build_result result;
	build_model(s, g, o, &result, &error);
	g_assert_no_error(error);
	return result;
}

static inline struct build_result build_some(const char *path, uint32_t scans)
{
	scan_graph *g = graph_of(scans);
	struct build_result r = build(path, g, NULL);
	scan_graph_free(g);
	return r;
}

/* SHA-256 of the model. */
static inline char *sum_of(const char *path)
{
	g_autofree char *file = model_path(path), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
	return g_compute_checksum_for_data(G_CHECKSUM_SHA256, (guchar *)bytes, length);
}

static inline void assert_same(const char *path, const char *expected)
{
	g_autofree char *sum = sum_of(path);
	g_assert_cmpstr(sum, ==, expected);
}

/* The model of all scans at once. */
static inline const char *whole_sum(void)
{
	static char *sum;
	if (!sum) {
		g_autofree char *path = fresh_site();
		build_some(path, SCANS);
		sum = sum_of(path);
	}
	return sum;
}

static inline char *why_due(const char *path, scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	bool due;
	char *why;
	g_assert_true(build_model_is_due(s, g, &due, &why, &error));
	g_assert_true(due == (why != NULL));
	return why;
}

static inline void expect_why(const char *path, scan_graph *g, const char *expected)
{
	g_autofree char *why = why_due(path, g);
	g_assert_cmpstr(why, ==, expected);
}

static inline void write_section(
	product_writer *w, const char *name, uint32_t bytes, const void *values, uint64_t count)
{
	g_assert_true(product_writer_begin(w, name, bytes, NULL));
	g_assert_true(product_writer_append(w, values, count, NULL));
}

/* The cell that a point of the model was measured in; RANGE_GRID_NONE: a beam on the edge of its cell may round into the next. */
static inline uint32_t cell_of(const struct model_chunk *c, const struct model_point *p,
	const range_grid *g, const struct pose *pose)
{
	struct pose back = pose_inverse(pose);
	double at[3];
	for (int k = 0; k < 3; k++)
		at[k] = c->centre_m[k] + p->position_m[k];
	pose_apply(&back, at, at);
	uint32_t cell = range_grid_find(g, at[0], at[1], at[2]);
	g_assert_cmpuint(cell, !=, RANGE_GRID_NONE);
	double off = fmax(fabs(g->x_m[cell] - at[0]),
		fmax(fabs(g->y_m[cell] - at[1]), fabs(g->z_m[cell] - at[2])));
	return off > 1e-5 ? RANGE_GRID_NONE : cell;
}

#endif
