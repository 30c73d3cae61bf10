#include "acquire/scan.h"
#include "process/range-grid.h"
#include "tests/simulated.h"
#include <math.h>

#define ROOM "hall?seed=3&ares=360&camera=none&divergence_mrad=0"

static panorama *scan_once(void)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	g_autoptr(GError) error = NULL;
	uint32_t number = simulated_draft(path, ROOM);
	g_autoptr(site) s = site_open(path, &error);
	panorama *p = scan_load(s, number, false, &error);
	g_assert_no_error(error);
	return p;
}

static void test_panorama_points_are_its_own(void)
{
	g_autoptr(panorama) p = scan_once();
	g_autoptr(range_grid) g = range_grid_from_panorama(p);
	size_t measured = 0;
	for (uint32_t r = 0; r < p->desc.rows; r++)
		for (uint32_t c = 0; c < p->desc.columns; c++) {
			size_t i = panorama_index(p, r, c);
			double exact[3] = { 0 };
			if (p->cell[i] == CELL_MEASURED)
				panorama_point(p, r, c, exact);
			measured += p->cell[i] == CELL_MEASURED;
			double off = fmax(fabs(g->x_m[i] - exact[0]),
				fmax(fabs(g->y_m[i] - exact[1]), fabs(g->z_m[i] - exact[2])));
			g_assert_cmpfloat(off, <=, 4e-7 * p->range_m[i]);
			g_assert_cmpint(g->range_m[i] > 0, ==, p->cell[i] == CELL_MEASURED);
		}
	g_assert_cmpuint(range_grid_count(g), ==, measured);
	g_assert_cmpuint(measured, >, 50000);
}

static void test_panorama_finds_its_cells(void)
{
	g_autoptr(panorama) p = scan_once();
	g_autoptr(range_grid) g = range_grid_from_panorama(p);
	size_t other = 0, measured = range_grid_count(g);
	for (size_t i = 0; i < range_grid_cells(g); i++)
		if (g->range_m[i] > 0)
			other += range_grid_find(g, g->x_m[i], g->y_m[i], g->z_m[i]) != i;
	/* A beam on the very edge of its cell may round into the next. */
	g_assert_cmpuint(other, <=, measured / 1000);
	g_assert_cmpuint(range_grid_find(g, 0, 1e-3, -1), ==, RANGE_GRID_NONE);
}

/* ---- of another scanner ---- */

struct uneven {
	uint32_t columns, rows;
	double *x, *y, *z;
	uint8_t *cell;
};

/* Rows that are not evenly spaced, every second one shifted by half a column, a hole here and there, azimuths from `first`
 * over `span`: a lidar with diodes. */
static struct uneven uneven_new(uint32_t columns, uint32_t rows, double first, double span)
{
	size_t n = (size_t)columns * rows;
	struct uneven u = { columns, rows, g_new0(double, n), g_new0(double, n), g_new0(double, n),
		g_new0(uint8_t, n) };
	for (uint32_t r = 0; r < rows; r++)
		for (uint32_t c = 0; c < columns; c++) {
			size_t i = (size_t)r * columns + c;
			double azimuth = first + (c + (r % 2 ? 0.4 : 0)) * span / columns;
			double elevation = 0.3 - 0.6 * r / rows - 0.004 * sin(r * 0.7);
			double range = 5 + 2 * sin(3 * azimuth) + r * 0.01;
			if ((r * 31 + c * 17) % 41 == 0)
				continue;
			u.x[i] = range * cos(elevation) * sin(azimuth);
			u.y[i] = range * cos(elevation) * cos(azimuth);
			u.z[i] = range * sin(elevation);
			u.cell[i] = CELL_MEASURED;
		}
	return u;
}

static void uneven_clear(struct uneven *u)
{
	g_free(u->x);
	g_free(u->y);
	g_free(u->z);
	g_free(u->cell);
}

static range_grid *uneven_grid(const struct uneven *u, GError **error)
{
	struct range_grid_desc desc = { u->columns, u->rows, u->x, u->y, u->z, u->cell, NULL,
		NULL };
	return range_grid_new(&desc, error);
}

