/* Normals of range grids: against rooms that are known exactly, the simulator's truth, and real scans. */
#include "process/geometry.h"
#include "process/import.h"
#include "process/normals.h"
#include "process/scan-data.h"
#include "sim/truth.h"
#include "tests/simulated.h"
#include "tests/support.h"
#include <stdlib.h>
#include <string.h>

#define DEG (180 / G_PI)

/* ---- rooms ---- */

/* A box, with a panel that stands free: x from panel_x_m[0] to [1], z likewise, at y = panel_y_m, facing -y. */
struct room {
	double low_m[3], high_m[3];
	double panel_x_m[2], panel_z_m[2], panel_y_m; /* 0: none */
};

static double meet(
	const struct room *r, const double eye[3], const double d[3], double ret_normal[3])
{
	double best = G_MAXDOUBLE;
	for (int k = 0; k < 3; k++) {
		double wall = d[k] > 0 ? r->high_m[k] : r->low_m[k], at = (wall - eye[k]) / d[k];
		if (fabs(d[k]) < 1e-12 || at >= best)
			continue;
		best = at;
		memset(ret_normal, 0, 3 * sizeof *ret_normal);
		ret_normal[k] = d[k] > 0 ? -1 : 1;
	}
	double at = (r->panel_y_m - eye[1]) / d[1], x = eye[0] + at * d[0], z = eye[2] + at * d[2];
	if (r->panel_y_m != 0 && d[1] > 0 && at > 0 && at < best && x > r->panel_x_m[0] &&
		x < r->panel_x_m[1] && z > r->panel_z_m[0] && z < r->panel_z_m[1]) {
		best = at;
		ret_normal[0] = ret_normal[2] = 0;
		ret_normal[1] = -1;
	}
	return best;
}

struct seen {
	range_grid *grid;
	double (*normal)[3]; /* the true one of each cell, scanner frame */
	struct pose pose;
};

static void seen_clear(struct seen *s)
{
	range_grid_free(s->grid);
	g_free(s->normal);
}

static double gauss(GRand *chance)
{
	return sqrt(-2 * log(1 - g_rand_double(chance))) * cos(2 * G_PI * g_rand_double(chance));
}

/* One beam a cell, off its centre as a real head's are. The scanner is turned by yaw. */
static struct seen look(const struct room *r, const double eye[3], double yaw_rad, uint32_t columns,
	uint32_t rows, double noise_m)
{
	struct panorama_desc desc = panorama_desc_for(columns, rows);
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	g_autoptr(GRand) chance = g_rand_new_with_seed(columns);
	struct seen s = { NULL, g_malloc0_n((size_t)columns * rows, 3 * sizeof(double)),
		pose_from_yaw(yaw_rad, eye) };
	struct pose to_scanner = pose_inverse(&s.pose);
	for (uint32_t i = 0; i < columns * rows; i++) {
		double azimuth =
			(i % columns + g_rand_double_range(chance, 0.1, 0.9)) * p->column_rad;
		double up = desc.elevation_max_rad -
			    (i / columns + g_rand_double_range(chance, 0.1, 0.9)) * p->row_rad;
		double d[3] = { sin(azimuth) * cos(up), cos(azimuth) * cos(up), sin(up) };
		pose_rotate(&s.pose, d, d);
		float range = (float)(meet(r, eye, d, s.normal[i]) + noise_m * gauss(chance)),
		      elevation = (float)up;
		uint16_t intensity = 0;
		pose_rotate(&to_scanner, s.normal[i], s.normal[i]);
		panorama_add(p, &azimuth, &elevation, &range, &intensity, 1);
	}
	s.grid = range_grid_from_panorama(p);
	return s;
}

