/* The grid, the beams in it, and what is filled between them. */
#include "acquire/panorama-means.h"
#include <math.h>
#include <string.h>

#define DEGREE (G_PI / 180)

static panorama *grid(uint32_t columns, uint32_t rows)
{
	struct panorama_desc desc = panorama_desc_for(columns, rows);
	panorama *p = panorama_new(&desc, NULL);
	g_assert_nonnull(p);
	return p;
}

/* A beam at (column, row) counted in cells from the upper left corner of the grid. */
static void beam(panorama *p, double column, double row, float range_m, uint16_t intensity)
{
	double azimuth = column * p->column_rad;
	float elevation = (float)(p->desc.elevation_max_rad - row * p->row_rad);
	panorama_add(p, &azimuth, &elevation, &range_m, &intensity, 1);
}

static void measure(panorama *p, uint32_t column, uint32_t row, float range_m)
{
	beam(p, column + 0.5, row + 0.5, range_m, (uint16_t)(100 * range_m));
}

static size_t at(const panorama *p, uint32_t column, uint32_t row)
{
	return panorama_index(p, row, column);
}

/* ---- the grid ---- */

static const struct {
	uint32_t columns, rows, horizon_row;
} grids[] = { { 750, 198, 109 }, { 1500, 396, 219 }, { 3000, 792, 439 } };

static void test_horizon(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(grids); i++) {
		g_autoptr(panorama) p = grid(grids[i].columns, grids[i].rows);
		g_assert_cmpfloat(fabs(p->row_rad - 90 * DEGREE / grids[i].rows), <, 1e-12);
		g_assert_cmpfloat(fabs(p->column_rad - 360 * DEGREE / grids[i].columns), <, 1e-12);
		g_assert_cmpfloat(
			fabs(panorama_elevation_rad(p, grids[i].horizon_row, 7)), <, 1e-12);
		/* 50 degrees above, 40 below, to a row. */
		g_assert_cmpfloat(fabs(p->desc.elevation_max_rad - 50 * DEGREE), <, p->row_rad);
		g_assert_cmpfloat(fabs(p->desc.elevation_min_rad + 40 * DEGREE), <, p->row_rad);
		g_assert_cmpfloat(
			fabs(panorama_azimuth_rad(p, 0, 0) - p->column_rad / 2), <, 1e-12);
	}
}

static const struct {
	const char *why;
	struct panorama_desc desc;
} absurd[] = {
	{ "no columns", { 0, 100, -1, 1 } },
	{ "three columns", { 3, 100, -1, 1 } },
	{ "no rows", { 100, 0, -1, 1 } },
	{ "too wide", { PANORAMA_COLUMNS_MAX + 1, 4, -1, 1 } },
	{ "too high", { 4, PANORAMA_ROWS_MAX + 1, -1, 1 } },
	{ "too many cells", { PANORAMA_COLUMNS_MAX, PANORAMA_ROWS_MAX, -1, 1 } },
	{ "as many as 32 bits count to", { UINT32_MAX, UINT32_MAX, -1, 1 } },
	{ "upside down", { 100, 100, 1, -1 } },
	{ "flat", { 100, 100, 0.5, 0.5 } },
	{ "not a number", { 100, 100, NAN, 1 } },
	{ "without end", { 100, 100, -1, INFINITY } },
	{ "beyond the zenith", { 100, 100, -1, 2 } },
	{ "beyond the nadir", { 100, 100, -2, 1 } },
};

static void test_absurd(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(absurd); i++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(panorama) p = panorama_new(&absurd[i].desc, &error);
		g_test_message("%s: %s", absurd[i].why, error ? error->message : "taken");
		g_assert_null(p);
		g_assert_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL);
	}
	panorama_free(NULL);
}

/* ---- beams ---- */

