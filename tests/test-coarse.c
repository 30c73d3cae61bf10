#include "process/coarse.h"
#include "tests/placed-scans.h"
#include <math.h>
#include <string.h>

#define CANDIDATES 12

static const struct placed *station_of(const char *scene, int number)
{
	g_autofree char *what = g_strdup_printf("%s?seed=9&station=%d", scene, number);
	return placed_scan(what);
}

static bool is_near(const struct pose *a, const struct pose *b, double metres, double degrees)
{
	struct pose between = pose_between(a, b);
	return pose_distance_m(&between) < metres &&
	       pose_angle_rad(&between) < degrees * G_PI / 180;
}

static void assert_in_order(const struct coarse_candidate *c, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		g_assert_true(pose_is_rigid(&c[i].pose, 1e-9));
		g_assert_cmpfloat(c[i].score, >=, 0);
		g_assert_cmpfloat(c[i].score, <=, 1);
		for (size_t k = 0; k < i; k++) {
			g_assert_cmpfloat(c[i].score, <=, c[k].score);
			g_assert_false(is_near(&c[i].pose, &c[k].pose, 0.5, 3));
		}
	}
}

/* The rank of the truth among the candidates, from 0; -1: it is not there. */
static int rank_of(const range_grid *a, const range_grid *b, const struct pose *expected,
	const struct coarse_options *options)
{
	g_autoptr(coarse_scan) scan_a = coarse_scan_new(a);
	g_autoptr(coarse_scan) scan_b = coarse_scan_new(b);
	struct coarse_candidate c[CANDIDATES];
	size_t count = coarse_align(scan_a, scan_b, options, c, CANDIDATES);
	g_assert_cmpuint(count, <=, CANDIDATES);
	assert_in_order(c, count);
	for (size_t i = 0; i < count; i++)
		if (is_near(&c[i].pose, expected, 0.3, 1.5))
			return (int)i;
	return -1;
}

struct pair {
	const char *scene;
	int a, b;
};

static void test_finds(gconstpointer data)
{
	const struct pair *p = data;
	const struct placed *a = station_of(p->scene, p->a), *b = station_of(p->scene, p->b);
	struct pose expected = pose_between(&a->pose, &b->pose);
	int rank = rank_of(a->grid, b->grid, &expected, NULL);
	g_test_message("stations %.1f m apart: rank %d", pose_distance_m(&expected), rank);
	g_assert_cmpint(rank, >=, 0);
	g_assert_cmpint(rank, <, 4); /* halls look alike from both ends */
}

static void test_finds_the_other_way(void)
{
	const struct placed *a = station_of("court", 2), *b = station_of("court", 1);
	struct pose expected = pose_between(&a->pose, &b->pose);
	g_assert_cmpint(rank_of(a->grid, b->grid, &expected, NULL), ==, 0);
}

/* ---- not level ---- */

