/* Scans that no scanner on a tripod made: a village as an aeroplane sees it, whose roofs become planes, and their ridges and eaves lines; and a
 * wall before a camera of depth, whose steps do not. */
#include "process/build-model.h"
#include "process/plane-site.h"
#include "process/scan-features.h"
#include "process/scan-geometry.h"
#include "process/segment-site.h"
#include "process/site-lines.h"
#include "tests/import-made.h"
#include "tests/line-places.h"

static double gauss(GRand *r)
{
	return sqrt(-2 * log(1 - g_rand_double(r))) * cos(2 * G_PI * g_rand_double(r));
}

/* All that pleinair process makes of one scan. */
static void process(const struct place *at)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_graph) g = scan_graph_new();
	struct placed_scan p = { .number = 1, .group = 1, .pose = POSE_IDENTITY };
	struct segment_site_result segmented;
	struct build_result built;
	struct plane_site_result planes;
	const struct plane_options options = { 0 };
	g_array_append_val(g->scans, p);
	g_assert_true(geometry_site(at->site, g, NULL, NULL, &error));
	g_assert_true(segment_site(at->site, g, NULL, &segmented, &error));
	g_assert_true(features_site(at->site, g, NULL, NULL, &error));
	g_assert_true(build_model(at->site, g, NULL, &built, &error));
	g_assert_true(plane_site(at->site, &options, &planes, &error));
	g_autoptr(profile_lines) lines = site_lines_make(at->site, NULL, &error);
	g_assert_no_error(error);
}

/* ---- a village from above ---- */

#define APART_M   0.5
#define NOISE_M   0.05
#define VILLAGE_M 48.0
/* Houses under gables: middle, which way their ridge runs, how long and wide, eaves and ridge. */
static const struct house {
	double x_m, y_m, way_rad, long_m, wide_m, eaves_m, ridge_m;
} houses[] = {
	{ 13, 13, 0.3, 12, 8, 5, 8 },
	{ 34, 14, -0.4, 13, 9, 6, 10 },
	{ 13, 35, 1.2, 11, 8, 4, 7 },
	{ 35, 35, 0.1, 14, 10, 7, 11.5 },
};

static void to_house(const struct house *h, double x, double y, double ret[2])
{
	double c = cos(h->way_rad), s = sin(h->way_rad);
	ret[0] = (x - h->x_m) * c + (y - h->y_m) * s;
	ret[1] = (y - h->y_m) * c - (x - h->x_m) * s;
}

static double height_at(double x, double y)
{
	for (size_t n = 0; n < G_N_ELEMENTS(houses); n++) {
		const struct house *h = &houses[n];
		double at[2];
		to_house(h, x, y, at);
		if (fabs(at[0]) < h->long_m / 2 && fabs(at[1]) < h->wide_m / 2)
			return h->ridge_m -
			       (h->ridge_m - h->eaves_m) * fabs(at[1]) / (h->wide_m / 2);
	}
	return 0.02 * x;
}

static struct place make_village(void)
{
	struct place at = place_new();
	g_autoptr(GRand) r = g_rand_new_with_seed(17);
	g_autoptr(GString) text = g_string_new(NULL);
	for (double i = 0; i < VILLAGE_M; i += APART_M)
		for (double j = 0; j < VILLAGE_M; j += APART_M) {
			double x = i + APART_M * g_rand_double(r),
			       y = j + APART_M * g_rand_double(r);
			g_string_append_printf(text, "%.3f %.3f %.3f\n", x + 0.02 * gauss(r),
				y + 0.02 * gauss(r), height_at(x, y) + NOISE_M * gauss(r));
		}
	g_autofree char *file = place_write(&at, "village.xyz", text->str, text->len);
	g_array_unref(place_import(&at, file));
	process(&at);
	return at;
}

static struct place village;

