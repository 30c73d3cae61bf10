#include "tests/placed-scans.h"

static struct verification verify_at(
	const char *a, const char *b, const double twist[6], struct verify_map *map)
{
	struct pose right = pose_between(&placed_scan(a)->pose, &placed_scan(b)->pose);
	struct fine_result fine = { .pose = pose_perturb(&right, twist) };
	struct verification v;
	pair_verify(pair_scan_of(a), pair_scan_of(b), &fine, &v, map);
	g_test_message(
		"%s: %s agreement %.3f overlap %.2f of %.2f sr, rms %.1f mm, rest %.1f mm %.3f deg",
		verdict_names[v.verdict], v.reason, v.agreement, v.overlap, v.agree_sr,
		1e3 * v.rms_m, 1e3 * v.rest_m, v.rest_rad * 180 / G_PI);
	g_assert_cmpuint(strlen(v.reason), >, 20);
	return v;
}

static const double still[6] = { 0 };

struct given {
	const char *name, *a, *b;
};
static const struct given pairs[] = {
	{ "court", "court?seed=9&station=1", "court?seed=9&station=3" },
	{ "street", "street?seed=9&station=1", "street?seed=9&station=3" },
};

static void test_truth(gconstpointer data)
{
	const struct given *g = data;
	struct verification v = verify_at(g->a, g->b, still, NULL);
	g_assert_cmpint(v.verdict, ==, VERDICT_ACCEPTED);
	g_assert_cmpfloat(v.agreement, >, 0.97);
	g_assert_cmpfloat(v.agree_sr, >, 3);
	g_assert_cmpfloat(v.rms_m, <, 0.015);
	g_assert_cmpfloat(v.balance, >, 0.1);
	g_assert_cmpfloat(v.rest_m, <, 0.003);
	g_assert_cmpfloat(v.rest_rad, <, 0.02 * G_PI / 180);
}

/* Every 5 cm and half a degree must be seen, whichever way. */
static void test_shifted(gconstpointer data)
{
	const struct given *g = data;
	static const double moves[] = { 0.05, -0.05, 0.2, 1.0 }, turns[] = { 0.4, 1, 5 };
	struct verification right = verify_at(g->a, g->b, still, NULL);
	for (int axis = 0; axis < 3; axis++)
		for (gsize i = 0; i < G_N_ELEMENTS(moves); i++) {
			double twist[6] = { 0 };
			twist[3 + axis] = moves[i];
			struct verification v = verify_at(g->a, g->b, twist, NULL);
			g_assert_cmpint(v.verdict, !=, VERDICT_ACCEPTED);
			g_assert_cmpfloat(v.agreement, <, right.agreement);
			g_assert_cmpfloat(v.rest_m, >, 5 * right.rest_m);
		}
	for (int axis = 0; axis < 3; axis++)
		for (gsize i = 0; i < G_N_ELEMENTS(turns); i++) {
			double twist[6] = { 0 };
			twist[axis] = turns[i] * G_PI / 180;
			struct verification v = verify_at(g->a, g->b, twist, NULL);
			g_assert_cmpint(v.verdict, !=, VERDICT_ACCEPTED);
		}
}

static void test_both_ways(void)
{
	const struct given *g = &pairs[0];
	struct verification forth = verify_at(g->a, g->b, still, NULL),
			    back = verify_at(g->b, g->a, still, NULL);
	g_assert_cmpfloat_with_epsilon(forth.agree_sr, back.agree_sr, 1e-3 * forth.agree_sr);
	g_assert_cmpfloat_with_epsilon(forth.overlap, back.overlap, 1e-3);
}

static void test_other_site(void)
{
	struct verification v = verify_at(pairs[0].a, pairs[1].b, still, NULL);
	g_assert_cmpint(v.verdict, !=, VERDICT_ACCEPTED);
	g_assert_cmpfloat(v.agreement, <, 0.9);
}

static void count_cells(const struct verify_map *m, size_t ret[VERIFY_OUTSIDE + 1])
{
	memset(ret, 0, (VERIFY_OUTSIDE + 1) * sizeof *ret);
	for (size_t i = 0; i < (size_t)m->columns * m->rows; i++) {
		g_assert_cmpuint(m->cell[i], <=, VERIFY_OUTSIDE);
		ret[m->cell[i]]++;
		if (m->cell[i] != VERIFY_AGREE)
			g_assert_cmpfloat(m->distance_m[i], ==, 0);
		else
			g_assert_cmpfloat(fabsf(m->distance_m[i]), <, 0.13);
	}
}

