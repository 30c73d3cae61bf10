/* Picked pairs: the motion they tell, and those that do not fit the rest. */
#include "process/picks.h"
#include <math.h>

#define DEGREE (G_PI / 180)

static double normal(GRand *chance)
{
	double u = 1 - g_rand_double(chance), v = g_rand_double(chance);
	return sqrt(-2 * log(u)) * cos(2 * G_PI * v);
}

static struct pose any_pose(GRand *chance)
{
	double twist[6];
	for (int i = 0; i < 6; i++)
		twist[i] = g_rand_double_range(chance, -1, 1) * (i < 3 ? 1.8 : 30);
	return pose_perturb(&POSE_IDENTITY, twist);
}

/* Points of a room of 12 x 8 x 4 m, far from the origin of b by up to 100 m. */
static void make(
	struct pick *p, size_t count, const struct pose *pose, double noise_m, GRand *chance)
{
	double origin[3];
	for (int k = 0; k < 3; k++)
		origin[k] = g_rand_double_range(chance, -100, 100);
	for (size_t i = 0; i < count; i++) {
		double size[3] = { 12, 8, 4 };
		for (int k = 0; k < 3; k++)
			p[i].b_m[k] = origin[k] + size[k] * g_rand_double(chance);
		pose_apply(pose, p[i].b_m, p[i].a_m);
		for (int k = 0; k < 3; k++)
			p[i].a_m[k] += noise_m * normal(chance);
	}
}

static void test_exact(void)
{
	GRand *chance = g_rand_new_with_seed(1);
	for (int pass = 0; pass < 300; pass++) {
		struct pick p[30];
		size_t count = 3 + (size_t)pass % 28;
		struct pose truth = any_pose(chance);
		struct picks_fit f;
		g_autoptr(GError) error = NULL;
		make(p, count, &truth, 0, chance);
		if (!picks_fit(p, count, &f, &error)) {
			/* three of a room's points may happen to be on a line */
			g_assert_cmpuint(count, ==, 3);
			g_assert_error(error, PICKS_ERROR, PICKS_ERROR_DEGENERATE);
			continue;
		}
		g_assert_cmpuint(f.blunders, ==, 0);
		g_assert_cmpfloat(f.rms_m, <, 1e-9);
		for (size_t i = 0; i < count; i++)
			g_assert_cmpfloat(f.residual_m[i], <, 1e-9);
		struct pose d = pose_between(&truth, &f.pose);
		g_assert_cmpfloat(pose_angle_rad(&d), <, 1e-9);
		g_assert_true(pose_is_rigid(&f.pose, 1e-12));
		picks_fit_clear(&f);
	}
	g_rand_free(chance);
}

/* With noise: as good as least squares can be, that is, residuals of the size of the noise, and no pair taken for a blunder
 * that is none more than now and then. */
static void test_noise(void)
{
	GRand *chance = g_rand_new_with_seed(2);
	double squares = 0, worst_rad = 0;
	size_t blunders = 0;
	for (int pass = 0; pass < 200; pass++) {
		struct pick p[10];
		struct pose truth = any_pose(chance);
		struct picks_fit f;
		make(p, 10, &truth, 0.02, chance);
		g_assert_true(picks_fit(p, 10, &f, NULL));
		struct pose d = pose_between(&truth, &f.pose);
		worst_rad = fmax(worst_rad, pose_angle_rad(&d));
		squares += f.rms_m * f.rms_m / 200;
		blunders += f.blunders;
		picks_fit_clear(&f);
	}
	/* 30 equations less 6 unknowns, three of them a pair */
	double expected = 0.02 * sqrt(3.0 * 24 / 30);
	g_test_message("rms %g m, expected %g; worst turn %g degrees; %zu of 2000 left out",
		sqrt(squares), expected, worst_rad / DEGREE, blunders);
	g_assert_cmpfloat_with_epsilon(sqrt(squares), expected, 0.1 * expected);
	g_assert_cmpfloat(worst_rad, <, 1.0 * DEGREE);
	g_assert_cmpuint(blunders, <=, 20);
	g_rand_free(chance);
}

static void spoil(struct pick *p, GRand *chance)
{
	double by_m = g_rand_double_range(chance, 0.7, 6), turn = g_rand_double(chance) * 6.28;
	p->a_m[0] += by_m * cos(turn);
	p->a_m[1] += by_m * sin(turn);
}

