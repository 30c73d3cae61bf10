/* Feature degree, points, lines, dithering and curvature, against shapes that are known exactly. */
#include "process/features.h"
#include "process/model.h"
#include "process/normals.h"
#include "tests/placed-scans.h"
#include <stdlib.h>

#define COLUMNS 480
#define ROWS    160
#define STEP    (0.25 * G_PI / 180)

/* ---- what is looked at: a range for every direction, 0: nothing ---- */

typedef double (*shape)(const double direction[3]);

struct look {
	double noise_m;
	uint8_t (*tone)(const double point[3]);   /* NULL: no colour */
	uint16_t (*light)(const double point[3]); /* NULL: no intensity */
	uint32_t columns, rows;
};

static double gauss(GRand *chance)
{
	return sqrt(-2 * log(1 - g_rand_double(chance))) * cos(2 * G_PI * g_rand_double(chance));
}

static range_grid *look_at(shape s, const struct look *how)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GRand) chance = g_rand_new_with_seed(5);
	const uint32_t columns = how->columns ? how->columns : COLUMNS,
		       rows = how->rows ? how->rows : ROWS;
	const size_t cells = (size_t)columns * rows;
	g_autofree double *xyz = g_new0(double, 3 * cells);
	g_autofree uint8_t *cell = g_malloc0(cells), *rgb = g_malloc0(3 * cells);
	g_autofree uint16_t *light = g_new0(uint16_t, cells);
	for (size_t i = 0; i < cells; i++) {
		double azimuth = ((double)(i % columns) - columns / 2.0 + 0.5) * STEP;
		double up = (rows / 2.0 - (double)(i / columns) - 0.5) * STEP;
		double d[3] = { cos(up) * sin(azimuth), cos(up) * cos(azimuth), sin(up) }, point[3];
		double range_m = s(d);
		cell[i] = range_m > 0 ? CELL_MEASURED : CELL_NO_RETURN;
		for (int k = 0; k < 3; k++)
			point[k] = range_m * d[k];
		if (!(range_m > 0))
			continue;
		range_m += how->noise_m * gauss(chance);
		for (int k = 0; k < 3; k++)
			xyz[(size_t)k * cells + i] = range_m * d[k];
		memset(rgb + 3 * i, how->tone ? how->tone(point) : 0, 3);
		light[i] = how->light ? how->light(point) : 0;
	}
	struct range_grid_desc desc = { columns, rows, xyz, xyz + cells, xyz + 2 * cells, cell,
		how->light ? light : NULL, how->tone ? rgb : NULL };
	range_grid *g = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	return g;
}

static features *features_of(const range_grid *g, const struct features_options *options)
{
	struct features_input of = { .grid = g, .pose = POSE_IDENTITY };
	return features_of_scans(&of, 1, 0, options);
}

static bool is_feature(const features *f, size_t i)
{
	return f->kind[i] >= FEATURE_UNDIRECTED;
}

/* ---- shapes ---- */

static double wall(const double d[3])
{
	return 8 / d[1];
}

/* Two walls that meet at a right angle in an upright edge 6 m away, as in a room. */
static double corner(const double d[3])
{
	return 6 / (d[1] + fabs(d[0]));
}

static double corner_far(const double d[3])
{
	return fabs(d[0]) < 0.9 * d[1] ? corner(d) : 0;
}

/* A board that stands 3 m before a wall. */
static double board(const double d[3])
{
	double at = 5 / d[1];
	return fabs(at * d[0]) < 1 && fabs(at * d[2]) < 0.8 ? at : wall(d);
}

static double ball(const double d[3])
{
	double along = 6 * d[1], rest = along * along - 36 + 1;
	return rest > 0 ? along - sqrt(rest) : 0;
}

/* Upright, radius 0.5 m, 5 m away. */
static double column(const double d[3])
{
	double level2 = d[0] * d[0] + d[1] * d[1], b = 5 * d[1],
	       rest = b * b - level2 * (25 - 0.25);
	return rest > 0 ? (b - sqrt(rest)) / level2 : 0;
}

/* From inside of a tunnel of radius 3 m along y. */
static double tunnel(const double d[3])
{
	double range_m = 3 / fmax(sqrt(d[0] * d[0] + d[2] * d[2]), 1e-9);
	return range_m < 15 ? range_m : 0;
}

static double foliage(const double d[3])
{
	uint32_t x = (uint32_t)(int)((d[0] + 2) * 1e5) * 2654435761u ^
		     (uint32_t)(int)((d[2] + 2) * 1e5) * 40503u;
	return 7 + 2.0 * (double)((x * 2246822519u) >> 8) / (1 << 24);
}

