/* The flood against one that looks at every cell of the shore each time, and against what it promises. */
#include "process/watershed.h"
#include <glib.h>
#include <math.h>
#include <string.h>

/* ---- a plain one ---- */

struct arrival {
	double height;
	size_t cell, order;
	int32_t label;
};

static double step(const struct watershed_image *m, size_t a, int down, int right, size_t b)
{
	const float *plane = down ? m->step_down : m->step_right;
	double s = plane ? plane[down > 0 || right > 0 ? a : b] : 0;
	return isnan(s) ? INFINITY : s;
}

static bool neighbour(
	const struct watershed_image *m, size_t cell, int down, int right, size_t *ret)
{
	long row = (long)(cell / m->columns) + down, column = (long)(cell % m->columns) + right;
	if (m->wraps)
		column = (column + m->columns) % m->columns;
	if (row < 0 || row >= m->rows || column < 0 || column >= m->columns)
		return false;
	*ret = (size_t)row * m->columns + (size_t)column;
	return true;
}

/* NAN: no way. */
static double pass(const struct watershed_image *m, size_t a, int down, int right, size_t b)
{
	double over = m->level ? m->level[b] : -INFINITY, s = 0;
	if (down && right) {
		size_t level = a, plumb = a;
		neighbour(m, a, 0, right, &level);
		neighbour(m, a, down, 0, &plumb);
		double first = fmax(step(m, a, 0, right, level), step(m, level, down, 0, b)),
		       second = fmax(step(m, a, down, 0, plumb), step(m, plumb, 0, right, b));
		s = fmin(first, second);
	} else {
		s = step(m, a, down, right, b);
	}
	return isnan(over) || isinf(s) ? NAN : fmax(over, m->step_right ? s : -INFINITY);
}

/* Every way over the shore is an arrival of its own here; the earliest of the lowest is taken each time. */
static void flood_plainly(const struct watershed_image *m, int32_t *label)
{
	static const int around[8][2] = { { -1, 0 }, { 0, -1 }, { 0, 1 }, { 1, 0 }, { -1, -1 },
		{ -1, 1 }, { 1, -1 }, { 1, 1 } };
	size_t cells = (size_t)m->columns * m->rows, order = 0;
	g_autofree bool *wet = g_new0(bool, cells);
	g_autoptr(GArray) shore = g_array_new(false, false, sizeof(struct arrival));
	for (size_t i = 0; i < cells; i++)
		if (label[i] > 0) {
			struct arrival a = { -INFINITY, i, order++, label[i] };
			g_array_append_val(shore, a);
		}
	while (shore->len) {
		guint best = 0;
		for (guint i = 1; i < shore->len; i++) {
			const struct arrival *a = &g_array_index(shore, struct arrival, i),
					     *b = &g_array_index(shore, struct arrival, best);
			if (a->height < b->height ||
				(a->height == b->height && a->order < b->order))
				best = i;
		}
		struct arrival at = g_array_index(shore, struct arrival, best);
		g_array_remove_index(shore, best);
		if (wet[at.cell])
			continue;
		wet[at.cell] = true;
		label[at.cell] = at.label;
		for (int k = 0; k < (m->diagonals ? 8 : 4); k++) {
			size_t to;
			if (!neighbour(m, at.cell, around[k][0], around[k][1], &to) || wet[to] ||
				label[to] != 0)
				continue;
			double over = pass(m, at.cell, around[k][0], around[k][1], to);
			struct arrival a = { fmax(at.height, over), to, order++, at.label };
			if (!isnan(over))
				g_array_append_val(shore, a);
		}
	}
}

/* ---- random images ---- */

enum { MOST = 40 * 40 };
struct scene {
	struct watershed_image image;
	float level[MOST], right[MOST], down[MOST];
	int32_t label[MOST];
};

static float height(GRand *chance, int kinds)
{
	return g_rand_double(chance) < 0.05 ? NAN
					    : (float)g_rand_int_range(chance, 0, kinds) - kinds / 2;
}

/* kinds: of heights; few make plateaus, where order decides. */
static void make_scene(struct scene *s, GRand *chance, int kinds, bool level, bool steps)
{
	uint32_t columns = (uint32_t)g_rand_int_range(chance, 1, 40),
		 rows = (uint32_t)g_rand_int_range(chance, 1, 40);
	for (uint32_t i = 0; i < columns * rows; i++) {
		s->level[i] = height(chance, kinds);
		s->right[i] = height(chance, kinds);
		s->down[i] = height(chance, kinds);
		double what = g_rand_double(chance);
		s->label[i] = what < 0.01 ? g_rand_int_range(chance, 1, 9) : what < 0.03 ? -1 : 0;
	}
	s->image = (struct watershed_image){ .columns = columns,
		.rows = rows,
		.wraps = columns > 2 && g_rand_boolean(chance),
		.diagonals = columns > 2 && g_rand_boolean(chance),
		.level = level ? s->level : NULL,
		.step_right = steps ? s->right : NULL,
		.step_down = steps ? s->down : NULL };
}