static void test_offsets(void)
{
	static const double offsets[][2] = { { 0, 0 }, { 0.25, -0.125 }, { -0.499, 0.499 },
		{ 0.4999, -0.4999 }, { 1 / 65534.0, -3 / 65534.0 } };
	for (size_t i = 0; i < G_N_ELEMENTS(offsets); i++) {
		g_autoptr(panorama) p = grid(750, 198);
		double across = offsets[i][0], up = offsets[i][1];
		double azimuth = (300.5 + across) * p->column_rad;
		float elevation = (float)(p->desc.elevation_max_rad - (50.5 - up) * p->row_rad);
		panorama_add(p, &azimuth, &elevation, (float[]){ 10 }, (uint16_t[]){ 77 }, 1);
		size_t k = at(p, 300, 50);
		g_assert_cmpint(p->cell[k], ==, CELL_MEASURED);
		g_assert_cmpfloat(p->range_m[k], ==, 10);
		g_assert_cmpint(p->intensity[k], ==, 77);
		/* To half a unit of the offset; a float elevation adds a few units of its own. */
		double azimuth_off = (panorama_azimuth_rad(p, 50, 300) - azimuth) / p->column_rad;
		double elevation_off =
			(panorama_elevation_rad(p, 50, 300) - (double)elevation) / p->row_rad;
		g_assert_cmpfloat(fabs(azimuth_off), <=, 0.5001 / 65534);
		g_assert_cmpfloat(fabs(elevation_off), <=, 0.5001 / 65534);
	}
}

static void test_nearest_wins(void)
{
	static const struct {
		double across, up;
	} beams[] = { { 0.3, 0 }, { -0.1, 0.1 }, { 0.2, 0.2 }, { 0, -0.4 }, { 0.11, 0.1 } };
	g_autoptr(panorama) p = grid(750, 198);
	for (uint32_t i = 0; i < G_N_ELEMENTS(beams); i++)
		beam(p, 10.5 + beams[i].across, 20.5 + beams[i].up, 1 + i, (uint16_t)i);
	g_assert_cmpfloat(p->range_m[at(p, 10, 20)], ==, 2);
	/* Also over one that saw nothing, and the other way round. */
	beam(p, 10.5, 20.5, 0, 9);
	g_assert_cmpint(p->cell[at(p, 10, 20)], ==, CELL_NO_RETURN);
	g_assert_cmpfloat(p->range_m[at(p, 10, 20)], ==, 0);
	g_assert_cmpint(p->intensity[at(p, 10, 20)], ==, 0);
	beam(p, 10.6, 20.5, 5, 5);
	g_assert_cmpint(p->cell[at(p, 10, 20)], ==, CELL_NO_RETURN);
}

struct shot {
	double azimuth_rad;
	float elevation_rad, range_m;
	uint16_t intensity;
};

static void shuffle(struct shot *shots, size_t n, GRand *r)
{
	for (size_t i = n - 1; i > 0; i--) {
		size_t k = (size_t)g_rand_int_range(r, 0, (gint32)i + 1);
		struct shot s = shots[i];
		shots[i] = shots[k];
		shots[k] = s;
	}
}

static panorama *shoot(const struct shot *shots, size_t n, bool mean)
{
	panorama *p = grid(64, 24);
	g_autoptr(GArray) kept = g_array_new(FALSE, FALSE, sizeof(struct panorama_beam));
	for (size_t i = 0; i < n; i++) {
		const struct shot *s = &shots[i];
		panorama_add_and_keep(
			p, &s->azimuth_rad, &s->elevation_rad, &s->range_m, &s->intensity, 1, kept);
	}
	if (mean)
		panorama_set_means(p, kept);
	return p;
}

static void assert_same(const panorama *a, const panorama *b)
{
	size_t n = (size_t)a->desc.columns * a->desc.rows;
	g_assert_cmpmem(a->range_m, 4 * n, b->range_m, 4 * n);
	g_assert_cmpmem(a->intensity, 2 * n, b->intensity, 2 * n);
	g_assert_cmpmem(a->cell, n, b->cell, n);
	g_assert_cmpmem(a->azimuth_offset, 2 * n, b->azimuth_offset, 2 * n);
	g_assert_cmpmem(a->elevation_offset, 2 * n, b->elevation_offset, 2 * n);
}