/* The map shows the same as the figures, and where a wrong pose is wrong. */
static void test_map(void)
{
	const double raised[6] = { 0, 0, 0, 0, 0, 0.5 };
	struct verify_map map;
	size_t right[VERIFY_OUTSIDE + 1], wrong[VERIFY_OUTSIDE + 1];
	verify_at(pairs[0].a, pairs[0].b, still, &map);
	g_assert_cmpuint(map.columns, ==, placed_scan(pairs[0].b)->grid->columns);
	count_cells(&map, right);
	verify_map_clear(&map);
	verify_at(pairs[0].a, pairs[0].b, raised, &map);
	count_cells(&map, wrong);
	verify_map_clear(&map);
	g_assert_null(map.cell);
	g_assert_cmpuint(right[VERIFY_AGREE], >, 20000);
	g_assert_cmpuint(right[VERIFY_OCCLUDED], >, 1000);
	g_assert_cmpuint(wrong[VERIFY_CONFLICT], >, 5 * right[VERIFY_CONFLICT] + 1000);
	g_assert_cmpuint(
		wrong[VERIFY_AGREE], <, right[VERIFY_AGREE] * 17 / 20); /* walls still do */
}

/* Walls, floor and ceiling agree wherever along the corridor one stands. */
static void test_corridor(void)
{
	g_autoptr(range_grid) grid = corridor_grid();
	g_autoptr(pair_scan) a = pair_scan_new(grid);
	g_autoptr(pair_scan) b = pair_scan_new(grid);
	struct fine_result fine = { .pose = POSE_IDENTITY };
	struct verification v;
	fine.pose.translation_m[1] = 2;
	pair_verify(a, b, &fine, &v, NULL);
	g_test_message("%s", v.reason);
	g_assert_cmpfloat(v.agreement, >, 0.99);
	g_assert_cmpint(v.verdict, ==, VERDICT_SLIDING);
}

/* ---- things beside the scanner ---- */

struct box {
	double least_m[3], most_m[3]; /* in the scanner's frame */
};

/* Where the ray enters it, in ranges of the ray; infinite: not. */
static double entry(const struct box *b, const double ray[3])
{
	double in = 0, out = INFINITY;
	for (int k = 0; k < 3; k++) {
		double inverse = 1 / (fabs(ray[k]) > 1e-9 ? ray[k] : 1e-9);
		double one = b->least_m[k] * inverse, other = b->most_m[k] * inverse;
		in = fmax(in, fmin(one, other));
		out = fmin(out, fmax(one, other));
	}
	return in < out ? in : INFINITY;
}