static double cosine(const float a[3], const double b[3])
{
	return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

/* Both slopes of each house are one plane each, as they lie, and nearly as large as they are. */
static void test_roofs(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = plane_regions_path(village.site_path);
	g_autoptr(plane_regions) r = plane_regions_open(path, &error);
	g_assert_no_error(error);
	for (size_t n = 0; n < 2 * G_N_ELEMENTS(houses); n++) {
		const struct house *h = &houses[n / 2];
		double side = n % 2 ? 1 : -1, rise = h->ridge_m - h->eaves_m, half = h->wide_m / 2,
		       slope = hypot(rise, half), area_m2 = 0, off_m = INFINITY;
		double normal[3] = { -side * rise / slope * sin(h->way_rad),
			side * rise / slope * cos(h->way_rad), half / slope };
		double middle[3] = { h->x_m - side * half / 2 * sin(h->way_rad),
			h->y_m + side * half / 2 * cos(h->way_rad), (h->ridge_m + h->eaves_m) / 2 };
		for (uint32_t k = 0; k < r->count; k++) {
			const struct plane_region *p = &r->region[k];
			double off = 0;
			for (int i = 0; i < 3; i++)
				off += (middle[i] - p->origin_m[i]) * (double)p->normal[i];
			if (cosine(p->normal, normal) < 0.998 || fabs(off) > 0.2 ||
				(double)p->area_m2 < area_m2)
				continue;
			area_m2 = (double)p->area_m2;
			off_m = fabs(off);
		}
		g_test_message("slope %zu: %.0f of %.0f m2, %.3f m off", n, area_m2,
			slope * h->long_m, off_m);
		g_assert_cmpfloat(off_m, <, 0.05);
		g_assert_cmpfloat(area_m2, >, 0.6 * slope * h->long_m);
		g_assert_cmpfloat(area_m2, <, 1.2 * slope * h->long_m);
	}
}

static double nearest_line(const profile_lines *lines, const double at[3], bool is_plan)
{
	double least = INFINITY;
	for (guint n = 0; n < lines->line->len; n++) {
		const struct profile_line *l = &g_array_index(lines->line, struct profile_line, n);
		for (uint32_t v = l->first; v + 1 < l->first + l->count; v++) {
			double a[3], b[3];
			vertex_at(lines, v, a);
			vertex_at(lines, v + 1, b);
			if (is_plan)
				a[2] = b[2] = at[2];
			least = fmin(least, off_segment(at, a, b));
		}
	}
	return least;
}

/* How much of what runs along the houses, so far beside their middle, lies near lines. */
static double covered(const profile_lines *lines, double beside, bool is_plan)
{
	int some = 0, all = 0;
	for (size_t n = 0; n < G_N_ELEMENTS(houses); n++) {
		const struct house *h = &houses[n];
		for (int s = 0; s < 100; s++, all++) {
			double u = ((s + 0.5) / 100 - 0.5) * h->long_m * 0.96,
			       v = beside * h->wide_m / 2;
			double at[3] = { h->x_m + u * cos(h->way_rad) - v * sin(h->way_rad),
				h->y_m + u * sin(h->way_rad) + v * cos(h->way_rad),
				beside == 0 ? h->ridge_m : h->eaves_m };
			some += nearest_line(lines, at, is_plan) < 0.8 * APART_M;
		}
	}
	return (double)some / all;
}

/* Of the lines' length, what is amid roofs and on ground without houses: neither ridge nor outline of a house or of the village. */
static double astray(const profile_lines *lines)
{
	double all_m = 0, astray_m = 0;
	for (guint n = 0; n < lines->line->len; n++) {
		const struct profile_line *l = &g_array_index(lines->line, struct profile_line, n);
		for (uint32_t v = l->first; v + 1 < l->first + l->count; v++) {
			double a[3], b[3], middle[3], length = 0;
			vertex_at(lines, v, a);
			vertex_at(lines, v + 1, b);
			for (int k = 0; k < 3; k++) {
				middle[k] = (a[k] + b[k]) / 2;
				length += (a[k] - b[k]) * (a[k] - b[k]);
			}
			double off = fmin(fmin(middle[0], VILLAGE_M - middle[0]),
				fmin(middle[1], VILLAGE_M - middle[1]));
			for (size_t k = 0; k < G_N_ELEMENTS(houses); k++) {
				double at[2], u, w;
				to_house(&houses[k], middle[0], middle[1], at);
				u = fabs(at[0]) - houses[k].long_m / 2;
				w = fabs(at[1]) - houses[k].wide_m / 2;
				if (u < APART_M && w < APART_M)
					off = fmin(off, fmin(fabs(at[1]), fmin(fabs(u), fabs(w))));
			}
			all_m += sqrt(length);
			astray_m += off > 1.5 * APART_M ? sqrt(length) : 0;
		}
	}
	return astray_m / all_m;
}

static void test_edges(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(profile_lines) lines = site_lines_load(village.site_path, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(lines->line->len, >, 0);
	double ridges = covered(lines, 0, false),
	       eaves = (covered(lines, 1, true) + covered(lines, -1, true)) / 2,
	       off = astray(lines);
	g_test_message("%u lines: %.0f %% of ridges, %.0f %% of eaves; %.0f %% astray",
		lines->line->len, 100 * ridges, 100 * eaves, 100 * off);
	g_assert_cmpfloat(ridges, >, 0.9);
	g_assert_cmpfloat(eaves, >, 0.6);
	g_assert_cmpfloat(off, <, 0.15);
}

/* ---- a wall before a camera of depth ---- */

#define COLUMNS 320
#define ROWS    240
#define FOCAL   260.0
#define STEP    0.0029 /* of depth, per its square */

/* Depth in steps, which are told by one more or less as chance has it. */
static double in_steps(double depth_m, GRand *r)
{
	double disparity = 1 / (STEP * depth_m) + 0.5 * gauss(r);
	return 1 / (STEP * round(disparity));
}

/* It leads away from 2.4 to 4.5 m. */
static void test_steps(void)
{
	struct place at = place_new();
	g_autoptr(GError) error = NULL;
	g_autoptr(GRand) r = g_rand_new_with_seed(5);
	g_autoptr(GString) text = g_string_new(NULL);
	g_string_append_printf(text,
		"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
		"WIDTH %d\nHEIGHT %d\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA ascii\n",
		COLUMNS, ROWS, COLUMNS * ROWS);
	for (int row = 0; row < ROWS; row++)
		for (int column = 0; column < COLUMNS; column++) {
			double x = (column - COLUMNS / 2 + 0.5) / FOCAL,
			       y = (row - ROWS / 2 + 0.5) / FOCAL,
			       z = in_steps(3.2 / (1 - 0.5 * x), r);
			g_string_append_printf(text, "%.5f %.5f %.5f\n", x * z, y * z, z);
		}
	g_autofree char *file = place_write(&at, "wall.pcd", text->str, text->len);
	g_array_unref(place_import(&at, file));
	process(&at);
	g_autoptr(profile_lines) lines = site_lines_load(at.site_path, &error);
	g_assert_no_error(error);
	double amid_m = 0;
	for (guint n = 0; n < lines->line->len; n++) {
		const struct profile_line *l = &g_array_index(lines->line, struct profile_line, n);
		double a[3], b[3];
		vertex_at(lines, l->first, a);
		vertex_at(lines, l->first + l->count - 1, b);
		/* Forward is y: its own borders are edges. */
		double side = (a[0] + b[0]) / (a[1] + b[1]) * FOCAL * 2 / COLUMNS,
		       up = (a[2] + b[2]) / (a[1] + b[1]) * FOCAL * 2 / ROWS;
		if (fabs(side) < 0.9 && fabs(up) < 0.9)
			amid_m += (double)l->length_m;
	}
	g_test_message("%u lines, %.1f m amid the wall", lines->line->len, amid_m);
	g_assert_cmpfloat(amid_m, <, 1.0);
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	village = make_village();
	g_test_add_func("/aerial/roofs", test_roofs);
	g_test_add_func("/aerial/edges", test_edges);
	g_test_add_func("/depth-camera/steps", test_steps);
	int failed = g_test_run();
	place_clear(&village);
	return failed;
}
