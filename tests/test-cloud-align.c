/* Clouds into one frame with no idea where they stand: the right pose is found and accepted, wrong ones are refused. */
#include "process/cloud-align.h"
#include "tests/cloud-made.h"
#include "tests/support.h"
#include <gio/gio.h>
#include <stdio.h>
#include <string.h>

static struct cloud_align_result align(const struct made *a, const struct made *b, uint32_t seed)
{
	struct cloud_view va = made_view(a), vb = made_view(b);
	struct cloud_align_options options = { .seed = seed };
	struct cloud_align_result r;
	g_autoptr(GError) error = NULL;
	g_assert_true(cloud_align(&va, &vb, &options, &r, &error));
	g_assert_no_error(error);
	g_assert_true(pose_is_rigid(&r.pose, 1e-9));
	g_test_message("verdict %d: %s", r.verification.verdict, r.verification.reason);
	return r;
}

/* Any turn, and up to 20 m along each axis. */
static struct pose random_pose(GRand *rand)
{
	double twist[6], length = 0;
	struct pose identity = POSE_IDENTITY;
	for (int i = 0; i < 3; i++) {
		twist[i] = g_rand_double_range(rand, -1, 1);
		twist[3 + i] = g_rand_double_range(rand, -20, 20);
		length += twist[i] * twist[i];
	}
	double angle = g_rand_double_range(rand, 0, G_PI);
	for (int i = 0; i < 3; i++)
		twist[i] *= angle / sqrt(length);
	return pose_perturb(&identity, twist);
}

/* Between the pose that was found and the true one, where the points of b are. */
static void assert_near(const struct cloud_align_result *r, const struct pose *truth,
	double max_rad, double max_m, const double at_m[3])
{
	struct pose d = pose_between(truth, &r->pose);
	double found[3], wanted[3], off = 0;
	pose_apply(&r->pose, at_m, found);
	pose_apply(truth, at_m, wanted);
	for (int k = 0; k < 3; k++)
		off += (found[k] - wanted[k]) * (found[k] - wanted[k]);
	g_test_message(
		"off by %.3f degrees, %.1f mm", pose_angle_rad(&d) / DEGREE, 1000 * sqrt(off));
	g_assert_cmpfloat(pose_angle_rad(&d), <, max_rad);
	g_assert_cmpfloat(sqrt(off), <, max_m);
}

/* ---- a yard that is known ---- */

static void add_box(
	struct made *m, const double low[3], const double high[3], double per_m2, double noise_m)
{
	for (int axis = 0; axis < 3; axis++)
		for (int side = 0; side < 2; side++) {
			int u = (axis + 1) % 3, v = (axis + 2) % 3;
			double area = (high[u] - low[u]) * (high[v] - low[v]);
			for (int i = 0; i < area * per_m2; i++) {
				double p[3];
				p[axis] = (side ? high : low)[axis] + made_normal(m, noise_m);
				p[u] = g_rand_double_range(m->rand, low[u], high[u]);
				p[v] = g_rand_double_range(m->rand, low[v], high[v]);
				made_add(m, p[0], p[1], p[2]);
			}
		}
}

/* Boxes of all sizes on the ground, which has half of the points; points are drawn anew with each seed, the boxes are those of `yard`. */
static struct made yard(guint32 yard_seed, guint32 seed, double per_m2)
{
	struct made m = made_new(seed);
	GRand *rand = g_rand_new_with_seed(yard_seed);
	add_box(&m, (double[3]){ -12, -9, -0.1 }, (double[3]){ 12, 9, 0 }, per_m2 / 2, 0.01);
	for (int i = 0; i < 9; i++) {
		double low[3] = { g_rand_double_range(rand, -11, 8),
			g_rand_double_range(rand, -8, 6), 0 };
		double high[3] = { low[0] + g_rand_double_range(rand, 0.6, 4),
			low[1] + g_rand_double_range(rand, 0.6, 4),
			g_rand_double_range(rand, 0.5, 6) };
		add_box(&m, low, high, per_m2, 0.01);
	}
	g_rand_free(rand);
	return m;
}

