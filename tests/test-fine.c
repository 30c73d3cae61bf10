/* Two scans fall into place from starts that are off, as exactly as their noise allows, and say how exactly; where they
 * cannot, they say that. */
#include "process/fine.h"
#include "process/pyramid.h"
#include "sim/truth.h"
#include "tests/import-made.h"
#include "tests/support.h"
#include <string.h>

#define DEGREE  (G_PI / 180)
#define NOISE_M 0.012

static double gauss(GRand *chance)
{
	double sum = 0;
	for (int i = 0; i < 12; i++)
		sum += g_rand_double(chance);
	return sum - 6;
}

/* ---- scans whose truth is known ---- */

struct seen {
	range_grid *grid;
	struct pose pose; /* scanner to world */
};

static void seen_clear(struct seen *s)
{
	range_grid_free(s->grid);
}

static struct pose pose_of(const struct world_station *station)
{
	struct pose p;
	memcpy(p.rotation, station->rotation, sizeof p.rotation);
	memcpy(p.translation_m, station->position_m, sizeof p.translation_m);
	return p;
}

/* What an ideal scanner with noise sees; glass is left out. */
static struct seen look(const char *description, uint32_t columns, double noise_m, uint32_t seed)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(truth) t = truth_new(description, &error);
	g_assert_no_error(error);
	struct panorama_desc desc = panorama_desc_for(columns, columns * 66 / 250);
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	size_t cells = (size_t)desc.columns * desc.rows;
	g_autofree struct truth_cell *cell = g_new(struct truth_cell, cells);
	struct truth_panorama around = { desc.columns, desc.rows, desc.elevation_max_rad,
		desc.elevation_min_rad };
	truth_look_around(t, &around, cell);
	g_autoptr(GRand) chance = g_rand_new_with_seed(seed);
	for (size_t i = 0; i < cells; i++) {
		bool hit = cell[i].range_m > 0 && cell[i].optics == WORLD_DIFFUSE;
		p->cell[i] = hit ? CELL_MEASURED : CELL_NO_RETURN;
		p->range_m[i] = hit ? cell[i].range_m + (float)(noise_m * gauss(chance)) : 0;
	}
	return (struct seen){ range_grid_from_panorama(p), pose_of(truth_station(t)) };
}

/* The same as seen by all tests that look from there: to build a site takes longer than what is done with it. */
static const struct seen *look_once(const char *description, uint32_t columns, uint32_t seed)
{
	static GHashTable *all;
	g_autofree char *key = g_strdup_printf("%s %u %u", description, columns, seed);
	if (!all)
		all = g_hash_table_new(g_str_hash, g_str_equal);
	struct seen *s = g_hash_table_lookup(all, key);
	if (!s) {
		s = g_new(struct seen, 1);
		*s = look(description, columns, NOISE_M, seed);
		g_hash_table_insert(all, g_steal_pointer(&key), s);
	}
	return s;
}

/* Station 1 and on of one site. */
static const struct seen *court_from(uint32_t station)
{
	g_autofree char *description = g_strdup_printf("court?seed=5&station=%u", station);
	return look_once(description, 500, 2 + station);
}

static struct pose off_by(const struct pose *p, double degrees, double metres, GRand *chance)
{
	double turn[6] = { 0 }, n = 0, m = 0, move[3];
	for (int k = 0; k < 3; k++) {
		turn[k] = gauss(chance);
		move[k] = gauss(chance);
		n += turn[k] * turn[k];
		m += move[k] * move[k];
	}
	for (int k = 0; k < 3; k++)
		turn[k] *= degrees * DEGREE / sqrt(n);
	struct pose there = POSE_IDENTITY, turned;
	there = pose_perturb(&there, turn);
	turned = pose_compose(p, &there);
	for (int k = 0; k < 3; k++)
		turned.translation_m[k] += move[k] * metres / sqrt(m);
	return turned;
}

struct error_of {
	double degrees, mm;
};

