/* Smooth regions of boxes, a ball and stairs. */
#include "process/smooth-regions.h"
#include "tests/surfaces-made.h"

static smooth_regions *grow(voxels *v, const uint8_t *skip, const struct smooth_options *options)
{
	voxels_finish(v);
	voxels_link(v, 1.6);
	return smooth_regions_grow(v, skip, options);
}

static uint32_t larger_than(const smooth_regions *r, uint32_t size)
{
	uint32_t found = 0;
	for (uint32_t k = 0; k < r->count; k++)
		found += r->region[k].voxels > size;
	return found;
}

/* Each face of a box is one region; only at the edges, where normals differ in a voxel, is anything else. */
static void test_box(void)
{
	static const double low[3] = { 0.07, 0.07, 0.07 }, high[3] = { 4.07, 3.07, 2.07 };
	g_autoptr(voxels) v = voxels_new(0.15);
	made_box(low, high, 0.03, made_into_voxels, v);
	g_autoptr(smooth_regions) r = grow(v, NULL, NULL);
	unsigned faces = 0;
	g_assert_cmpuint(larger_than(r, 40), ==, 6);
	for (uint32_t k = 0; k < r->count; k++) {
		const struct smooth_region *s = &r->region[k];
		if (s->voxels <= 40)
			continue;
		for (int a = 0; a < 3; a++) {
			if (fabs(s->normal[a]) < 0.9)
				continue;
			faces |= 1u << (2 * a + (s->normal[a] > 0));
			double at = s->normal[a] > 0 ? high[a] : low[a];
			g_assert_cmpfloat(fabs(s->low_m[a] - at), <, 0.01);
			g_assert_cmpfloat(fabs(s->high_m[a] - at), <, 0.01);
			g_assert_cmpfloat(fabs(s->centre_m[a] - at), <, 0.01);
		}
	}
	g_assert_cmpuint(faces, ==, 63);
}

static void test_ball(void)
{
	static const double centre[3] = { 1, 2, 3 };
	g_autoptr(voxels) v = voxels_new(0.15);
	made_ball(centre, 2, 0.03, made_into_voxels, v);
	g_autoptr(smooth_regions) r = grow(v, NULL, NULL);
	g_assert_cmpuint(larger_than(r, 20), ==, 1);
	uint32_t in = 0;
	for (uint32_t k = 0; k < r->count; k++)
		in = MAX(in, r->region[k].voxels);
	g_assert_cmpfloat(in, >, 0.99 * v->count);
	/* a strict angle takes it apart */
	struct smooth_options strict = { .angle_deg = 2, .residual = 0.1f };
	g_autoptr(smooth_regions) parts = smooth_regions_grow(v, NULL, &strict);
	g_assert_cmpuint(parts->count, >, 20);
}

/* Four steps, 0.3 m high and 0.6 m deep: treads and risers, each one region. */
static void test_stairs(void)
{
	enum { STEPS = 4 };
	g_autoptr(voxels) v = voxels_new(0.05);
	for (int i = 0; i < STEPS; i++) {
		double riser[3] = { 0.6 * i + 0.02, 0.02, 0.3 * i + 0.02 },
		       tread[3] = { 0.6 * i + 0.02, 0.02, 0.3 * (i + 1) + 0.02 };
		made_patch(riser, (double[3]){ 0, 0, 0.3 }, (double[3]){ 0, 2, 0 }, 0.0125,
			made_into_voxels, v);
		made_patch(tread, (double[3]){ 0.6, 0, 0 }, (double[3]){ 0, 2, 0 }, 0.0125,
			made_into_voxels, v);
	}
	g_autoptr(smooth_regions) r = grow(v, NULL, NULL);
	unsigned up = 0, level = 0;
	for (uint32_t k = 0; k < r->count; k++) {
		if (r->region[k].voxels < 100)
			continue;
		up += r->region[k].normal[2] > 0.9;
		level += r->region[k].normal[0] < -0.9;
	}
	g_assert_cmpuint(up, ==, STEPS);
	g_assert_cmpuint(level, ==, STEPS);
}

static void test_skipped(void)
{
	g_autoptr(voxels) v = voxels_new(0.2);
	made_floor((double[2]){ 0, 0 }, (double[2]){ 4, 2 }, 0.1, 0.04, made_into_voxels, v);
	voxels_finish(v);
	voxels_link(v, 1.6);
	g_autofree uint8_t *skip = g_new0(uint8_t, v->count);
	for (uint32_t i = 0; i < v->count; i++)
		skip[i] = v->voxel[i].at[0] == 8;
	g_autoptr(smooth_regions) whole = smooth_regions_grow(v, NULL, NULL);
	g_autoptr(smooth_regions) halves = smooth_regions_grow(v, skip, NULL);
	g_assert_cmpuint(whole->count, ==, 1);
	g_assert_cmpuint(whole->region[0].points, ==, 5000);
	g_assert_cmpuint(halves->count, ==, 2);
	for (uint32_t i = 0; i < v->count; i++)
		g_assert_true((halves->of[i] == VOXEL_NONE) == skip[i]);
}

/* What faces nowhere is of no region. */
static void test_without_normals(void)
{
	g_autoptr(voxels) v = voxels_new(0.2);
	for (int i = 0; i < 100; i++)
		made_point((double[3]){ 0.1 * i, 0, 0 }, (double[3]){ 0, 0, 0 }, 0.1,
			made_into_voxels, v);
	g_autoptr(smooth_regions) r = grow(v, NULL, NULL);
	g_assert_cmpuint(r->count, ==, 0);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/smooth-regions/box", test_box);
	g_test_add_func("/smooth-regions/ball", test_ball);
	g_test_add_func("/smooth-regions/stairs", test_stairs);
	g_test_add_func("/smooth-regions/skipped", test_skipped);
	g_test_add_func("/smooth-regions/without-normals", test_without_normals);
	return g_test_run();
}