/* The same seed gives the same, to the last bit. */
static void assert_same(const struct cloud_align_result *r, const struct made *a,
	const struct made *b, uint32_t seed)
{
	struct cloud_align_result s = align(a, b, seed);
	for (int i = 0; i < 3; i++) {
		g_assert_cmpfloat(r->pose.translation_m[i], ==, s.pose.translation_m[i]);
		for (int k = 0; k < 3; k++)
			g_assert_cmpfloat(r->pose.rotation[i][k], ==, s.pose.rotation[i][k]);
	}
}

static void test_yard(void)
{
	GRand *rand = g_rand_new_with_seed(5);
	struct made a = yard(1, 10, 60);
	for (guint32 i = 1; i < 2; i++) {
		struct made b = yard(1, 20 + i, 60);
		double turn[3] = { 20 * i, 5, -3 };
		/* Levelled, as normals that look up tell the sides of things apart. */
		struct pose moved = pose_from_yaw(g_rand_double_range(rand, -3, 3), turn);
		made_move(&b, &moved);
		struct pose truth = pose_inverse(&moved);
		struct cloud_align_result r = align(&a, &b, i);
		g_assert_cmpint(r.verification.verdict, ==, VERDICT_ACCEPTED);
		g_assert_false(r.free_space);
		assert_near(&r, &truth, 0.1 * DEGREE, 0.015, turn);
		assert_same(&r, &a, &b, i);
		made_clear(&b);
	}
	made_clear(&a);
	g_rand_free(rand);
}

/* Near start: no search. The deviation that is told must be of the size of the error. */
static void test_near(void)
{
	struct made a = yard(2, 10, 60), b = yard(2, 11, 60);
	struct cloud_view va = made_view(&a), vb = made_view(&b);
	struct pose identity = POSE_IDENTITY,
		    start = pose_perturb(&identity, (double[6]){ 0.01, 0, 0.02, 0.1, -0.1, 0.05 });
	struct cloud_align_result r;
	g_assert_true(cloud_align_near(&va, &vb, &start, &r, NULL));
	g_assert_cmpint(r.verification.verdict, ==, VERDICT_ACCEPTED);
	assert_near(&r, &identity, 0.1 * DEGREE, 0.01, (double[3]){ 0, 0, 1 });
	g_assert_cmpfloat(r.verification.deviation_m, <, 0.01);
	g_assert_cmpfloat(r.verification.deviation_m, >, 1e-5);
	for (int i = 0; i < 6; i++)
		g_assert_cmpfloat(r.fine.covariance[i][i], >, 0);
	made_clear(&a);
	made_clear(&b);
}

/* ---- a real pair ---- */

static bool read_reference(struct pose *ret)
{
	const char *path = shared_path("data/vlp-pair/T_target_source.txt");
	FILE *file = path ? fopen(path, "r") : NULL;
	*ret = (struct pose)POSE_IDENTITY;
	for (int i = 0; i < 3 && file; i++) {
		double *r = ret->rotation[i];
		g_assert_cmpint(fscanf(file, "%lf %lf %lf %lf", &r[0], &r[1], &r[2],
					&ret->translation_m[i]),
			==, 4);
	}
	if (file)
		fclose(file);
	else
		g_test_skip("no pair of sweeps beside the checkout");
	return file;
}

