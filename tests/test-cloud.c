/* Surfaces that are known, and what is said of them; real clouds, of which every point must get a normal; sweeps of lidars. */
#include "process/cloud.h"
#include "tests/cloud-made.h"
#include "tests/support.h"
#include <gio/gio.h>
#include <string.h>

static cloud_geometry *estimate(
	const struct cloud_view *v, const struct cloud_geometry_options *options)
{
	g_autoptr(GError) error = NULL;
	cloud_geometry *g = cloud_geometry_estimate(v, options, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(g->count, ==, v->count);
	return g;
}

static double angle_between(const float *n, const double *to)
{
	double dot = 0, length = 0;
	for (int k = 0; k < 3; k++) {
		dot += n[k] * to[k];
		length += to[k] * to[k];
	}
	return acos(CLAMP(dot / sqrt(length), -1, 1)) / DEGREE;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double quantile(double *values, size_t count, double q)
{
	qsort(values, count, sizeof *values, by_value);
	return values[(size_t)(q * (double)(count - 1))];
}

/* ---- a plane ---- */

static void slope(struct made *m, double side_m, size_t count, double noise_m)
{
	for (size_t i = 0; i < count; i++) {
		double x = g_rand_double_range(m->rand, 0, side_m),
		       y = g_rand_double_range(m->rand, 0, side_m), d = made_normal(m, noise_m);
		/* 30 degrees about y */
		made_add(m, x * cos(30 * DEGREE) + d * sin(30 * DEGREE), y,
			-x * sin(30 * DEGREE) + d * cos(30 * DEGREE));
	}
}

static void test_plane(void)
{
	static const double normal[3] = { 0.5, 0, 0.86602540378443865 };
	struct made m = made_new(1);
	slope(&m, 10, 40000, 0);
	struct cloud_view v = made_view(&m);
	g_autoptr(cloud_geometry) g = estimate(&v, NULL);
	for (size_t i = 0; i < v.count; i++) {
		g_assert_cmpfloat(angle_between(g->normal[i], normal), <, 0.1);
		g_assert_cmpfloat(g->plane_error_m[i], <, 1e-5);
		g_assert_cmpfloat(g->curvature[i], <, 1e-6);
	}
	/* 400 points a square metre: 5 cm each. */
	double sum = 0;
	for (size_t i = 0; i < v.count; i++)
		sum += g->point_size_m[i];
	g_assert_cmpfloat(fabs(sum / (double)v.count - 0.05), <, 0.005);
	made_clear(&m);
}

/* Points so dense that the nearest are nothing but noise: the window is as wide as it must be. */
static void test_dense_noise(void)
{
	static const double normal[3] = { 0.5, 0, 0.86602540378443865 };
	struct made m = made_new(2);
	slope(&m, 1, 40000, 0.004);
	struct cloud_view v = made_view(&m);
	struct cloud_geometry_options options = { .radius_m = 0.1f };
	g_autoptr(cloud_geometry) g = estimate(&v, &options);
	g_autofree double *off = g_new(double, v.count);
	double error = 0, size = 0;
	for (size_t i = 0; i < v.count; i++) {
		off[i] = angle_between(g->normal[i], normal);
		error += g->plane_error_m[i];
		size += g->point_size_m[i];
	}
	g_assert_cmpfloat(quantile(off, v.count, 0.5), <, 3);
	g_assert_cmpfloat(quantile(off, v.count, 0.99), <, 10);
	g_assert_cmpfloat(fabs(error / (double)v.count - 0.004), <, 0.0008);
	g_assert_cmpfloat(fabs(size / (double)v.count - 0.005), <, 0.001);
	made_clear(&m);
}

/* ---- a sphere ---- */

static void ball(struct made *m, size_t count, double noise_m)
{
	for (size_t i = 0; i < count; i++) {
		double z = g_rand_double_range(m->rand, -1, 1),
		       a = g_rand_double_range(m->rand, 0, 2 * G_PI),
		       r = 5 + made_normal(m, noise_m), level = r * sqrt(1 - z * z);
		made_add(m, level * cos(a), level * sin(a), r * z);
	}
}

static void check_ball(const struct cloud_view *v, const struct made *m, double sign, double limit)
{
	g_autoptr(cloud_geometry) g = estimate(v, NULL);
	g_autofree double *off = g_new(double, v->count);
	for (size_t i = 0; i < v->count; i++) {
		double out[3];
		for (int k = 0; k < 3; k++)
			out[k] = sign * made_at(m, i)[k];
		off[i] = angle_between(g->normal[i], out);
	}
	g_assert_cmpfloat(quantile(off, v->count, 0.5), <, limit);
	g_assert_cmpfloat(quantile(off, v->count, 0.999), <, 8 * limit);
}

static void test_sphere(void)
{
	struct made m = made_new(3);
	ball(&m, 30000, 0.005);
	struct cloud_view v = made_view(&m);
	v.has_viewpoint = true; /* within: all look to the middle */
	check_ball(&v, &m, -1, 3);
	made_clear(&m);
}

/* ---- which way ---- */

/* A house on a field, as from the air: roofs and ground look up, walls out. */
static void test_outwards(void)
{
	struct made m = made_new(4);
	for (int i = 0; i < 40000; i++) {
		double x = g_rand_double_range(m.rand, -20, 20),
		       y = g_rand_double_range(m.rand, -20, 20);
		made_add(&m, x, y, fabs(x) < 5 && fabs(y) < 5 ? 8 : 0);
	}
	size_t walls = m.xyz->len / 3;
	for (int i = 0; i < 8000; i++) {
		double along = g_rand_double_range(m.rand, -4.5, 4.5),
		       z = g_rand_double_range(m.rand, 0.5, 7.5);
		int side = i % 4;
		double across = side % 2 ? 5 : -5;
		made_add(&m, side < 2 ? across : along, side < 2 ? along : across, z);
	}
	struct cloud_view v = made_view(&m);
	g_autoptr(cloud_geometry) g = estimate(&v, NULL);
	for (size_t i = 0; i < walls; i++)
		g_assert_cmpfloat(g->normal[i][2], >=, 0);
	size_t out = 0;
	for (size_t i = walls; i < v.count; i++) {
		const double *p = made_at(&m, i);
		double outwards[3] = { fabs(p[0]) == 5 ? p[0] : 0, fabs(p[1]) == 5 ? p[1] : 0, 0 };
		out += angle_between(g->normal[i], outwards) < 30;
	}
	g_assert_cmpfloat((double)out, >, 0.98 * (double)(v.count - walls));
	made_clear(&m);
}

/* ---- blocks ---- */

/* Where the cloud is cut must not show. */
static void test_blocks(void)
{
	struct made m = made_new(5);
	ball(&m, 40000, 0.01);
	struct cloud_view v = made_view(&m);
	v.has_viewpoint = true;
	struct cloud_geometry_options small = { .block_points = 3000 };
	g_autoptr(cloud_geometry) whole = estimate(&v, NULL), cut = estimate(&v, &small);
	size_t differ = 0;
	for (size_t i = 0; i < v.count; i++) {
		double n[3] = { whole->normal[i][0], whole->normal[i][1], whole->normal[i][2] };
		differ += angle_between(cut->normal[i], n) > 0.2 ||
			  fabs(cut->point_size_m[i] - whole->point_size_m[i]) > 1e-4;
	}
	g_assert_cmpuint(differ, ==, 0);
	made_clear(&m);
}

/* Map coordinates, and one place many times. */
static void test_far_and_repeated(void)
{
	static const double up[3] = { 0, 0, 1 };
	struct made m = made_new(6);
	for (int i = 0; i < 20000; i++) {
		double x = 4.5e5 + g_rand_double_range(m.rand, 0, 30),
		       y = 5.4e6 + g_rand_double_range(m.rand, 0, 30);
		for (int k = 0; k < (i < 5 ? 60 : 1); k++)
			made_add(&m, x, y, 1200);
	}
	struct cloud_view v = made_view(&m);
	g_autoptr(cloud_geometry) g = estimate(&v, NULL);
	for (size_t i = 0; i < v.count; i++)
		g_assert_cmpfloat(angle_between(g->normal[i], up), <, 0.5);
	made_clear(&m);
}

static void test_degenerate(void)
{
	struct made m = made_new(7);
	struct cloud_view v = made_view(&m);
	cloud_geometry_free(estimate(&v, NULL));
	for (int i = 0; i < 50; i++)
		made_add(&m, 1, 2, 3);
	v = made_view(&m);
	g_autoptr(cloud_geometry) g = estimate(&v, NULL);
	for (size_t i = 0; i < v.count; i++) {
		g_assert_true(g->normal[i][0] == 0 && g->normal[i][1] == 0 && g->normal[i][2] == 0);
		g_assert_true(isnan(g->plane_error_m[i]) && isnan(g->curvature[i]));
	}
	made_add(&m, NAN, 0, 0);
	v = made_view(&m);
	g_autoptr(GError) error = NULL;
	g_assert_null(cloud_geometry_estimate(&v, NULL, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA);
	made_clear(&m);
}

static bool stop(double fraction, gpointer user_data)
{
	(void)fraction;
	return --*(int *)user_data > 0;
}

static void test_stopped(void)
{
	struct made m = made_new(8);
	ball(&m, 10000, 0);
	struct cloud_view v = made_view(&m);
	int left = 3;
	struct cloud_geometry_options options = {
		.block_points = 1000, .progress = stop, .user_data = &left
	};
	g_autoptr(GError) error = NULL;
	g_assert_null(cloud_geometry_estimate(&v, &options, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
	g_assert_cmpint(left, ==, 0);
	made_clear(&m);
}

/* ---- real clouds ---- */

static void test_aerial(void)
{
	static const char *const files[] = { "data/aerial-town/ign-77050-627755.las",
		"data/aerial-colour/autzen_trim.las" };
	for (size_t f = 0; f < G_N_ELEMENTS(files); f++) {
		const char *path = shared_path(files[f]);
		if (!path) {
			g_test_skip("no aerial scans beside the checkout");
			return;
		}
		struct made m = made_from_file(path, &import_las, 1);
		struct cloud_view v = made_view(&m);
		g_autoptr(cloud_geometry) g = estimate(&v, NULL);
		size_t up = 0;
		for (size_t i = 0; i < v.count; i++) {
			const float *n = g->normal[i];
			g_assert_cmpfloat(
				fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1), <, 1e-4);
			g_assert_true(g->plane_error_m[i] >= 0 && g->point_size_m[i] >= 0);
			g_assert_true(g->curvature[i] >= 0 && g->curvature[i] <= 0.334f);
			up += n[2] > -0.301f;
		}
		g_assert_cmpuint(up, ==, v.count);
		g_test_message("%s: %zu points", files[f], v.count);
		made_clear(&m);
	}
}

/* ---- points in the air ---- */

/* A floor, and a few points far above it and from each other, which are no metres large. */
static void test_loose(void)
{
	struct made m = made_new(21);
	for (int i = 0; i < 20000; i++)
		made_add(&m, g_rand_double_range(m.rand, 0, 5), g_rand_double_range(m.rand, 0, 5),
			made_normal(&m, 0.001));
	for (int i = 0; i < 60; i++)
		made_add(&m, g_rand_double_range(m.rand, 0, 5), g_rand_double_range(m.rand, 0, 5),
			g_rand_double_range(m.rand, 3, 8));
	struct cloud_view v = made_view(&m);
	g_autoptr(cloud_geometry) g = estimate(&v, NULL);
	for (size_t i = 0; i < 20000; i++)
		g_assert_cmpfloat(g->point_size_m[i], <, 0.12);
	for (size_t i = 20000; i < v.count; i++)
		g_assert_cmpfloat(g->point_size_m[i], <, 0.12);
	made_clear(&m);
}

/* Two and three points beside a floor, on its plane, are no metres large either; but where the floor is sparse nearly all of its points keep
 * the size that closes it. */
static void test_alone(void)
{
	struct made m = made_new(23);
	for (int i = 0; i < 20000; i++)
		made_add(&m, g_rand_double_range(m.rand, 0, 5), g_rand_double_range(m.rand, 0, 5),
			0);
	for (int i = 0; i < 1000; i++)
		made_add(&m, g_rand_double_range(m.rand, 10, 15), g_rand_double_range(m.rand, 0, 5),
			0);
	for (int i = 0; i < 5; i++)
		made_add(&m, i < 2 ? -4 : 22, 2.5 + 0.02 * i, 0);
	struct cloud_view v = made_view(&m);
	g_autoptr(cloud_geometry) g = estimate(&v, NULL);
	uint32_t limited = 0;
	for (size_t i = 20000; i < 21000; i++)
		limited += g->point_size_m[i] < 0.09f;
	g_assert_cmpuint(limited, <, 80);
	for (size_t i = 21000; i < v.count; i++)
		g_assert_cmpfloat(g->point_size_m[i], <, 0.12);
	made_clear(&m);
}

/* ---- rings ---- */

/* A room of 12 x 8 x 3 m from its middle, as a lidar of 32 rings sees it. */
static void sweep(struct made *m, double wobble_rad)
{
	for (int column = 0; column < 1000; column++)
		for (int ring = 0; ring < 32; ring++) {
			double a = column * 2 * G_PI / 1000,
			       e = (10 - ring * 1.33) * DEGREE + made_normal(m, wobble_rad);
			double d[3] = { cos(e) * sin(a), cos(e) * cos(a), sin(e) };
			double range = fmin(6 / fabs(d[0]), 4 / fabs(d[1]));
			range = fmin(range, d[2] > 0 ? 1.5 / d[2] : -1.5 / d[2]);
			range += made_normal(m, 0.01);
			made_add(m, range * d[0], range * d[1], range * d[2]);
		}
}

static void test_rings(void)
{
	struct made m = made_new(9);
	sweep(&m, 0.0002);
	struct cloud_view v = made_view(&m);
	g_autofree double *elevation = NULL;
	uint32_t rings = 0;
	g_assert_true(cloud_find_rings(&v, &elevation, &rings));
	g_assert_cmpuint(rings, ==, 32);
	for (uint32_t i = 0; i < rings; i++)
		g_assert_cmpfloat(fabs(elevation[i] - (10 - i * 1.33) * DEGREE), <, 0.0005);
	for (double at = 0; at < 32; at += 0.4) /* beyond the last ring as well */
		g_assert_cmpfloat(
			fabs(cloud_ring_height_rad(elevation, rings, (10 - at * 1.33) * DEGREE) -
				1.33 * DEGREE),
			<, 0.0005);
	g_autofree uint32_t *index = NULL;
	g_autoptr(range_grid) g = cloud_range_grid(&v, &index);
	g_assert_nonnull(g);
	g_assert_cmpuint(g->rows, ==, 32);
	g_assert_true(g->wraps);
	g_assert_cmpfloat((double)range_grid_count(g), >, 0.98 * (double)v.count);
	/* A look along a beam finds a point of that direction. */
	for (size_t i = 0; i < v.count; i += 7) {
		const double *p = made_at(&m, i);
		uint32_t at = range_grid_find(g, p[0], p[1], p[2]);
		g_assert_cmpuint(at, !=, RANGE_GRID_NONE);
		if (g->range_m[at] > 0) {
			double to[3] = { p[0], p[1], p[2] };
			float there[3] = { g->x_m[at] / g->range_m[at], g->y_m[at] / g->range_m[at],
				g->z_m[at] / g->range_m[at] };
			g_assert_cmpfloat(angle_between(there, to), <, 2);
		}
	}
	made_clear(&m);
}

static void test_no_rings(void)
{
	g_autofree double *elevation = NULL;
	uint32_t rings;
	struct made moved = made_new(10), noise = made_new(11), round = made_new(12);
	sweep(&moved, 0.0002);
	struct pose p = pose_from_yaw(0.3, (double[3]){ 1, 0.5, 0.2 });
	made_move(&moved, &p); /* no longer seen from the origin */
	sweep(&noise, 0.01);
	ball(&round, 20000, 0);
	struct cloud_view views[] = { made_view(&moved), made_view(&noise), made_view(&round) };
	for (size_t i = 0; i < G_N_ELEMENTS(views); i++) {
		g_assert_false(cloud_find_rings(&views[i], &elevation, &rings));
		g_assert_null(cloud_range_grid(&views[i], NULL));
	}
	made_clear(&moved);
	made_clear(&noise);
	made_clear(&round);
}

static void test_real_rings(void)
{
	const char *sweep_path = shared_path("data/vlp-pair/source.ply"),
		   *town_path = shared_path("data/aerial-town/ign-77050-627755.las");
	if (!sweep_path || !town_path) {
		g_test_skip("no sweeps beside the checkout");
		return;
	}
	struct made m = made_from_file(sweep_path, &import_ply, 1),
		    town = made_from_file(town_path, &import_las, 1);
	struct cloud_view v = made_view(&m), above = made_view(&town);
	g_autofree double *elevation = NULL;
	uint32_t rings = 0;
	g_assert_true(cloud_find_rings(&v, &elevation, &rings));
	g_assert_cmpuint(rings, ==, 32);
	g_autoptr(range_grid) g = cloud_range_grid(&v, NULL);
	g_assert_nonnull(g);
	g_assert_cmpfloat((double)range_grid_count(g), >, 0.97 * (double)v.count);
	g_assert_null(cloud_range_grid(&above, NULL));
	made_clear(&m);
	made_clear(&town);
}

/* A roof from above, half a metre between points that waver by 4 cm: next to its ridge each normal is of the slope that its point is on. */
static void test_ridge(void)
{
	g_autoptr(GError) error = NULL;
	struct made roof = made_new(21);
	const double slope = 0.75;
	double near = 0, right = 0;
	for (int i = 0; i < 3200; i++) {
		double x = g_rand_double_range(roof.rand, -10, 10),
		       y = g_rand_double_range(roof.rand, -20, 20);
		made_add(&roof, x, y, 8 - slope * fabs(x) + made_normal(&roof, 0.04));
	}
	struct cloud_view v = made_view(&roof);
	g_autoptr(cloud_geometry) g = cloud_geometry_estimate(&v, NULL, &error);
	g_assert_no_error(error);
	for (size_t i = 0; i < v.count; i++) {
		const double *at = cloud_view_at(&v, i);
		if (fabs(at[0]) < 0.15 || fabs(at[0]) > 1 || fabs(at[1]) > 18)
			continue;
		double side = at[0] > 0 ? 1 : -1,
		       cosine = ((double)g->normal[i][2] + side * slope * (double)g->normal[i][0]) /
				hypot(1, slope);
		near++;
		right += cosine > cos(10 * G_PI / 180);
	}
	g_test_message("%.0f points beside the ridge, %.0f %% look as their slope does", near,
		100 * right / near);
	g_assert_cmpfloat(right, >, 0.85 * near);
	made_clear(&roof);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/cloud/plane", test_plane);
	g_test_add_func("/cloud/dense-noise", test_dense_noise);
	g_test_add_func("/cloud/sphere", test_sphere);
	g_test_add_func("/cloud/outwards", test_outwards);
	g_test_add_func("/cloud/blocks", test_blocks);
	g_test_add_func("/cloud/far-and-repeated", test_far_and_repeated);
	g_test_add_func("/cloud/degenerate", test_degenerate);
	g_test_add_func("/cloud/stopped", test_stopped);
	g_test_add_func("/cloud/loose", test_loose);
	g_test_add_func("/cloud/alone", test_alone);
	g_test_add_func("/cloud/aerial", test_aerial);
	g_test_add_func("/cloud/rings", test_rings);
	g_test_add_func("/cloud/no-rings", test_no_rings);
	g_test_add_func("/cloud/real-rings", test_real_rings);
	g_test_add_func("/cloud/ridge", test_ridge);
	return g_test_run();
}