/* Directions on a coarse raster, so that many beams are equally far from the centre. */
static void test_any_order(gconstpointer mean)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(4);
	static struct shot shots[20000];
	for (size_t i = 0; i < G_N_ELEMENTS(shots); i++)
		shots[i] = (struct shot){ g_rand_int_range(r, 0, 256) * 2 * G_PI / 256,
			(float)((g_rand_int_range(r, 0, 192) - 86) * 90 * DEGREE / 192),
			(float)g_rand_int_range(r, 0, 4) * (mean ? 0.03f : 1.0f),
			(uint16_t)g_rand_int_range(r, 0, 3) };
	g_autoptr(panorama) p = shoot(shots, G_N_ELEMENTS(shots), mean);
	struct panorama_counts counts = panorama_count(p);
	g_assert_cmpuint(counts.measured, >, 500);
	g_assert_cmpuint(counts.no_return, >, 100);
	for (int i = 0; i < 5; i++) {
		shuffle(shots, G_N_ELEMENTS(shots), r);
		g_autoptr(panorama) q = shoot(shots, G_N_ELEMENTS(shots), mean);
		assert_same(p, q);
	}
}

/* Beams of one cell: where, how far, and what is expected of the cell. */
static const struct {
	const char *path;
	struct {
		double across, up;
		float range_m;
		uint16_t intensity;
	} beams[4];
	enum panorama_cell cell;
	double range_m, across, up;
	uint16_t intensity;
} cells[] = {
	{ "one", { { 0.3, -0.2, 5, 100 } }, CELL_MEASURED, 5, 0.3, -0.2, 100 },
	{ "one-surface", { { 0.1, 0.2, 5.01f, 100 }, { -0.3, -0.2, 4.99f, 200 } }, CELL_MEASURED, 5,
		-0.1, 0, 150 },
	{ "four",
		{ { 0, 0.4, 5.02f, 10 }, { 0, 0.1, 4.98f, 20 }, { 0, -0.1, 5, 30 },
			{ 0, -0.4, 5, 40 } },
		CELL_MEASURED, 5, 0, 0, 25 },
	{ "an-edge", { { 0.1, 0, 5, 100 }, { -0.3, 0, 5.1f, 200 }, { 0.3, 0, 5.02f, 200 } },
		CELL_MEASURED, 5.01, 0.2, 0, 150 },
	{ "nothing-beside", { { 0.1, 0, 5, 100 }, { -0.3, 0, 0, 0 } }, CELL_MEASURED, 5, 0.1, 0,
		100 },
	{ "hardly-away", { { 0.1, 0, 1e-12f, 1 }, { 0.3, 0, 1e-12f, 3 } }, CELL_MEASURED, 0, 0.2, 0,
		2 },
	{ "nothing-nearest", { { 0.3, 0, 5, 100 }, { -0.1, 0, 0, 0 } }, CELL_NO_RETURN, 0, -0.1, 0,
		0 },
};

static void test_mean(gconstpointer data)
{
	size_t k = GPOINTER_TO_SIZE(data);
	g_autoptr(panorama) p = grid(750, 198);
	g_autoptr(GArray) kept = g_array_new(FALSE, FALSE, sizeof(struct panorama_beam));
	for (size_t i = 0; i < G_N_ELEMENTS(cells[k].beams); i++) {
		double azimuth = (10.5 + cells[k].beams[i].across) * p->column_rad;
		float elevation = (float)(p->desc.elevation_max_rad -
					  (20.5 - cells[k].beams[i].up) * p->row_rad);
		if (i && !cells[k].beams[i].across && !cells[k].beams[i].up)
			break;
		panorama_add_and_keep(p, &azimuth, &elevation, &cells[k].beams[i].range_m,
			&cells[k].beams[i].intensity, 1, kept);
	}
	panorama_set_means(p, kept);
	size_t i = at(p, 10, 20);
	g_assert_cmpint(p->cell[i], ==, cells[k].cell);
	g_assert_cmpfloat_with_epsilon((double)p->range_m[i], cells[k].range_m, 0.0002);
	g_assert_cmpint(p->intensity[i], ==, cells[k].intensity);
	g_assert_cmpfloat_with_epsilon(
		p->azimuth_offset[i] / PANORAMA_OFFSET_ONE, cells[k].across, 1e-4);
	g_assert_cmpfloat_with_epsilon(
		p->elevation_offset[i] / PANORAMA_OFFSET_ONE, cells[k].up, 1e-4);
	g_assert_cmpuint(panorama_count(p).empty, ==, 750 * 198 - 1);
}

