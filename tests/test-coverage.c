/* What is covered, and where the scan has to go again. */
#include "acquire/coverage.h"
#include <math.h>

#define DEGREE (G_PI / 180)
#define JOIN   (4 * DEGREE)

static struct panorama_desc desc;
static double column_rad;

static coverage *covered(uint32_t columns, uint32_t rows)
{
	desc = panorama_desc_for(columns, rows);
	column_rad = 2 * G_PI / columns;
	return coverage_new(&desc);
}

/* A beam in each row_step-th row of a column, from row `from` to before row `to`. */
static void see(coverage *c, uint32_t column, uint32_t from, uint32_t to, uint32_t row_step)
{
	double row_rad = (desc.elevation_max_rad - desc.elevation_min_rad) / desc.rows;
	for (uint32_t row = from; row < to; row += row_step) {
		double azimuth = (column + 0.5) * column_rad;
		float elevation = (float)(desc.elevation_max_rad - (row + 0.5) * row_rad);
		coverage_add(c, &azimuth, &elevation, 1);
	}
}

static void see_all_but(coverage *c, const uint32_t *without, size_t n, uint32_t row_step)
{
	for (uint32_t column = 0; column < desc.columns; column++) {
		bool skip = false;
		for (size_t i = 0; i < n; i++)
			skip |= without[i] == column;
		if (!skip)
			see(c, column, 0, desc.rows, row_step);
	}
}

struct interval {
	double from, to; /* columns */
};

static void assert_missing(
	const coverage *c, double join_rad, const struct interval *wanted, size_t n)
{
	g_autoptr(GArray) got = coverage_missing(c, join_rad);
	for (guint i = 0; i < got->len; i++) {
		const struct front_interval *f = &g_array_index(got, struct front_interval, i);
		g_test_message("%.2f to %.2f", f->from_rad / column_rad, f->to_rad / column_rad);
	}
	g_assert_cmpuint(got->len, ==, n);
	for (guint i = 0; i < got->len; i++) {
		const struct front_interval *f = &g_array_index(got, struct front_interval, i);
		g_assert_cmpfloat(fabs(f->from_rad / column_rad - wanted[i].from), <, 1e-6);
		g_assert_cmpfloat(fabs(f->to_rad / column_rad - wanted[i].to), <, 1e-6);
	}
}

static const struct scene {
	const char *path;
	uint32_t columns, without[8];
	size_t n;
	struct interval missing[4];
	size_t intervals;
	double join_deg;
} scenes[] = {
	{ "whole", 750, { 0 }, 0, { { 0 } }, 0, 4 },
	{ "front", 750, { 100 }, 1, { { 99.5, 101.5 } }, 1, 4 },
	/* Column 475 is seen by the back, while the front is at 100. */
	{ "back", 750, { 475 }, 1, { { 99.5, 101.5 } }, 1, 4 },
	{ "both", 750, { 100, 475 }, 2, { { 99.5, 101.5 } }, 1, 4 },
	{ "run", 750, { 100, 101, 102, 478 }, 4, { { 99.5, 104.5 } }, 1, 4 },
	/* Half a degree a column: 6 free columns, less half at either end, are 2.4 degrees. */
	{ "joined", 750, { 100, 107 }, 2, { { 99.5, 108.5 } }, 1, 4 },
	{ "apart", 750, { 100, 112 }, 2, { { 99.5, 101.5 }, { 111.5, 113.5 } }, 2, 4 },
	{ "not-joined", 750, { 100, 103 }, 2, { { 99.5, 101.5 }, { 102.5, 104.5 } }, 2, 0 },
	/* Column 374 and 375 are neighbours for the eye, but half a turn apart for the stage. */
	{ "seam", 750, { 0, 374, 375, 749 }, 4, { { -0.5, 1.5 }, { 373.5, 375.5 } }, 2, 4 },
	{ "odd", 11, { 10 }, 1, { { 4.5, 6.5 } }, 1, 0 },
};

static void test_scene(gconstpointer data)
{
	const struct scene *s = data;
	g_autoptr(coverage) c = covered(s->columns, s->columns > 100 ? 198 : 20);
	see_all_but(c, s->without, s->n, 1);
	g_assert_cmpuint(coverage_missing_columns(c), ==, s->n);
	g_assert_cmpfloat(fabs(coverage_fraction(c) - (1 - (double)s->n / s->columns)), <, 1e-12);
	assert_missing(c, s->join_deg * DEGREE, s->missing, s->intervals);
}

