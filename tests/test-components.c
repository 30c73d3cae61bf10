/* What a gap separates, and what is too small: components of voxels. */
#include "process/components.h"
#include "tests/surfaces-made.h"

/* Boxes of 1 m in a row, the next one gap_m[i] further. */
static voxels *boxes_in_a_row(const double *gap_m, int gaps, double size_m)
{
	voxels *v = voxels_new(size_m);
	double x = 0.003;
	for (int i = 0; i <= gaps; i++) {
		double low[3] = { x, 0.003, 0.003 }, high[3] = { x + 1, 1.003, 1.003 };
		made_box(low, high, 0.02, made_into_voxels, v);
		x += 1 + (i < gaps ? gap_m[i] : 0);
	}
	voxels_finish(v);
	voxels_link(v, 1.6);
	return v;
}

static uint32_t count(const double *gap_m, int gaps, double size_m)
{
	g_autoptr(voxels) v = boxes_in_a_row(gap_m, gaps, size_m);
	g_autoptr(components) c = components_find(v, NULL, 0);
	return c->count;
}

/* A gap of two cells always separates, one of none never does: the octree's level decides. */
static void test_gap(void)
{
	static const double gap_m[3] = { 0.1, 0.5, 1.1 };
	g_assert_cmpuint(count(gap_m, 3, 0.05), ==, 4);
	g_assert_cmpuint(count(gap_m, 3, 0.125), ==, 3);
	g_assert_cmpuint(count(gap_m, 3, 0.5), ==, 2);
	g_assert_cmpuint(count(gap_m, 3, 2), ==, 1);
}

static void test_level(void)
{
	g_assert_cmpfloat(octree_cell_m(64, 0), ==, 64);
	g_assert_cmpfloat(octree_cell_m(64, 6), ==, 1);
	g_assert_cmpfloat(octree_cell_m(64, 9), ==, 0.125);
	g_assert_cmpfloat(octree_cell_m(64, 99), ==, octree_cell_m(64, 21));
	g_assert_cmpuint(octree_level(64, 1), ==, 6);
	g_assert_cmpuint(octree_level(64, 0.9), ==, 6);
	g_assert_cmpuint(octree_level(64, 0.125), ==, 9);
	g_assert_cmpuint(octree_level(64, 1000), ==, 0);
	g_assert_cmpuint(octree_level(64, 1e-12), ==, 21);
	for (unsigned level = 0; level <= 21; level++)
		g_assert_cmpuint(octree_level(70, octree_cell_m(70, level)), ==, level);
}

static void test_points_min(void)
{
	g_autoptr(voxels) v = voxels_new(0.2);
	for (int i = 0; i < 3; i++) {
		double low[3] = { 3.0 * i, 0, 0 }, high[3] = { 3.0 * i + 0.5 * (i + 1), 1, 1 };
		made_box(low, high, 0.1, made_into_voxels, v);
	}
	voxels_finish(v);
	voxels_link(v, 1);
	/* 400, 600 and 800 points */
	static const uint32_t least[] = { 0, 400, 401, 600, 601, 800, 801 },
			      left[] = { 3, 3, 2, 2, 1, 1, 0 };
	for (size_t n = 0; n < G_N_ELEMENTS(least); n++) {
		g_autoptr(components) c = components_find(v, NULL, least[n]);
		uint64_t points = 0, in = 0;
		g_assert_cmpuint(c->count, ==, left[n]);
		for (uint32_t k = 0; k < c->count; k++)
			points += c->component[k].points;
		for (uint32_t i = 0; i < v->count; i++) {
			g_assert_true(c->of[i] < c->count || c->of[i] == VOXEL_NONE);
			in += c->of[i] < c->count ? v->voxel[i].points : 0;
		}
		g_assert_cmpuint(points, ==, in);
	}
}

static void test_kinds(void)
{
	static const double gap_m[1] = { 0 };
	g_autoptr(voxels) v = boxes_in_a_row(gap_m, 1, 0.1);
	g_autofree uint8_t *kind = g_new(uint8_t, v->count);
	for (uint32_t i = 0; i < v->count; i++)
		kind[i] = v->voxel[i].at[0] < 5 ? 0 : v->voxel[i].at[0] < 10 ? 1 : 2;
	g_autoptr(components) c = components_find(v, kind, 0);
	g_assert_cmpuint(c->count, ==, 2);
	for (uint32_t i = 0; i < v->count; i++)
		g_assert_true((c->of[i] == VOXEL_NONE) == (kind[i] == 0));
}

/* Of a box of 1 x 2 x 3 m, all faces: its middle, its corners, and how far it spreads. */
static void test_measures(void)
{
	g_autoptr(voxels) v = voxels_new(0.1);
	static const double low[3] = { 10, 20, -3 }, high[3] = { 11, 22, 0 };
	made_box(low, high, 0.05, made_into_voxels, v);
	voxels_finish(v);
	voxels_link(v, 1);
	g_autoptr(components) c = components_find(v, NULL, 0);
	g_assert_cmpuint(c->count, ==, 1);
	for (int k = 0; k < 3; k++) {
		g_assert_cmpfloat(
			fabs(c->component[0].centre_m[k] - (low[k] + high[k]) / 2), <, 0.05);
		g_assert_cmpfloat(fabs(c->component[0].low_m[k] - low[k]), <, 0.1);
		g_assert_cmpfloat(fabs(c->component[0].high_m[k] - high[k]), <, 0.1);
	}
	const double *m = c->component[0].covariance_m2;
	g_assert_true(m[0] > 0 && m[0] < m[3] && m[3] < m[5]);
	g_assert_cmpfloat(fabs(m[1]) + fabs(m[2]) + fabs(m[4]), <, 0.05);
}

static void test_empty(void)
{
	g_autoptr(voxels) v = voxels_new(1);
	voxels_finish(v);
	voxels_link(v, 1);
	g_autoptr(components) c = components_find(v, NULL, 0);
	g_assert_cmpuint(c->count, ==, 0);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/components/gap", test_gap);
	g_test_add_func("/components/level", test_level);
	g_test_add_func("/components/points-min", test_points_min);
	g_test_add_func("/components/kinds", test_kinds);
	g_test_add_func("/components/measures", test_measures);
	g_test_add_func("/components/empty", test_empty);
	return g_test_run();
}