/* Where a floor is met at 80 degrees, the mean lies on it. */
static void test_mean_of_slant(void)
{
	g_autoptr(panorama) p = grid(750, 198);
	g_autoptr(GArray) kept = g_array_new(FALSE, FALSE, sizeof(struct panorama_beam));
	for (int i = 0; i < 4; i++) {
		double azimuth = 10.5 * p->column_rad;
		float elevation =
			(float)(p->desc.elevation_max_rad - (132.2 + 0.2 * i) * p->row_rad);
		float range = (float)(0.3 / sin(-(double)elevation));
		panorama_add_and_keep(p, &azimuth, &elevation, &range, &(uint16_t){ 7 }, 1, kept);
	}
	panorama_set_means(p, kept);
	double point[3];
	panorama_point(p, 132, 10, point);
	g_assert_cmpint(p->cell[at(p, 10, 132)], ==, CELL_MEASURED);
	g_assert_cmpint(abs(p->elevation_offset[at(p, 10, 132)]), <, 30);
	g_assert_cmpfloat_with_epsilon(point[2], -0.3, 2e-6);
}

static void test_seam(void)
{
	g_autoptr(panorama) p = grid(750, 198);
	float level = 0;
	double azimuths[] = { 0, 2 * G_PI, 2 * G_PI - 1e-9, 1e-9 };
	static const uint32_t columns[] = { 0, 0, 749, 0 };
	for (size_t i = 0; i < G_N_ELEMENTS(azimuths); i++) {
		size_t k = at(p, columns[i], 109);
		memset(p->cell, CELL_EMPTY, (size_t)750 * 198);
		panorama_add(p, &azimuths[i], &level, (float[]){ 3 }, (uint16_t[]){ 1 }, 1);
		g_assert_cmpint(p->cell[k], ==, CELL_MEASURED);
		g_assert_cmpuint(panorama_count(p).measured, ==, 1);
		double off =
			remainder(panorama_azimuth_rad(p, 109, columns[i]) - azimuths[i], 2 * G_PI);
		g_assert_cmpfloat(fabs(off), <=, p->column_rad / 65534);
	}
}

/* Passed over: above, below, directions that are none. */
static void test_outside(void)
{
	g_autoptr(panorama) p = grid(750, 198);
	static const double azimuths[] = { 1, 1, 1, 1, NAN, -0.1, INFINITY, -INFINITY, 1e300 };
	const float elevations[] = { (float)p->desc.elevation_max_rad + 1e-5f,
		(float)p->desc.elevation_min_rad - 1e-5f, NAN, -INFINITY, 0, 0, 0, 0, 0 };
	float ranges[G_N_ELEMENTS(azimuths)];
	uint16_t intensities[G_N_ELEMENTS(azimuths)] = { 0 };
	for (size_t i = 0; i < G_N_ELEMENTS(azimuths); i++)
		ranges[i] = 7;
	panorama_add(p, azimuths, elevations, ranges, intensities, G_N_ELEMENTS(azimuths));
	g_assert_cmpuint(panorama_count(p).empty, ==, 750 * 198);
	beam(p, 3.5, 0.001, 7, 1);
	beam(p, 3.5, 197.999, 7, 1);
	g_assert_cmpuint(panorama_count(p).measured, ==, 2);
}

/* What a file of planes may not hold must not get in: a calibration may make ranges negative. */
static void test_odd_ranges(void)
{
	static const float ranges[] = { 0, -0.02f, NAN, INFINITY, 2e6f };
	for (size_t i = 0; i < G_N_ELEMENTS(ranges); i++) {
		g_autoptr(panorama) p = grid(750, 198);
		beam(p, 5.5, 5.5, ranges[i], 500);
		g_assert_cmpint(p->cell[at(p, 5, 5)], ==, CELL_NO_RETURN);
		g_assert_cmpfloat(p->range_m[at(p, 5, 5)], ==, 0);
		g_assert_cmpint(p->intensity[at(p, 5, 5)], ==, 0);
	}
}

/* ---- filling ---- */

static const struct gap {
	const char *path;
	uint32_t from, to;      /* columns or rows that are measured */
	float from_m, to_m;     /* 0: nothing came back */
	uint32_t reach, filled; /* how many cells between them are filled */
} gaps[] = {
	{ "one", 10, 12, 5, 5, 4, 1 },
	{ "as-far-as-reach", 10, 14, 5, 5.1f, 4, 3 },
	{ "beyond-reach", 10, 15, 5, 5, 4, 0 },
	{ "no-reach", 10, 12, 5, 5, 0, 0 },
	{ "neighbours", 10, 11, 5, 5, 4, 0 },
	{ "edge", 10, 14, 5, 9, 4, 3 },
	{ "sky-on-one-side", 10, 14, 5, 0, 4, 2 },
	{ "sky-on-both-sides", 10, 14, 0, 0, 4, 0 },
};