static struct error_of compare(const struct pose *found, const struct pose *exact)
{
	double twist[6];
	struct pose between = pose_between(found, exact);
	pose_difference(found, exact, twist);
	return (struct error_of){ pose_angle_rad(&between) / DEGREE,
		1e3 * sqrt(twist[3] * twist[3] + twist[4] * twist[4] + twist[5] * twist[5]) };
}

/* Squared error over what the covariance expects, per degree of freedom; Gauss-Jordan. */
static double normalised(const struct fine_result *r, const struct pose *exact)
{
	double m[6][7], sum = 0, twist[6];
	pose_difference(&r->pose, exact, twist);
	for (int i = 0; i < 6; i++) {
		memcpy(m[i], r->covariance[i], sizeof r->covariance[i]);
		m[i][6] = twist[i];
	}
	for (int i = 0; i < 6; i++) /* positive definite: no pivots needed */
		for (int k = 0; k < 6; k++) {
			double f = k == i ? 0 : m[k][i] / m[i][i];
			for (int j = i; j < 7; j++)
				m[k][j] -= f * m[i][j];
		}
	for (int i = 0; i < 6; i++)
		sum += twist[i] * m[i][6] / m[i][i];
	return sum / 6;
}

/* ---- exactness ---- */

struct place_pair {
	const char *a, *b;
	double degrees, mm; /* at most, of the worst */
};

static void test_exact(gconstpointer data)
{
	const struct place_pair *p = data;
	const struct seen *a = look_once(p->a, 1500, 1), *b = look_once(p->b, 1500, 2);
	g_autoptr(fine_scan) fa = fine_scan_new(a->grid);
	g_autoptr(fine_scan) fb = fine_scan_new(b->grid);
	struct pose exact = pose_between(&a->pose, &b->pose);
	g_autoptr(GRand) chance = g_rand_new_with_seed(5);
	for (int trial = 0; trial < 2; trial++) {
		struct pose start = off_by(&exact, 2, 0.3, chance);
		struct fine_result r;
		g_assert_true(fine_align(fa, fb, &start, FINE_FROM_NEAR, &r));
		struct error_of e = compare(&r.pose, &exact);
		g_test_message("%.5f degrees, %.3f mm, normalised %.2f, %u steps, %u pairs",
			e.degrees, e.mm, normalised(&r, &exact), r.iterations, r.pairs);
		g_assert_true(r.converged);
		g_assert_cmpfloat(e.degrees, <, p->degrees);
		g_assert_cmpfloat(e.mm, <, p->mm);
		g_assert_true(pose_is_rigid(&r.pose, 1e-12));
		g_assert_cmpfloat(r.inlier_share, >, 0.2);
		g_assert_cmpfloat(r.through_share, <, 0.03);
		g_assert_cmpfloat(r.information_eigenvalues[0], >, 0.002);
	}
}

/* The other way round is the inverse. */
static void test_both_ways(void)
{
	const struct seen *a = court_from(1), *b = court_from(2);
	g_autoptr(fine_scan) fa = fine_scan_new(a->grid);
	g_autoptr(fine_scan) fb = fine_scan_new(b->grid);
	struct pose ab = pose_between(&a->pose, &b->pose), ba = pose_inverse(&ab);
	struct fine_result forth, back;
	g_assert_true(fine_align(fa, fb, &ab, FINE_FROM_NEAR, &forth));
	g_assert_true(fine_align(fb, fa, &ba, FINE_FROM_NEAR, &back));
	struct pose again = pose_inverse(&back.pose);
	struct error_of e = compare(&forth.pose, &again);
	g_assert_cmpfloat(e.degrees, <, 0.0005);
	g_assert_cmpfloat(e.mm, <, 0.1);
}

