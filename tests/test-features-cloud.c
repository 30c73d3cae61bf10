/* Features of points without a grid: of shapes that are known exactly, and of real scans. */
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

/* Two walls of 4 m x 2 m that meet at a right angle along z, 2.5 cm between points, which are 3 mm off. */
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

/* ---- curvature ---- */

/* A point of a surface whose curvature is known. */
struct surface {
	double at[3], normal[3], k1, k2, along[3]; /* along k1; 0 0 0: all ways */
};
typedef struct surface (*shape)(double u, double v); /* 0..1 across */

/* Of 0.4 m radius, 0.6 m tall, whole around. */
static struct surface pillar(double u, double v)
{
	double c = cos(2 * G_PI * v), s = sin(2 * G_PI * v);
	return (struct surface){ { 0.4 * c, 0.4 * s, 0.6 * u }, { c, s, 0 }, 2.5, 0, { -s, c, 0 } };
}

static struct surface ball(double u, double v)
{
	double z = 2 * u - 1, level = sqrt(1 - z * z);
	double n[3] = { level * cos(2 * G_PI * v), level * sin(2 * G_PI * v), z };
	return (struct surface){ { 0.4 * n[0], 0.4 * n[1], 0.4 * n[2] }, { n[0], n[1], n[2] }, 2.5,
		2.5 };
}

/* A tube of 0.2 m radius along a circle of 0.5 m; the inner half of it is a saddle. */
static struct surface ring(double u, double v)
{
	double c = cos(2 * G_PI * u), s = sin(2 * G_PI * u), a = cos(2 * G_PI * v),
	       b = sin(2 * G_PI * v), out = 0.5 + 0.2 * a;
	return (struct surface){ { out * c, out * s, 0.2 * b }, { a * c, a * s, b }, 5, a / out,
		{ -b * c, -b * s, a } };
}

static struct surface board(double u, double v)
{
	return (struct surface){ { u, 0.8 * v, 0 }, { 0, 0, 1 }, 0, 0 };
}

static const struct bent {
	const char *name;
	shape shape;
	double area_m2, noise_m;
	bool ends_u, ends_v;
	double most,
		most_degrees; /* that nine of ten may be off, 1/m; the direction: 0: has none */
} bents[] = {
	{ "pillar", pillar, 1.51, 0.002, true, false, 0.375, 6 }, /* 15 % */
	{ "ball", ball, 2.01, 0.002, false, false, 0.375, 0 },
	{ "ring", ring, 3.95, 0.002, false, false, 0.5, 6 }, /* 10 % */
	{ "board", board, 0.8, 0.002, true, true, 0.3, 0 },
	{ "exact pillar", pillar, 1.51, 0, true, false, 0.075, 2 }, /* 3 % */
	{ "exact ring", ring, 3.95, 0, false, false, 0.25, 2 },
	{ "exact board", board, 0.8, 0, true, true, 0.01, 0 },
};

