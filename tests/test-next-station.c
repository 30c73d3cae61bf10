/* Where to scan next, in rooms whose walls are known: what a head sees is cast here by itself, ray by ray. */
#include "process/next-station.h"
#include <math.h>

#define STEP_M 0.1
#define HEAD_M 1.6

struct wall {
	double a[2], b[2];
};

struct room {
	const struct wall *wall;
	size_t walls;
};

/* How far a ray gets, at most range_m. */
static double reach(
	const struct room *r, const double from[2], const double along[2], double range_m)
{
	double nearest = range_m;
	for (size_t i = 0; i < r->walls; i++) {
		const struct wall *w = &r->wall[i];
		double e[2] = { w->b[0] - w->a[0], w->b[1] - w->a[1] };
		double d[2] = { w->a[0] - from[0], w->a[1] - from[1] };
		double cross = along[0] * e[1] - along[1] * e[0];
		double t = (d[0] * e[1] - d[1] * e[0]) / cross;
		double u = (d[0] * along[1] - d[1] * along[0]) / cross;
		if (t > 0 && t < nearest && u >= 0 && u <= 1)
			nearest = t;
	}
	return nearest;
}

/* Floor at z 10, walls 3 m high. */
static void scan(const struct room *r, const double at[3], station_plan *p)
{
	for (int i = 0; i < 3600; i++) {
		double angle = i * G_PI / 1800, along[2] = { cos(angle), sin(angle) };
		double end = reach(r, at, along, 30);
		for (double s = 1.5; s < end - 0.05; s += STEP_M)
			station_plan_add(
				p, (double[3]){ at[0] + s * along[0], at[1] + s * along[1], 10 });
		for (double z = 10; end < 30 && z < 13; z += STEP_M)
			station_plan_add(p,
				(double[3]){ at[0] + end * along[0], at[1] + end * along[1], z });
	}
}

static bool next_of(const struct room *r, const double (*at)[3], size_t n, struct next_station *ret)
{
	g_autoptr(station_plan) p =
		station_plan_new((double[3]){ -25, -25, 9 }, (double[3]){ 25, 25, 20 });
	for (size_t i = 0; i < n; i++)
		scan(r, at[i], p);
	return next_station_find(p, *at, n, ret);
}

/* An L: a leg along x from 0 to 16, one along y from 0 to 16, both 5 wide. */
static const struct wall l_walls[] = {
	{ { 0, 0 }, { 16, 0 } },
	{ { 16, 0 }, { 16, 5 } },
	{ { 16, 5 }, { 5, 5 } },
	{ { 5, 5 }, { 5, 16 } },
	{ { 5, 16 }, { 0, 16 } },
	{ { 0, 16 }, { 0, 0 } },
};
static const struct room l_room = { l_walls, G_N_ELEMENTS(l_walls) };

static void looks_around_the_corner(void)
{
	static const double at[][3] = { { 13, 2.5, 10 + HEAD_M } };
	struct next_station n;
	g_assert_true(next_of(&l_room, at, 1, &n));
	g_test_message("%.2f %.2f: %.1f m2 new, %.2f known", n.x_m, n.y_m, n.new_m2, n.known_share);
	/* Where it stands sees into the other leg and along this one. */
	g_assert_cmpfloat(n.x_m, <, 6);
	g_assert_cmpfloat(n.x_m, >, 0.5);
	g_assert_cmpfloat(n.y_m, >, 0.5);
	g_assert_cmpfloat(n.y_m, <, 7);
	g_assert_cmpfloat(n.new_m2, >, 10);
	g_assert_cmpfloat(n.known_share, >, 0.4);
}

static void needs_no_more_when_all_is_seen(void)
{
	static const double at[][3] = { { 13, 2.5, 10 + HEAD_M }, { 2.5, 2.5, 10 + HEAD_M } };
	struct next_station n;
	g_assert_false(next_of(&l_room, at, 2, &n));
}

/* In the open there is always more to see, but never without what is known already. */
static void keeps_sight_of_what_is_known(void)
{
	static const struct wall walls[] = { { { -4, 3 }, { 4, 3 } }, { { -4, 3 }, { -4, 9 } } };
	static const struct room r = { walls, G_N_ELEMENTS(walls) };
	static const double at[][3] = { { 0, 0, 10 + HEAD_M } };
	struct next_station n;
	g_assert_true(next_of(&r, at, 1, &n));
	g_test_message("%.2f %.2f: %.1f m2 new, %.2f known", n.x_m, n.y_m, n.new_m2, n.known_share);
	g_assert_cmpfloat(n.known_share, >, 0.25);
	g_assert_cmpfloat(hypot(n.x_m, n.y_m), <, 15);
	/* What it cannot see is behind the wall, so it stands to the side or behind of it. */
	g_assert_true(fabs(n.x_m) > 3 || n.y_m > 3);
}

static void stands_where_there_is_room(void)
{
	static const double at[][3] = { { 13, 2.5, 10 + HEAD_M } };
	struct next_station n;
	g_assert_true(next_of(&l_room, at, 1, &n));
	for (int i = 0; i < 360; i++) {
		double along[2] = { cos(i * G_PI / 180), sin(i * G_PI / 180) };
		g_assert_cmpfloat(reach(&l_room, (double[2]){ n.x_m, n.y_m }, along, 10), >, 0.6);
	}
}

static void knows_nothing_without_stations(void)
{
	struct next_station n;
	g_autoptr(station_plan) p =
		station_plan_new((double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 });
	g_assert_false(next_station_find(p, NULL, 0, &n));
	/* Far away and not numbers at all. */
	station_plan_add(p, (double[3]){ 1e300, -1e300, NAN });
	static const double at[][3] = { { NAN, INFINITY, 0 } };
	g_assert_false(next_station_find(p, *at, 1, &n));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/next-station/looks-around-the-corner", looks_around_the_corner);
	g_test_add_func(
		"/next-station/needs-no-more-when-all-is-seen", needs_no_more_when_all_is_seen);
	g_test_add_func("/next-station/keeps-sight-of-what-is-known", keeps_sight_of_what_is_known);
	g_test_add_func("/next-station/stands-where-there-is-room", stands_where_there_is_room);
	g_test_add_func(
		"/next-station/knows-nothing-without-stations", knows_nothing_without_stations);
	return g_test_run();
}