/* ---- edges ---- */

static double share_near(
	const range_grid *g, const features *f, bool (*is_edge)(const range_grid *, size_t))
{
	size_t edges = 0, found = 0;
	for (uint32_t row = 2; row + 2 < g->rows; row++)
		for (uint32_t c = 2; c + 2 < g->columns; c++) {
			size_t i = (size_t)row * g->columns + c;
			if (!(g->range_m[i] > 0) || !is_edge(g, i))
				continue;
			bool near = false;
			for (int y = -1; y <= 1; y++)
				for (int x = -1; x <= 1; x++)
					near |= is_feature(
						f, i + (size_t)y * g->columns + (size_t)x);
			edges++;
			found += near;
		}
	g_assert_cmpuint(edges, >, 50);
	return (double)found / (double)edges;
}

static bool in_middle(const range_grid *g, size_t i)
{
	uint32_t c = (uint32_t)(i % g->columns);
	return c == g->columns / 2 || c == g->columns / 2 - 1;
}

static bool is_of_board(const range_grid *g, size_t i)
{
	return g->y_m[i] < 6.5;
}

static bool is_board_edge(const range_grid *g, size_t i)
{
	return is_of_board(g, i) &&
	       (!is_of_board(g, i - 1) || !is_of_board(g, i + 1) ||
		       !is_of_board(g, i - g->columns) || !is_of_board(g, i + g->columns));
}

static void test_crease(void)
{
	for (double noise_m = 0.002; noise_m < 0.02; noise_m += 0.005) {
		struct look how = { .noise_m = noise_m };
		g_autoptr(range_grid) g = look_at(corner_far, &how);
		g_autoptr(features) f = features_of(g, NULL);
		size_t false_points = 0, directed = 0, exact = 0, straight = 0, points = 0;
		for (size_t i = 0; i < range_grid_cells(g); i++) {
			int32_t off = abs((int32_t)(i % COLUMNS) - COLUMNS / 2);
			uint32_t row = (uint32_t)(i / COLUMNS);
			float u[3];
			bool inner = row > 20 && row < ROWS - 20;
			points += is_feature(f, i) && inner && off < 60;
			false_points += is_feature(f, i) && inner && off > 3 && off < 60;
			if (!is_feature(f, i) || !inner || off > 3)
				continue;
			straight++;
			if (f->kind[i] != FEATURE_DIRECTED)
				continue;
			model_unpack_normal(f->direction[i], u);
			directed++;
			exact += fabsf(u[2]) > 0.9986f; /* 3 degrees */
			g_assert_cmpuint(f->line_error[i], <, 1000);
			g_assert_true(f->flags[i] & FEATURE_CREASE || f->degree[i] > 0.42 * 255);
		}
		double share = share_near(g, f, in_middle);
		g_test_message("noise %.3f m: %.3f found, %zu of %zu false, %zu of %zu directed",
			noise_m, share, false_points, points, directed, straight);
		g_assert_cmpfloat(share, >, 0.97);
		g_assert_cmpuint(20 * false_points, <, points);
		g_assert_cmpuint(10 * exact, >, 9 * directed);
		g_assert_cmpuint(5 * directed, >, 3 * straight);
	}
}

static void test_depth_edge(void)
{
	struct look how = { .noise_m = 0.012 };
	g_autoptr(range_grid) g = look_at(board, &how);
	g_autoptr(features) f = features_of(g, NULL);
	g_assert_cmpfloat(share_near(g, f, is_board_edge), >, 0.97);
	size_t behind = 0, points = 0, silhouette = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		points += is_feature(f, i);
		silhouette +=
			is_feature(f, i) && f->flags[i] & FEATURE_SILHOUETTE && is_of_board(g, i);
		behind += f->flags[i] & FEATURE_BEHIND && !is_of_board(g, i);
	}
	g_assert_cmpuint(silhouette, >, 200);
	g_assert_cmpuint(behind, >, 200);
	g_assert_cmpuint(points, <, 4 * silhouette);
}

static void test_even_wall(void)
{
	for (double noise_m = 0; noise_m < 0.02; noise_m += 0.006) {
		struct look how = { .noise_m = noise_m };
		g_autoptr(range_grid) g = look_at(wall, &how);
		g_autoptr(features) f = features_of(g, NULL);
		size_t points = 0;
		for (uint32_t row = 3; row < ROWS - 3; row++)
			for (uint32_t c = 3; c < COLUMNS - 3; c++)
				points += is_feature(f, (size_t)row * COLUMNS + c);
		g_assert_cmpuint(points, <, ROWS * COLUMNS / 500);
	}
}