#define STATIONS 4
static void test_covariance(void)
{
	const struct seen *s[STATIONS];
	fine_scan *f[STATIONS];
	double sum = 0;
	int count = 0;
	for (int k = 0; k < STATIONS; k++) {
		s[k] = court_from((uint32_t)k + 1);
		f[k] = fine_scan_new(s[k]->grid);
	}
	for (int i = 0; i < STATIONS; i++)
		for (int k = i + 1; k < STATIONS; k++) {
			struct pose exact = pose_between(&s[i]->pose, &s[k]->pose);
			struct fine_result r;
			if (pose_distance_m(&exact) > 16)
				continue;
			g_assert_true(fine_align(f[i], f[k], &exact, FINE_FROM_NEAR, &r));
			sum += normalised(&r, &exact);
			count++;
		}
	g_test_message("normalised error %.2f over %d pairs", sum / count, count);
	g_assert_cmpint(count, >=, 4);
	g_assert_cmpfloat(sum / count, >, 0.3);
	g_assert_cmpfloat(sum / count, <, 3);
	for (int k = 0; k < STATIONS; k++)
		fine_scan_free(f[k]);
}

/* ---- from afar ---- */

static void test_basin(void)
{
	struct seen a = look("street?seed=4&station=1", 500, NOISE_M, 7),
		    b = look("street?seed=4&station=2", 500, NOISE_M, 8);
	g_autoptr(fine_scan) fa = fine_scan_new(a.grid);
	g_autoptr(fine_scan) fb = fine_scan_new(b.grid);
	struct pose exact = pose_between(&a.pose, &b.pose);
	g_autoptr(GRand) chance = g_rand_new_with_seed(11);
	int right = 0, trials = 8;
	for (int trial = 0; trial < trials; trial++) {
		struct pose start = off_by(&exact, 15, 3, chance);
		struct fine_result r;
		bool good = fine_align(fa, fb, &start, FINE_FROM_COARSE, &r);
		struct error_of e = compare(&r.pose, &exact);
		bool there = e.degrees < 0.02 && e.mm < 10;
		if (good && r.converged)
			g_assert_true(there);
		right += there;
	}
	g_test_message("%d of %d", right, trials);
	g_assert_cmpint(right, >=, trials - 1);
	seen_clear(&a);
	seen_clear(&b);
}

/* ---- where it cannot ---- */

static void test_other_places(void)
{
	const struct seen *a = court_from(1);
	struct seen b = look("bridge?seed=2&station=1", 500, NOISE_M, 4);
	g_autoptr(fine_scan) fa = fine_scan_new(a->grid);
	g_autoptr(fine_scan) fb = fine_scan_new(b.grid);
	g_autoptr(GRand) chance = g_rand_new_with_seed(2);
	for (int trial = 0; trial < 3; trial++) {
		struct pose start = POSE_IDENTITY;
		start = off_by(&start, 90, 5, chance);
		struct fine_result r;
		bool good = fine_align(fa, fb, &start, FINE_FROM_COARSE, &r);
		g_assert_false(good && r.converged);
	}
	seen_clear(&b);
}

/* A tunnel of rectangular section, without ends, as seen from a place in it. */
static range_grid *tunnel(double across_m, double up_m, uint32_t seed)
{
	enum { COLUMNS = 720, ROWS = 180 };
	g_autofree double *p = g_new0(double, 3 * COLUMNS * ROWS);
	g_autofree uint8_t *cell = g_new0(uint8_t, COLUMNS * ROWS);
	g_autoptr(GRand) chance = g_rand_new_with_seed(seed);
	double *x = p, *y = p + COLUMNS * ROWS, *z = p + 2 * COLUMNS * ROWS;
	for (int r = 0; r < ROWS; r++)
		for (int c = 0; c < COLUMNS; c++) {
			double azimuth = (c + 0.5) * 2 * G_PI / COLUMNS;
			double elevation = (45 - (r + 0.5) * 90 / ROWS) * DEGREE;
			double d[3] = { cos(elevation) * sin(azimuth),
				cos(elevation) * cos(azimuth), sin(elevation) };
			double range = fmin(fabs(((d[0] > 0 ? 2 : -2) - across_m) / d[0]),
				fabs(((d[2] > 0 ? 3 : -2) - up_m) / d[2]));
			int i = r * COLUMNS + c;
			cell[i] = range < 40 ? CELL_MEASURED : CELL_NO_RETURN;
			range = range < 40 ? range + NOISE_M * gauss(chance) : 0;
			x[i] = d[0] * range;
			y[i] = d[1] * range;
			z[i] = d[2] * range;
		}
	struct range_grid_desc desc = {
		.columns = COLUMNS, .rows = ROWS, .x_m = x, .y_m = y, .z_m = z, .cell = cell
	};
	g_autoptr(GError) error = NULL;
	range_grid *g = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	return g;
}