static void test_gap(gconstpointer data)
{
	const struct gap *g = data;
	for (int along_row = 0; along_row < 2; along_row++) {
		g_autoptr(panorama) p = grid(750, 198);
		uint32_t filled = 0;
		measure(p, along_row ? g->from : 50, along_row ? 50 : g->from, g->from_m);
		measure(p, along_row ? g->to : 50, along_row ? 50 : g->to, g->to_m);
		struct panorama_counts before = panorama_count(p);
		panorama_fill(p, g->reach);
		for (uint32_t i = g->from + 1; i < g->to; i++) {
			size_t k = at(p, along_row ? i : 50, along_row ? 50 : i);
			bool is_filled = p->cell[k] == CELL_FILLED;
			filled += is_filled;
			g_assert_true(is_filled || p->cell[k] == CELL_EMPTY);
			g_assert_true(is_filled == (p->range_m[k] > 0));
			/* Nothing stands in the air between near and far. */
			bool mixed = g->to_m > g->from_m * 1.2f && p->range_m[k] != g->from_m &&
				     p->range_m[k] != g->to_m;
			g_assert_false(is_filled && mixed);
		}
		struct panorama_counts after = panorama_count(p);
		g_assert_cmpuint(filled, ==, g->filled);
		g_assert_cmpuint(after.filled, ==, g->filled);
		g_assert_cmpuint(after.measured, ==, before.measured);
		g_assert_cmpuint(after.no_return, ==, before.no_return);
	}
}

static void test_fill_seam(void)
{
	g_autoptr(panorama) p = grid(750, 198);
	measure(p, 748, 50, 5);
	measure(p, 1, 50, 5);
	/* Rows have two ends: the lowest is no neighbour of the highest. */
	measure(p, 300, 0, 5);
	measure(p, 300, 197, 5);
	panorama_fill(p, 4);
	g_assert_cmpint(p->cell[at(p, 749, 50)], ==, CELL_FILLED);
	g_assert_cmpint(p->cell[at(p, 0, 50)], ==, CELL_FILLED);
	g_assert_cmpuint(panorama_count(p).filled, ==, 2);
}

/* A wall, seen by every third row and every other column: along a column it comes out flat. */
static void test_fill_plane(void)
{
	g_autoptr(panorama) p = grid(3000, 792);
	for (uint32_t column = 100; column < 200; column += 2)
		for (uint32_t row = 300; row < 600; row += 3) {
			double azimuth = panorama_azimuth_rad(p, row, column),
			       elevation = panorama_elevation_rad(p, row, column);
			double range = 8 / (cos(elevation) * cos(azimuth - 0.4));
			measure(p, column, row, (float)range);
		}
	panorama_fill(p, 4);
	double worst_m = 0;
	size_t filled = 0;
	for (uint32_t column = 100; column <= 198; column++)
		for (uint32_t row = 300; row <= 597; row++) {
			size_t k = at(p, column, row);
			double azimuth = panorama_azimuth_rad(p, row, column),
			       elevation = panorama_elevation_rad(p, row, column);
			double off = p->range_m[k] * cos(elevation) * cos(azimuth - 0.4) - 8;
			g_assert_true(p->cell[k] == CELL_FILLED || p->cell[k] == CELL_MEASURED);
			filled += p->cell[k] == CELL_FILLED;
			worst_m = fmax(worst_m, fabs(off));
		}
	g_test_message("%zu filled, %.3f mm from the plane at most", filled, 1000 * worst_m);
	g_assert_cmpuint(filled, >, 20000);
	g_assert_cmpfloat(worst_m, <, 0.0001);
}