static void test_foliage(void)
{
	struct look how = { .noise_m = 0.012 };
	g_autoptr(range_grid) g = look_at(foliage, &how);
	g_autoptr(features) f = features_of(g, NULL);
	size_t points = 0, directed = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		points += is_feature(f, i);
		directed += f->kind[i] == FEATURE_DIRECTED;
	}
	g_test_message("%zu points, %zu directed", points, directed);
	g_assert_cmpuint(points, >, ROWS * COLUMNS / 3);
	/* Some lie in a row by chance: this is denser than leaves, which test_simulated holds to a tenth. */
	g_assert_cmpuint(20 * directed, <, 3 * points);
}

/* ---- what it looks like ---- */

static uint8_t half_black(const double point[3])
{
	return point[0] < 0 ? 40 : 200;
}

static uint16_t half_dark(const double point[3])
{
	return point[0] < 0 ? 500 : 4000;
}

static uint8_t even_grey(const double point[3])
{
	(void)point;
	return 128;
}

static uint16_t even_light(const double point[3])
{
	(void)point;
	return 2000;
}

static void test_looks(void)
{
	const struct {
		struct look how;
		bool found;
		uint8_t flag;
	} tries[] = {
		{ { .noise_m = 0.01, .tone = half_black }, true, FEATURE_COLOUR_EDGE },
		{ { .noise_m = 0.01, .light = half_dark }, true, FEATURE_INTENSITY_EDGE },
		{ { .noise_m = 0.01, .tone = half_black, .light = even_light }, true,
			FEATURE_COLOUR_EDGE },
		/* Where there is colour, intensity alone has a weight of 0.3 only. */
		{ { .noise_m = 0.01, .tone = even_grey, .light = half_dark }, false,
			FEATURE_INTENSITY_EDGE },
		{ { .noise_m = 0.01 }, false, 0 },
	};
	for (size_t t = 0; t < G_N_ELEMENTS(tries); t++) {
		g_autoptr(range_grid) g = look_at(wall, &tries[t].how);
		g_autoptr(features) f = features_of(g, NULL);
		size_t flagged = 0;
		for (size_t i = 0; i < range_grid_cells(g); i++)
			flagged += (f->flags[i] & tries[t].flag) != 0;
		double share = share_near(g, f, in_middle);
		g_test_message("%zu: %.3f found, %zu flagged", t, share, flagged);
		g_assert_true(tries[t].found ? share > 0.97 : share < 0.05);
		g_assert_true(tries[t].flag ? flagged > ROWS / 2 : flagged == 0);
	}
}

static void test_parameters(void)
{
	struct look how = { .noise_m = 0.01, .tone = half_black };
	g_autoptr(range_grid) g = look_at(wall, &how);
	struct features_options none = { .colour_weight = -1, .intensity_weight = -1 },
				high = { .threshold = 0.99f };
	g_autoptr(features) without = features_of(g, &none);
	g_autoptr(features) strict = features_of(g, &high);
	g_assert_cmpfloat(share_near(g, without, in_middle), <, 0.05);
	g_autoptr(features) usual = features_of(g, NULL);
	size_t more = 0, fewer = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		g_assert_cmpuint(strict->degree[i], ==, usual->degree[i]);
		g_assert_true(!is_feature(strict, i) || is_feature(usual, i));
		more += is_feature(usual, i);
		fewer += is_feature(strict, i);
	}
	g_assert_cmpuint(fewer, <, more);
	struct features_options o = features_defaults(NULL);
	g_assert_cmpfloat(o.threshold, ==, 0.42f);
	g_assert_cmpfloat(features_defaults(&none).colour_weight, ==, 0);
}

/* ---- dithering ---- */

static uint8_t black(const double point[3])
{
	(void)point;
	return 0;
}

static uint8_t white(const double point[3])
{
	(void)point;
	return 255;
}

/* Walls at 3 m and 9 m. Further off, at a slant, a cell would stand for more than one dithering point. */
static double steps(const double d[3])
{
	return (d[0] < 0 ? 3 : 9) / d[1];
}