/* All is held but the way along the tunnel, and that is what it says. */
static void test_sliding(void)
{
	g_autoptr(range_grid) ga = tunnel(0, 0, 1);
	g_autoptr(range_grid) gb = tunnel(0.3, -0.1, 2);
	g_autoptr(fine_scan) fa = fine_scan_new(ga);
	g_autoptr(fine_scan) fb = fine_scan_new(gb);
	struct pose start = POSE_IDENTITY;
	struct fine_result r;
	start.translation_m[0] = 0.25;
	if (fine_align(fa, fb, &start, FINE_FROM_NEAR, &r)) {
		g_assert_cmpfloat(fabs(r.pose.translation_m[0] - 0.3), <, 1e-3);
		g_assert_cmpfloat(fabs(r.pose.translation_m[2] + 0.1), <, 1e-3);
		g_assert_cmpfloat(sqrt(r.covariance[4][4]), >, 20 * sqrt(r.covariance[3][3]));
	}
	g_test_message("%g %g", r.information_eigenvalues[0], r.information_eigenvalues[1]);
	g_assert_cmpfloat(r.information_eigenvalues[0], <, 1e-3);
	g_assert_cmpfloat(r.information_eigenvalues[1], >, 1e-2);
}

static void test_next_to_nothing(void)
{
	enum { COLUMNS = 12, ROWS = 6 };
	double x[COLUMNS * ROWS], y[COLUMNS * ROWS], z[COLUMNS * ROWS];
	uint8_t cell[COLUMNS * ROWS];
	for (int i = 0; i < COLUMNS * ROWS; i++) {
		double azimuth = (i % COLUMNS) * 2 * G_PI / COLUMNS;
		x[i] = 5 * sin(azimuth);
		y[i] = 5 * cos(azimuth);
		z[i] = 1 - i / COLUMNS * 0.4;
		cell[i] = CELL_MEASURED;
	}
	struct range_grid_desc desc = {
		.columns = COLUMNS, .rows = ROWS, .x_m = x, .y_m = y, .z_m = z, .cell = cell
	};
	g_autoptr(range_grid) g = range_grid_new(&desc, NULL);
	g_assert_nonnull(g);
	g_autoptr(fine_scan) f = fine_scan_new(g);
	struct pose start = POSE_IDENTITY;
	struct fine_result r;
	g_assert_false(fine_align(f, f, &start, FINE_FROM_NEAR, &r));
	g_assert_false(r.converged);
}

/* ---- the pyramid ---- */