/* One or two of six, one of four, seven of fifteen, and many of many. */
static void test_blunders(void)
{
	static const size_t cases[][2] = { { 6, 1 }, { 6, 2 }, { 4, 1 }, { 15, 7 }, { 60, 25 } };
	GRand *chance = g_rand_new_with_seed(3);
	size_t missed = 0, all = 0;
	for (int pass = 0; pass < 250; pass++) {
		struct pick p[60];
		size_t count = cases[pass % 5][0], wrong = cases[pass % 5][1];
		struct pose truth = any_pose(chance);
		struct picks_fit f;
		g_autoptr(GError) error = NULL;
		make(p, count, &truth, 0.005, chance);
		for (size_t i = 0; i < wrong; i++)
			spoil(&p[2 * i], chance);
		all++;
		if (!picks_fit(p, count, &f, &error)) {
			/* three that are left may be on a line */
			g_assert_error(error, PICKS_ERROR, PICKS_ERROR_DEGENERATE);
			missed++;
			continue;
		}
		bool named = f.blunders == wrong;
		for (size_t i = 0; i < wrong; i++)
			named &= f.blunder[2 * i] && f.residual_m[2 * i] > 0.3;
		missed += !named;
		if (named)
			g_assert_cmpfloat(f.rms_m, <, 0.02);
		picks_fit_clear(&f);
	}
	/* Of four, three with the wrong one among them agree as well now and then. */
	g_test_message("%zu of %zu not named", missed, all);
	g_assert_cmpuint(missed, <=, all / 40);
	g_rand_free(chance);
}

/* What is seen in a mirror: a reflection would fit exactly, a motion does not. */
static void test_reflection(void)
{
	GRand *chance = g_rand_new_with_seed(4);
	struct pick p[8];
	struct picks_fit f;
	g_autoptr(GError) error = NULL;
	make(p, 8, &POSE_IDENTITY, 0, chance);
	for (int i = 0; i < 8; i++)
		p[i].a_m[0] = -p[i].a_m[0];
	g_assert_false(picks_fit(p, 8, &f, &error));
	g_assert_error(error, PICKS_ERROR, PICKS_ERROR_DISAGREE);
	/* On a plane, the mirror's view is also that of a turn: fine. */
	for (int i = 0; i < 8; i++)
		p[i].a_m[2] = p[i].b_m[2] = 1;
	g_clear_error(&error);
	g_assert_true(picks_fit(p, 8, &f, &error));
	const double(*r)[3] = f.pose.rotation;
	double determinant = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
			     r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
			     r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
	g_assert_cmpfloat_with_epsilon(determinant, 1, 1e-9);
	g_assert_cmpfloat(f.rms_m, <, 1e-9);
	picks_fit_clear(&f);
	g_rand_free(chance);
}

static void assert_refused(const struct pick *p, size_t count, int code)
{
	struct picks_fit f;
	g_autoptr(GError) error = NULL;
	g_assert_false(picks_fit(p, count, &f, &error));
	g_assert_error(error, PICKS_ERROR, code);
	g_test_message("%s", error->message);
	g_assert_null(f.residual_m);
	g_assert_null(f.blunder);
}

static void test_refused(void)
{
	GRand *chance = g_rand_new_with_seed(5);
	struct pose truth = any_pose(chance);
	struct pick p[9] = { 0 };
	assert_refused(p, 0, PICKS_ERROR_FEW);
	assert_refused(p, 9, PICKS_ERROR_DEGENERATE); /* all at one place */
	make(p, 9, &truth, 0, chance);
	assert_refused(p, 2, PICKS_ERROR_FEW);
	for (int i = 0; i < 9; i++) {
		p[i].b_m[0] = 2 + i;
		p[i].b_m[1] = 1 + 2 * i;
		p[i].b_m[2] = 0.01 * (i % 2);
		pose_apply(&truth, p[i].b_m, p[i].a_m);
	}
	assert_refused(p, 9, PICKS_ERROR_DEGENERATE);
	assert_refused(p, 3, PICKS_ERROR_DEGENERATE);
	/* One beside the line is enough; a wrong one beside it is not. */
	p[4].b_m[1] += 3;
	pose_apply(&truth, p[4].b_m, p[4].a_m);
	struct picks_fit f;
	g_assert_true(picks_fit(p, 9, &f, NULL));
	picks_fit_clear(&f);
	p[4].a_m[0] += 2;
	assert_refused(p, 9, PICKS_ERROR_DEGENERATE);
	make(p, 9, &truth, 0, chance);
	for (int i = 0; i < 9; i++)
		for (int k = 0; k < 3; k++)
			p[i].a_m[k] = g_rand_double_range(chance, -20, 20);
	assert_refused(p, 9, PICKS_ERROR_DISAGREE);
	assert_refused(p, 3, PICKS_ERROR_DISAGREE);
	g_rand_free(chance);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/picks/exact", test_exact);
	g_test_add_func("/picks/noise", test_noise);
	g_test_add_func("/picks/blunders", test_blunders);
	g_test_add_func("/picks/reflection", test_reflection);
	g_test_add_func("/picks/refused", test_refused);
	return g_test_run();
}