static double angle_deg(const geometry *g, size_t i, const double n[3])
{
	double a[3] = { g->normal_x[i], g->normal_y[i], g->normal_z[i] };
	double c[3] = { a[1] * n[2] - a[2] * n[1], a[2] * n[0] - a[0] * n[2],
		a[0] * n[1] - a[1] * n[0] };
	return atan2(sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]),
		       a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) *
	       DEG;
}

static bool has_normal(const geometry *g, size_t i)
{
	return g->normal_x[i] != 0 || g->normal_y[i] != 0 || g->normal_z[i] != 0;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct errors {
	double median_deg, p90_deg, worst_deg, none;
};

static struct errors errors_of(const struct seen *s, const geometry *g)
{
	size_t n = range_grid_cells(s->grid), count = 0, none = 0;
	g_autofree double *angle = g_new(double, n);
	for (size_t i = 0; i < n; i++) {
		if (!(s->grid->range_m[i] > 0))
			continue;
		if (has_normal(g, i))
			angle[count++] = angle_deg(g, i, s->normal[i]);
		else
			none++;
	}
	g_assert_cmpuint(count, >, 0);
	qsort(angle, count, sizeof *angle, by_value);
	return (struct errors){ angle[count / 2], angle[count * 9 / 10], angle[count - 1],
		(double)none / (double)(count + none) };
}

static const struct room hall = { { -6, -9, -1.7 }, { 7, 8, 4 }, { 0 }, { 0 }, 0 };

static void test_exact(void)
{
	static const double eye[3] = { 0, 0, 0 };
	for (double scale = 1; scale <= 16; scale *= 16) {
		struct room r = hall;
		for (int k = 0; k < 3; k++) {
			r.low_m[k] *= scale;
			r.high_m[k] *= scale;
		}
		struct seen s = look(&r, eye, 0.3, 1500, 396, 0);
		g_autoptr(geometry) g = geometry_estimate(s.grid, NULL);
		struct errors e = errors_of(&s, g);
		g_test_message("x%g: median %g, p90 %g deg", scale, e.median_deg, e.p90_deg);
		g_assert_cmpfloat(e.median_deg, <, 0.01);
		g_assert_cmpfloat(e.p90_deg, <, 0.02);
		g_assert_cmpfloat(e.none, ==, 0);
		seen_clear(&s);
	}
}

/* Noise is along the rays: where they meet a wall at an angle, fitting to the points would tilt it. */
static void test_unbiased(void)
{
	static const double eye[3] = { 3, 2, 0 };
	struct seen s = look(&hall, eye, 0, 1500, 396, 0.02);
	struct geometry_options options = { .range_noise_m = 0.02f };
	g_autoptr(geometry) g = geometry_estimate(s.grid, &options);
	double tilt_deg = 0;
	size_t count = 0;
	for (size_t i = 0; i < range_grid_cells(s.grid); i++) {
		double away = atan2(s.grid->x_m[i], s.grid->y_m[i]) * DEG;
		if (s.normal[i][0] != -1 || away < 50 || away > 70 || fabsf(s.grid->z_m[i]) > 1)
			continue;
		tilt_deg += atan2(g->normal_y[i], -g->normal_x[i]) * DEG;
		count++;
	}
	g_test_message("mean tilt of %zu: %g deg", count, tilt_deg / (double)count);
	g_assert_cmpuint(count, >, 1000);
	g_assert_cmpfloat(fabs(tilt_deg / (double)count), <, 0.1);
	struct errors e = errors_of(&s, g);
	g_test_message("median %g, p90 %g deg", e.median_deg, e.p90_deg);
	g_assert_cmpfloat(e.median_deg, <, 1.2);
	g_assert_cmpfloat(e.p90_deg, <, 5);
	seen_clear(&s);
}

/* The noise that nobody told. */
static void test_noise_is_found(void)
{
	static const double eye[3] = { 0, 0, 0 }, noise_m[] = { 0.002, 0.012, 0.03 };
	for (size_t i = 0; i < G_N_ELEMENTS(noise_m); i++) {
		struct seen s = look(&hall, eye, 0, 750, 198, noise_m[i]);
		double found_m = normals_range_noise_m(s.grid, NULL);
		g_test_message("%g m: %g m", noise_m[i], found_m);
		g_assert_cmpfloat(found_m, >, 0.8 * noise_m[i]);
		g_assert_cmpfloat(found_m, <, 1.2 * noise_m[i]);
		seen_clear(&s);
	}
}

/* What stands before a wall, and the wall beside it, keep their own planes up to the last cell. */
static void test_depth_edge(void)
{
	static const double eye[3] = { 0, 0, 0 };
	struct room r = hall;
	r.panel_y_m = 5;
	r.panel_x_m[0] = r.panel_z_m[0] = -1;
	r.panel_x_m[1] = r.panel_z_m[1] = 1;
	struct seen s = look(&r, eye, 0, 1500, 396, 0.012);
	g_autoptr(geometry) g = geometry_estimate(s.grid, NULL);
	size_t beside = 0, wrong = 0;
	for (size_t i = 1; i + 1 < range_grid_cells(s.grid); i++) {
		bool edge = fabsf(s.grid->range_m[i - 1] - s.grid->range_m[i]) > 1.5f ||
			    fabsf(s.grid->range_m[i + 1] - s.grid->range_m[i]) > 1.5f;
		if (!edge || fabsf(s.grid->z_m[i]) > 0.8f)
			continue;
		beside++;
		wrong += !has_normal(g, i) || angle_deg(g, i, s.normal[i]) > 6 ||
			 !(g->plane_error_m[i] < 0.03f);
	}
	g_test_message("%zu of %zu cells at the edge are wrong", wrong, beside);
	g_assert_cmpuint(beside, >, 200);
	g_assert_cmpuint(wrong * 20, <, beside);
	seen_clear(&s);
}

/* Towards the scanner, of unit length, and numbers that mean something; nothing where nothing was measured. */
static void assert_sound(const range_grid *grid, const geometry *g)
{
	for (size_t i = 0; i < range_grid_cells(grid); i++) {
		double x = g->normal_x[i], y = g->normal_y[i], z = g->normal_z[i];
		if (!has_normal(g, i)) {
			g_assert_true(isnan(g->plane_error_m[i]) && isnan(g->curvature[i]));
			continue;
		}
		g_assert_cmpfloat(grid->range_m[i], >, 0);
		g_assert_cmpfloat_with_epsilon(x * x + y * y + z * z, 1, 1e-4);
		g_assert_cmpfloat(
			(x * grid->x_m[i] + y * grid->y_m[i] + z * grid->z_m[i]) / grid->range_m[i],
			<, 0.05);
		g_assert_true(g->plane_error_m[i] >= 0 && g->plane_error_m[i] < 100);
		g_assert_true(g->curvature[i] >= 0 && g->curvature[i] <= 0.3334f);
	}
}

static void test_portable(void)
{
	static const double eye[3] = { 1, 1, 0 };
	struct room r = hall;
	r.panel_y_m = 5;
	r.panel_x_m[0] = r.panel_z_m[0] = -1;
	r.panel_x_m[1] = r.panel_z_m[1] = 1;
	struct seen s = look(&r, eye, 0, 750, 198, 0.012);
	size_t n = range_grid_cells(s.grid), differ = 0;
	g_autofree float *plane = g_new0(float, 2 * (3 * n + 64));
	for (int k = 0; k < 2; k++) {
		float *at = plane + k * (3 * n + 64);
		struct normals_options o = {
			.radius_m = 0.06f, .range_noise_m = 0.012f, .portable = k == 1
		};
		struct normals_planes p = { .normal = { at, at + n, at + 2 * n } };
		normals_fit(s.grid, &o, &p);
	}
	for (size_t i = 0; i < 3 * n; i++)
		differ += fabsf(plane[i] - plane[3 * n + 64 + i]) > 2e-3f;
	g_test_message("%zu of %zu differ", differ, 3 * n);
	g_assert_cmpuint(differ * 1000, <, 3 * n); /* a window's last cell may fall either way */
	seen_clear(&s);
}

/* Bands and strips, with several threads or one, are the same as one step after the other: whatever the grid's size. */
static void assert_estimate_is_fit_and_mend(uint32_t columns, uint32_t rows)
{
	static const double eye[3] = { 1, 1, 0 };
	struct room r = hall;
	r.panel_y_m = 5;
	r.panel_x_m[0] = r.panel_z_m[0] = -1;
	r.panel_x_m[1] = r.panel_z_m[1] = 1;
	struct seen s = look(&r, eye, 0, columns, rows, 0.012);
	size_t n = range_grid_cells(s.grid), differ = 0, mended = 0;
	g_autofree float *plane = g_new0(float, 7 * (5 * n + 64));
	struct normals_planes p[4];
	for (int k = 0; k < 4; k++) {
		float *at = plane + (size_t)k * (5 * n + 64);
		p[k] = (struct normals_planes){ .normal = { at, at + n, at + 2 * n },
			.error_m = at + 3 * n,
			.curvature = at + 4 * n,
			.offset_m = plane + (size_t)(4 + k % 2) * (5 * n + 64) };
		struct normals_options o = {
			.radius_m = 0.06f, .range_noise_m = 0.012f, .single_thread = k == 2
		};
		if (k >= 2) {
			p[k].offset_m = NULL;
			normals_estimate(s.grid, &o, &p[k]);
			continue;
		}
		normals_fit(s.grid, &o, &p[k]);
		if (k == 1)
			normals_mend(s.grid, &o, &p[k]);
	}
	for (size_t i = 0; i < 5 * n; i++) {
		const float *fitted = p[0].normal[0] + i, *one = p[1].normal[0] + i;
		mended += memcmp(fitted, one, sizeof *one) != 0;
		for (int k = 2; k < 4; k++)
			differ += memcmp(one, p[k].normal[0] + i, sizeof *one) != 0;
	}
	g_test_message("%u x %u: %zu mended, %zu differ", columns, rows, mended, differ);
	g_assert_cmpuint(mended, >, 0);
	g_assert_cmpuint(differ, ==, 0);
	seen_clear(&s);
}

static void test_bands(void)
{
	assert_estimate_is_fit_and_mend(750, 198);
	assert_estimate_is_fit_and_mend(1024, 300);
	assert_estimate_is_fit_and_mend(771, 133); /* the last band is one row */
	assert_estimate_is_fit_and_mend(401, 31);
	assert_estimate_is_fit_and_mend(129, 140); /* no strip has inner columns */
	assert_estimate_is_fit_and_mend(37, 20);
}

/* ---- several scans ---- */

static void test_union(void)
{
	static const double eyes[3][3] = { { 0, 0, 0 }, { 2, 1.5, 0.1 }, { -2, 3, -0.1 } };
	struct seen s[3];
	struct posed_grid scans[3];
	for (int i = 0; i < 3; i++) {
		s[i] = look(&hall, eyes[i], 0.7 * i, 750 + (uint32_t)i, 198, 0.012);
		scans[i] = (struct posed_grid){ .grid = s[i].grid, .pose = s[i].pose };
	}
	g_autoptr(geometry) alone = geometry_estimate(s[0].grid, NULL);
	g_autoptr(geometry) all = geometry_estimate_union(scans, 3, 0, NULL, NULL, NULL);
	struct errors one = errors_of(&s[0], alone), three = errors_of(&s[0], all);
	g_test_message("alone %.3f / %.3f deg, with two more %.3f / %.3f deg", one.median_deg,
		one.p90_deg, three.median_deg, three.p90_deg);
	g_assert_cmpfloat(three.median_deg, <, 0.85 * one.median_deg);
	g_assert_cmpfloat(three.p90_deg, <=, 1.05 * one.p90_deg);
	assert_sound(s[0].grid, all);
	for (int i = 0; i < 3; i++)
		seen_clear(&s[i]);
}

/* A scan of which only single cells are left, far apart: alone it has no normals; another one gives them. */
static void test_union_gives(void)
{
	static const double eyes[2][3] = { { 0, 0, 0 }, { 1, 1, 0 } };
	struct seen s[2] = { look(&hall, eyes[0], 0, 750, 198, 0.012),
		look(&hall, eyes[1], 0.4, 751, 198, 0.012) };
	range_grid *g = s[0].grid;
	size_t left = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		if (i / g->columns % 8 == 0 && i % g->columns % 8 == 0) {
			left++;
			continue;
		}
		g->range_m[i] = g->x_m[i] = g->y_m[i] = g->z_m[i] = 0;
		g->cell[i] = CELL_EMPTY;
	}
	struct posed_grid scans[2] = { { g, s[0].pose, NULL }, { s[1].grid, s[1].pose, NULL } };
	struct geometry_options options = { .range_noise_m = 0.012f };
	g_autoptr(geometry) alone = geometry_estimate(g, &options);
	g_autoptr(geometry) both = geometry_estimate_union(scans, 2, 0, &options, NULL, NULL);
	struct errors e = errors_of(&s[0], both);
	size_t had = 0;
	for (size_t i = 0; i < range_grid_cells(g); i++)
		had += has_normal(alone, i);
	g_test_message("%zu cells, %zu had a normal; now all but %.3f, %.2f deg", left, had, e.none,
		e.median_deg);
	g_assert_cmpuint(had, ==, 0);
	g_assert_cmpfloat(e.none, <, 0.25);
	g_assert_cmpfloat(e.median_deg, <, 2);
	seen_clear(&s[0]);
	seen_clear(&s[1]);
}