static void test_portable(void)
{
	const struct seen *a = look_once("hall?seed=5&station=1", 1500, 1);
	g_autoptr(pyramid) wide = pyramid_new(a->grid);
	g_autoptr(pyramid) portable = pyramid_new_portable(a->grid);
	g_assert_cmpfloat(fabs(wide->noise_m / portable->noise_m - 1), <, 0.01);
	for (int l = 0; l < PYRAMID_LEVELS; l++) {
		const struct pyramid_level *w = &wide->level[l], *p = &portable->level[l];
		size_t cells = (size_t)w->columns * w->rows, other = 0;
		g_assert_cmpuint(w->columns, ==, p->columns);
		for (size_t i = 0; i < cells; i++) {
			const struct surfel *s = &w->surfel[i], *t = &p->surfel[i];
			double along = 0, off = 0;
			for (int k = 0; k < 3; k++) {
				along += (double)s->normal[k] * t->normal[k];
				off += fabs(s->point_m[k] - t->point_m[k]);
			}
			other += off > 1e-5 * (1 + s->range_m) ||
				 (s->sigma_m > 0) != (t->sigma_m > 0) ||
				 (s->sigma_m > 0 && s->sigma_m < 0.02f && along < 0.9999);
		}
		g_assert_cmpuint(other, <=, cells / 1000);
	}
}

/* Its planes are those that stand there, and it knows the noise. */
static void test_planes(void)
{
	g_autoptr(range_grid) g = tunnel(0, 0, 1);
	g_autoptr(pyramid) p = pyramid_new(g);
	g_assert_cmpfloat(fabs(p->noise_m / NOISE_M - 1), <, 0.1);
	const struct pyramid_level *l = &p->level[1];
	size_t planes = 0, wrong = 0;
	for (size_t i = 0; i < (size_t)l->columns * l->rows; i++) {
		const struct surfel *s = &l->surfel[i];
		if (!(s->sigma_m > 0) || s->sigma_m > 0.01f)
			continue;
		double square = fmax(fabs(s->normal[0]), fabs(s->normal[2]));
		double inward = 0;
		for (int k = 0; k < 3; k++)
			inward += (double)s->normal[k] * s->point_m[k];
		g_assert_cmpfloat(inward, <, 0);
		planes++;
		wrong += square < cos(10 * DEGREE);
	}
	g_assert_cmpuint(planes, >, 8000);
	g_assert_cmpuint(wrong, <, planes / 50);
}

/* ---- scans of our head, and of others' ---- */

static range_grid *record(const char *site_path, const char *description, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	simulated_draft(site_path, description);
	g_autoptr(site) s = site_open(site_path, &error);
	g_autoptr(panorama) p = scan_load(s, number, false, &error);
	g_assert_no_error(error);
	return range_grid_from_panorama(p);
}

static void test_recorded(void)
{
	static const char *const at[2] = {
		"hall?seed=3&station=1&ares=360&camera=none&divergence_mrad=0",
		"hall?seed=3&station=2&ares=360&camera=none&divergence_mrad=0"
	};
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	fine_scan *f[2];
	struct pose pose[2];
	for (int k = 0; k < 2; k++) {
		g_autoptr(range_grid) g = record(path, at[k], (uint32_t)k + 1);
		g_autoptr(truth) t = truth_new(at[k], NULL);
		f[k] = fine_scan_new(g);
		pose[k] = pose_of(truth_station(t));
	}
	struct pose exact = pose_between(&pose[0], &pose[1]);
	g_autoptr(GRand) chance = g_rand_new_with_seed(9);
	struct pose start = off_by(&exact, 3, 0.5, chance);
	struct fine_result r;
	g_assert_true(fine_align(f[0], f[1], &start, FINE_FROM_COARSE, &r));
	struct error_of e = compare(&r.pose, &exact);
	g_test_message("%.4f degrees, %.2f mm, %.1f m apart, share %.2f, through %.3f, %u pairs",
		e.degrees, e.mm, pose_distance_m(&exact), r.inlier_share, r.through_share, r.pairs);
	g_assert_true(r.converged);
	g_assert_cmpfloat(e.degrees, <, 0.03);
	g_assert_cmpfloat(e.mm, <, 8);
	fine_scan_free(f[0]);
	fine_scan_free(f[1]);
}

/* The same points as seen after the scanner was moved a little: a grid of the same size, each cell with the nearest point
 * that falls into it. */