/* Filling again, from what was filled, must not eat on into the empty. */
static void test_fill_twice(void)
{
	g_autoptr(panorama) p = grid(750, 198);
	measure(p, 10, 50, 5);
	measure(p, 14, 50, 5);
	measure(p, 20, 50, 5);
	panorama_fill(p, 4);
	struct panorama_counts once = panorama_count(p);
	panorama_fill(p, 4);
	struct panorama_counts twice = panorama_count(p);
	g_assert_cmpmem(&once, sizeof once, &twice, sizeof twice);
	g_assert_cmpuint(once.filled, ==, 3);
}

/* ---- what is told of it ---- */

static void test_point(void)
{
	g_autoptr(panorama) p = grid(3000, 792);
	/* To the right of home and up: x right, y along home, z up. */
	double azimuth = 60 * DEGREE;
	float elevation = (float)(30 * DEGREE);
	panorama_add(p, &azimuth, &elevation, (float[]){ 20 }, (uint16_t[]){ 0 }, 1);
	uint32_t column = (uint32_t)(azimuth / p->column_rad),
		 row = (uint32_t)((p->desc.elevation_max_rad - elevation) / p->row_rad);
	double point[3];
	panorama_point(p, row, column, point);
	g_assert_cmpfloat(fabs(point[0] - 15), <, 1e-5);
	g_assert_cmpfloat(fabs(point[1] - sqrt(75)), <, 1e-5);
	g_assert_cmpfloat(fabs(point[2] - 10), <, 1e-5);
	/* Here a row is the larger side: 0.11364 degrees against 0.12 cos 30. */
	g_assert_cmpfloat(fabs(panorama_point_size_m(p, row, column) - 20 * p->row_rad), <, 1e-5);
	measure(p, 7, 439, 10);
	g_assert_cmpfloat(fabs(panorama_point_size_m(p, 439, 7) - 10 * p->column_rad), <, 1e-5);
	g_assert_cmpfloat(panorama_point_size_m(p, 440, 7), ==, 0);
}

static void test_counts(void)
{
	g_autoptr(panorama) p = grid(750, 198);
	for (uint32_t row = 0; row < 99; row++)
		measure(p, 4, 2 * row, row % 3 ? 5 : 0);
	struct panorama_counts c = panorama_count(p);
	g_assert_cmpuint(c.measured, ==, 66);
	g_assert_cmpuint(c.no_return, ==, 33);
	g_assert_cmpuint(c.filled, ==, 0);
	g_assert_cmpuint(c.empty, ==, 750 * 198 - 99);
	g_assert_cmpfloat(fabs(panorama_column_coverage(p, 4) - 0.5), <, 1e-12);
	g_assert_cmpfloat(panorama_column_coverage(p, 5), ==, 0);
	panorama_fill(p, 4);
	g_assert_cmpfloat(fabs(panorama_column_coverage(p, 4) - 0.5), <, 1e-12);
	g_assert_cmpuint(panorama_count(p).filled, >, 60);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/panorama/horizon", test_horizon);
	g_test_add_func("/panorama/absurd", test_absurd);
	g_test_add_func("/panorama/offsets", test_offsets);
	g_test_add_func("/panorama/nearest-wins", test_nearest_wins);
	g_test_add_data_func("/panorama/any-order", NULL, test_any_order);
	g_test_add_data_func("/panorama/mean/any-order", "mean", test_any_order);
	for (size_t i = 0; i < G_N_ELEMENTS(cells); i++) {
		g_autofree char *path = g_strconcat("/panorama/mean/", cells[i].path, NULL);
		g_test_add_data_func(path, GSIZE_TO_POINTER(i), test_mean);
	}
	g_test_add_func("/panorama/mean/slant", test_mean_of_slant);
	g_test_add_func("/panorama/seam", test_seam);
	g_test_add_func("/panorama/outside", test_outside);
	g_test_add_func("/panorama/odd-ranges", test_odd_ranges);
	for (size_t i = 0; i < G_N_ELEMENTS(gaps); i++) {
		g_autofree char *path = g_strconcat("/panorama/fill/", gaps[i].path, NULL);
		g_test_add_data_func(path, &gaps[i], test_gap);
	}
	g_test_add_func("/panorama/fill/seam", test_fill_seam);
	g_test_add_func("/panorama/fill/plane", test_fill_plane);
	g_test_add_func("/panorama/fill/twice", test_fill_twice);
	g_test_add_func("/panorama/point", test_point);
	g_test_add_func("/panorama/counts", test_counts);
	return g_test_run();
}
