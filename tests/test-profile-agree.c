/* What looks agree on. */
#include "process/profile-agree.h"
#include <math.h>

enum { LOOKS = 6 };

/* Along x, so far aside. */
static void add(GArray *pieces, double from_m, double to_m, double aside_m)
{
	struct profile_piece p = { .line = { .at = { 0, aside_m, 0 }, .along = { 1, 0, 0 } },
		.from_m = from_m,
		.to_m = to_m,
		.spacing_m = 0.03f,
		.support = 1,
		.kind = PROFILE_END };
	g_array_append_val(pieces, p);
}

static void new_looks(GArray *found[LOOKS])
{
	for (int n = 0; n < LOOKS; n++)
		found[n] = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
}

static void free_looks(GArray *found[LOOKS])
{
	for (int n = 0; n < LOOKS; n++)
		g_array_unref(found[n]);
}

/* Whether some of what they agree on runs so far aside, from and to there; they agree on so many pieces that do. */
static guint count_at(const GArray *agreed, double aside_m, double from_m, double to_m)
{
	guint count = 0;
	for (guint n = 0; n < agreed->len; n++) {
		const struct profile_piece *p = &g_array_index(agreed, struct profile_piece, n);
		count += fabs(p->line.at[1] - aside_m) < 1e-6 && fabs(p->from_m - from_m) < 0.06 &&
			 fabs(p->to_m - to_m) < 0.06;
	}
	return count;
}

/* What one look alone shows goes, and what two do; what three show stays, as far as another does. */
static void test_alone(void)
{
	GArray *found[LOOKS];
	new_looks(found);
	for (int n = 0; n < 3; n++)
		add(found[n], 0.25 * n, 2 + n, 0.002 * n);
	for (int n = 0; n < 2; n++)
		add(found[n], 0, 2, 1);
	add(found[2], 0, 2, 2);
	g_autoptr(GArray) agreed = profile_agree(found, LOOKS, false);
	g_assert_cmpuint(agreed->len, ==, 3);
	g_assert_cmpuint(count_at(agreed, 0, 0.25, 2), ==, 1);
	g_assert_cmpuint(count_at(agreed, 0.002, 0.25, 3), ==, 1);
	g_assert_cmpuint(count_at(agreed, 0.004, 0.5, 3), ==, 1);
	free_looks(found);
}

/* Where three looks show it here and three there, 3 cm apart, it is one edge, and the longer one is kept; where they show both it is two. */
static void test_rivals(void)
{
	for (int both = 0; both < 2; both++) {
		GArray *found[LOOKS];
		new_looks(found);
		for (int n = 0; n < LOOKS; n++) {
			if (n < 3 || both)
				add(found[n], 0, 2, 0);
			if (n >= 3 || both)
				add(found[n], 0, 1.5, 0.03);
		}
		g_autoptr(GArray) agreed = profile_agree(found, LOOKS, false);
		g_assert_cmpuint(count_at(agreed, 0, 0, 2), ==, both ? 6 : 3);
		g_assert_cmpuint(count_at(agreed, 0.03, 0, 1.5), ==, both ? 6 : 0);
		free_looks(found);
	}
}

/* Four looks are right against three, though these show it longer. */
static void test_more(void)
{
	enum { MORE = 7 };
	GArray *found[MORE];
	for (int n = 0; n < MORE; n++) {
		found[n] = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
		add(found[n], 0, n < 4 ? 1.5 : 2, n < 4 ? 0.03 : 0);
	}
	g_autoptr(GArray) agreed = profile_agree(found, MORE, true);
	g_assert_cmpuint(agreed->len, ==, 4);
	g_assert_cmpuint(count_at(agreed, 0.03, 0, 1.5), ==, 4);
	for (int n = 0; n < MORE; n++)
		g_array_unref(found[n]);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-agree/alone", test_alone);
	g_test_add_func("/profile-agree/rivals", test_rivals);
	g_test_add_func("/profile-agree/more", test_more);
	return g_test_run();
}