static range_grid *seen_from(const range_grid *g, const struct pose *there)
{
	const struct range_lattice *l = &g->lattice;
	size_t cells = (size_t)l->columns * l->rows;
	g_autofree double *p = g_new0(double, 3 * cells);
	g_autofree uint8_t *cell = g_new0(uint8_t, cells);
	struct pose back = pose_inverse(there);
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		double q[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		if (!(g->range_m[i] > 0))
			continue;
		pose_apply(&back, q, q);
		int64_t at = range_lattice_find(l, q[0], q[1], q[2]);
		if (at < 0)
			continue;
		double old = hypot(hypot(p[at], p[cells + at]), p[2 * cells + at]);
		if (cell[at] == CELL_MEASURED && old <= hypot(hypot(q[0], q[1]), q[2]))
			continue;
		cell[at] = CELL_MEASURED;
		for (int k = 0; k < 3; k++)
			p[k * cells + at] = q[k];
	}
	struct range_grid_desc desc = { .columns = l->columns,
		.rows = l->rows,
		.x_m = p,
		.y_m = p + cells,
		.z_m = p + 2 * cells,
		.cell = cell };
	g_autoptr(GError) error = NULL;
	range_grid *moved = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	return moved;
}

static void test_imported(gconstpointer data)
{
	const char *path = shared_path(data);
	if (!path) {
		g_test_skip("the scan is not here");
		return;
	}
	g_autoptr(GError) error = NULL;
	struct place place = place_new();
	g_autoptr(GArray) numbers = place_import(&place, path);
	g_autoptr(scan_data) d =
		scan_data_load(place.site, g_array_index(numbers, uint32_t, 0), &error);
	g_assert_no_error(error);
	g_assert_cmpint(d->kind, ==, SCAN_ORDERED);
	double twist[6] = { 0.004, -0.006, 0.03, 0.10, -0.15, 0.05 };
	struct pose there = POSE_IDENTITY, start = POSE_IDENTITY;
	there = pose_perturb(&there, twist);
	g_autoptr(range_grid) moved = seen_from(d->grid, &there);
	g_autoptr(fine_scan) fa = fine_scan_new(d->grid);
	g_autoptr(fine_scan) fb = fine_scan_new(moved);
	struct fine_result r;
	g_assert_true(fine_align(fa, fb, &start, FINE_FROM_NEAR, &r));
	struct error_of e = compare(&r.pose, &there);
	g_test_message("%s: %.4f degrees, %.3f mm, %u pairs, rms %.1f mm", (const char *)data,
		e.degrees, e.mm, r.pairs, 1e3 * r.rms_m);
	g_assert_cmpfloat(e.degrees, <, 0.02);
	g_assert_cmpfloat(e.mm, <, 6);
	place_clear(&place);
}

int main(int argc, char **argv)
{
	static const struct place_pair court = { "court?seed=5&station=1", "court?seed=5&station=2",
		0.002, 0.6 },
				       hall = { "hall?seed=5&station=1", "hall?seed=5&station=2",
					       0.004, 1.0 };
	g_test_init(&argc, &argv, NULL);
	g_test_add_data_func("/fine/exact/court", &court, test_exact);
	g_test_add_data_func("/fine/exact/hall", &hall, test_exact);
	g_test_add_func("/fine/both-ways", test_both_ways);
	g_test_add_func("/fine/covariance", test_covariance);
	g_test_add_func("/fine/basin", test_basin);
	g_test_add_func("/fine/other-places", test_other_places);
	g_test_add_func("/fine/sliding", test_sliding);
	g_test_add_func("/fine/next-to-nothing", test_next_to_nothing);
	g_test_add_func("/pyramid/portable", test_portable);
	g_test_add_func("/pyramid/planes", test_planes);
	g_test_add_func("/fine/recorded", test_recorded);
	g_test_add_data_func("/fine/imported/pump", "data/pump/pump.ptx", test_imported);
	g_test_add_data_func("/fine/imported/os2", "data/ouster-os2/os2.ptx", test_imported);
	return g_test_run();
}
