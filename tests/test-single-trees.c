/* Trees made of balls and cones of points, at known places: each is found once, and most of its voxels are its own. */
#include "process/single-trees.h"
#include "tests/surfaces-made.h"
#include <glib.h>

struct made_tree {
	double at_m[2], height_m, radius_m;
	bool is_cone;
};

struct forest {
	voxels *v;
	GArray *from; /* of guint, by point */
	GArray *points;
	unsigned now;
};

static void take(const struct voxel_point *p, void *to)
{
	struct forest *f = to;
	voxels_add(f->v, p);
	g_array_append_val(f->points, *p);
	g_array_append_val(f->from, f->now);
}

static void grow_crown(const struct made_tree *t, struct forest *f)
{
	double up[3] = { 0, 0, 1 };
	if (!t->is_cone) {
		double centre[3] = { t->at_m[0], t->at_m[1], t->height_m - t->radius_m };
		made_ball(centre, t->radius_m, 0.08, take, f);
		return;
	}
	/* a spruce, from 0.5 m up */
	for (double z = 0.5; z < t->height_m; z += 0.08) {
		double radius = t->radius_m * (t->height_m - z) / (t->height_m - 0.5);
		int n = (int)(2 * M_PI * radius / 0.08) + 1;
		for (int i = 0; i < n; i++) {
			double at[3] = { t->at_m[0] + radius * cos(2 * M_PI * i / n),
				t->at_m[1] + radius * sin(2 * M_PI * i / n), z };
			made_point(at, up, 0.08, take, f);
		}
	}
}

static void grow_trunk(const struct made_tree *t, struct forest *f)
{
	double up[3] = { 0, 0, 1 };
	for (double z = 0.05; z < t->height_m - t->radius_m; z += 0.05)
		for (int i = 0; i < 8; i++) {
			double at[3] = { t->at_m[0] + 0.15 * cos(i * M_PI / 4),
				t->at_m[1] + 0.15 * sin(i * M_PI / 4), z };
			made_point(at, up, 0.05, take, f);
		}
}

static struct forest plant(const struct made_tree *tree, unsigned trees)
{
	struct forest f = { voxels_new(0.15), g_array_new(FALSE, FALSE, sizeof(unsigned)),
		g_array_new(FALSE, FALSE, sizeof(struct voxel_point)), 0 };
	for (f.now = 0; f.now < trees; f.now++) {
		grow_crown(&tree[f.now], &f);
		grow_trunk(&tree[f.now], &f);
	}
	voxels_finish(f.v);
	voxels_link(f.v, 1.6);
	return f;
}

static void fell(struct forest *f)
{
	voxels_free(f->v);
	g_array_unref(f->from);
	g_array_unref(f->points);
}

static struct single_trees find(const struct forest *f, uint32_t points_min)
{
	g_autofree uint8_t *is_plant = g_malloc(f->v->count + 1);
	g_autofree float *height_m = g_new(float, f->v->count + 1);
	memset(is_plant, 1, f->v->count);
	for (uint32_t i = 0; i < f->v->count; i++) {
		double at[3];
		voxel_point_m(f->v, i, at);
		height_m[i] = (float)at[2];
	}
	return single_trees_find(f->v, is_plant, height_m, points_min);
}

/* IoU of a made tree with the found one that has most of it. */
static double best_iou(const struct forest *f, const struct single_trees *t, unsigned tree)
{
	g_autofree double *both = g_new0(double, t->count + 1);
	g_autofree double *found = g_new0(double, t->count + 1);
	double own = 0, best = 0;
	for (guint i = 0; i < f->points->len; i++) {
		const struct voxel_point *p = &g_array_index(f->points, struct voxel_point, i);
		uint32_t k = t->of[voxels_find_point(f->v, p->at_m)];
		bool is_own = g_array_index(f->from, unsigned, i) == tree;
		own += is_own;
		if (k == TREE_NONE)
			continue;
		found[k]++;
		both[k] += is_own;
	}
	for (uint32_t k = 0; k < t->count; k++)
		best = fmax(best, both[k] / (own + found[k] - both[k]));
	return best;
}

static void check(const struct made_tree *tree, unsigned trees, double least_iou)
{
	struct forest f = plant(tree, trees);
	struct single_trees t = find(&f, 0);
	g_autofree uint32_t *of = t.of;
	double least = 1;
	for (unsigned k = 0; k < trees; k++) {
		double iou = best_iou(&f, &t, k);
		g_test_message("tree %u of %u found: IoU %.3f", k, t.trees, iou);
		least = fmin(least, iou);
	}
	g_assert_cmpuint(t.trees, ==, trees);
	g_assert_cmpuint(t.count, ==, trees);
	g_assert_cmpfloat(least, >=, least_iou);
	for (uint32_t i = 0; i < f.v->count; i++)
		g_assert_cmpuint(of[i], <, trees);
	fell(&f);
}

static void test_apart(void)
{
	static const struct made_tree tree[] = { { { 0, 0 }, 6, 2, false },
		{ { 8, 1 }, 9, 2.5, false }, { { 1, 9 }, 7, 1.8, true },
		{ { 12, 10 }, 12, 2.2, true } };
	check(tree, G_N_ELEMENTS(tree), 1);
}

/* An avenue whose crowns come near each other. */
static void test_touching(void)
{
	static const struct made_tree tree[] = { { { 0, 0 }, 7, 2.1, false },
		{ { 5, 0 }, 7.5, 2.1, false }, { { 10, 0 }, 7.2, 2.1, false },
		{ { 5, 5 }, 8.3, 2.1, false } };
	check(tree, G_N_ELEMENTS(tree), 0.75);
}

static void test_touching_cones(void)
{
	static const struct made_tree tree[] = { { { 0, 0 }, 10, 2, true },
		{ { 3.5, 0 }, 9, 2, true }, { { 0, 3.5 }, 11, 2, true },
		{ { 3.6, 3.4 }, 8, 2, true } };
	check(tree, G_N_ELEMENTS(tree), 0.75);
}

/* Low ones are bushes, however many balls they are of. */
static void test_bushes(void)
{
	static const struct made_tree plants[] = { { { 0, 0 }, 6, 2, false },
		{ { 6, 0 }, 1.2, 0.6, false }, { { 7, 0 }, 1.3, 0.6, false },
		{ { 12, 0 }, 2, 1, false } };
	struct forest f = plant(plants, G_N_ELEMENTS(plants));
	struct single_trees t = find(&f, 0);
	g_assert_cmpuint(t.trees, ==, 1);
	g_assert_cmpuint(t.count, ==, 3);
	g_free(t.of);
	/* what is too small is of none */
	t = find(&f, 3000);
	g_assert_cmpuint(t.trees, ==, 1);
	g_assert_cmpuint(t.count, ==, 1);
	g_free(t.of);
	fell(&f);
}

static void test_none(void)
{
	struct forest f = plant(NULL, 0);
	struct single_trees t = find(&f, 0);
	g_assert_cmpuint(t.count, ==, 0);
	g_free(t.of);
	fell(&f);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/single-trees/apart", test_apart);
	g_test_add_func("/single-trees/touching", test_touching);
	g_test_add_func("/single-trees/touching-cones", test_touching_cones);
	g_test_add_func("/single-trees/bushes", test_bushes);
	g_test_add_func("/single-trees/none", test_none);
	return g_test_run();
}
