/* Water among the ground: basins with banks, fields, locks, and decks over them. */
#include "process/water.h"
#include "tests/surfaces-made.h"

#define CELL_M  0.8
#define APART_M 0.25

static void take(const struct voxel_point *p, void *to)
{
	ground_add(to, p);
}

static void add_floor(ground *g, double x0, double y0, double x1, double y1, double z)
{
	made_floor((double[2]){ x0, y0 }, (double[2]){ x1, y1 }, z, APART_M, take, g);
}

/* A canal along x from -40 to 40, water between y -10 and 10 at z, banks of 50 % up to 0. */
static void add_canal(ground *g, double x0, double x1, double z)
{
	double run = -z / 0.5;
	add_floor(g, x0, -10, x1, 10, z);
	made_patch((double[3]){ x0, 10, z }, (double[3]){ x1 - x0, 0, 0 },
		(double[3]){ 0, run, -z }, APART_M, take, g);
	made_patch((double[3]){ x0, -10 - run, 0 }, (double[3]){ x1 - x0, 0, 0 },
		(double[3]){ 0, run, z }, APART_M, take, g);
	add_floor(g, x0, 10 + run, x1, 40, 0);
	add_floor(g, x0, -40, x1, -10 - run, 0);
}

struct place {
	ground *g;
	uint8_t *class;
};

static struct place look(ground *g, const double (*station_m)[3], size_t stations)
{
	ground_find(g, station_m, stations);
	return (struct place){ g, water_find(g, station_m, stations) };
}

static void clear(struct place *p)
{
	ground_free(p->g);
	g_free(p->class);
}

static int class_at(const struct place *p, double x, double y, double z)
{
	uint32_t i = voxels_find_point(ground_surfels(p->g), (double[3]){ x, y, z });
	g_assert_true(i != VOXEL_NONE && ground_is(p->g, i));
	return p->class[i];
}

static double share_of(const struct place *p, int class)
{
	double all = 0, of = 0;
	for (uint32_t i = 0; i < ground_surfels(p->g)->count; i++)
		if (ground_is(p->g, i)) {
			all++;
			of += p->class[i] == class;
		}
	return of / all;
}

static void test_basin(void)
{
	ground *g = ground_new(CELL_M);
	add_canal(g, -40, 40, -1.6);
	struct place p = look(g, NULL, 0);
	for (double x = -38; x < 39; x += 3)
		for (double y = -8.5; y < 9; y += 1.7)
			g_assert_cmpint(class_at(&p, x, y, -1.6), ==, CLASS_WATER);
	g_assert_cmpint(class_at(&p, 0, 30, 0), ==, CLASS_TERRAIN);
	g_assert_cmpint(class_at(&p, 0, 12, -0.6), ==, CLASS_TERRAIN);
	g_assert_cmpfloat(share_of(&p, CLASS_WATER), <, 0.29);
	g_assert_cmpfloat(share_of(&p, CLASS_STRUCTURE), ==, 0);
	clear(&p);
}

static void test_field(void)
{
	ground *g = ground_new(CELL_M);
	add_floor(g, -40, -40, 40, 40, 2);
	struct place p = look(g, NULL, 0);
	g_assert_cmpfloat(share_of(&p, CLASS_TERRAIN), ==, 1);
	clear(&p);
	/* one that a ditch runs along, lower than it */
	g = ground_new(CELL_M);
	add_floor(g, -40, -40, 40, 40, 2);
	made_patch((double[3]){ -40, 40, 2 }, (double[3]){ 80, 0, 0 }, (double[3]){ 0, 6, -1.2 },
		APART_M, take, g);
	p = look(g, NULL, 0);
	g_assert_cmpfloat(share_of(&p, CLASS_TERRAIN), ==, 1);
	clear(&p);
}

/* A puddle of 15 x 15 m is less than the area asked for. */
static void test_too_small(void)
{
	ground *g = ground_new(CELL_M);
	add_floor(g, -7, -7, 7, 7, -1);
	for (int k = 0; k < 4; k++) {
		double c = (k == 0) - (k == 2), s = (k == 1) - (k == 3);
		double corner[3] = { -7 * c + 7 * s, -7 * s - 7 * c, -1 };
		made_patch(corner, (double[3]){ 14 * c, 14 * s, 0 },
			(double[3]){ 5 * s, -5 * c, 1 }, APART_M, take, g);
	}
	struct place p = look(g, NULL, 0);
	g_assert_cmpfloat(share_of(&p, CLASS_WATER), ==, 0);
	clear(&p);
}

/* What someone stood a tripod on is a sunken square. */
static void test_tripod(void)
{
	const double stations[2][3] = { { 0, 0, 0.1 }, { 0, 30, 1.7 } };
	ground *g = ground_new(CELL_M);
	add_canal(g, -40, 40, -1.6);
	struct place p = look(g, stations, 2);
	g_assert_cmpfloat(share_of(&p, CLASS_TERRAIN), ==, 1);
	clear(&p);
	g = ground_new(CELL_M);
	add_canal(g, -40, 40, -1.6);
	p = look(g, stations + 1, 1); /* on the bank */
	g_assert_cmpint(class_at(&p, 0, 0, -1.6), ==, CLASS_WATER);
	clear(&p);
}

/* Two reaches, the upper half a metre above the lower one: it drops to water alone. */
static void test_lock(void)
{
	ground *g = ground_new(CELL_M);
	add_canal(g, -40, 0, -1.6);
	add_canal(g, 0, 40, -1.1);
	struct place p = look(g, NULL, 0);
	g_assert_cmpint(class_at(&p, -20, 0, -1.6), ==, CLASS_WATER);
	g_assert_cmpint(class_at(&p, 20, 0, -1.1), ==, CLASS_WATER);
	clear(&p);
}

/* A bridge of 6 m, 2.6 m above the water, is a structure; the roads to it are terrain. */
static void test_deck(void)
{
	ground *g = ground_new(CELL_M);
	add_canal(g, -40, -3, -2.4);
	add_canal(g, 3, 40, -2.4);
	add_floor(g, -3, -40, 3, 40, 0.1);
	struct place p = look(g, NULL, 0);
	g_assert_cmpint(class_at(&p, -20, 0, -2.4), ==, CLASS_WATER);
	g_assert_cmpint(class_at(&p, 20, 0, -2.4), ==, CLASS_WATER);
	for (double y = -8; y < 9; y += 2)
		g_assert_cmpint(class_at(&p, 0, y, 0.1), ==, CLASS_STRUCTURE);
	g_assert_cmpint(class_at(&p, 0, 36, 0.1), ==, CLASS_TERRAIN);
	g_assert_cmpint(class_at(&p, 0, -36, 0.1), ==, CLASS_TERRAIN);
	clear(&p);
}

static void test_none(void)
{
	struct place p = look(ground_new(CELL_M), NULL, 0);
	g_assert_nonnull(p.class);
	clear(&p);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/water/basin", test_basin);
	g_test_add_func("/water/field", test_field);
	g_test_add_func("/water/too-small", test_too_small);
	g_test_add_func("/water/tripod", test_tripod);
	g_test_add_func("/water/lock", test_lock);
	g_test_add_func("/water/deck", test_deck);
	g_test_add_func("/water/none", test_none);
	return g_test_run();
}
