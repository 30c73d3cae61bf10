/* What covers a wall: ivy, green paint, rough stone. */
#include "process/classify.h"
#include "process/voxel-shape.h"
#include "tests/surfaces-made.h"

#define CELL_M   0.15
#define GROUND_M 0.12f
#define WALL_Y_M 10.0
#define APART_M  0.05

struct cover {
	float off_m, askew, error_m; /* as far as before the wall; of the normals */
	uint8_t rgb[3];
};
static const struct cover plaster = { 0, 0, 0.003f, { 170, 160, 150 } };
static const struct cover ivy = { 0.15f, 0.5f, 0.045f, { 85, 115, 75 } };
static const struct cover paint = { 0, 0, 0.003f, { 85, 115, 75 } };
static const struct cover stone = { 0.15f, 0.5f, 0.045f, { 120, 110, 100 } };

static void take_ground(const struct voxel_point *p, void *to)
{
	ground_add(to, p);
}

/* Of the wall from x0 to x1 and from z0 to z1, which faces -y. */
static void add_cover(voxels *v, GRand *chance, const struct cover *c, const double low_m[2],
	const double high_m[2])
{
	for (double x = low_m[0]; x < high_m[0]; x += APART_M)
		for (double z = low_m[1]; z < high_m[1]; z += APART_M) {
			struct voxel_point p = { .error_m = c->error_m,
				.size_m = APART_M,
				.area_m2 = APART_M * APART_M,
				.rgb = c->rgb,
				.normal = { 0, -1, 0 } };
			p.at_m[0] = x;
			p.at_m[1] = WALL_Y_M - (double)c->off_m * g_rand_double(chance);
			p.at_m[2] = z;
			for (int k = 0; k < 3; k += 2)
				p.normal[k] = c->askew * (float)g_rand_double_range(chance, -1, 1);
			double n[3] = { (double)p.normal[0], (double)p.normal[1],
				(double)p.normal[2] };
			for (int k = 0; k < 3; k++)
				p.normal[k] /= (float)made_length(n);
			voxels_add(v, &p);
		}
}

struct counts {
	unsigned all, class[SEGMENT_CLASSES];
};

/* Of the voxels with their points in a part of the wall. */
static struct counts count(
	const voxels *v, const uint8_t *class, const double low_m[2], const double high_m[2])
{
	struct counts ret = { 0 };
	for (uint32_t i = 0; i < v->count; i++) {
		double at[3];
		voxel_point_m(v, i, at);
		if (at[0] < low_m[0] || at[0] > high_m[0] || at[2] < low_m[1] || at[2] > high_m[1])
			continue;
		ret.all++;
		ret.class[class[i]]++;
	}
	return ret;
}

/* A plastered wall of 12 m by 5 m on a floor, of which 4 m by 3.4 m are covered; whether the cover is a plant, and all else a wall. */
static void check(const struct cover *cover, enum segment_class as)
{
	static const double low[2] = { 4, 0.9 }, high[2] = { 8, 4.3 };
	g_autoptr(GRand) chance = g_rand_new_with_seed(11);
	g_autoptr(ground) floor = ground_new(2 * CELL_M);
	g_autoptr(voxels) v = voxels_new(CELL_M);
	made_floor(
		(double[2]){ -5, 0 }, (double[2]){ 17, WALL_Y_M }, 0, APART_M, take_ground, floor);
	ground_find(floor, (const double[][3]){ { 6, 3, 1.6 } }, 1);
	add_cover(v, chance, &plaster, (double[2]){ 0, 0.05 }, (double[2]){ 12, low[1] });
	add_cover(v, chance, &plaster, (double[2]){ 0, high[1] }, (double[2]){ 12, 5 });
	add_cover(v, chance, &plaster, (double[2]){ 0, low[1] }, (double[2]){ low[0], high[1] });
	add_cover(v, chance, &plaster, (double[2]){ high[0], low[1] }, (double[2]){ 12, high[1] });
	add_cover(v, chance, cover, low, high);
	voxels_finish(v);
	voxels_link(v, 1.6);
	g_autofree struct voxel_shape *shape = voxel_shapes(v);
	g_autoptr(smooth_regions) regions = smooth_regions_grow(v, NULL, NULL);
	g_autofree float *height_m = g_new(float, v->count);
	g_autofree uint8_t *ground_class = g_malloc(ground_surfels(floor)->count + 1);
	memset(ground_class, CLASS_TERRAIN, ground_surfels(floor)->count);
	for (uint32_t i = 0; i < v->count; i++) {
		double at[3];
		voxel_point_m(v, i, at);
		height_m[i] = ground_height_m(floor, at);
	}
	struct classify_input in = { v, shape, regions, floor, height_m, ground_class, GROUND_M };
	g_autofree uint8_t *class = classify(&in);
	struct counts covered = count(v, class, low, high),
		      left = count(v, class, (double[2]){ 0, 0.5 }, (double[2]){ 3.7, 5 }),
		      right = count(v, class, (double[2]){ 8.3, 0.5 }, (double[2]){ 12, 5 });
	g_test_message("of %u covered %u are building, %u vegetation", covered.all,
		covered.class[CLASS_BUILDING], covered.class[CLASS_VEGETATION]);
	g_assert_cmpuint(covered.all, >, 500);
	g_assert_cmpfloat(covered.class[as], >=, 0.9 * covered.all);
	g_assert_cmpuint(left.class[CLASS_BUILDING], ==, left.all);
	g_assert_cmpuint(right.class[CLASS_BUILDING], ==, right.all);
}

static void test_ivy(void)
{
	check(&ivy, CLASS_VEGETATION);
}

static void test_green_paint(void)
{
	check(&paint, CLASS_BUILDING);
}

static void test_rough_stone(void)
{
	check(&stone, CLASS_BUILDING);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/classify/ivy", test_ivy);
	g_test_add_func("/classify/green-paint", test_green_paint);
	g_test_add_func("/classify/rough-stone", test_rough_stone);
	return g_test_run();
}
