/* The features of a site's scans as files: what is in them, and when they are made again. */
#include "process/scan-data.h"
#include "process/scan-features.h"
#include "process/scan-geometry.h"
#include "tests/hall-site.h"
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t make(struct fixture *f)
{
	g_autoptr(GError) error = NULL;
	uint32_t made = 99;
	bool good = features_site(f->site, &f->graph, NULL, &made, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	return made;
}

static void assert_due(struct fixture *f, const char *why)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *said = NULL;
	bool due = false,
	     good = features_site_is_due(f->site, &f->graph, NULL, &due, &said, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	g_assert_cmpstr(said, ==, why);
	g_assert_true(due == (why != NULL));
}

static void make_geometry(struct fixture *f)
{
	g_autoptr(GError) error = NULL;
	g_assert_true(geometry_site(f->site, &f->graph, NULL, NULL, &error));
	g_assert_no_error(error);
}

static void test_contents(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	make_geometry(f);
	assert_due(f, "scan 1 has no features");
	g_assert_cmpuint(make(f), ==, 2);
	assert_due(f, NULL);
	g_autoptr(scan_features) file = scan_features_open(f->site, 1, &error);
	g_assert_no_error(error);
	g_assert_true(product_verify(file->file, &error));
	struct features_input in[2] = { 0 };
	scan_data *d[2];
	for (uint32_t i = 0; i < 2; i++) {
		d[i] = scan_data_load(f->site, i + 1, &error);
		g_assert_no_error(error);
		in[1 - i] =
			(struct features_input){ /* the scan itself is the last, as there */ .grid =
							 d[i]->grid,
				.pose = g_array_index(f->graph.scans, struct placed_scan, i).pose };
	}
	g_autoptr(features) same = features_of_scans(in, 2, 1, NULL);
	size_t n = range_grid_cells(d[0]->grid);
	g_assert_cmpuint(file->count, ==, n);
	g_assert_cmpmem(file->degree, n, same->degree, n);
	g_assert_cmpmem(file->kind, n, same->kind, n);
	g_assert_cmpmem(file->flags, n, same->flags, n);
	g_assert_cmpmem(file->principal, 4 * n, same->principal, 4 * n);
	for (int i = 0; i < 2; i++)
		scan_data_free(d[i]);
}

static void test_due(struct fixture *f, gconstpointer data)
{
	(void)data;
	make_geometry(f);
	make(f);
	struct placed_scan *p = &g_array_index(f->graph.scans, struct placed_scan, 1);
	p->pose.translation_m[0] += 0.0001; /* less than what counts */
	assert_due(f, NULL);
	p->pose.translation_m[0] += 0.01;
	assert_due(f, "scan 1 or what its features come from has changed");
	g_assert_cmpuint(make(f), ==, 2);
	struct features_options other = { .threshold = 0.6f };
	bool due = false;
	g_assert_true(features_site_is_due(f->site, &f->graph, &other, &due, NULL, NULL));
	g_assert_true(due);
}

static void test_damage(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *bytes = NULL;
	gsize length;
	(void)data;
	make_geometry(f);
	make(f);
	g_autofree char *path = g_build_filename(f->path, "features", "0002.features", NULL);
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	g_assert_true(g_file_set_contents(path, bytes, (gssize)length / 2, NULL));
	g_assert_null(scan_features_open(f->site, 2, &error));
	g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED);
	assert_due(f, "scan 2 has features that cannot be read");
	g_assert_cmpuint(make(f), ==, 1);
	g_autofree char *again = NULL;
	gsize again_length;
	g_assert_true(g_file_get_contents(path, &again, &again_length, NULL));
	g_assert_cmpmem(again, again_length, bytes, length);
}

static bool stop_at_second(double fraction, const char *doing, gpointer user_data)
{
	(void)fraction;
	(void)user_data;
	return !strstr(doing, "scan 2");
}

static void test_stop(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	uint32_t made = 9;
	struct features_site_options options = { .progress = stop_at_second };
	(void)data;
	make_geometry(f);
	g_assert_false(features_site(f->site, &f->graph, &options, &made, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
	g_assert_cmpuint(made, ==, 1);
	assert_due(f, "scan 2 has no features");
	g_assert_cmpuint(make(f), ==, 1);
	assert_due(f, NULL);
}

static void expect_tone(struct fixture *f, double dither_per_m2, double tone_exponent)
{
	g_autoptr(scan_features) file = scan_features_open(f->site, 1, NULL);
	JsonObject *made = product_manifest(file->file);
	g_assert_cmpfloat(json_object_get_double_member(made, "dither_per_m2"), ==, dither_per_m2);
	g_assert_cmpfloat(json_object_get_double_member(made, "tone_exponent"), ==, tone_exponent);
}

/* Each file says what its dithering points were chosen with, and is made anew for others. */
static void test_tone(struct fixture *f, gconstpointer data)
{
	const struct features_options defaults = features_defaults(NULL);
	struct features_site_options options = { .features = { .dither_per_m2 = 30,
							 .tone_exponent = 2 } };
	g_autoptr(GError) error = NULL;
	uint32_t made;
	(void)data;
	make_geometry(f);
	make(f);
	expect_tone(f, defaults.dither_per_m2, defaults.tone_exponent);
	features_site(f->site, &f->graph, &options, &made, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(made, ==, 2);
	expect_tone(f, 30, 2);
}

static void test_cloud(struct fixture *f, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	import_cloud(f);
	make_geometry(f);
	g_assert_cmpuint(make(f), ==, 3);
	g_autoptr(scan_features) file = scan_features_open(f->site, 3, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(file->count, ==, 3000);
	/* New geometry makes new features. */
	g_autofree char *path = g_build_filename(f->path, "geometry", "0003.geometry", NULL);
	g_assert_cmpint(remove(path), ==, 0);
	assert_due(f, "scan 3 or what its features come from has changed");
}

#define ADD(name, test)                                                                            \
	g_test_add("/scan-features/" name, struct fixture, NULL, set_up, test, tear_down)

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	ADD("contents", test_contents);
	ADD("due", test_due);
	ADD("damage", test_damage);
	ADD("stop", test_stop);
	ADD("tone", test_tone);
	ADD("cloud", test_cloud);
	return g_test_run();
}