/* The scan, had the box stood there. */
static range_grid *with_box(const range_grid *g, const struct box *box)
{
	size_t cells = range_grid_cells(g);
	g_autofree double *xyz = g_new0(double, 3 * cells);
	g_autoptr(GError) error = NULL;
	for (size_t i = 0; i < cells; i++) {
		double ray[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		double to = g->range_m[i] > 0 ? fmin(entry(box, ray), 1) : 0;
		for (int k = 0; k < 3; k++)
			xyz[k * cells + i] = to * ray[k];
	}
	struct range_grid_desc desc = { .columns = g->columns,
		.rows = g->rows,
		.x_m = xyz,
		.y_m = xyz + cells,
		.z_m = xyz + 2 * cells,
		.cell = g->cell };
	range_grid *ret = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	return ret;
}

static struct verification verify_with(const struct box *box)
{
	const struct given *g = &pairs[1];
	g_autoptr(range_grid) grid = with_box(placed_scan(g->b)->grid, box);
	g_autoptr(pair_scan) b = pair_scan_new(grid);
	struct fine_result fine = { .pose = pose_between(
					    &placed_scan(g->a)->pose, &placed_scan(g->b)->pose) };
	struct verification v;
	pair_verify(pair_scan_of(g->a), b, &fine, &v, NULL);
	g_test_message("conflict %.3f thing %.3f of %.2f sr; %s", v.conflict_sr, v.thing_sr,
		v.agree_sr, v.reason);
	return v;
}

/* A van that parked beside the scanner says nothing of the pose; a wall across the street does. */
static void test_thing(void)
{
	const struct box van = { { 1.5, -2, -1.7 }, { 3.3, 2.4, 0.6 } },
			 wall = { { -20, 3, -1.7 }, { 20, 3.2, 3 } };
	struct verification with_van = verify_with(&van), with_wall = verify_with(&wall);
	g_assert_cmpfloat(with_van.thing_sr, >, 0.3);
	g_assert_cmpint(with_van.verdict, ==, VERDICT_ACCEPTED);
	g_assert_cmpfloat(verify_contradiction(&with_van), <, 0.03);
	g_assert_nonnull(strstr(with_van.reason, "came or went"));
	g_assert_cmpfloat(with_wall.thing_sr, ==, 0);
	g_assert_cmpint(with_wall.verdict, ==, VERDICT_CONFLICT);
}

/* ---- the verdict, from figures alone ---- */

static const struct verification fine_one = { .agree_sr = 6,
	.conflict_sr = 0.02,
	.overlap = 0.7,
	.agreement = 0.99,
	.balance = 0.5,
	.deviation_m = 5e-4,
	.deviation_rad = 3e-5 };

static void assert_judged(const struct verification *v, const struct verification *rival,
	enum verdict expected, const char *figure)
{
	struct verification judged = *v;
	verify_judge(&judged, rival);
	g_test_message("%s: %s", verdict_names[judged.verdict], judged.reason);
	g_assert_cmpint(judged.verdict, ==, expected);
	g_assert_nonnull(strstr(judged.reason, figure));
}

static void test_verdicts(void)
{
	struct verification v = fine_one, rival = fine_one;
	assert_judged(&v, NULL, VERDICT_ACCEPTED, "70 %");
	v.agree_sr = 0.2;
	assert_judged(&v, NULL, VERDICT_NO_OVERLAP, "0.20 sr");
	v = fine_one;
	v.conflict_sr = 0.8;
	assert_judged(&v, NULL, VERDICT_CONFLICT, "11.8 %");
	v.conflict_sr = 0.4; /* cars elsewhere */
	assert_judged(&v, NULL, VERDICT_ACCEPTED, "70 %");
	v.agree_sr = 1; /* but not where so little is shared */
	v.conflict_sr = 0.05;
	assert_judged(&v, NULL, VERDICT_CONFLICT, "4.8 %");
	v = fine_one;
	v.agreement = 0.85;
	assert_judged(&v, NULL, VERDICT_CONFLICT, "15.0 %");
	v = fine_one;
	v.deviation_m = 0.05;
	assert_judged(&v, NULL, VERDICT_SLIDING, "50 mm");
	v = fine_one;
	v.balance = 0.003;
	assert_judged(&v, NULL, VERDICT_SLIDING, "0.1 %");
	v = fine_one;
	v.deviation_rad = 2e-3 * G_PI / 18;
	assert_judged(&v, NULL, VERDICT_IMPRECISE, "0.020 degrees");
	v = fine_one;
	v.rest_m = 0.04;
	assert_judged(&v, NULL, VERDICT_IMPRECISE, "40 mm");
	v = fine_one;
	assert_judged(&v, &rival, VERDICT_AMBIGUOUS, "0.3 %");
	rival.conflict_sr = 0.5; /* scattered: it refutes nothing */
	assert_judged(&v, &rival, VERDICT_AMBIGUOUS, "0.3 %");
	rival.together_sr = 0.4;
	assert_judged(&v, &rival, VERDICT_ACCEPTED, "70 %");
	v.together_sr = 0.25; /* things moved: then the rival's may have moved too */
	assert_judged(&v, &rival, VERDICT_AMBIGUOUS, "7.7 %");
	v = fine_one;
	rival = (struct verification){ .agree_sr = 0.1 }; /* shares next to nothing: no rival */
	assert_judged(&v, &rival, VERDICT_ACCEPTED, "70 %");
	verify_no_solution(&v);
	g_assert_cmpint(v.verdict, ==, VERDICT_NO_SOLUTION);
	for (int i = 0; i < VERDICTS; i++)
		g_assert_nonnull(verdict_names[i]);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (gsize i = 0; i < G_N_ELEMENTS(pairs); i++) {
		g_autofree char *at_truth = g_strconcat("/verify/truth/", pairs[i].name, NULL);
		g_autofree char *shifted = g_strconcat("/verify/shifted/", pairs[i].name, NULL);
		g_test_add_data_func(at_truth, &pairs[i], test_truth);
		g_test_add_data_func(shifted, &pairs[i], test_shifted);
	}
	g_test_add_func("/verify/both-ways", test_both_ways);
	g_test_add_func("/verify/other-site", test_other_site);
	g_test_add_func("/verify/map", test_map);
	g_test_add_func("/verify/corridor", test_corridor);
	g_test_add_func("/verify/thing", test_thing);
	g_test_add_func("/verify/verdicts", test_verdicts);
	return g_test_run();
}