/* The scan as a scanner would have made it that lay otherwise: same beams, other axes. */
static range_grid *turned(const range_grid *g, const struct pose *turn)
{
	size_t n = range_grid_cells(g);
	g_autofree double *plane = g_new(double, 3 * n);
	for (size_t i = 0; i < n; i++) {
		double p[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		pose_apply(turn, p, p);
		for (int k = 0; k < 3; k++)
			plane[k * n + i] = p[k];
	}
	struct range_grid_desc desc = { .columns = g->columns,
		.rows = g->rows,
		.x_m = plane,
		.y_m = plane + n,
		.z_m = plane + 2 * n,
		.cell = g->cell };
	g_autoptr(GError) error = NULL;
	range_grid *ret = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	return ret;
}

static void test_finds_turned(gconstpointer data)
{
	/* Overhead and on its side; the other leaning a little and turned by much. */
	static const double twists[2][2][6] = { { { 3.1, 0, 0 }, { 0, 1.6, 0 } },
		{ { 0.1, -0.15, 0.5 }, { -2, 0.9, 0.3 } } };
	const struct pair *p = data;
	const struct placed *a = station_of(p->scene, p->a), *b = station_of(p->scene, p->b);
	struct coarse_options options = { .not_level = true };
	for (int i = 0; i < 2; i++) {
		struct pose turn_a = pose_perturb(&POSE_IDENTITY, twists[i][0]),
			    turn_b = pose_perturb(&POSE_IDENTITY, twists[i][1]);
		g_autoptr(range_grid) grid_a = turned(a->grid, &turn_a);
		g_autoptr(range_grid) grid_b = turned(b->grid, &turn_b);
		struct pose from_a = pose_inverse(&turn_a), from_b = pose_inverse(&turn_b);
		struct pose place_a = pose_compose(&a->pose, &from_a),
			    place_b = pose_compose(&b->pose, &from_b);
		struct pose expected = pose_between(&place_a, &place_b);
		int rank = rank_of(grid_a, grid_b, &expected, &options);
		g_test_message("turned %d: rank %d", i, rank);
		g_assert_cmpint(rank, >=, 0);
		g_assert_cmpint(rank, <, 4);
	}
}

/* ---- what else is promised ---- */

static void test_same_again(void)
{
	const struct placed *a = station_of("court", 1), *b = station_of("court", 2);
	struct coarse_candidate c[2][CANDIDATES];
	size_t count[2];
	memset(c, 0, sizeof c);
	for (int i = 0; i < 2; i++) {
		g_autoptr(coarse_scan) scan_a = coarse_scan_new(a->grid);
		g_autoptr(coarse_scan) scan_b = coarse_scan_new(b->grid);
		count[i] = coarse_align(scan_a, scan_b, NULL, c[i], CANDIDATES);
	}
	g_assert_cmpuint(count[0], ==, count[1]);
	g_assert_cmpint(memcmp(c[0], c[1], sizeof c[0]), ==, 0);
}

static void test_keeps_to_limits(void)
{
	const struct placed *a = station_of("court", 1), *b = station_of("court", 2);
	g_autoptr(coarse_scan) scan_a = coarse_scan_new(a->grid);
	g_autoptr(coarse_scan) scan_b = coarse_scan_new(b->grid);
	struct coarse_options options = { .distance_max_m = 4 };
	struct coarse_candidate c[CANDIDATES], one[2] = { { .score = 7 }, { .score = 7 } };
	size_t count = coarse_align(scan_a, scan_b, &options, c, CANDIDATES);
	for (size_t i = 0; i < count; i++)
		g_assert_cmpfloat(pose_distance_m(&c[i].pose), <=, 4);
	g_assert_cmpuint(coarse_align(scan_a, scan_b, NULL, one, 0), ==, 0);
	g_assert_cmpfloat(one[0].score, ==, 7);
	g_assert_cmpuint(coarse_align(scan_a, scan_b, NULL, one, 1), ==, 1);
	g_assert_cmpfloat(one[1].score, ==, 7);
}

/* Two places that have nothing to do with each other: whatever is proposed scores below what is true. */
static void test_strangers(void)
{
	const struct placed *a = station_of("court", 1), *near = station_of("court", 2),
			    *other = station_of("bridge", 1);
	g_autoptr(coarse_scan) scan_a = coarse_scan_new(a->grid);
	g_autoptr(coarse_scan) scan_near = coarse_scan_new(near->grid);
	g_autoptr(coarse_scan) scan_other = coarse_scan_new(other->grid);
	struct coarse_candidate truth_c[CANDIDATES], c[CANDIDATES];
	g_assert_cmpuint(coarse_align(scan_a, scan_near, NULL, truth_c, CANDIDATES), >, 0);
	size_t count = coarse_align(scan_a, scan_other, NULL, c, CANDIDATES);
	assert_in_order(c, count);
	g_test_message("true pair %.3f, strangers %.3f", truth_c[0].score, count ? c[0].score : 0);
	if (count)
		g_assert_cmpfloat(c[0].score, <, truth_c[0].score - 0.15);
}

static range_grid *few_points(uint32_t columns, uint32_t rows, uint32_t measured)
{
	size_t n = (size_t)columns * rows;
	g_autofree double *plane = g_new0(double, 3 * n);
	g_autofree uint8_t *cell = g_malloc0(n);
	for (uint32_t i = 0; i < n; i++) {
		double azimuth = 0.1 * (i % columns), elevation = 0.3 - 0.1 * (i / columns);
		cell[i] = i < measured ? CELL_MEASURED : CELL_NO_RETURN;
		plane[i] = 5 * cos(elevation) * sin(azimuth);
		plane[n + i] = 5 * cos(elevation) * cos(azimuth);
		plane[2 * n + i] = 5 * sin(elevation);
	}
	struct range_grid_desc desc = { columns, rows, plane, plane + n, plane + 2 * n, cell };
	g_autoptr(GError) error = NULL;
	range_grid *g = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	return g;
}

static void test_hardly_anything(void)
{
	static const uint32_t sizes[][3] = { { 2, 2, 4 }, { 12, 9, 108 }, { 40, 3, 100 } };
	const struct placed *a = station_of("court", 1);
	g_autoptr(coarse_scan) whole = coarse_scan_new(a->grid);
	for (size_t i = 0; i < G_N_ELEMENTS(sizes); i++) {
		g_autoptr(range_grid) g = few_points(sizes[i][0], sizes[i][1], sizes[i][2]);
		g_autoptr(coarse_scan) few = coarse_scan_new(g);
		for (int level = 0; level < 2; level++) {
			struct coarse_options options = { .not_level = !level };
			struct coarse_candidate c[CANDIDATES];
			assert_in_order(c, coarse_align(few, few, &options, c, CANDIDATES));
			assert_in_order(c, coarse_align(whole, few, &options, c, CANDIDATES));
		}
	}
}

static void test_nothing_seen(void)
{
	struct panorama_desc desc = panorama_desc_for(75, 20);
	g_autoptr(GError) error = NULL;
	g_autoptr(panorama) p = panorama_new(&desc, &error);
	g_assert_no_error(error);
	g_autoptr(range_grid) g = range_grid_from_panorama(p);
	g_autoptr(coarse_scan) s = coarse_scan_new(g);
	struct coarse_candidate c[CANDIDATES];
	struct coarse_options options = { .not_level = true };
	g_assert_cmpuint(coarse_align(s, s, NULL, c, CANDIDATES), ==, 0);
	g_assert_cmpuint(coarse_align(s, s, &options, c, CANDIDATES), ==, 0);
}

int main(int argc, char **argv)
{
	static const struct pair court = { "court", 1, 2 }, street = { "street", 1, 2 },
				 bridge = { "bridge", 1, 2 }, hall = { "hall", 1, 2 };
	g_test_init(&argc, &argv, NULL);
	g_test_add_data_func("/coarse/finds/court", &court, test_finds);
	g_test_add_data_func("/coarse/finds/street", &street, test_finds);
	g_test_add_data_func("/coarse/finds/bridge", &bridge, test_finds);
	g_test_add_data_func("/coarse/finds/hall", &hall, test_finds);
	g_test_add_func("/coarse/finds/other-way", test_finds_the_other_way);
	g_test_add_data_func("/coarse/turned/court", &court, test_finds_turned);
	g_test_add_data_func("/coarse/turned/hall", &hall, test_finds_turned);
	g_test_add_func("/coarse/same-again", test_same_again);
	g_test_add_func("/coarse/limits", test_keeps_to_limits);
	g_test_add_func("/coarse/strangers", test_strangers);
	g_test_add_func("/coarse/hardly-anything", test_hardly_anything);
	g_test_add_func("/coarse/nothing-seen", test_nothing_seen);
	return g_test_run();
}
