/* Worlds: every scene is built, is the same for the same seed, and is fit to be scanned. */
#include <math.h>

#include "sim/truth.h"
#include "sim/world.h"

static const uint64_t seeds[] = { 1, 2, 7001 };

/* What a panorama from some stations must show. */
static const unsigned expected[] = {
	/* court */ 1U << WORLD_BUILDING | 1U << WORLD_VEGETATION | 1U << WORLD_TERRAIN |
		1U << WORLD_STRUCTURE | 1U << WORLD_VEHICLE | 1U << WORLD_PERSON |
		1U << WORLD_FURNITURE | 1U << WORLD_NOTHING,
	/* street */ 1U << WORLD_BUILDING | 1U << WORLD_VEGETATION | 1U << WORLD_TERRAIN |
		1U << WORLD_STRUCTURE | 1U << WORLD_VEHICLE | 1U << WORLD_PERSON |
		1U << WORLD_NOTHING,
	/* bridge */ 1U << WORLD_BUILDING | 1U << WORLD_VEGETATION | 1U << WORLD_TERRAIN |
		1U << WORLD_STRUCTURE | 1U << WORLD_WATER | 1U << WORLD_PERSON |
		1U << WORLD_NOTHING,
	/* hall */ 1U << WORLD_BUILDING | 1U << WORLD_VEGETATION | 1U << WORLD_TERRAIN |
		1U << WORLD_FURNITURE | 1U << WORLD_PERSON,
	/* range */ 1U << WORLD_BUILDING | 1U << WORLD_TERRAIN | 1U << WORLD_STRUCTURE |
		1U << WORLD_PERSON,
};

struct given {
	const char *scene;
	unsigned expected;
	uint64_t seed;
};

static void direction_of(double azimuth, double elevation, double ret[3])
{
	ret[0] = sin(azimuth) * cos(elevation);
	ret[1] = cos(azimuth) * cos(elevation);
	ret[2] = sin(elevation);
}

/* Directions spread over the sphere by the golden angle. */
static void spread(unsigned i, unsigned n, double ret[3])
{
	direction_of(2.399963229728653 * i, asin(2 * (i + 0.5) / n - 1), ret);
}

static uint64_t fingerprint(const world *w)
{
	uint64_t sum = 14695981039346656037U;
	for (unsigned i = 0; i < 10000; i++) {
		struct world_station s;
		struct surface h;
		double d[3];
		world_get_station(w, 1 + i % 4, &s);
		spread(i, 10000, d);
		world_cast(w, s.position_m, d, 200, &h);
		const unsigned char *bytes[] = { (void *)&h.range_m, (void *)h.albedo,
			(void *)&h.instance };
		const size_t sizes[] = { sizeof(h.range_m), sizeof(h.albedo), sizeof(h.instance) };
		for (unsigned k = 0; k < 3; k++)
			for (size_t b = 0; b < sizes[k]; b++)
				sum = (sum ^ bytes[k][b]) * 1099511628211U;
	}
	return sum;
}

static void check_surface(const struct surface *h, const double d[3])
{
	double length = 0, towards = 0;
	for (unsigned k = 0; k < 3; k++) {
		length += h->normal[k] * h->normal[k];
		towards += h->normal[k] * d[k];
		g_assert_cmpfloat(h->albedo[k], >=, 0);
		g_assert_cmpfloat(h->albedo[k], <=, 1);
	}
	g_assert_cmpfloat_with_epsilon(length, 1, 1e-4);
	g_assert_cmpfloat(towards, <=, 1e-6);
	g_assert_cmpfloat(h->range_m, >, 0);
	g_assert_cmpfloat(h->reflectivity, >, 0);
	g_assert_cmpuint(h->instance, >, 0);
	g_assert_cmpuint(h->class, >, WORLD_NOTHING);
	g_assert_cmpuint(h->class, <, WORLD_CLASSES);
}

