/* What points of leaves stand for. */
#include "render/scene-foliage.h"
#include "tests/scene-made.h"

#define SIZE_M 0.02f
/* As a scanner's points claim, which is never quite their size. */
#define BEAM_M (1.05f * SIZE_M)

/* A tree, and a wall with leaves on it. claimed_m: of the tree's points; 0: their size, as a cloud's. */
static made ball_of(int leaves, double radius_m, float claimed_m)
{
	made m = made_new();
	struct made_plane wall = { .corner_m = { 0, 4, 0 },
		.a_m = { 2, 0, 0 },
		.b_m = { 0, 0, 1 },
		.apart_m = SIZE_M,
		.order = MADE_JITTERED };
	made_add_plane(&m, &wall);
	made_add_ball(&m, (const double[3]){ 1, 4, 0.5 }, 0.4, 900, MADE_LEAF);
	made_add_ball(&m, (const double[3]){ 1, 0, 1 }, radius_m, leaves, MADE_LEAF + 1);
	for (guint i = m.points->len - (guint)leaves; i < m.points->len; i++)
		g_array_index(m.points, struct made_point, i).claimed_m = claimed_m;
	return m;
}

static void read_classed(made *m)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = made_tree();
	g_autofree uint8_t *leaf_class = segments_classes(tree);
	made_read(m);
	scene_free(m->scene);
	m->scene = scene_new_within(m->model, leaf_class, G_MAXUINT64, &error);
	g_assert_no_error(error);
}

static double mean_spacing_m(const scene *s, uint32_t leaf)
{
	double sum = 0;
	uint32_t count = 0;
	for (uint32_t n = 0; n < s->chunks; n++)
		for (uint32_t i = 0; i < s->chunk[n].count && s->chunk[n].leaf == leaf; i++) {
			sum += s->place[s->chunk[n].first + i].spacing * (double)s->unit_m;
			count++;
		}
	g_assert_cmpuint(count, >, 0);
	return sum / count;
}

static double tree_spacing_m(int leaves, double radius_m, float claimed_m)
{
	g_auto(made) m = ball_of(leaves, radius_m, claimed_m);
	read_classed(&m);
	return mean_spacing_m(m.scene, MADE_LEAF + 1);
}

static void assert_near(double x, double wanted, double part)
{
	g_assert_cmpfloat(x, >, wanted * (1 - part));
	g_assert_cmpfloat(x, <, wanted * (1 + part));
}

/* Eight times as many around: each stands for less, by some third of the root of that. */
static void test_dense(void)
{
	double some = tree_spacing_m(4000, 0.8, BEAM_M), many = tree_spacing_m(4000, 0.4, BEAM_M);
	g_test_message("spacing of leaves: %.4f m, eight times denser %.4f m", some, many);
	/* Half of them are so near the ball's end that fewer are around. */
	assert_near(many / some, pow(8, -0.175), 0.06);
	/* Where a ball of 0.3 m holds some 250 points of 2 cm, they stand for about what their beams were wide. */
	assert_near(some, SIZE_M, 0.15);
}

/* A leaf may have been met at any angle: what that would make of its patch is not asked. It changes which points come first in a chunk, and
 * so by how little what is around them is rounded: within the unit that spacings are told in. */
static void test_aslant(void)
{
	double aslant = tree_spacing_m(4000, 0.6, SIZE_M * 1.4f),
	       straight = tree_spacing_m(4000, 0.6, BEAM_M);
	g_assert_cmpfloat(fabs(aslant - straight), <, 1.01 * SCENE_UNIT_M);
}

/* What a cloud's points so far apart stand for: more than half is for those behind. */
static double of_cloud_m(double spacing_m)
{
	return spacing_m / sqrt(2 * pow(spacing_m, -0.085));
}

/* A cloud's points claim their size: however many there are. */
static void test_cloud(void)
{
	assert_near(tree_spacing_m(4000, 0.8, 0), of_cloud_m(SIZE_M), 0.01);
	assert_near(tree_spacing_m(4000, 0.4, 0), of_cloud_m(SIZE_M), 0.01);
	assert_near(tree_spacing_m(1, 0.1, 0), of_cloud_m(SIZE_M), 0.01);
}

/* A single leaf, and a thousand in one place, are within bounds. */
static void test_absurd(void)
{
	assert_near(tree_spacing_m(1, 0.1, BEAM_M), SIZE_M / sqrt(0.8), 0.02);
	assert_near(tree_spacing_m(4000, 0.01, BEAM_M), SIZE_M / sqrt(2.2), 0.25);
}

/* Trees whose points are farther apart than a model can say, are not narrowed to what it can. */
static void test_sparse(void)
{
	g_auto(made) m = made_new();
	made_add_ball(&m, (const double[3]){ 0, 0, 0 }, 300, 500, MADE_LEAF + 1);
	for (guint i = 0; i < m.points->len; i++)
		g_array_index(m.points, struct made_point, i).apart_m = 20;
	read_classed(&m);
	double classed_m = mean_spacing_m(m.scene, MADE_LEAF + 1);
	g_autoptr(GError) error = NULL;
	g_autoptr(scene) plain = scene_new(m.model, &error);
	g_assert_no_error(error);
	double plain_m = mean_spacing_m(plain, MADE_LEAF + 1);
	g_test_message("spacing of far trees: %.2f m, without classes %.2f m", classed_m, plain_m);
	g_assert_cmpfloat(plain_m, >, 20);
	assert_near(classed_m, of_cloud_m(plain_m), 0.01);
}

