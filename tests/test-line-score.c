/* What counts as an edge when profile lines are held against the truth. */
#include "process/line-score.h"
#include "process/profile-lines.h"
#include <math.h>
#include <string.h>

enum { COLUMNS = 3000, ROWS = 400, ACROSS = 60, FRONTS = 8 };
#define LOWEST_RAD  0.35
#define HIGHEST_RAD 0.70
#define NEAREST_M   10.0
#define BACK_M      0.3

static struct bench_truth_scan new_panorama(void)
{
	struct bench_truth_scan s = { .elevation_max_rad = HIGHEST_RAD,
		.elevation_min_rad = LOWEST_RAD,
		.columns = COLUMNS,
		.rows = ROWS };
	s.cell = g_new0(struct bench_truth_cell, (size_t)COLUMNS * ROWS);
	for (int k = 0; k < 3; k++)
		s.pose.rotation[k][k] = 1;
	return s;
}

/* So far away, upright and facing the station, in a column to either side of home. */
static void set_cell(struct bench_truth_scan *s, uint32_t row, int column, double away_m,
	enum bench_truth_class class, uint8_t optics, uint16_t instance)
{
	double azimuth = (column + 0.5) * 2 * G_PI / COLUMNS,
	       elevation = HIGHEST_RAD - (row + 0.5) * (HIGHEST_RAD - LOWEST_RAD) / ROWS;
	struct bench_truth_cell *c =
		&s->cell[(size_t)row * COLUMNS + (size_t)((column + COLUMNS) % COLUMNS)];
	*c = (struct bench_truth_cell){
		.range_m = (float)(away_m / cos(azimuth) / cos(elevation)),
		.normal = { 0, -1, 0 },
		.instance = instance,
		.class = (uint8_t) class,
		.optics = optics,
	};
}

/* How much the beam rises on its way to a front, in how far that is away. */
static double rise_of(uint32_t row, int column)
{
	return tan(HIGHEST_RAD - (row + 0.5) * (HIGHEST_RAD - LOWEST_RAD) / ROWS) /
	       cos((column + 0.5) * 2 * G_PI / COLUMNS);
}

/* Fronts of one roof, each above and behind the last, with nothing to be seen between. */
static struct line_score score_fronts(double high_m)
{
	struct bench_truth_scan s = new_panorama();
	const double step = high_m / NEAREST_M, lowest = tan(LOWEST_RAD) + 0.02;
	for (uint32_t row = 0; row < ROWS; row++)
		for (int column = -ACROSS; column < ACROSS; column++) {
			int front = (int)floor((rise_of(row, column) - lowest) / step);
			if (front >= 0 && front < FRONTS)
				set_cell(&s, row, column, NEAREST_M + BACK_M * front,
					BENCH_TRUTH_BUILDING, 0, 1);
		}
	g_autoptr(line_truth) t = line_truth_new();
	g_autoptr(profile_lines) none = profile_lines_new();
	struct line_score score;
	line_truth_add(t, &s, NULL, COLUMNS);
	line_score_make(t, none, &s.pose, &score);
	g_free(s.cell);
	return score;
}

/* Where a front ends there is an edge if it is as high as faces are, however many stand in a row. */
static void test_faces(void)
{
	struct line_score low = score_fronts(0.04), high = score_fronts(0.15);
	g_test_message("%u edges of %.1f m of low fronts, %u of %.1f m of high ones", low.edges,
		low.edges_m, high.edges, high.edges_m);
	g_assert_cmpuint(low.edges, ==, 0);
	g_assert_cmpuint(high.edges, ==, FRONTS + 1); /* and the lowest begins */
	double wide_m = 2 * NEAREST_M * tan(ACROSS * 2 * G_PI / COLUMNS);
	g_assert_cmpfloat(high.edges_m, >, (FRONTS + 1) * (wide_m - 0.1));
}