static unsigned classes_seen(const world *w, const struct world_station *s, unsigned n)
{
	unsigned seen = 0;
	for (unsigned i = 0; i < n; i++) {
		struct surface h;
		double d[3];
		spread(i, n, d);
		if (world_cast(w, s->position_m, d, 200, &h))
			check_surface(&h, d);
		seen |= 1U << h.class;
	}
	return seen;
}

static void check_free(const world *w, const struct world_station *s, double ground_z)
{
	for (double up = 0.5; up <= 2.2; up += 0.17)
		for (unsigned i = 0; i < 48; i++) {
			double from[3] = { s->position_m[0], s->position_m[1], ground_z + up },
			       d[3];
			struct surface h;
			direction_of(2 * G_PI * (i + up) / 48, 0, d);
			if (world_cast(w, from, d, 1.2, &h))
				g_assert_cmpuint(h.class, ==, WORLD_TERRAIN);
		}
}

static void check_rotation(const struct world_station *s)
{
	for (unsigned i = 0; i < 3; i++)
		for (unsigned j = 0; j < 3; j++) {
			double dot = 0;
			for (unsigned k = 0; k < 3; k++)
				dot += s->rotation[k][i] * s->rotation[k][j];
			g_assert_cmpfloat_with_epsilon(dot, i == j, 1e-12);
		}
	g_assert_cmpfloat(s->rotation[2][2], >=, cos(0.5001 * G_PI / 180));
}

static void check_stations(const world *w)
{
	struct world_station last = { 0 };
	g_assert_cmpuint(world_station_count(w), >=, 10);
	for (uint32_t i = 1; i <= world_station_count(w); i++) {
		struct world_station s;
		struct surface h;
		const double down[3] = { 0, 0, -1 };
		world_get_station(w, i, &s);
		g_assert_true(world_cast(w, s.position_m, down, 10, &h));
		g_assert_cmpuint(h.class, ==, WORLD_TERRAIN);
		g_assert_cmpfloat(h.range_m, >, 1.5);
		g_assert_cmpfloat(h.range_m, <, 1.9);
		check_free(w, &s, s.position_m[2] - h.range_m);
		check_rotation(&s);
		double step = hypot(
			s.position_m[0] - last.position_m[0], s.position_m[1] - last.position_m[1]);
		if (i > 1)
			g_assert_true(step >= 5 && step <= 20);
		last = s;
	}
}

static void check_radiance(const world *w)
{
	struct world_station s;
	double sum = 0;
	world_get_station(w, 1, &s);
	for (unsigned i = 0; i < 3000; i++) {
		double d[3];
		float rgb[3];
		spread(i, 3000, d);
		world_radiance(w, s.position_m, d, 1, rgb);
		for (unsigned k = 0; k < 3; k++) {
			g_assert_true(isfinite(rgb[k]) && rgb[k] >= 0 && rgb[k] < 10);
			sum += rgb[k] / 9000;
		}
	}
	g_assert_cmpfloat(sum, >, 0.1);
	g_assert_cmpfloat(sum, <, 1.0);
}

/* Of a raster, as a camera looks: the same light whether rays are cast one by one or together, but for a few that just miss an edge. */
static void check_together(const world *w)
{
	enum { SIDE = 60, ALL = SIDE * SIDE };
	g_autofree double *d = g_new(double, 3 * ALL);
	g_autofree float *together = g_new(float, 3 * ALL);
	struct world_station s;
	unsigned off = 0;
	world_get_station(w, 1, &s);
	for (unsigned i = 0; i < ALL; i++) {
		double x = (i % SIDE) / 30.0 - 1, z = (i / SIDE) / 30.0 - 1,
		       norm = sqrt(x * x + 1 + z * z);
		d[3 * i] = x / norm, d[3 * i + 1] = 1 / norm, d[3 * i + 2] = z / norm;
	}
	world_radiance(w, s.position_m, d, ALL - 3, together);
	world_radiance(w, s.position_m, d + 3 * (ALL - 3), 3, together + 3 * (ALL - 3));
	for (unsigned i = 0; i < ALL; i++) {
		float rgb[3];
		world_radiance(w, s.position_m, d + 3 * i, 1, rgb);
		for (unsigned k = 0; k < 3; k++)
			off += fabsf(rgb[k] - together[3 * i + k]) > 1e-4f;
	}
	g_assert_cmpuint(off, <=, 3 * ALL / 1000);
}

