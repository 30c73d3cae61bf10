#include "process/pose.h"
#include <glib.h>
#include <math.h>

static double random_between(double low, double high)
{
	return g_test_rand_double_range(low, high);
}

static struct pose any_pose(double angle_max, double distance)
{
	double twist[6];
	for (int i = 0; i < 3; i++) {
		twist[i] = random_between(-angle_max, angle_max) / sqrt(3);
		twist[3 + i] = random_between(-distance, distance);
	}
	struct pose identity = POSE_IDENTITY;
	return pose_perturb(&identity, twist);
}

static void assert_same(const struct pose *p, const struct pose *q, double tolerance)
{
	for (int i = 0; i < 3; i++) {
		g_assert_cmpfloat_with_epsilon(p->translation_m[i], q->translation_m[i], tolerance);
		for (int j = 0; j < 3; j++)
			g_assert_cmpfloat_with_epsilon(
				p->rotation[i][j], q->rotation[i][j], tolerance);
	}
}

static void test_inverse_undoes(void)
{
	struct pose identity = POSE_IDENTITY;
	for (int i = 0; i < 100; i++) {
		struct pose p = any_pose(3, 20), back = pose_inverse(&p),
			    both = pose_compose(&back, &p);
		assert_same(&both, &identity, 1e-12);
		g_assert_true(pose_is_rigid(&p, 1e-12));
	}
}

static void test_compose_applies_in_order(void)
{
	for (int i = 0; i < 100; i++) {
		struct pose p = any_pose(3, 20), q = any_pose(3, 20), both = pose_compose(&q, &p);
		double point[3] = { 1, -2, 3 }, one[3] = { 1, -2, 3 };
		pose_apply(&p, point, point);
		pose_apply(&q, point, point);
		pose_apply(&both, one, one);
		for (int k = 0; k < 3; k++)
			g_assert_cmpfloat_with_epsilon(point[k], one[k], 1e-12);
	}
}

static void test_difference_is_what_perturb_adds(void)
{
	for (int i = 0; i < 1000; i++) {
		double size = pow(10, random_between(-9, 0.49)); /* up to nearly half a turn */
		struct pose p = any_pose(3, 20);
		double twist[6], found[6];
		for (int k = 0; k < 6; k++)
			twist[k] = random_between(-size, size) / sqrt(3);
		struct pose q = pose_perturb(&p, twist);
		pose_difference(&p, &q, found);
		for (int k = 0; k < 6; k++)
			g_assert_cmpfloat_with_epsilon(twist[k], found[k], 1e-11 + 1e-8 * size);
	}
}

static void test_angle_is_exact_at_both_ends(void)
{
	for (int i = 0; i < 200; i++) {
		double angle = i < 100 ? pow(10, random_between(-10, 0))
				       : G_PI - pow(10, random_between(-9, 0));
		double axis[3] = { random_between(-1, 1), random_between(-1, 1),
			random_between(-1, 1) };
		double n = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
		double twist[6] = { axis[0] / n * angle, axis[1] / n * angle, axis[2] / n * angle };
		struct pose identity = POSE_IDENTITY, p = pose_perturb(&identity, twist);
		g_assert_cmpfloat_with_epsilon(pose_angle_rad(&p), angle, 1e-11 + 1e-7 * angle);
		double found[6];
		pose_difference(&identity, &p, found);
		for (int k = 0; k < 3; k++)
			g_assert_cmpfloat_with_epsilon(found[k], twist[k], 1e-7);
	}
}

static void test_half_a_turn_has_an_axis(void)
{
	struct pose identity = POSE_IDENTITY, half = POSE_IDENTITY;
	half.rotation[0][0] = half.rotation[1][1] = -1;
	double twist[6];
	pose_difference(&identity, &half, twist);
	g_assert_cmpfloat_with_epsilon(fabs(twist[2]), G_PI, 1e-12);
	g_assert_cmpfloat_with_epsilon(fabs(twist[0]) + fabs(twist[1]), 0, 1e-12);
}

static void test_yaw_is_clockwise(void)
{
	double there[3] = { 0 }, north[3] = { 0, 1, 0 };
	struct pose p = pose_from_yaw(G_PI / 2, there);
	pose_rotate(&p, north, north);
	g_assert_cmpfloat_with_epsilon(
		north[0], 1, 1e-12); /* a quarter clockwise of north is east */
	for (double yaw = -3; yaw <= 3; yaw += 0.37) {
		p = pose_from_yaw(yaw, there);
		g_assert_cmpfloat_with_epsilon(pose_yaw_rad(&p), yaw, 1e-12);
	}
}

static void test_orthonormalise_mends_rounding(void)
{
	for (int i = 0; i < 100; i++) {
		struct pose p = any_pose(3, 5), bent = p;
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				bent.rotation[r][c] += random_between(-1e-4, 1e-4);
		g_assert_false(pose_is_rigid(&bent, 1e-9));
		pose_orthonormalise(&bent);
		g_assert_true(pose_is_rigid(&bent, 1e-12));
		assert_same(&bent, &p, 4e-4);
	}
}

static void test_mirrors_and_nonsense_are_not_rigid(void)
{
	struct pose p = POSE_IDENTITY;
	p.rotation[0][0] = -1;
	g_assert_false(pose_is_rigid(&p, 1e-6));
	p = POSE_IDENTITY;
	p.rotation[1][1] = 1.001;
	g_assert_false(pose_is_rigid(&p, 1e-6));
	p = POSE_IDENTITY;
	p.translation_m[2] = NAN;
	g_assert_false(pose_is_rigid(&p, 1e-6));
	p = POSE_IDENTITY;
	p.rotation[2][0] = NAN;
	g_assert_false(pose_is_rigid(&p, 1e-6));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/pose/inverse", test_inverse_undoes);
	g_test_add_func("/pose/compose", test_compose_applies_in_order);
	g_test_add_func("/pose/difference", test_difference_is_what_perturb_adds);
	g_test_add_func("/pose/angle", test_angle_is_exact_at_both_ends);
	g_test_add_func("/pose/half-turn", test_half_a_turn_has_an_axis);
	g_test_add_func("/pose/yaw", test_yaw_is_clockwise);
	g_test_add_func("/pose/orthonormalise", test_orthonormalise_mends_rounding);
	g_test_add_func("/pose/not-rigid", test_mirrors_and_nonsense_are_not_rigid);
	return g_test_run();
}
