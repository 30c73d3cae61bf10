/* Scans of others, which are not as scanners of ours make them: what is made of them on the way to a drawing. */
#include "process/import.h"
#include "process/model.h"
#include "process/register-site.h"
#include "process/scan-data.h"
#include "process/scan-geometry.h"
#include "tests/simulated.h"
#include <math.h>
#include <string.h>

static void put_scan(const char *site_path, const char *name, const GString *text)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *file = g_build_filename(site_path, name, NULL);
	g_autoptr(site) s = site_open_for_writing(site_path, &error);
	g_assert_no_error(error);
	g_assert_true(g_file_set_contents(file, text->str, (gssize)text->len, &error));
	g_autoptr(GArray) scans = import_file(s, file, &(struct import_options){ 0 }, &error);
	g_assert_no_error(error);
}

/* ---- colours that nobody photographed ---- */

static GString *coloured(int count, int black_of_100)
{
	GString *text = g_string_new(NULL);
	for (int i = 0; i < count; i++) {
		bool black = i % 100 < black_of_100;
		g_string_append_printf(text, "%d.5 %d.25 %d.1 %d %d %d\n", i % 37, i % 53, i % 3,
			black ? 0 : 255, 0, black ? 0 : 250);
	}
	return text;
}

static void test_codes(void)
{
	static const int black_of_100[] = { 0, 20, 30, 100 };
	for (size_t n = 0; n < G_N_ELEMENTS(black_of_100); n++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *path = simulated_folder();
		g_autoptr(GString) text = coloured(5000, black_of_100[n]);
		put_scan(path, "codes.xyz", text);
		g_autoptr(site) s = site_open(path, &error);
		g_autoptr(scan_data) d = scan_data_load(s, 1, &error);
		g_assert_no_error(error);
		g_assert_cmpint(
			(d->points->have & POINTS_HAVE_COLOUR) != 0, ==, black_of_100[n] <= 20);
		/* The file has them still, for whoever exports it. */
		if (black_of_100[n] < 100)
			g_assert_cmpuint(d->points->record[99].rgb[2], ==, 250);
	}
}

/* ---- the sweep of a lidar ---- */

/* A room of 12 x 8 x 3 m from its middle, in 16 rings. */
static GString *sweep(double off_m)
{
	GString *text = g_string_new(NULL);
	for (int column = 0; column < 720; column++)
		for (int ring = 0; ring < 16; ring++) {
			double a = column * G_PI / 360, e = (15 - ring * 2) * G_PI / 180;
			double d[3] = { cos(e) * sin(a), cos(e) * cos(a), sin(e) };
			double range = fmin(6 / fabs(d[0]), 4 / fabs(d[1]));
			range = fmin(range, 1.5 / fabs(d[2]));
			g_string_append_printf(text, "%.4f %.4f %.4f\n", range * d[0] + off_m,
				range * d[1], range * d[2]);
		}
	return text;
}

static void test_sweep(void)
{
	for (int moved = 0; moved < 2; moved++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *path = simulated_folder();
		g_autoptr(GString) text = sweep(moved);
		put_scan(path, "sweep.xyz", text);
		g_autoptr(site) s = site_open(path, &error);
		g_assert_no_error(error);
		g_autoptr(scan_graph) graph = scan_graph_new();
		struct placed_scan placed = { .number = 1, .group = 1, .pose = POSE_IDENTITY };
		g_array_append_val(graph->scans, placed);
		g_assert_true(geometry_site(s, graph, NULL, NULL, &error));
		g_autoptr(scan_geometry) g = scan_geometry_open(s, 1, &error);
		g_autoptr(scan_data) d = scan_data_load(s, 1, &error);
		g_assert_no_error(error);
		g_assert_cmpuint(g->rings, ==, moved ? 0 : 16);
		for (uint64_t i = 0; i < g->count && !moved; i++) {
			const struct point_record *r = &d->points->record[i];
			float n[3];
			model_unpack_normal(g->normal[i], n);
			/* They face where they were seen from, and reach to the next ring. */
			g_assert_cmpfloat((double)n[0] * r->x_m + (double)n[1] * r->y_m +
						  (double)n[2] * r->z_m,
				<, 1e-2);
			double range = hypot(hypot(r->x_m, r->y_m), r->z_m);
			g_assert_cmpfloat(
				(double)g->point_size_m[i], >, 0.95 * range * 2 * G_PI / 180);
		}
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/odd-scans/codes", test_codes);
	g_test_add_func("/odd-scans/sweep", test_sweep);
	return g_test_run();
}