/* Two leaves on one wall: what is known of the other side of the border does not come in. */
static void test_segments(void)
{
	static const double eye[3] = { 0, 0, 0 };
	struct seen s = look(&hall, eye, 0, 750, 198, 0.012);
	size_t n = range_grid_cells(s.grid);
	g_autofree uint32_t *leaf = g_new(uint32_t, n);
	for (size_t i = 0; i < n; i++)
		leaf[i] = s.grid->x_m[i] > 0.5f ? 1 : 2;
	g_autofree float *count[2] = { NULL, NULL };
	g_autofree float *planes = g_new0(float, 10 * (n + 64));
	for (int k = 0; k < 2; k++) {
		struct normals_options o = {
			.radius_m = 0.06f, .range_noise_m = 0.012f, .segment = k ? leaf : NULL
		};
		struct normals_planes p = { .count = planes + k * (n + 64) };
		float *spare = planes + 2 * (n + 64);
		for (int a = 0; a < 3; a++)
			p.centre_m[a] = spare;
		for (int a = 0; a < 6; a++)
			p.covariance_m2[a] = spare + n + 64;
		normals_fit(s.grid, &o, &p);
	}
	size_t fewer = 0, more = 0;
	for (size_t i = 0; i < n; i++) {
		fewer += planes[n + 64 + i] < planes[i];
		more += planes[n + 64 + i] > planes[i];
	}
	g_test_message("%zu windows are smaller, %zu larger", fewer, more);
	g_assert_cmpuint(fewer, >, 500);
	g_assert_cmpuint(fewer, <, n / 4);
	g_assert_cmpuint(more, ==, 0);
	seen_clear(&s);
}

