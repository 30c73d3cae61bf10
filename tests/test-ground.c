/* The ground under made places: slopes, kerbs, stairs, bridges, what walls hide, and what is none of it. */
#include "process/ground.h"
#include "tests/surfaces-made.h"

#define CELL_M  0.3
#define APART_M 0.07

static void take(const struct voxel_point *p, void *to)
{
	ground_add(to, p);
}

static void add_floor(ground *g, double x0, double y0, double x1, double y1, double z)
{
	made_floor((double[2]){ x0, y0 }, (double[2]){ x1, y1 }, z, APART_M, take, g);
}

/* Upright, from one place of the plan to another. */
static void add_wall(ground *g, double x0, double y0, double x1, double y1, double z0, double z1)
{
	made_patch((double[3]){ x0, y0, z0 }, (double[3]){ x1 - x0, y1 - y0, 0 },
		(double[3]){ 0, 0, z1 - z0 }, APART_M, take, g);
}

static void find_from(ground *g, double x, double y, double z)
{
	const double station[1][3] = { { x, y, z } };
	ground_find(g, station, 1);
}

static float height(const ground *g, double x, double y, double z)
{
	return ground_height_m(g, (double[3]){ x, y, z });
}

static void assert_height(const ground *g, double x, double y, double z, double wanted_m)
{
	float got = height(g, x, y, z);
	if (!(fabs(got - wanted_m) < 0.04))
		g_test_message("at %g %g %g: %g m, but %g is wanted", x, y, z, got, wanted_m);
	g_assert_true(fabs(got - wanted_m) < 0.04);
}

/* Whether the surfel there is ground. */
static bool is_at(const ground *g, double x, double y, double z)
{
	uint32_t i = voxels_find_point(ground_surfels(g), (double[3]){ x, y, z });
	return i != VOXEL_NONE && ground_is(g, i);
}

static void test_level(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, -8, -8, 8, 8, 0.05);
	find_from(g, 0, 0, 1.7);
	assert_height(g, 3, 3, 2.05, 2);
	assert_height(g, -7, 5, -0.05, -0.1);
	g_assert_true(ground_is_seen(g, (double[3]){ 7, 7, 0 }));
	g_assert_false(ground_is_seen(g, (double[3]){ 11, 7, 0 }));
	assert_height(g, 11, 7, 1.05, 1); /* from what is nearest */
	g_assert_true(isinf(ground_above_m(g, (double[3]){ 0, 0, 0 })));
	uint32_t top = ground_top(g, (double[2]){ 2, 2 });
	g_assert_true(top != VOXEL_NONE && ground_is(g, top));
	g_assert_cmpuint(ground_top(g, (double[2]){ 20, 2 }), ==, VOXEL_NONE);
}

/* 25 %, and heights are exact between the columns' middles. */
static void test_slope(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	made_patch((double[3]){ -12, -6, -3 }, (double[3]){ 24, 0, 6 }, (double[3]){ 0, 12, 0 },
		APART_M, take, g);
	find_from(g, 0, 0, 1.7);
	for (double x = -11; x < 11; x += 0.37)
		assert_height(g, x, 2 * sin(x), 0.25 * x + 0.5, 0.5);
}

static void test_kerb(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, -6, -6, 0, 6, 0);
	add_wall(g, 0, -6, 0, 6, 0, 0.13);
	add_floor(g, 0, -6, 6, 6, 0.13);
	find_from(g, -3, 0, 1.7);
	assert_height(g, -4, 1, 1, 1);
	assert_height(g, 4, 1, 1.13, 1);
}

/* Twelve steps of 17 cm to a terrace. */
static void test_stairs(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, -5, -3, 0, 3, 0);
	for (int i = 0; i < 12; i++) {
		add_wall(g, 0.3 * i, 3, 0.3 * i, -3, 0.17 * i, 0.17 * (i + 1));
		add_floor(g, 0.3 * i, -3, 0.3 * (i + 1), 3, 0.17 * (i + 1));
	}
	add_floor(g, 3.6, -3, 9, 3, 2.04);
	find_from(g, -3, 0, 1.7);
	g_assert_true(is_at(g, 6, 0, 2.04));
	assert_height(g, 6, 0, 3.04, 1);
	float half = height(g, 1.8, 0, 6 * 0.17 + 1);
	g_assert_cmpfloat(half, >, 0.7);
	g_assert_cmpfloat(half, <, 1.3);
}

/* A wall of 2 m is no step: what is on top of it is none, with a station below. */
static void test_platform(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, -6, -6, 0, 6, 0);
	add_wall(g, 0, 6, 0, -6, 0, 2);
	add_floor(g, 0, -6, 6, 6, 2);
	find_from(g, -3, 0, 1.7);
	g_assert_true(is_at(g, -3, 0, 0));
	g_assert_false(is_at(g, 3, 0, 2));
}

