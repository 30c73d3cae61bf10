/* Points at least a spacing apart, against a straightforward comparison of each with each. */
#include "process/spacing.h"
#include <math.h>

static double squares(const double a[3], const double b[3])
{
	double s = 0;
	for (int i = 0; i < 3; i++)
		s += (a[i] - b[i]) * (a[i] - b[i]);
	return s;
}

/* Spread over a box, a plane, or around a far place. */
static const struct spread {
	const char *name;
	double size_m[3], at_m[3], spacing_m;
} spreads[] = { { "box", { 1, 1, 1 }, { 0, 0, 0 }, 0.1 },
	{ "plane", { 2, 2, 0 }, { -1, -1, 0.3 }, 0.05 },
	{ "far", { 1, 2, 0.2 }, { 51234.5, -123456.25, 900 }, 0.07 },
	{ "coarse", { 1, 1, 1 }, { -0.5, -0.5, -0.5 }, 10 } };

static void test_spread(gconstpointer data)
{
	const struct spread *d = data;
	g_autoptr(GRand) chance = g_rand_new_with_seed(7);
	g_autoptr(spacing) s = spacing_new(d->spacing_m);
	g_autoptr(GArray) taken = g_array_new(false, false, 3 * sizeof(double));
	for (int n = 0; n < 6000; n++) {
		double p[3], nearest = INFINITY;
		for (int i = 0; i < 3; i++)
			p[i] = d->at_m[i] + d->size_m[i] * g_rand_double(chance);
		for (guint i = 0; i < taken->len; i++)
			nearest =
				fmin(nearest, squares(p, (double *)(gpointer)taken->data + 3 * i));
		bool took = spacing_take(s, p);
		/* Between the two anything goes: places are kept in steps. */
		if (sqrt(nearest) < d->spacing_m)
			g_assert_false(took);
		if (sqrt(nearest) > 1.0045 * d->spacing_m)
			g_assert_true(took);
		if (took)
			g_array_append_val(taken, p);
	}
	g_assert_cmpuint(spacing_count(s), ==, taken->len);
	g_assert_cmpuint(taken->len, >=, 1);
}

/* The same point is never taken twice, however many there are. */
static void test_many(void)
{
	g_autoptr(spacing) s = spacing_new(0.01);
	guint count = 0;
	for (int pass = 0; pass < 2; pass++)
		for (int x = 0; x < 300; x++)
			for (int y = 0; y < 300; y++) {
				double p[3] = { x * 0.0101, y * 0.0101, 5 };
				count += spacing_take(s, p);
			}
	g_assert_cmpuint(count, ==, 300 * 300);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (gsize i = 0; i < G_N_ELEMENTS(spreads); i++) {
		g_autofree char *name = g_strconcat("/spacing/", spreads[i].name, NULL);
		g_test_add_data_func(name, &spreads[i], test_spread);
	}
	g_test_add_func("/spacing/many", test_many);
	return g_test_run();
}