/* ---- scans ---- */

static void test_simulated(void)
{
	const char *description = "hall?seed=3&ares=720&camera=none&divergence_mrad=0";
	g_autofree char *path = simulated_folder();
	g_autoptr(GError) error = NULL;
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	simulated_scan(path, description, &options, NULL, NULL, &result, &partial, &error);
	g_assert_no_error(error);
	g_autoptr(site) at = site_open(path, &error);
	g_autoptr(panorama) p = scan_load(at, result.number, false, &error);
	g_assert_no_error(error);
	g_autoptr(truth) t = truth_new(description, &error);
	g_assert_no_error(error);
	struct seen s = { range_grid_from_panorama(p), NULL, POSE_IDENTITY };
	size_t n = range_grid_cells(s.grid), measured = 0, none = 0, ground = 0;
	g_autoptr(geometry) g = geometry_estimate(s.grid, NULL);
	g_autofree double *angle = g_new(double, n);
	assert_sound(s.grid, g);
	for (uint32_t i = 0; i < n; i++) {
		if (!(s.grid->range_m[i] > 0))
			continue;
		measured++;
		none += !has_normal(g, i);
		struct truth_cell c = truth_look(t,
			panorama_azimuth_rad(p, i / s.grid->columns, i % s.grid->columns),
			panorama_elevation_rad(p, i / s.grid->columns, i % s.grid->columns));
		double normal[3] = { c.normal[0], c.normal[1], c.normal[2] };
		if (has_normal(g, i) && c.class == WORLD_TERRAIN &&
			fabsf(c.range_m - s.grid->range_m[i]) < 0.1f)
			angle[ground++] = angle_deg(g, i, normal);
	}
	qsort(angle, ground, sizeof *angle, by_value);
	g_test_message("%zu measured, %zu without a normal; floor: median %.2f, p90 %.2f deg",
		measured, none, angle[ground / 2], angle[ground * 9 / 10]);
	g_assert_cmpuint(none * 100, <=, measured);
	g_assert_cmpuint(ground, >, 1000);
	g_assert_cmpfloat(angle[ground / 2], <, 0.7);
	seen_clear(&s);
}