/* Dithering points per area of a wall at that depth, well inside of it. */
static double density(const range_grid *g, const features *f, double depth_m)
{
	double area_m2 = 0, count = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		int32_t c = (int32_t)(i % COLUMNS), row = (int32_t)(i / COLUMNS);
		if (fabs(g->y_m[i] - depth_m) > 0.2 || abs(c - COLUMNS / 2) < 6 || c < 3 ||
			c > COLUMNS - 4 || row < 3 || row > ROWS - 4)
			continue;
		double cosine = depth_m / g->range_m[i],
		       level = hypot(g->x_m[i], g->y_m[i]) / g->range_m[i];
		if (is_feature(f, i))
			continue; /* which is drawn, and takes no other point's place */
		area_m2 += g->range_m[i] * g->range_m[i] * STEP * STEP * level / cosine;
		count += f->kind[i] == FEATURE_DITHER;
	}
	return count / area_m2;
}

static void test_dithering(void)
{
	static uint8_t (*const tones[])(const double *) = { black, even_grey, white };
	static const double expected[] = { 60, 60 * (1 - 128 / 255.0), 0 };
	for (int t = 0; t < 3; t++) {
		struct look how = { .noise_m = 0.005, .tone = tones[t] };
		g_autoptr(range_grid) g = look_at(steps, &how);
		g_autoptr(features) f = features_of(g, NULL);
		double near = density(g, f, 3), far = density(g, f, 9);
		g_test_message("near %.1f, far %.1f of %.1f", near, far, expected[t]);
		g_assert_cmpfloat(fabs(near - expected[t]), <=, 0.15 * expected[t]);
		g_assert_cmpfloat(fabs(far - expected[t]), <=, 0.1 * expected[t]);
		struct features_options half = { .dither_per_m2 = 30 };
		g_autoptr(features) fewer = features_of(g, &half);
		g_assert_cmpfloat(
			fabs(density(g, fewer, 9) - expected[t] / 2), <=, 0.06 * expected[t]);
	}
}

/* ---- curvature ---- */

struct bend {
	float k1, k2, along_z; /* medians over what has any; along_z: of the magnitudes */
	size_t count;
};

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static struct bend bend_of(shape s, double noise_m)
{
	struct look how = { .noise_m = noise_m };
	g_autoptr(range_grid) g = look_at(s, &how);
	struct features_options options = { .range_noise_m = 0.002f };
	g_autoptr(features) f = features_of(g, &options);
	size_t cells = range_grid_cells(g), n = 0;
	g_autofree float *k1 = g_new(float, cells), *k2 = g_new(float, cells),
			 *z = g_new(float, cells);
	for (size_t i = 0; i < cells; i++) {
		float u[3];
		if (!isfinite(f->k1[i]))
			continue;
		model_unpack_normal(f->principal[i], u);
		g_assert_cmpfloat(fabsf(f->k1[i]), >=, fabsf(f->k2[i]));
		k1[n] = f->k1[i];
		k2[n] = f->k2[i];
		z[n++] = fabsf(u[2]);
	}
	g_assert_cmpuint(n, >, 500);
	qsort(k1, n, sizeof *k1, by_value);
	qsort(k2, n, sizeof *k2, by_value);
	qsort(z, n, sizeof *z, by_value);
	return (struct bend){ k1[n / 2], k2[n / 2], z[n / 2], n };
}

static void test_curvature(void)
{
	struct bend c = bend_of(column, 0), b = bend_of(ball, 0), p = bend_of(tunnel, 0),
		    w = bend_of(wall, 0);
	g_test_message(
		"column %g %g, ball %g %g, tunnel %g %g", c.k1, c.k2, b.k1, b.k2, p.k1, p.k2);
	g_assert_cmpfloat(fabsf(c.k1 - 2), <, 0.1f); /* 1 / 0.5 m, bulging */
	g_assert_cmpfloat(fabsf(c.k2), <, 0.05f);
	g_assert_cmpfloat(c.along_z, <, 0.03f); /* around it, not along it */
	g_assert_cmpfloat(fabsf(b.k1 - 1), <, 0.06f);
	g_assert_cmpfloat(fabsf(b.k2 - 1), <, 0.06f);
	g_assert_cmpfloat(fabsf(p.k1 + 1 / 3.f), <, 0.03f); /* hollow */
	g_assert_cmpfloat(fabsf(p.k2), <, 0.03f);
	g_assert_cmpfloat(fabsf(w.k1), <, 0.01f);
	c = bend_of(column, 0.002);
	g_assert_cmpfloat(fabsf(c.k1 - 2), <, 0.3f);
}