static double kind_spacing_m(const made *m, int kind, uint32_t leaf)
{
	const scene *s = m->scene;
	double sum = 0;
	uint32_t count = 0;
	for (uint32_t n = 0; n < s->chunks; n++)
		for (uint32_t i = s->chunk[n].first;
			i < s->chunk[n].first + s->chunk[n].count && s->chunk[n].leaf == leaf; i++)
			if (s->kind[i] == kind) {
				sum += s->place[i].spacing * (double)s->unit_m;
				count++;
			}
	return sum / count;
}

/* Of a ball of leaves all but one in so many are told for surface. */
static made mixed(guint every)
{
	made m = ball_of(2000, 0.6, BEAM_M);
	for (guint i = m.points->len - 2000; i < m.points->len; i++)
		if (i % every != 0)
			g_array_index(m.points, struct made_point, i).kind = FEATURE_NONE;
	read_classed(&m);
	return m;
}

/* Surface among leaves is leaves too, and stands for as much less; surface with a few leaves on it stays what it is. */
static void test_surface(void)
{
	g_auto(made) tree = mixed(2), bough = mixed(20);
	g_autoptr(GError) error = NULL;
	g_autoptr(scene) plain = scene_new(bough.model, &error);
	g_assert_no_error(error);
	double leaf_m = kind_spacing_m(&tree, FEATURE_UNDIRECTED, MADE_LEAF + 1),
	       surface_m = kind_spacing_m(&tree, FEATURE_NONE, MADE_LEAF + 1);
	g_test_message("spacing of leaves %.4f m, of surface among them %.4f m", leaf_m, surface_m);
	assert_near(leaf_m / SIZE_M, surface_m / (double)BEAM_M, 0.02);
	g_assert_cmpfloat(fabs(leaf_m - SIZE_M), >, 0.05 * SIZE_M);
	for (uint32_t i = 0; i < plain->count; i++)
		if (plain->kind[i] == FEATURE_NONE)
			g_assert_cmpuint(
				bough.scene->place[i].spacing, ==, plain->place[i].spacing);
}

/* Nothing but the leaves of vegetation is changed: all else is as without classes. */
static void test_others(void)
{
	g_auto(made) m = ball_of(9000, 0.5, BEAM_M);
	read_classed(&m);
	g_autoptr(GError) error = NULL;
	g_autoptr(scene) plain = scene_new(m.model, &error);
	g_assert_no_error(error);
	uint32_t changed = 0;
	for (uint32_t n = 0; n < plain->chunks; n++)
		for (uint32_t i = plain->chunk[n].first;
			i < plain->chunk[n].first + plain->chunk[n].count; i++) {
			if (plain->chunk[n].leaf == MADE_LEAF)
				g_assert_cmpuint(
					m.scene->place[i].spacing, ==, plain->place[i].spacing);
			else
				changed += m.scene->place[i].spacing != plain->place[i].spacing;
			g_assert_cmpuint(m.scene->disc[i], ==, plain->disc[i]);
		}
	g_assert_cmpuint(changed, ==, 9000);
}

/* The first quarter of a chunk, which stands for all of it, is worth the same. */
static void test_part(void)
{
	g_auto(made) m = ball_of(4096, 0.5, BEAM_M);
	scene *s = (read_classed(&m), m.scene);
	uint32_t n = 0;
	while (s->chunk[n].leaf != MADE_LEAF + 1 || s->chunk[n].count < 2000)
		g_assert_cmpuint(++n, <, s->chunks);
	struct scene_chunk quarter = s->chunk[n];
	const struct model_point *p = &model_points(m.model)[quarter.first];
	double whole = 0, part = 0;
	quarter.count /= 4;
	quarter.part = 0.25f;
	for (uint32_t i = 0; i < quarter.count; i++) {
		whole += s->place[quarter.first + i].spacing;
		s->place[quarter.first + i].spacing = (uint16_t)(2 * p[i].spacing);
	}
	scene_foliage_chunk(s, &quarter, p);
	for (uint32_t i = 0; i < quarter.count; i++)
		part += s->place[quarter.first + i].spacing;
	g_test_message("spacing of a quarter: %.3f of twice the whole's", part / (2 * whole));
	assert_near(part, 2 * whole, 0.03);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/scene-foliage/dense", test_dense);
	g_test_add_func("/scene-foliage/aslant", test_aslant);
	g_test_add_func("/scene-foliage/cloud", test_cloud);
	g_test_add_func("/scene-foliage/absurd", test_absurd);
	g_test_add_func("/scene-foliage/sparse", test_sparse);
	g_test_add_func("/scene-foliage/surface", test_surface);
	g_test_add_func("/scene-foliage/others", test_others);
	g_test_add_func("/scene-foliage/part", test_part);
	return g_test_run();
}