/* Before anything was seen all is missing, in one pass over half a turn. */
static void test_nothing(void)
{
	g_autoptr(coverage) c = covered(750, 198);
	g_assert_cmpuint(coverage_missing_columns(c), ==, 750);
	g_assert_cmpfloat(coverage_fraction(c), ==, 0);
	assert_missing(c, JOIN, &(struct interval){ -0.5, 375.5 }, 1);
	/* A first few columns do not make the others whole. */
	see(c, 7, 0, 198, 1);
	g_assert_cmpuint(coverage_missing_columns(c), ==, 749);
	coverage_free(NULL);
}

/* The lidar's beams lie three rows apart: a third of the rows is all there is to have. */
static void test_coarse_lidar(void)
{
	g_autoptr(coverage) c = covered(750, 198);
	static const uint32_t without[] = { 200, 201 };
	see_all_but(c, without, 2, 3);
	g_assert_cmpuint(coverage_missing_columns(c), ==, 2);
	assert_missing(c, JOIN, &(struct interval){ 199.5, 202.5 }, 1);
	/* Other phases of the beam in some columns add rows to those; the rest stays whole. */
	for (uint32_t column = 300; column < 308; column++)
		see(c, column, 1, 198, 3);
	g_assert_cmpuint(coverage_missing_columns(c), ==, 2);
}

/* Half a column is none. Seen twice counts once. */
static void test_partial_rows(void)
{
	g_autoptr(coverage) c = covered(750, 198);
	static const uint32_t without[] = { 40, 41 };
	see_all_but(c, without, 2, 1);
	see(c, 40, 0, 190, 1);
	see(c, 40, 0, 190, 1);
	see(c, 41, 0, 193, 1);
	g_assert_cmpuint(coverage_missing_columns(c), ==, 1);
	assert_missing(c, JOIN, &(struct interval){ 39.5, 41.5 }, 1);
	see(c, 40, 190, 198, 1);
	g_assert_cmpuint(coverage_missing_columns(c), ==, 0);
}

/* Front and back columns of what the stage did between two angles; angles do not wrap. */
static void test_clear(void)
{
	static const struct {
		double from, to; /* columns */
		uint32_t cleared;
		struct interval missing[2];
		size_t intervals;
	} clears[] = {
		{ 100.2, 102.7, 6, { { 99.5, 103.5 } }, 1 },
		{ 850.2, 852.7, 6, { { 99.5, 103.5 } }, 1 },
		{ -1.5, 0.5, 6, { { -0.5, 1.5 }, { 372.5, 375.5 } }, 2 },
		{ 474.5, 475.5, 4, { { 98.5, 101.5 } }, 1 },
		{ 10, 2000, 750, { { -0.5, 375.5 } }, 1 },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(clears); i++) {
		g_autoptr(coverage) c = covered(750, 198);
		see_all_but(c, NULL, 0, 1);
		coverage_clear(c, clears[i].from * column_rad, clears[i].to * column_rad);
		g_assert_cmpuint(coverage_missing_columns(c), ==, clears[i].cleared);
		assert_missing(c, JOIN, clears[i].missing, clears[i].intervals);
		see_all_but(c, NULL, 0, 1);
		g_assert_cmpuint(coverage_missing_columns(c), ==, 0);
	}
}

/* Directions that are outside, or none at all. */
static void test_outside(void)
{
	g_autoptr(coverage) c = covered(750, 198);
	const double azimuths[] = { 1, 1, 1, NAN, INFINITY, -1, 1e300, 2 * G_PI };
	const float elevations[] = { (float)desc.elevation_max_rad + 1e-4f,
		(float)desc.elevation_min_rad - 1e-4f, NAN, 0, 0, 0, 0, 0 };
	coverage_add(c, azimuths, elevations, G_N_ELEMENTS(azimuths));
	/* Only the last is a direction: column 0. */
	g_assert_cmpuint(coverage_missing_columns(c), ==, 749);
	g_autoptr(GArray) missing = coverage_missing(c, 0);
	g_assert_cmpfloat(
		fabs(g_array_index(missing, struct front_interval, 0).from_rad + column_rad / 2), <,
		1e-9);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++) {
		g_autofree char *path = g_strconcat("/coverage/", scenes[i].path, NULL);
		g_test_add_data_func(path, &scenes[i], test_scene);
	}
	g_test_add_func("/coverage/nothing", test_nothing);
	g_test_add_func("/coverage/coarse-lidar", test_coarse_lidar);
	g_test_add_func("/coverage/partial-rows", test_partial_rows);
	g_test_add_func("/coverage/clear", test_clear);
	g_test_add_func("/coverage/outside", test_outside);
	return g_test_run();
}
