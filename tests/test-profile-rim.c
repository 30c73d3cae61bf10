/* Where a wall ends, told by the beams of two scanners. */
#include "process/profile-rim.h"
#include "tests/profile-model.h"
#include <string.h>

#define BEAM_RAD 0.0021

/* A wall, y = 0, from x = -1 to where it ends, x = 0, as two scanners see it, aslant; ranges waver by 12 mm, or by 1. Its end is so deep, which the
 * second one sees. */
#define RIM_NOISE_M  0.012
#define CALM_NOISE_M 0.001
static const double rim_scanner_m[2][3] = { { -4, -4, 1.1 }, { 3, -6, 0.9 } };

static void add_wall(
	GArray *all, JsonArray *scans, GRand *r, int scan, double deep_m, double noise_m)
{
	const double *from = rim_scanner_m[scan], up = 0.3;
	const float normal[2][3] = { { 0, -1, 0 }, { 1, 0, 0 } };
	JsonArray *pose = json_array_new();
	JsonObject *about = json_object_new();
	for (double azimuth = -1.2; azimuth < 1.2; azimuth += BEAM_RAD)
		for (double elevation = -up; elevation < up; elevation += BEAM_RAD) {
			double way[3] = { cos(elevation) * sin(azimuth),
				cos(elevation) * cos(azimuth), sin(elevation) };
			double far = -from[1] / way[1], at[3];
			bool is_end = from[0] + far * way[0] > 0;
			if (is_end)
				far = -from[0] / way[0];
			double x = from[0] + far * way[0], y = from[1] + far * way[1],
			       z = from[2] + far * way[2];
			if (x < -1 || y > deep_m + 1e-9 || (is_end && y < 0) || z < 0 || z > 2 ||
				far < 0)
				continue;
			for (int k = 0; k < 3; k++)
				at[k] = from[k] + (far + noise_m * gauss(r)) * way[k];
			struct morton_place place;
			g_assert_true(morton_from_point(at, morton_cell_m(0), &place));
			double size = 1e4 * far * BEAM_RAD * sqrt(cos(elevation));
			struct part_point p = { .code = place.code,
				.leaf = scan ? SECOND_LEAF : 20,
				.size = (uint16_t)size,
				.spacing = (uint16_t)(size / sqrt(way[1])) };
			memcpy(p.within, place.within, sizeof p.within);
			model_pack_normal(normal[is_end], p.normal);
			p.k1 = p.k2 = MODEL_HALF_NONE;
			g_array_append_val(all, p);
		}
	for (int n = 0; n < 12; n++)
		json_array_add_double_element(pose, n < 9 ? n % 4 == 0 : from[n - 9]);
	json_object_set_int_member(about, "scan", scan + 1);
	json_object_set_array_member(about, "pose", pose);
	json_array_add_object_element(scans, about);
}

static model *make_wall(double deep_m, double noise_m)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(4);
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct part_point));
	JsonArray *scans = json_array_new();
	for (int scan = 0; scan < 2; scan++)
		add_wall(all, scans, r, scan, deep_m, noise_m);
	return write_model(all, scans);
}

static struct profile_piece upright_at(double x, uint8_t kind)
{
	return (struct profile_piece){ .line = { { x, 0.01, 0.3 }, { 0, 0, 1 } },
		.to_m = 1.4,
		.spacing_m = 0.012f,
		.kind = kind,
		.face = { { 0, -1, 0 }, { kind == PROFILE_CREASE ? 1 : 0, 0, 0 } } };
}

static void check_rim(const struct profile_piece *p)
{
	g_assert_cmpint(p->kind, ==, PROFILE_END);
	for (int end = 0; end < 2; end++) {
		double at[3];
		straight_place(&p->line, end ? p->to_m : p->from_m, at);
		g_test_message("%.1f mm beside, %.1f mm off", 1000 * at[0], 1000 * at[1]);
		g_assert_cmpfloat(fabs(at[0]), <, 0.007);
		g_assert_cmpfloat(fabs(at[1]), <, 0.004);
	}
}

/* Beams are 2 cm apart on the wall; by all of them together its end is told better than that, from wherever one begins. */
static void test_rim(void)
{
	const double origin_m[3] = { 0 };
	g_autoptr(model) m = make_wall(0, RIM_NOISE_M);
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, 1);
	struct profile_station station;
	g_assert_false(profile_around_station(around, 3, &station));
	g_assert_true(profile_around_station(around, 2, &station));
	g_assert_cmpfloat(fabs(station.beam_rad - BEAM_RAD), <, 0.05 * BEAM_RAD);
	for (int n = 0; n < 9; n++) {
		struct profile_piece p = upright_at(0.015 * (n % 3 - 1), PROFILE_END);
		p.line.along[0] = 0.01 * (n / 3 - 1);
		g_assert_cmpint(profile_rim_fit(around, &p), ==, PROFILE_RIM_FITTED);
		check_rim(&p);
	}
}

/* Amid the wall it does not end; where there are no points nobody knows, but of points far apart and beside no face there is none. */
static void test_no_rim(void)
{
	const double origin_m[3] = { 0 };
	g_autoptr(model) m = make_wall(0, CALM_NOISE_M);
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, 1);
	struct profile_piece amid = upright_at(-0.5, PROFILE_END), was = amid,
			     away = upright_at(5, PROFILE_END), mark = upright_at(0, PROFILE_MARK);
	g_assert_cmpint(profile_rim_fit(around, &amid), ==, PROFILE_RIM_NONE);
	g_assert_cmpmem(&amid, sizeof amid, &was, sizeof was);
	g_assert_cmpint(profile_rim_fit(around, &away), ==, PROFILE_RIM_UNKNOWN);
	g_assert_cmpint(profile_rim_fit(around, &mark), ==, PROFILE_RIM_UNKNOWN);
	struct profile_piece flat = upright_at(0, PROFILE_END);
	memcpy(flat.face[0], (const float[3]){ 0, 0, 1 }, sizeof flat.face[0]);
	g_assert_cmpint(profile_rim_fit(around, &flat), ==, PROFILE_RIM_UNKNOWN);
	flat.spacing_m = 0.06f;
	g_assert_cmpint(profile_rim_fit(around, &flat), ==, PROFILE_RIM_NONE);
}

/* A crease is one when stations see both of its faces; what has hardly any points is no face, and the other one ends. */
static void test_narrow(void)
{
	const double origin_m[3] = { 0 }, deep_m[2] = { 0.02, 0.4 };
	for (int n = 0; n < 2; n++) {
		g_autoptr(model) m = make_wall(deep_m[n], CALM_NOISE_M);
		g_autoptr(profile_around) around = profile_around_new(m, origin_m, 1);
		struct profile_piece crease = upright_at(0, PROFILE_CREASE), was = crease;
		if (n) {
			g_assert_cmpint(profile_rim_fit(around, &crease), ==, PROFILE_RIM_UNKNOWN);
			g_assert_cmpmem(&crease, sizeof crease, &was, sizeof was);
		} else {
			g_assert_cmpint(profile_rim_fit(around, &crease), ==, PROFILE_RIM_FITTED);
			check_rim(&crease);
		}
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/profile-rim/end", test_rim);
	g_test_add_func("/profile-rim/none", test_no_rim);
	g_test_add_func("/profile-rim/narrow", test_narrow);
	return g_test_run();
}