static void test_scene(gconstpointer data)
{
	const struct given *g = data;
	g_autoptr(GError) error = NULL;
	g_autoptr(world) w = world_new(g->scene, g->seed, NULL, &error);
	g_assert_no_error(error);
	check_stations(w);
	check_radiance(w);
	check_together(w);
	unsigned seen = 0;
	for (uint32_t i = 1; i <= world_station_count(w); i++) {
		struct world_station s;
		world_get_station(w, i, &s);
		seen |= classes_seen(w, &s, 3000);
	}
	g_assert_cmphex(seen & g->expected, ==, g->expected);
	if (g_str_equal(g->scene, "hall")) /* closed: no ray gets out */
		g_assert_false(seen & 1U << WORLD_NOTHING);
}

static void test_again(gconstpointer data)
{
	const struct given *g = data;
	g_autoptr(world) one = world_new(g->scene, g->seed, NULL, NULL);
	g_autoptr(world) again = world_new(g->scene, g->seed, NULL, NULL);
	g_autoptr(world) other = world_new(g->scene, g->seed + 1, NULL, NULL);
	g_assert_cmphex(fingerprint(one), ==, fingerprint(again));
	g_assert_cmphex(fingerprint(one), !=, fingerprint(other));
}

static void test_unknown(void)
{
	g_autoptr(GError) error = NULL;
	g_assert_null(world_new("moon", 1, NULL, &error));
	g_assert_nonnull(error);
	for (unsigned i = 0; world_scene_names[i]; i++)
		g_assert_nonnull(strstr(error->message, world_scene_names[i]));
	world_free(NULL);
}

/* ---- variants ---- */

static double range_from(const world *w, const double from[3], double azimuth, double elevation)
{
	double d[3] = { cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth),
		sin(elevation) };
	struct surface s;
	return world_cast(w, from, d, 100, &s) ? s.range_m : 0;
}

/* How many of the rays from the one place see something else than those from the other. */
static unsigned count_different(const world *a, const double from_a[3], const world *b,
	const double from_b[3], double turned)
{
	unsigned different = 0;
	for (unsigned i = 0; i < 400; i++)
		for (int k = -12; k < 18; k++) {
			double azimuth = i * G_PI / 200, elevation = k * 0.05;
			double here = range_from(a, from_a, azimuth, elevation),
			       there = range_from(b, from_b, azimuth + turned, elevation);
			different += fabs(here - there) > 1e-3;
		}
	return different;
}

static void test_symmetric_hall(void)
{
	struct world_variant variant = { .symmetric = true };
	g_autoptr(world) w = world_new("hall", 5, &variant, NULL);
	g_autoptr(world) plain = world_new("hall", 5, NULL, NULL);
	double here[3] = { 4.1, 1.3, 1.7 }, there[3] = { -4.1, -1.3, 1.7 };
	unsigned rays = 400 * 30;
	/* Rays along the joints of triangles may round either way. */
	g_assert_cmpuint(count_different(w, here, w, there, G_PI), <, rays / 500);
	g_assert_cmpuint(count_different(plain, here, plain, there, G_PI), >, rays / 50);
}

static void test_repeated_street(void)
{
	struct world_variant variant = { .repeated = true };
	g_autoptr(world) w = world_new("street", 5, &variant, NULL);
	g_autoptr(world) plain = world_new("street", 5, NULL, NULL);
	double here[3] = { 19, 0.3, 1.7 }, there[3] = { 27.5, 0.3, 1.7 };
	unsigned same = 0, same_in_plain = 0, rays = 0;
	for (double azimuth = -0.5; azimuth <= 0.5; azimuth += 0.01) /* the row in front */
		for (double elevation = 0.2; elevation < 0.6; elevation += 0.02, rays++) {
			same += fabs(range_from(w, here, azimuth, elevation) -
					range_from(w, there, azimuth, elevation)) < 2e-3;
			same_in_plain +=
				fabs(range_from(plain, here, azimuth, elevation) -
					range_from(plain, there, azimuth, elevation)) < 2e-3;
		}
	g_assert_cmpuint(same, >, rays * 97 / 100);
	g_assert_cmpuint(same_in_plain, <, rays / 2);
}