static void assert_as_plain(bool level, bool steps, int kinds)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed((guint32)kinds);
	g_autofree struct scene *s = g_new0(struct scene, 1);
	int32_t plain[MOST];
	size_t flooded = 0;
	for (int round = 0; round < 60; round++) {
		make_scene(s, chance, kinds, level, steps);
		size_t cells = (size_t)s->image.columns * s->image.rows, dry = 0, left = 0;
		memcpy(plain, s->label, sizeof plain);
		for (size_t i = 0; i < cells; i++)
			dry += s->label[i] == 0;
		flood_plainly(&s->image, plain);
		size_t reached = watershed_flood(&s->image, s->label);
		g_assert_cmpmem(s->label, cells * sizeof *plain, plain, cells * sizeof *plain);
		for (size_t i = 0; i < cells; i++)
			left += s->label[i] == 0;
		g_assert_cmpuint(reached, ==, dry - left);
		flooded += reached;
	}
	g_assert_cmpuint(flooded, >, 1000);
}

/* Heights of few kinds make plateaus, on which the order of arrival decides. */
static void test_levels(void)
{
	assert_as_plain(true, false, 1000);
	assert_as_plain(true, false, 3);
}

static void test_steps(void)
{
	assert_as_plain(false, true, 20000);
	assert_as_plain(false, true, 3);
}

static void test_both(void)
{
	assert_as_plain(true, true, 20000);
	assert_as_plain(true, true, 3);
}

/* ---- what it promises ---- */

/* A ridge between two valleys, over the seam or not. */
static void test_seam(void)
{
	enum { COLUMNS = 12 };
	static const float level[COLUMNS] = { 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 0 };
	int32_t open[COLUMNS] = { 0, 0, 1, 0, 2 }, wrapped[COLUMNS] = { 0, 0, 1, 0, 2 };
	struct watershed_image m = { .columns = COLUMNS, .rows = 1, .level = level };
	watershed_flood(&m, open);
	g_assert_cmpint(open[0], ==, 1);
	g_assert_cmpint(open[11], ==, 2);
	m.wraps = true;
	watershed_flood(&m, wrapped);
	g_assert_cmpint(wrapped[11], ==, 1);
	g_assert_cmpint(wrapped[6], ==, 2);
}

/* A post one cell wide between two walls: with steps it keeps its own label. */
static void test_thin(void)
{
	enum { SIDE = 9 };
	float right[SIDE * SIDE] = { 0 }, down[SIDE * SIDE] = { 0 };
	int32_t label[SIDE * SIDE] = { 0 };
	for (int r = 0; r < SIDE; r++)
		right[r * SIDE + 3] = right[r * SIDE + 4] = 1;
	label[0] = 1;
	label[4 * SIDE + 4] = 2;
	label[SIDE - 1] = 3;
	struct watershed_image m = {
		.columns = SIDE, .rows = SIDE, .step_right = right, .step_down = down
	};
	g_assert_cmpuint(watershed_flood(&m, label), ==, SIDE * SIDE - 3);
	for (int i = 0; i < SIDE * SIDE; i++)
		g_assert_cmpint(label[i], ==, i % SIDE < 4 ? 1 : i % SIDE == 4 ? 2 : 3);
}

/* Nothing gets through a wall of NAN or of cells outside; no markers, no flood; a level that is the same everywhere. */
static void test_walls(void)
{
	enum { SIDE = 7 };
	float level[SIDE * SIDE] = { 0 };
	int32_t label[SIDE * SIDE] = { 1 };
	for (int r = 0; r < SIDE; r++)
		level[r * SIDE + 2] = NAN, label[r * SIDE + 5] = -1;
	struct watershed_image m = {
		.columns = SIDE, .rows = SIDE, .diagonals = true, .level = level
	};
	g_assert_cmpuint(watershed_flood(&m, label), ==, 2 * SIDE - 1);
	for (int i = 0; i < SIDE * SIDE; i++)
		g_assert_cmpint(label[i], ==, i % SIDE < 2 ? 1 : i % SIDE == 5 ? -1 : 0);
	memset(label, 0, sizeof label);
	g_assert_cmpuint(watershed_flood(&m, label), ==, 0);
}

static void test_time(void)
{
	uint32_t columns = 3000, rows = 792;
	size_t cells = (size_t)columns * rows;
	g_autofree float *level = g_new(float, cells);
	g_autofree int32_t *label = g_new0(int32_t, cells);
	g_autoptr(GRand) chance = g_rand_new_with_seed(1);
	for (size_t i = 0; i < cells; i++)
		level[i] = (float)g_rand_double(chance);
	for (int k = 0; k < 200; k++)
		label[(size_t)g_rand_int(chance) % cells] = k + 1;
	struct watershed_image m = {
		.columns = columns, .rows = rows, .wraps = true, .diagonals = true, .level = level
	};
	gint64 from = g_get_monotonic_time();
	watershed_flood(&m, label);
	g_test_message("%u x %u cells in %.0f ms", columns, rows,
		(double)(g_get_monotonic_time() - from) / 1e3);
	for (size_t i = 0; i < cells; i++)
		g_assert_cmpint(label[i], >, 0);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/watershed/levels", test_levels);
	g_test_add_func("/watershed/steps", test_steps);
	g_test_add_func("/watershed/both", test_both);
	g_test_add_func("/watershed/seam", test_seam);
	g_test_add_func("/watershed/thin", test_thin);
	g_test_add_func("/watershed/walls", test_walls);
	g_test_add_func("/watershed/time", test_time);
	return g_test_run();
}