static void test_real(gconstpointer data)
{
	const char *file = shared_path(data);
	if (!file) {
		g_test_skip("the scan is not there");
		return;
	}
	g_autoptr(GError) error = NULL;
	g_autofree char *path = simulated_folder();
	g_autoptr(site) s = site_open_for_writing(path, &error);
	g_assert_no_error(error);
	g_autoptr(GArray) scans = import_file(s, file, &(struct import_options){ 0 }, &error);
	g_assert_no_error(error);
	g_autoptr(scan_data) d = scan_data_load(s, 1, &error);
	g_assert_no_error(error);
	g_autoptr(geometry) g = geometry_estimate(d->grid, NULL);
	size_t measured = range_grid_count(d->grid), had = 0;
	assert_sound(d->grid, g);
	for (size_t i = 0; i < range_grid_cells(d->grid); i++)
		had += has_normal(g, i);
	g_test_message("%ux%u, noise %.4f m: %.2f %% of %zu have a normal", d->grid->columns,
		d->grid->rows, normals_range_noise_m(d->grid, NULL),
		100.0 * (double)had / (double)measured, measured);
	g_assert_cmpfloat((double)had, >=, 0.95 * (double)measured);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/geometry/exact", test_exact);
	g_test_add_func("/geometry/unbiased", test_unbiased);
	g_test_add_func("/geometry/noise", test_noise_is_found);
	g_test_add_func("/geometry/depth-edge", test_depth_edge);
	g_test_add_func("/geometry/portable", test_portable);
	g_test_add_func("/geometry/bands", test_bands);
	g_test_add_func("/geometry/union", test_union);
	g_test_add_func("/geometry/union-gives", test_union_gives);
	g_test_add_func("/geometry/segments", test_segments);
	g_test_add_func("/geometry/simulated", test_simulated);
	g_test_add_data_func("/geometry/real/pump", "data/pump/pump.ptx", test_real);
	g_test_add_data_func("/geometry/real/ouster", "data/ouster-os2/os2.ptx", test_real);
	return g_test_run();
}
