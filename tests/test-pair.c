#include "tests/placed-scans.h"

struct pair_of {
	const struct placed *a, *b;
	const pair_scan *scan_a, *scan_b;
};

static struct pair_of pair_of_scans(const char *a, const char *b)
{
	struct pair_of p = { placed_scan(a), placed_scan(b) };
	p.scan_a = pair_scan_of(a);
	p.scan_b = pair_scan_of(b);
	return p;
}

static struct pair_result align(const struct pair_of *p, const struct pair_options *options)
{
	struct pair_result r;
	pair_align(p->scan_a, p->scan_b, options, &r);
	struct pose off = pose_off(p->a, p->b, &r.pose);
	g_test_message("%s: %s %.4f degrees, %.2f mm off; rival %.2f",
		verdict_names[r.verification.verdict], r.verification.reason,
		pose_angle_rad(&off) * 180 / G_PI, 1e3 * pose_distance_m(&off),
		r.verification.rival_score);
	return r;
}

static void assert_found(const struct pair_of *p, const struct pair_result *r)
{
	struct pose off = pose_off(p->a, p->b, &r->pose);
	g_assert_cmpint(r->verification.verdict, ==, VERDICT_ACCEPTED);
	g_assert_cmpfloat(pose_angle_rad(&off), <, 0.03 * G_PI / 180);
	g_assert_cmpfloat(pose_distance_m(&off), <, 0.006);
	g_assert_cmpfloat(r->verification.rival_score, <, 1);
}

static void test_found(void)
{
	struct pair_of p = pair_of_scans("court?seed=9&station=1", "court?seed=9&station=3");
	struct pair_result r = align(&p, NULL), again = align(&p, NULL);
	assert_found(&p, &r);
	g_assert_cmpmem(&r.pose, sizeof r.pose, &again.pose, sizeof again.pose);
	struct pose start = pose_between(&p.a->pose, &p.b->pose);
	start.translation_m[0] += 0.2;
	struct pair_result near = align(&p, &(struct pair_options){ .start = &start });
	assert_found(&p, &near);
}

static void test_moved_things(void)
{
	struct pair_of p =
		pair_of_scans("court?seed=9&station=1", "court?seed=9&station=3&moved=1");
	struct pair_result r = align(&p, NULL);
	assert_found(&p, &r);
}

/* Nothing tells the ends of this hall apart, so neither pose may be accepted, not even with the true one to start from. */
static void test_symmetric(void)
{
	struct pair_of p = pair_of_scans(
		"hall?seed=9&symmetric=1&station=1", "hall?seed=9&symmetric=1&station=3");
	struct pair_result r = align(&p, NULL);
	g_assert_cmpint(r.verification.verdict, ==, VERDICT_AMBIGUOUS);
	g_assert_cmpfloat(r.verification.rival_score, >=, 1);
	struct pose start = pose_between(&p.a->pose, &p.b->pose);
	r = align(&p, &(struct pair_options){ .start = &start });
	g_assert_cmpint(r.verification.verdict, ==, VERDICT_AMBIGUOUS);
}

static void test_other_site(void)
{
	struct pair_of p =
		pair_of_scans("court?seed=9&station=1", "hall?seed=9&symmetric=1&station=1");
	struct pair_result r = align(&p, NULL);
	g_assert_cmpint(r.verification.verdict, !=, VERDICT_ACCEPTED);
	g_assert_cmpuint(strlen(r.verification.reason), >, 20);
}

static void test_corridor(void)
{
	g_autoptr(range_grid) grid = corridor_grid();
	g_autoptr(pair_scan) a = pair_scan_new(grid);
	g_autoptr(pair_scan) b = pair_scan_new(grid);
	struct pair_result r;
	pair_align(a, b, NULL, &r);
	g_test_message("%s", r.verification.reason);
	g_assert_cmpint(r.verification.verdict, !=, VERDICT_ACCEPTED);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/pair/found", test_found);
	g_test_add_func("/pair/moved-things", test_moved_things);
	g_test_add_func("/pair/symmetric", test_symmetric);
	g_test_add_func("/pair/other-site", test_other_site);
	g_test_add_func("/pair/corridor", test_corridor);
	return g_test_run();
}