/* One walks over it and under it. */
static void test_bridge(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, -20, -10, 20, 10, 0);
	/* a ramp of 20 %, a deck 4 m up */
	made_patch((double[3]){ -20, -2, 0 }, (double[3]){ 20, 0, 4 }, (double[3]){ 0, 4, 0 },
		APART_M, take, g);
	add_floor(g, 0, -2, 14, 2, 4);
	find_from(g, -18, 6, 1.7);
	assert_height(g, 7, 0, 1, 1);
	assert_height(g, 7, 0, 5, 1);
	assert_height(g, 7, 6, 5, 5);
	g_assert_cmpfloat(fabs(ground_above_m(g, (double[3]){ 7, 0, 1 }) - 3), <, 0.05);
	g_assert_true(isinf(ground_above_m(g, (double[3]){ 7, 0, 5 })));
	g_assert_true(isinf(ground_above_m(g, (double[3]){ 7, 6, 1 })));
	uint32_t below = ground_surfel(g, (double[3]){ 7, 0, 1 }),
		 deck = ground_surfel(g, (double[3]){ 7, 0, 4.5 });
	g_assert_cmpuint(below, !=, deck);
	g_assert_cmpuint(ground_top(g, (double[2]){ 7, 0 }), ==, deck);
}

/* A yard behind a high wall, seen over it; beside it a roof, which is none. */
static void test_behind_a_wall(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, -10, -10, 0, 10, 0);
	add_wall(g, 0, 10, 0, -10, 0, 2.5);
	add_floor(g, 4, -8, 12, 0, 0.15);
	add_floor(g, 4, 2, 12, 10, 3.5);
	find_from(g, -5, 0, 1.7);
	g_assert_true(is_at(g, 8, -4, 0.15));
	g_assert_false(is_at(g, 8, 6, 3.5));
	assert_height(g, 8, -4, 1.15, 1);
}

/* A table of 1 x 2 m stands on it; a low bench as well. */
static void test_table(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, -6, -6, 6, 6, 0);
	add_floor(g, 2, 1, 3, 3, 0.74);
	add_floor(g, -4, 1, -3.5, 3, 0.45);
	find_from(g, 0, 0, 1.7);
	g_assert_false(is_at(g, 2.5, 2, 0.74));
	g_assert_false(is_at(g, -3.7, 2, 0.45));
	assert_height(g, 2.5, 2, 0.74, 0.74);
	assert_height(g, -3.7, 2, 0.45, 0.45);
}

/* Nobody knows where scanners stood: an aerial scan of fields with a house. */
static void test_without_stations(void)
{
	g_autoptr(ground) g = ground_new(1);
	double apart = 0.3;
	made_floor((double[2]){ -60, -60 }, (double[2]){ 60, 60 }, 12, apart, take, g);
	made_floor((double[2]){ 10, 10 }, (double[2]){ 22, 30 }, 19, apart, take, g);
	ground_find(g, NULL, 0);
	assert_height(g, -40, -40, 13, 1);
	assert_height(g, 30, -20, 13, 1);
	assert_height(g, 16, 20, 19, 7);
	g_assert_false(is_at(g, 16, 20, 19));
}

/* A tripod that stands on nothing that faces up is as good as none. */
static void test_station_without_ground(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_floor(g, 6, -6, 14, 6, 0);
	find_from(g, -6, 0, 1.7);
	assert_height(g, 8, 0, 1, 1);
}

static void test_none(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	add_wall(g, 0, 10, 0, -10, 0, 2.5);
	find_from(g, -5, 0, 1.7);
	g_assert_true(isnan(height(g, 0, 0, 0)));
	g_assert_cmpuint(ground_surfel(g, (double[3]){ 0, 0, 0 }), ==, VOXEL_NONE);
	g_assert_cmpuint(ground_top(g, (double[2]){ 0, 0 }), ==, VOXEL_NONE);
	g_assert_true(isinf(ground_above_m(g, (double[3]){ 0, 0, 0 })));
	g_assert_false(ground_is_seen(g, (double[3]){ 0, 0, 0 }));
	g_autoptr(ground) empty = ground_new(CELL_M);
	ground_find(empty, NULL, 0);
	g_assert_true(isnan(height(empty, 0, 0, 0)));
}

/* Leaves face anywhere, some of them up. */
static void test_shrub(void)
{
	g_autoptr(ground) g = ground_new(CELL_M);
	g_autoptr(GRand) chance = g_rand_new_with_seed(5);
	add_floor(g, -6, -6, 1.2, 6, 0);
	for (int i = 0; i < 20000; i++) {
		double at[3], n[3], length;
		for (int k = 0; k < 3; k++) {
			at[k] = g_rand_double_range(chance, k < 2 ? -1.5 : 0, k < 2 ? 1.5 : 0.5);
			n[k] = g_rand_double_range(chance, -1, 1);
		}
		length = made_length(n);
		at[0] += 3;
		for (int k = 0; k < 3; k++)
			n[k] /= length;
		made_point(at, n, APART_M, take, g);
	}
	find_from(g, -3, 0, 1.7);
	g_assert_true(is_at(g, -3, 0, 0));
	for (double x = 1.8; x < 4.4; x += 0.2)
		for (double z = 0.05; z < 0.5; z += 0.2)
			g_assert_false(is_at(g, x, 0, z));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/ground/level", test_level);
	g_test_add_func("/ground/slope", test_slope);
	g_test_add_func("/ground/kerb", test_kerb);
	g_test_add_func("/ground/stairs", test_stairs);
	g_test_add_func("/ground/platform", test_platform);
	g_test_add_func("/ground/bridge", test_bridge);
	g_test_add_func("/ground/behind-a-wall", test_behind_a_wall);
	g_test_add_func("/ground/table", test_table);
	g_test_add_func("/ground/without-stations", test_without_stations);
	g_test_add_func("/ground/station-without-ground", test_station_without_ground);
	g_test_add_func("/ground/none", test_none);
	g_test_add_func("/ground/shrub", test_shrub);
	return g_test_run();
}