/* Without this processor's vectors it is the same, but for rounding. */
static void test_portable(void)
{
	struct look how = { .noise_m = 0.002 };
	g_autoptr(range_grid) g = look_at(column, &how);
	struct features_options portable = { .portable = true };
	g_autoptr(features) a = features_of(g, NULL);
	g_autoptr(features) b = features_of(g, &portable);
	size_t compared = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		g_assert_cmpint(abs(a->degree[i] - b->degree[i]), <=, 1);
		g_assert_cmpint(isfinite(a->k1[i]), ==, isfinite(b->k1[i]));
		if (!isfinite(a->k1[i]))
			continue;
		compared++;
		g_assert_cmpfloat(fabsf(a->k1[i] - b->k1[i]), <, 2e-3f);
		g_assert_cmpfloat(fabsf(a->k2[i] - b->k2[i]), <, 2e-3f);
	}
	g_assert_cmpuint(compared, >, 500);
}

/* ---- odd grids ---- */

static void test_threads(void)
{
	struct look how = { .noise_m = 0.012, .tone = half_black, .light = half_dark };
	g_autoptr(range_grid) g = look_at(board, &how);
	struct features_options one = { .single_thread = true };
	g_autoptr(features) a = features_of(g, NULL);
	g_autoptr(features) b = features_of(g, &one);
	size_t n = range_grid_cells(g);
	g_assert_cmpmem(a->degree, n, b->degree, n);
	g_assert_cmpmem(a->kind, n, b->kind, n);
	g_assert_cmpmem(a->flags, n, b->flags, n);
	g_assert_cmpmem(a->direction, 4 * n, b->direction, 4 * n);
	g_assert_cmpmem(a->line_error, 2 * n, b->line_error, 2 * n);
	g_assert_cmpmem(a->principal, 4 * n, b->principal, 4 * n);
}

static void test_narrow(void)
{
	static const uint32_t sizes[][2] = { { 2, 2 }, { 3, 200 }, { 200, 3 } };
	for (size_t s = 0; s < G_N_ELEMENTS(sizes); s++) {
		struct look how = { .noise_m = 0.01,
			.tone = half_black,
			.columns = sizes[s][0],
			.rows = sizes[s][1] };
		g_autoptr(range_grid) g = look_at(wall, &how);
		g_autoptr(features) f = features_of(g, NULL);
		g_assert_cmpuint(f->columns, ==, sizes[s][0]);
		g_assert_cmpuint(f->rows, ==, sizes[s][1]);
	}
}

static double few_points(const double d[3])
{
	return fabs(d[0]) < 2 * STEP && fabs(d[2]) < 2 * STEP ? 4 : 0;
}

/* A grid without any two points side by side is refused (range-grid.h); this has a few. */
static void test_empty(void)
{
	struct look how = { 0 };
	g_autoptr(range_grid) g = look_at(few_points, &how);
	g_autoptr(features) f = features_of(g, NULL);
	for (size_t i = 0; i < range_grid_cells(g); i++)
		g_assert_true(
			g->range_m[i] > 0 || (f->kind[i] == FEATURE_NONE && f->degree[i] == 0));
}

static void test_leaves_apart(void)
{
	struct look how = { .noise_m = 0.005 };
	g_autoptr(range_grid) g = look_at(corner_far, &how);
	g_autofree uint16_t *leaf = g_new(uint16_t, range_grid_cells(g));
	for (size_t i = 0; i < range_grid_cells(g); i++)
		leaf[i] = i % COLUMNS < COLUMNS / 2 ? 1 : 2;
	struct features_input of = { .grid = g, .pose = POSE_IDENTITY, .leaf = leaf };
	g_autoptr(features) f = features_of_scans(&of, 1, 0, NULL);
	for (size_t i = 0; i < range_grid_cells(g); i++)
		g_assert_cmpuint(f->kind[i], <, FEATURE_KINDS);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/features/crease", test_crease);
	g_test_add_func("/features/depth-edge", test_depth_edge);
	g_test_add_func("/features/even-wall", test_even_wall);
	g_test_add_func("/features/foliage", test_foliage);
	g_test_add_func("/features/looks", test_looks);
	g_test_add_func("/features/parameters", test_parameters);
	g_test_add_func("/features/dithering", test_dithering);
	g_test_add_func("/features/curvature", test_curvature);
	g_test_add_func("/features/portable", test_portable);
	g_test_add_func("/features/threads", test_threads);
	g_test_add_func("/features/narrow", test_narrow);
	g_test_add_func("/features/empty", test_empty);
	g_test_add_func("/features/leaves-apart", test_leaves_apart);
	return g_test_run();
}