static void test_moved_things(void)
{
	for (int i = 0; world_scene_names[i]; i++) {
		struct world_variant variant = { .moved = 3 };
		g_autoptr(world) w = world_new(world_scene_names[i], 5, NULL, NULL);
		g_autoptr(world) moved = world_new(world_scene_names[i], 5, &variant, NULL);
		struct world_station station;
		world_get_station(w, 1, &station);
		unsigned different =
			count_different(w, station.position_m, moved, station.position_m, 0);
		g_test_message("%s: %u", world_scene_names[i], different);
		g_assert_cmpuint(different, >, 20);
		g_assert_cmpuint(different, <, 400 * 30 / 4);
	}
}

static void test_variants_that_are_not(void)
{
	g_autoptr(GError) error = NULL;
	struct world_variant symmetric = { .symmetric = true }, repeated = { .repeated = true };
	g_assert_null(world_new("street", 5, &symmetric, &error));
	g_assert_nonnull(strstr(error->message, "no symmetric street"));
	g_clear_error(&error);
	g_assert_null(world_new("hall", 5, &repeated, &error));
	g_assert_nonnull(strstr(error->message, "no repeated hall"));
}

/* What stands behind panes is told where they are, and all else as it was. */
static void test_behind_panes(void)
{
	enum { COLUMNS = 400, ROWS = 100 };
	g_autoptr(truth) t = truth_new("court?seed=2", NULL);
	struct truth_panorama p = { COLUMNS, ROWS, 50 * M_PI / 180, -40 * M_PI / 180, false };
	g_autofree struct truth_cell *seen = g_new(struct truth_cell, COLUMNS * ROWS),
				     *behind = g_new(struct truth_cell, COLUMNS * ROWS);
	uint32_t panes = 0;
	g_assert_nonnull(t);
	truth_look_around(t, &p, seen);
	p.is_behind = true;
	truth_look_around(t, &p, behind);
	for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
		g_assert_cmpint(behind[i].optics, !=, WORLD_GLASS);
		if (seen[i].optics != WORLD_GLASS) {
			g_assert_cmpmem(&seen[i], sizeof *seen, &behind[i], sizeof *behind);
			continue;
		}
		panes++;
		g_assert_true(behind[i].range_m > seen[i].range_m || !(behind[i].range_m > 0));
	}
	g_assert_cmpuint(panes, >, 100);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (unsigned i = 0; world_scene_names[i]; i++) {
		for (unsigned k = 0; k < G_N_ELEMENTS(seeds); k++) {
			struct given *g = g_new(struct given, 1);
			*g = (struct given){ world_scene_names[i], expected[i], seeds[k] };
			g_autofree char *path = g_strdup_printf("/world/%s/%u", g->scene, k + 1);
			g_test_add_data_func_full(path, g, test_scene, g_free);
		}
	}
	/* the two that are built fastest stand for all */
	static const struct given again[] = { { "court", 0, 1 }, { "hall", 0, 1 } };
	g_test_add_data_func("/world/court/again", &again[0], test_again);
	g_test_add_data_func("/world/hall/again", &again[1], test_again);
	g_test_add_func("/world/unknown", test_unknown);
	g_test_add_func("/world/variant/symmetric", test_symmetric_hall);
	g_test_add_func("/world/variant/repeated", test_repeated_street);
	g_test_add_func("/world/variant/moved", test_moved_things);
	g_test_add_func("/world/variant/none", test_variants_that_are_not);
	g_test_add_func("/world/behind-panes", test_behind_panes);
	return g_test_run();
}
