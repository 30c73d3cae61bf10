/* Features of points without a grid: of a box that is known exactly, and of real scans. */
#include "process/features-cloud.h"
#include "process/model.h"
#include "tests/cloud-made.h"
#include "tests/support.h"
#include <stdlib.h>
#include <string.h>

struct cloud {
	struct made made;
	cloud_geometry *geometry;
	int16_t (*normal)[2];
	struct features_cloud_input input;
};

static void cloud_prepare(struct cloud *c)
{
	g_autoptr(GError) error = NULL;
	struct cloud_view v = made_view(&c->made);
	c->geometry = cloud_geometry_estimate(&v, NULL, &error);
	g_assert_no_error(error);
	c->normal = g_malloc_n(v.count, sizeof *c->normal);
	for (size_t i = 0; i < v.count; i++)
		model_pack_normal(c->geometry->normal[i], c->normal[i]);
	c->input = (struct features_cloud_input){ .view = v,
		.normal = (const int16_t(*)[2])c->normal,
		.plane_error_m = c->geometry->plane_error_m,
		.point_size_m = c->geometry->point_size_m };
}

static void cloud_clear(struct cloud *c)
{
	made_clear(&c->made);
	cloud_geometry_free(c->geometry);
	g_free(c->normal);
}

/* Two walls of 4 m x 2 m that meet at a right angle along z, 2 cm between points, which are 3 mm off. */
static struct cloud corner(void)
{
	struct cloud c = { .made = made_new(7) };
	for (int i = 0; i < 40000; i++) {
		double along = g_rand_double_range(c.made.rand, 0, 4),
		       up = g_rand_double_range(c.made.rand, 0, 2);
		double off = made_normal(&c.made, 0.003);
		if (i % 2)
			made_add(&c.made, along, off, up);
		else
			made_add(&c.made, off, along, up);
	}
	cloud_prepare(&c);
	return c;
}

static void test_corner(void)
{
	struct cloud c = corner();
	g_autoptr(features) f = features_of_cloud(&c.input, NULL, NULL, NULL);
	size_t edge = 0, found = 0, even = 0, wrong = 0, directed = 0, exact = 0, dots = 0;
	for (size_t i = 0; i < c.input.view.count; i++) {
		const double *p = made_at(&c.made, i);
		double off_m = fmax(p[0], p[1]);
		if (p[2] < 0.3 || p[2] > 1.7 || off_m > 3.7)
			continue;
		bool is = f->kind[i] >= FEATURE_UNDIRECTED;
		edge += off_m < 0.02;
		found += off_m < 0.02 && is;
		even += off_m > 0.3;
		wrong += off_m > 0.3 && is;
		dots += off_m > 0.3 && f->kind[i] == FEATURE_DITHER;
		if (off_m < 0.1 && f->kind[i] == FEATURE_DIRECTED) {
			float u[3];
			model_unpack_normal(f->direction[i], u);
			directed++;
			exact += fabsf(u[2]) > 0.985f; /* 10 degrees */
		}
	}
	double density = (double)dots / (2 * 3.4 * 1.4);
	g_test_message(
		"found %zu of %zu, wrong %zu of %zu, directed %zu, exact %zu, %.1f dots per m2",
		found, edge, wrong, even, directed, exact, density);
	g_assert_cmpuint(10 * found, >, 9 * edge);
	g_assert_cmpuint(10 * wrong, <, even);
	g_assert_cmpuint(directed, >, edge / 3);
	g_assert_cmpuint(10 * exact, >, 9 * directed);
	g_assert_cmpfloat(
		fabs(density - 30), <, 6); /* of the tone in the middle, for there is no colour */
	cloud_clear(&c);
}

static void test_threads(void)
{
	struct cloud c = corner();
	struct features_options one = { .single_thread = true };
	g_autoptr(features) a = features_of_cloud(&c.input, NULL, NULL, NULL);
	g_autoptr(features) b = features_of_cloud(&c.input, &one, NULL, NULL);
	size_t n = c.input.view.count;
	g_assert_cmpmem(a->degree, n, b->degree, n);
	g_assert_cmpmem(a->kind, n, b->kind, n);
	g_assert_cmpmem(a->direction, 4 * n, b->direction, 4 * n);
	cloud_clear(&c);
}

static bool stop(double fraction, gpointer user_data)
{
	(void)fraction;
	(void)user_data;
	return false;
}

static void test_few(void)
{
	for (int n = 0; n < 4; n++) {
		struct cloud c = { .made = made_new(1) };
		for (int i = 0; i < n; i++)
			made_add(&c.made, i, 0, 0);
		cloud_prepare(&c);
		g_autoptr(features) f = features_of_cloud(&c.input, NULL, NULL, NULL);
		g_assert_cmpuint(f->columns, ==, n);
		cloud_clear(&c);
	}
	struct cloud c = corner();
	g_assert_null(features_of_cloud(&c.input, NULL, stop, NULL));
	cloud_clear(&c);
}

static void test_real(void)
{
	const char *path = shared_path("data/office/office1.pcd");
	if (!path) {
		g_test_skip("no real scans beside the checkout");
		return;
	}
	struct cloud c = { .made = made_from_file(path, &import_pcd, 1) };
	cloud_prepare(&c);
	g_autoptr(features) f = features_of_cloud(&c.input, NULL, NULL, NULL);
	size_t drawn = 0, dots = 0;
	for (size_t i = 0; i < c.input.view.count; i++) {
		drawn += f->kind[i] >= FEATURE_UNDIRECTED;
		dots += f->kind[i] == FEATURE_DITHER;
	}
	g_test_message("%zu points: %zu features, %zu dots", c.input.view.count, drawn, dots);
	g_assert_cmpuint(drawn, >, c.input.view.count / 100);
	g_assert_cmpuint(drawn, <, c.input.view.count / 2);
	g_assert_cmpuint(dots, >, 0);
	cloud_clear(&c);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/features-cloud/corner", test_corner);
	g_test_add_func("/features-cloud/threads", test_threads);
	g_test_add_func("/features-cloud/few", test_few);
	g_test_add_func("/features-cloud/real", test_real);
	return g_test_run();
}