/* 2.5 cm between points where they are sparse, and a third of that where they are dense; where is filled with u and v of each. */
static struct cloud bent_cloud(const struct bent *b, GArray *where)
{
	struct cloud c = { .made = made_new(11) };
	const int tries = (int)(9 * b->area_m2 / (0.025 * 0.025));
	for (int i = 0; i < tries; i++) {
		double uv[2] = { g_rand_double(c.made.rand), g_rand_double(c.made.rand) };
		if (g_rand_double(c.made.rand) > (1 + 4 * (1 + cos(4 * G_PI * uv[1]))) / 9)
			continue;
		struct surface s = b->shape(uv[0], uv[1]);
		double off = b->noise_m > 0 ? made_normal(&c.made, b->noise_m) : 0;
		made_add(&c.made, s.at[0] + off * s.normal[0], s.at[1] + off * s.normal[1],
			s.at[2] + off * s.normal[2]);
		g_array_append_vals(where, uv, 2);
	}
	cloud_prepare(&c);
	return c;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* The value that so many are below. */
static double quantile(GArray *values, double share)
{
	g_assert_cmpuint(values->len, >, 100);
	g_array_sort(values, by_value);
	return g_array_index(values, double, (guint)(share * (values->len - 1)));
}

static double angle_deg(const int16_t packed[2], const double along[3])
{
	float u[3];
	model_unpack_normal(packed, u);
	double cosine = u[0] * along[0] + u[1] * along[1] + u[2] * along[2];
	return acos(fmin(fabs(cosine), 1)) / DEGREE;
}

/* How far curvatures are off, away from the ends and near them, and their directions. */
struct misses {
	GArray *inside, *ends, *degrees; /* of double */
	size_t none;                     /* inside */
};

static void add_miss(struct misses *m, const struct bent *b, const struct cloud *c,
	const features *f, size_t i, const double uv[2])
{
	const struct surface s = b->shape(uv[0], uv[1]);
	const float *normal = c->geometry->normal[i];
	const bool inside =
		(!b->ends_u || fabs(uv[0] - 0.5) < 0.3) && (!b->ends_v || fabs(uv[1] - 0.5) < 0.3);
	/* Nobody knows from where it was seen: what bulges does so along the point's own normal. */
	double side = normal[0] * s.normal[0] + normal[1] * s.normal[1] + normal[2] * s.normal[2];
	double k1 = copysign(1, side) * f->k1[i], k2 = copysign(1, side) * f->k2[i];
	double miss = fmax(fabs(k1 - s.k1), fabs(k2 - s.k2));
	double degrees = angle_deg(f->principal[i], s.along);
	m->none += inside && isnan(f->k1[i]);
	if (isnan(f->k1[i])) {
		g_assert_true(isnan(f->k2[i]) && f->principal[i][0] == MODEL_NORMAL_NONE);
		return;
	}
	g_assert_cmpfloat(fabsf(f->k1[i]), >=, fabsf(f->k2[i]));
	g_array_append_val(inside ? m->inside : m->ends, miss);
	if (inside)
		g_array_append_val(m->degrees, degrees);
}

static void check_bent(const struct bent *b)
{
	g_autoptr(GArray) where = g_array_new(false, false, sizeof(double));
	g_autoptr(GArray) inside = g_array_new(false, false, sizeof(double));
	g_autoptr(GArray) ends = g_array_new(false, false, sizeof(double));
	g_autoptr(GArray) degrees = g_array_new(false, false, sizeof(double));
	struct misses m = { inside, ends, degrees, 0 };
	struct cloud c = bent_cloud(b, where);
	g_autoptr(features) f = features_of_cloud(&c.input, NULL, NULL, NULL);
	for (size_t i = 0; i < c.input.view.count; i++)
		add_miss(&m, b, &c, f, i, &g_array_index(where, double, 2 * i));
	g_test_message("%s: %u inside, %zu without, off by %.3f (half), %.3f (p90), %.3f (p99) 1/m",
		b->name, inside->len, m.none, quantile(inside, 0.5), quantile(inside, 0.9),
		quantile(inside, 0.99));
	g_assert_cmpuint(1000 * m.none, <, inside->len);
	g_assert_cmpfloat(quantile(inside, 0.9), <, b->most);
	g_assert_cmpfloat(quantile(inside, 0.99), <, 2 * b->most);
	if (b->ends_u) {
		g_test_message("  %u near the ends, off by %.3f (p90) 1/m", ends->len,
			quantile(ends, 0.9));
		g_assert_cmpfloat(quantile(ends, 0.9), <, 4 * b->most);
	}
	if (b->most_degrees > 0) {
		g_test_message("  directions off by %.2f (half), %.2f (p90) degrees",
			quantile(degrees, 0.5), quantile(degrees, 0.9));
		g_assert_cmpfloat(quantile(degrees, 0.9), <, b->most_degrees);
	}
	cloud_clear(&c);
}

static void test_curvature(void)
{
	for (size_t n = 0; n < G_N_ELEMENTS(bents); n++)
		check_bent(&bents[n]);
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
	g_assert_cmpmem(a->principal, 4 * n, b->principal, 4 * n);
	g_assert_cmpmem(a->k1, 4 * n, b->k1, 4 * n);
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
	g_test_add_func("/features-cloud/curvature", test_curvature);
	g_test_add_func("/features-cloud/threads", test_threads);
	g_test_add_func("/features-cloud/few", test_few);
	g_test_add_func("/features-cloud/real", test_real);
	return g_test_run();
}