static void check_uneven(double first, double span, bool wraps)
{
	g_autoptr(GError) error = NULL;
	struct uneven u = uneven_new(360, 60, first, span);
	g_autoptr(range_grid) g = uneven_grid(&u, &error);
	g_assert_no_error(error);
	g_assert_cmpint(g->wraps, ==, wraps);
	g_assert_cmpfloat_with_epsilon(g->column_rad, span / 360, 0.02 * span / 360);
	g_assert_cmpfloat_with_epsilon(g->row_rad, 0.01, 0.003);
	size_t far = 0, none = 0, measured = range_grid_count(g);
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		if (!(g->range_m[i] > 0))
			continue;
		uint32_t found = range_grid_find(g, g->x_m[i], g->y_m[i], g->z_m[i]);
		none += found == RANGE_GRID_NONE;
		if (found == RANGE_GRID_NONE)
			continue;
		double dot = (double)g->x_m[i] * g->x_m[found] + (double)g->y_m[i] * g->y_m[found] +
			     (double)g->z_m[i] * g->z_m[found];
		double angle = acos(fmin(dot / g->range_m[i] / g->range_m[found], 1));
		far += angle > 2 * hypot(g->column_rad, g->row_rad);
	}
	g_assert_cmpuint(none, ==, 0);
	g_assert_cmpuint(far, <=, measured / 500);
	uneven_clear(&u);
}

static void test_uneven_full_turn(void)
{
	check_uneven(0.5, 2 * G_PI, true);
}

static void test_uneven_sector_across_north(void)
{
	check_uneven(-0.6, 1.3, false);
}

/* Of three rows two have no beam. */
static void test_rows_between_beams(void)
{
	g_autoptr(GError) error = NULL;
	struct uneven u = uneven_new(360, 60, 0.5, 2 * G_PI);
	for (size_t i = 0; i < (size_t)u.columns * u.rows; i++)
		if (i / u.columns % 3)
			u.cell[i] = CELL_EMPTY;
	g_autoptr(range_grid) g = uneven_grid(&u, &error);
	g_assert_no_error(error);
	g_assert_cmpfloat_with_epsilon(g->row_rad, 0.01, 0.003);
	g_assert_cmpfloat_with_epsilon(g->column_rad, 2 * G_PI / 360, 0.0004);
	uneven_clear(&u);
}

static void test_sector_knows_where_it_did_not_look(void)
{
	struct uneven u = uneven_new(360, 60, -0.6, 1.3);
	g_autoptr(range_grid) g = uneven_grid(&u, NULL);
	g_assert_cmpuint(range_grid_find(g, 0, 1, 0), !=, RANGE_GRID_NONE);
	g_assert_cmpuint(range_grid_find(g, 0, -1, 0), ==, RANGE_GRID_NONE);
	g_assert_cmpuint(range_grid_find(g, 0, 1, 2), ==, RANGE_GRID_NONE);
	uneven_clear(&u);
}

static void test_nonsense_is_refused(void)
{
	struct uneven u = uneven_new(36, 6, 0, 6);
	g_autoptr(GError) error = NULL;
	u.x[80] = NAN;
	u.cell[80] = CELL_MEASURED;
	g_assert_null(uneven_grid(&u, &error));
	g_assert_nonnull(strstr(error->message, "row 2, column 8"));
	g_clear_error(&error);
	memset(u.cell, CELL_EMPTY, 36 * 6);
	g_assert_null(uneven_grid(&u, &error));
	g_assert_nonnull(strstr(error->message, "no points"));
	g_clear_error(&error);
	u.columns = 0;
	g_assert_null(uneven_grid(&u, &error));
	u.columns = 36;
	uneven_clear(&u);
}

static void test_own_place_is_no_point(void)
{
	struct uneven u = uneven_new(36, 6, 0, 6);
	u.x[50] = u.y[50] = u.z[50] = 0;
	u.cell[50] = CELL_MEASURED;
	g_autoptr(range_grid) g = uneven_grid(&u, NULL);
	g_assert_cmpuint(g->cell[50], ==, CELL_EMPTY);
	uneven_clear(&u);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/range-grid/panorama/points", test_panorama_points_are_its_own);
	g_test_add_func("/range-grid/panorama/find", test_panorama_finds_its_cells);
	g_test_add_func("/range-grid/uneven/full-turn", test_uneven_full_turn);
	g_test_add_func("/range-grid/uneven/sector", test_uneven_sector_across_north);
	g_test_add_func("/range-grid/uneven/between-beams", test_rows_between_beams);
	g_test_add_func("/range-grid/uneven/outside", test_sector_knows_where_it_did_not_look);
	g_test_add_func("/range-grid/nonsense", test_nonsense_is_refused);
	g_test_add_func("/range-grid/own-place", test_own_place_is_no_point);
	return g_test_run();
}
