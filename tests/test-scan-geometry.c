/* The geometry of a site's scans as files: what is in them, and when they are made again. */
#include "process/geometry.h"
#include "process/model.h"
#include "process/scan-data.h"
#include "process/scan-geometry.h"
#include "tests/hall-site.h"
#include <gio/gio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t make(struct fixture *f)
{
	g_autoptr(GError) error = NULL;
	uint32_t made = 99;
	bool good = geometry_site(f->site, &f->graph, NULL, &made, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	return made;
}

static void assert_due(struct fixture *f, const char *why)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *said = NULL;
	bool due = false, good = geometry_site_is_due(f->site, &f->graph, &due, &said, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	g_assert_cmpstr(said, ==, why);
	g_assert_true(due == (why != NULL));
}

/* That the file has what estimating gives. */
static void assert_file(
	struct fixture *f, uint32_t number, const geometry *g, const range_grid *grid)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_geometry) file = scan_geometry_open(f->site, number, &error);
	g_assert_no_error(error);
	g_assert_true(product_verify(file->file, &error));
	g_assert_cmpuint(file->count, ==, range_grid_cells(grid));
	for (size_t i = 0; i < file->count; i++) {
		float normal[3];
		model_unpack_normal(file->normal[i], normal);
		g_assert_cmpfloat_with_epsilon(normal[0], g->normal_x[i], 1e-3);
		g_assert_cmpfloat_with_epsilon(normal[1], g->normal_y[i], 1e-3);
		g_assert_cmpfloat_with_epsilon(normal[2], g->normal_z[i], 1e-3);
		g_assert_true(isnan(g->plane_error_m[i])
				      ? isnan(file->plane_error_m[i])
				      : file->plane_error_m[i] == g->plane_error_m[i]);
		g_assert_true(isnan(file->point_size_m[i]) == !(grid->range_m[i] > 0));
	}
}

static void test_placed(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	assert_due(f, "scan 1 has no normals");
	g_assert_cmpuint(make(f), ==, 2);
	assert_due(f, NULL);
	g_assert_cmpuint(make(f), ==, 0);
	struct posed_grid scans[2] = { 0 };
	g_autoptr(scan_data) a = scan_data_load(f->site, 1, &error);
	g_autoptr(scan_data) b = scan_data_load(f->site, 2, &error);
	g_assert_no_error(error);
	scans[0] = (struct posed_grid){ a->grid,
		g_array_index(f->graph.scans, struct placed_scan, 0).pose, NULL };
	scans[1] = (struct posed_grid){ b->grid,
		g_array_index(f->graph.scans, struct placed_scan, 1).pose, NULL };
	g_autoptr(geometry) g = geometry_estimate_union(scans, 2, 1, NULL, NULL, NULL);
	assert_file(f, 2, g, b->grid);
}

static void test_alone(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	g_array_index(f->graph.scans, struct placed_scan, 1).group = 0;
	g_assert_cmpuint(make(f), ==, 2);
	g_autoptr(scan_data) d = scan_data_load(f->site, 1, &error);
	g_assert_no_error(error);
	g_autoptr(geometry) g = geometry_estimate(d->grid, NULL);
	assert_file(f, 1, g, d->grid);
}

static void test_due(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	struct pose *pose = &g_array_index(f->graph.scans, struct placed_scan, 1).pose;
	g_autofree char *file = g_build_filename(f->path, "geometry", "0002.geometry", NULL);
	(void)data;
	make(f);
	pose->translation_m[0] +=
		1e-5; /* too little to matter, unless it is rounded the other way */
	pose->translation_m[0] -= 1e-5;
	assert_due(f, NULL);
	pose->translation_m[0] += 0.01;
	assert_due(f, "scan 1 or where it stands has changed");
	g_assert_cmpuint(make(f), ==, 2);
	g_array_index(f->graph.scans, struct placed_scan, 0).group = 2; /* both alone now */
	g_assert_cmpuint(make(f), ==, 2);
	g_assert_true(g_file_set_contents(file, "nonsense", 8, &error));
	assert_due(f, "scan 2 has normals that cannot be read");
	g_assert_cmpuint(make(f), ==, 1);
	assert_due(f, NULL);
}

static bool stop_late(double fraction, const char *doing, gpointer user_data)
{
	double *last = user_data;
	g_assert_cmpfloat(fraction, >=, *last);
	g_assert_nonnull(doing);
	*last = fraction;
	return fraction < 0.6;
}

static void test_stopped(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	double last = 0;
	struct geometry_site_options options = { .progress = stop_late, .user_data = &last };
	uint32_t made;
	(void)data;
	g_assert_false(geometry_site(f->site, &f->graph, &options, &made, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
	g_assert_cmpuint(made, ==, 1);
	g_assert_cmpuint(make(f), ==, 1);
}

static void test_cloud(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	import_cloud(f);
	g_assert_cmpuint(make(f), ==, 3);
	g_autoptr(scan_geometry) g = scan_geometry_open(f->site, 3, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(g->count, ==, 3000);
	for (size_t i = 0; i < g->count; i++) {
		float normal[3];
		model_unpack_normal(g->normal[i], normal);
		g_assert_cmpfloat(fabsf(normal[2]), >, 0.99f);
		g_assert_cmpfloat(g->plane_error_m[i], <, 0.001f);
		g_assert_cmpfloat(g->point_size_m[i], >, 0);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
#define TEST(name, function)                                                                       \
	g_test_add("/scan-geometry/" name, struct fixture, NULL, set_up, function, tear_down)
	TEST("placed", test_placed);
	TEST("alone", test_alone);
	TEST("due", test_due);
	TEST("stopped", test_stopped);
	TEST("cloud", test_cloud);
	return g_test_run();
}