/* The reference is itself a registration: several programs stand up to 0.7 degrees and 30 mm from it. */
static void test_pair(void)
{
	struct pose reference;
	if (!read_reference(&reference))
		return;
	struct made a = made_from_file(shared_path("data/vlp-pair/target.ply"), &import_ply, 1),
		    b = made_from_file(shared_path("data/vlp-pair/source.ply"), &import_ply, 1);
	struct cloud_align_result r = align(&a, &b, 0);
	g_assert_cmpint(r.verification.verdict, ==, VERDICT_ACCEPTED);
	g_assert_true(r.free_space);
	g_assert_cmpfloat(r.verification.agreement, >, 0.95);
	assert_near(&r, &reference, 0.7 * DEGREE, 0.03, (double[3]){ 0, 0, 0 });
	GRand *rand = g_rand_new_with_seed(1);
	for (uint32_t i = 0; i < 1; i++) {
		struct pose start = random_pose(rand), back = pose_inverse(&start),
			    truth = pose_compose(&reference, &back);
		struct made c = made_new(1);
		g_array_append_vals(c.xyz, b.xyz->data, b.xyz->len);
		made_move(&c, &start);
		struct cloud_view va = made_view(&a), vc = made_view(&c);
		vc.has_viewpoint = true;
		for (int k = 0; k < 3; k++)
			vc.viewpoint_m[k] = start.translation_m[k];
		struct cloud_align_options options = { .seed = i };
		g_assert_true(cloud_align(&va, &vc, &options, &r, NULL));
		g_assert_cmpint(r.verification.verdict, ==, VERDICT_ACCEPTED);
		assert_near(&r, &truth, 0.7 * DEGREE, 0.03, start.translation_m);
		made_clear(&c);
	}
	g_rand_free(rand);
	made_clear(&a);
	made_clear(&b);
}

/* ---- refused ---- */

static void assert_refused(const struct made *a, const struct made *b)
{
	struct cloud_align_result r = align(a, b, 1);
	g_assert_cmpint(r.verification.verdict, !=, VERDICT_ACCEPTED);
	g_assert_cmpuint(strlen(r.verification.reason), >, 10);
}

static void test_unrelated(void)
{
	struct made a = yard(1, 10, 8), b = yard(77, 11, 8), flat = made_new(1);
	add_box(&flat, (double[3]){ -12, -9, -0.1 }, (double[3]){ 12, 9, 0 }, 8, 0.01);
	assert_refused(&a, &b);
	struct cloud_view ground = made_view(&flat); /* fits itself anywhere */
	struct pose identity = POSE_IDENTITY;
	struct cloud_align_result r;
	g_assert_true(cloud_align_near(&ground, &ground, &identity, &r, NULL));
	g_assert_cmpint(r.verification.verdict, !=, VERDICT_ACCEPTED);
	made_clear(&a);
	made_clear(&b);
	made_clear(&flat);
}

static void test_unrelated_real(void)
{
	const char *sweep = shared_path("data/vlp-pair/target.ply"),
		   *office = shared_path("data/office/office1.pcd"),
		   *town = shared_path("data/aerial-town/ign-77050-627755.las");
	if (!sweep || !office || !town) {
		g_test_skip("no clouds beside the checkout");
		return;
	}
	struct made a = made_from_file(sweep, &import_ply, 6),
		    b = made_from_file(office, &import_pcd, 80),
		    c = made_from_file(town, &import_las, 16);
	assert_refused(&a, &b);
	assert_refused(&a, &c);
	made_clear(&a);
	made_clear(&b);
	made_clear(&c);
}

static void test_unusable(void)
{
	struct made a = yard(1, 10, 15), few = made_new(1), one = made_new(2);
	for (int i = 0; i < 500; i++) {
		if (i < 99)
			made_add(&few, i, 0, 0);
		made_add(&one, 1, 2, 3);
	}
	struct cloud_view va = made_view(&a), vb = made_view(&few);
	struct cloud_align_result r;
	g_autoptr(GError) error = NULL;
	g_assert_false(cloud_align(&va, &vb, NULL, &r, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA);
	g_clear_error(&error);
	made_at(&a, 7)[1] = NAN;
	g_assert_false(cloud_align(&va, &va, NULL, &r, &error));
	g_assert_nonnull(strstr(error->message, "point 8 of cloud A"));
	made_at(&a, 7)[1] = 0;
	assert_refused(&a, &one);
	made_clear(&a);
	made_clear(&few);
	made_clear(&one);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/cloud-align/yard", test_yard);
	g_test_add_func("/cloud-align/near", test_near);
	g_test_add_func("/cloud-align/pair", test_pair);
	g_test_add_func("/cloud-align/unrelated", test_unrelated);
	g_test_add_func("/cloud-align/unrelated-real", test_unrelated_real);
	g_test_add_func("/cloud-align/unusable", test_unusable);
	return g_test_run();
}