/* Through a pane a line may lie on an edge of what stands behind it. */
static void test_behind(void)
{
	struct bench_truth_scan seen = new_panorama(), behind = new_panorama();
	const double middle = tan((LOWEST_RAD + HIGHEST_RAD) / 2);
	for (uint32_t row = 0; row < ROWS; row++)
		for (int column = -ACROSS; column < ACROSS; column++) {
			bool is_upper = rise_of(row, column) > middle;
			set_cell(&seen, row, column, NEAREST_M, BENCH_TRUTH_BUILDING,
				BENCH_TRUTH_GLASS, 1);
			set_cell(&behind, row, column, NEAREST_M + (is_upper ? 2 : 1),
				BENCH_TRUTH_BUILDING, 0, 2);
		}
	g_autoptr(profile_lines) lines = profile_lines_new();
	struct profile_line line = { .count = 2, .length_m = 2 };
	for (int n = 0; n < 2; n++) {
		struct profile_vertex v = { .at_m = { (float)(2 * n - 1), (float)NEAREST_M + 1,
						    (float)(middle * (NEAREST_M + 1)) } };
		g_array_append_val(lines->vertex, v);
	}
	g_array_append_val(lines->line, line);
	for (int looks = 0; looks < 2; looks++) {
		g_autoptr(line_truth) t = line_truth_new();
		struct line_score score;
		line_truth_add(t, &seen, NULL, COLUMNS);
		if (looks)
			line_truth_add_behind(t, &seen, &behind);
		line_score_make(t, lines, &seen.pose, &score);
		g_assert_cmpfloat_with_epsilon(score.lines_m, 2, 1e-3);
		g_assert_cmpfloat_with_epsilon(score.astray_m, looks ? 0 : 2, 1e-3);
	}
	g_free(seen.cell);
	g_free(behind.cell);
}

/* A front that ends half way up, and lines along its upper edge, each from one part of its width to another. */
static double score_covered(const double (*part)[2], uint32_t lines)
{
	struct bench_truth_scan s = new_panorama();
	const double rise = tan((LOWEST_RAD + HIGHEST_RAD) / 2),
		     half_m = NEAREST_M * tan(ACROSS * 2 * G_PI / COLUMNS);
	for (uint32_t row = 0; row < ROWS; row++)
		for (int column = -ACROSS; column < ACROSS; column++)
			if (rise_of(row, column) < rise)
				set_cell(&s, row, column, NEAREST_M, BENCH_TRUTH_BUILDING, 0, 1);
	g_autoptr(profile_lines) all = profile_lines_new();
	for (uint32_t n = 0; n < lines; n++) {
		struct profile_line line = { .first = 2 * n, .count = 2 };
		for (int e = 0; e < 2; e++) {
			struct profile_vertex v = {
				.at_m = { (float)(half_m * (2 * part[n][e] - 1)), (float)NEAREST_M,
					(float)(rise * NEAREST_M) }
			};
			g_array_append_val(all->vertex, v);
		}
		g_array_append_val(all->line, line);
	}
	g_autoptr(line_truth) t = line_truth_new();
	struct line_score score;
	line_truth_add(t, &s, NULL, COLUMNS);
	line_score_make(t, all, &s.pose, &score);
	g_free(s.cell);
	/* Its sides are edges, too. */
	return score.covered_m / (2 * half_m);
}

/* Of all lines those two count that cover the most together, whichever comes first. */
static void test_covered(void)
{
	static const double cases[][4][2] = {
		{ { 0, 0.4 }, { -0.01, 1.01 } },
		{ { -0.01, 1.01 }, { 0, 0.4 } },
		{ { 0.2, 0.6 }, { -0.01, 0.5 }, { 0.5, 1.01 } },
		{ { 0, 0.3 }, { 0.3, 0.6 }, { 0.6, 0.9 } },
	};
	static const uint32_t lines[] = { 2, 2, 3, 3 };
	static const double covered[] = { 1, 1, 1, 0.6 };
	for (size_t n = 0; n < G_N_ELEMENTS(cases); n++) {
		double part = score_covered(cases[n], lines[n]);
		g_test_message("case %zu: %.3f", n, part);
		g_assert_cmpfloat_with_epsilon(part, covered[n], 0.03);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/line-score/faces", test_faces);
	g_test_add_func("/line-score/behind", test_behind);
	g_test_add_func("/line-score/covered", test_covered);
	return g_test_run();
}
