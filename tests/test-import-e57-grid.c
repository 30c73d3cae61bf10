/* Rows and columns of E57 files: which of them make a grid, where its points then are, and what becomes of the others; and real files. */
#include "tests/e57-taken.h"
#include "tests/support.h"

enum { COLUMNS = 24, ROWS = 12, CELLS = COLUMNS * ROWS };

/* ---- a scene in a grid: row 0 the highest, columns clockwise ---- */

struct grid {
	const char *path;
	bool upwards, anticlockwise;
	int64_t first_row, first_column; /* of the file's numbers */
	bool with_echoes, later_first;   /* every third cell has a second echo */
	bool every;                      /* no holes */
	double far_m;                    /* added to x: coordinates of a map */
};
static const struct grid grids[] = {
	{ .path = "plain", .every = true },
	{ .path = "holes" },
	{ .path = "upwards", .upwards = true },
	{ .path = "anticlockwise", .anticlockwise = true, .first_row = -40, .first_column = 1000 },
	{ .path = "upwards-anticlockwise", .upwards = true, .anticlockwise = true, .first_row = 3 },
	{ .path = "echoes", .with_echoes = true },
	{ .path = "later-echoes-first", .with_echoes = true, .later_first = true, .upwards = true },
};

static void cell_point(unsigned cell, bool is_later, double ret_m[3])
{
	double azimuth_rad = -(cell % COLUMNS + 0.5) * 2 * G_PI / COLUMNS,
	       elevation_rad = 0.6 - cell / COLUMNS * 0.1,
	       range_m = 3 + (cell * 7 % 31) * 0.1 + (is_later ? 5 : 0);
	ret_m[0] = range_m * cos(elevation_rad) * cos(azimuth_rad);
	ret_m[1] = range_m * cos(elevation_rad) * sin(azimuth_rad);
	ret_m[2] = range_m * sin(elevation_rad);
}

/* Of a cell: 0 a point, 1 no return, 2 not to be used, 3 not in the file. */
static int state_of(const struct grid *g, unsigned cell)
{
	if (g->every || cell == 0 || cell == CELLS - 1)
		return 0;
	return cell % 11 == 3 ? 3 : cell % 13 == 5 ? 1 : cell % 17 == 1 ? 2 : 0;
}

static bool has_later(const struct grid *g, unsigned cell)
{
	return g->with_echoes && cell % 3 == 0 && state_of(g, cell) == 0;
}

static const struct made_field grid_fields[] = { DOUBLES, WHOLES("rowIndex", -100, 1100),
	WHOLES("columnIndex", -100, 1100), WHOLES("returnIndex", 0, 1),
	WHOLES("cartesianInvalidState", 0, 2) };

static void add_record(GArray *table, const struct grid *g, unsigned cell, bool is_later)
{
	unsigned row = cell / COLUMNS, column = cell % COLUMNS;
	int state = state_of(g, cell);
	double at_m[3];
	cell_point(cell, is_later, at_m);
	row = g->upwards ? ROWS - 1 - row : row;
	column = g->anticlockwise ? COLUMNS - 1 - column : column;
	/* What stands in a record that is no point must not matter. */
	union made_value of[] = { REAL(state ? NAN : at_m[0] + g->far_m), REAL(at_m[1]),
		REAL(at_m[2]), WHOLE(row + g->first_row), WHOLE(column + g->first_column),
		WHOLE(is_later), WHOLE(state) };
	g_array_append_vals(table, of, G_N_ELEMENTS(of));
}

/* In no order: every 53rd cell, round and round. */
static GArray *grid_table(const struct grid *g)
{
	GArray *table = g_array_new(false, false, sizeof(union made_value));
	for (unsigned i = 0; i < CELLS; i++) {
		unsigned cell = i * 53 % CELLS;
		if (state_of(g, cell) == 3)
			continue;
		if (has_later(g, cell) && g->later_first)
			add_record(table, g, cell, true);
		add_record(table, g, cell, false);
		if (has_later(g, cell) && !g->later_first)
			add_record(table, g, cell, true);
	}
	return table;
}

static GByteArray *table_file(
	const struct made_field *fields, unsigned count, const GArray *table, const char *what)
{
	struct made_points made = { fields, count, table->len / count,
		.value = (const union made_value *)table->data, .packets = 3, .apart = 1 };
	return made_one(&made, what);
}

static void assert_cell(const struct grid *g, const struct point_record *r, unsigned cell)
{
	double at_m[3];
	cell_point(cell, false, at_m);
	if (state_of(g, cell) == 0)
		assert_close(r, at_m, 1e-9);
	else
		g_assert_cmpint(r->cell, ==, state_of(g, cell) == 1 ? CELL_NO_RETURN : CELL_EMPTY);
	if (state_of(g, cell) == 0)
		g_assert_cmpint(r->return_number, ==, 1);
}

static void test_grid(gconstpointer data)
{
	const struct grid *g = data;
	g_autoptr(GArray) table = grid_table(g);
	struct taken t = taken_new(table_file(grid_fields, 7, table, NULL));
	uint64_t later = 0, points_there = 0;
	g_assert_cmpuint(t.p->columns, ==, COLUMNS);
	g_assert_cmpuint(t.p->rows, ==, ROWS);
	for (unsigned cell = 0; cell < CELLS; cell++) {
		assert_cell(g, &t.p->record[cell], cell);
		later += has_later(g, cell);
		points_there += state_of(g, cell) == 0;
	}
	g_assert_cmpuint(taken_scan(&t, 0)->points, ==, points_there);
	g_assert_cmpuint(taken_scan(&t, 0)->left_out, ==, later);
	taken_assert_note(&t, 0, later ? "others have their rows and columns" : NULL);
	manifest_assert_string(t.m, "source.grid.rows_run", g->upwards ? "up" : "down");
	manifest_assert_string(
		t.m, "source.grid.columns_run", g->anticlockwise ? "anticlockwise" : "clockwise");
	taken_clear(&t);
}

/* ---- what looks like a grid and is none ---- */

/* Coordinates of a map: a cloud, near the points. */
static void test_map(void)
{
	struct grid g = { .far_m = 456789 };
	g_autoptr(GArray) table = grid_table(&g);
	struct taken t = taken_new(table_file(grid_fields, 7, table, NULL));
	g_assert_cmpuint(t.p->columns, ==, 0);
	g_assert_nonnull(strstr(taken_scan(&t, 0)->grid, "map coordinates"));
	JsonArray *origin = json_node_get_array(manifest_get_node(t.m, "points.origin_m"));
	double x_m = json_array_get_double_element(origin, 0), at_m[3];
	g_assert_cmpfloat(fabs(x_m - 456789), <, 20);
	uint64_t k = 0;
	for (unsigned cell = 0; cell < CELLS; cell++)
		k += state_of(&g, cell) == 0;
	g_assert_cmpuint(t.p->count, ==, k);
	cell_point(0, false, at_m);
	k = 0;
	for (uint64_t i = 0; i < t.p->count; i++)
		k += fabs(t.p->record[i].x_m + x_m - 456789 - at_m[0]) < 1e-6 &&
		     fabs(t.p->record[i].z_m + json_array_get_double_element(origin, 2) - at_m[2]) <
			     1e-6;
	g_assert_cmpuint(k, ==, 1);
	taken_clear(&t);
}

/* Rows and columns of records 0..: row i / columns % rows. */
static void assert_no_grid(unsigned columns, unsigned rows, unsigned count, const char *words)
{
	GArray *table = g_array_new(false, false, sizeof(union made_value));
	for (unsigned i = 0; i < count; i++) {
		double at_m[3];
		scene_point(i, at_m);
		union made_value of[] = { REAL(at_m[0]), REAL(at_m[1]), REAL(at_m[2]),
			WHOLE(i / columns % rows), WHOLE(i % columns), WHOLE(0), WHOLE(0) };
		g_array_append_vals(table, of, G_N_ELEMENTS(of));
	}
	struct taken t = taken_new(table_file(grid_fields, 7, table, NULL));
	g_assert_cmpuint(t.p->columns, ==, 0);
	g_assert_cmpuint(t.p->count, ==, count);
	for (unsigned i = 0; i < count; i++) {
		double at_m[3];
		scene_point(i, at_m);
		assert_close(&t.p->record[i], at_m, 1e-9);
	}
	g_assert_nonnull(strstr(taken_scan(&t, 0)->grid, words));
	g_array_unref(table);
	taken_clear(&t);
}

static void test_no_grid(void)
{
	assert_no_grid(300, 1, 300, "rows and columns make none");
	assert_no_grid(1, 300, 300, "rows and columns make none");
	assert_no_grid(20, 10, 400, "points share rows and columns");
	assert_no_grid(20, 10, 203, "points share rows and columns");
}

/* Far apart numbers of a few points must not become a grid of a thousand million cells. */
static void test_sparse(void)
{
	static const struct made_field fields[] = { DOUBLES, WHOLES("rowIndex", 0, 60000),
		WHOLES("columnIndex", 0, INT64_MAX) };
	static const int64_t columns[] = { 60000, INT64_MAX, 70000 };
	for (size_t k = 0; k < G_N_ELEMENTS(columns); k++) {
		const union made_value value[] = { REAL(1), REAL(2), REAL(3), WHOLE(0), WHOLE(0),
			REAL(2), REAL(3), REAL(1), WHOLE(1000), WHOLE(columns[k]) };
		struct made_points made = { fields, 5, 2, .value = value };
		struct taken t = taken_new(made_one(&made, NULL));
		g_assert_cmpuint(t.p->count, ==, 2);
		g_assert_cmpuint(t.p->columns, ==, 0);
		taken_clear(&t);
	}
}

/* More rows than a panorama may have. */
static void test_too_high(void)
{
	static const struct made_field fields[] = { DOUBLES, WHOLES("rowIndex", 0, 60000),
		WHOLES("columnIndex", 0, 1) };
	g_autoptr(GArray) table = g_array_new(false, false, sizeof(union made_value));
	for (unsigned i = 0; i < 100; i++) {
		double at_m[3];
		scene_point(i, at_m);
		union made_value of[] = { REAL(at_m[0]), REAL(at_m[1]), REAL(at_m[2]),
			WHOLE(i * 400), WHOLE(i % 2) };
		g_array_append_vals(table, of, G_N_ELEMENTS(of));
	}
	struct taken t = taken_new(table_file(fields, 5, table, NULL));
	g_assert_cmpuint(t.p->columns, ==, 0);
	g_assert_cmpuint(t.p->count, ==, 100);
	taken_clear(&t);
}

/* A row that is no number has no cell: its point is left out, and counted. */
static void test_row_no_number(void)
{
	static const struct made_field fields[] = { DOUBLES,
		{ "rowIndex", MADE_FLOAT64, 0, 0, 0, 0, NULL },
		{ "columnIndex", MADE_FLOAT64, 0, 0, 0, 0, NULL } };
	g_autoptr(GArray) table = g_array_new(false, false, sizeof(union made_value));
	for (unsigned cell = 0; cell < CELLS; cell++) {
		double at_m[3];
		cell_point(cell, false, at_m);
		union made_value of[] = { REAL(at_m[0]), REAL(at_m[1]), REAL(at_m[2]),
			REAL(cell == 40 ? NAN : cell / COLUMNS),
			REAL(cell == 50 ? INFINITY : cell % COLUMNS) };
		g_array_append_vals(table, of, G_N_ELEMENTS(of));
	}
	struct taken t = taken_new(table_file(fields, 5, table, NULL));
	g_assert_cmpuint(t.p->columns, ==, COLUMNS);
	g_assert_cmpuint(taken_scan(&t, 0)->points, ==, CELLS - 2);
	g_assert_cmpuint(taken_scan(&t, 0)->left_out, ==, 2);
	taken_clear(&t);
}

/* ---- clouds ---- */

static const struct made_field cloud_fields[] = { DOUBLES, WHOLES("cartesianInvalidState", 0, 2),
	WHOLES("returnIndex", 0, 300) };

/* Points that the file marks as none, or that are no numbers; one at zero is a point where a field says so; echoes of one pulse all
 * stay. */
static void test_cloud(void)
{
	g_autoptr(GArray) table = g_array_new(false, false, sizeof(union made_value));
	for (unsigned i = 0; i < 400; i++) {
		double at_m[3];
		scene_point(i, at_m);
		bool zero = i % 10 == 7, none = i % 10 == 8;
		union made_value of[] = { REAL(none      ? NAN
						  : zero ? 0
							 : at_m[0]),
			REAL(zero ? 0 : at_m[1]), REAL(zero ? 0 : at_m[2]),
			WHOLE(i % 10 < 3 ? i % 10 : 0), WHOLE(i % 301) };
		g_array_append_vals(table, of, G_N_ELEMENTS(of));
	}
	struct taken t = taken_new(table_file(cloud_fields, 5, table, NULL));
	g_assert_cmpuint(t.p->count, ==, 400 - 3 * 40);
	g_assert_cmpuint(taken_scan(&t, 0)->left_out, ==, 2 * 40);
	for (unsigned i = 0, k = 0; i < 400; i++) {
		double at_m[3];
		scene_point(i, at_m);
		if (i % 10 == 1 || i % 10 == 2 || i % 10 == 8)
			continue;
		if (i % 10 == 7)
			memset(at_m, 0, sizeof at_m);
		g_assert_cmpuint(t.p->record[k].return_number, ==, i % 301 < 255 ? i % 301 + 1 : 1);
		assert_close(&t.p->record[k++], at_m, 1e-9);
	}
	taken_clear(&t);
}

static void test_all_invalid(void)
{
	const union made_value value[] = { REAL(1), REAL(2), REAL(3), WHOLE(2), WHOLE(0), REAL(1),
		REAL(2), REAL(3), WHOLE(1), WHOLE(0) };
	struct made_points made = { cloud_fields, 5, 2, .value = value };
	taken_assert_refused(made_one(&made, NULL), G_IO_ERROR_INVALID_DATA,
		"scan 1 of the file has no points but such as");
}

static void test_too_far(void)
{
	const union made_value value[] = { REAL(1), REAL(2), REAL(3), REAL(1e10), REAL(0),
		REAL(0) };
	struct made_points made = { cloud_fields, 3, 2, .value = value };
	taken_assert_refused(made_one(&made, NULL), G_IO_ERROR_INVALID_DATA,
		"scan 1: 1e+10 m is too far to be a point");
}

/* ---- real files ---- */

static void test_pump(void)
{
	const char *path = shared_path("data/pump/pump.e57");
	g_autofree char *ptx = g_strdup(shared_path("data/pump/pump.ptx"));
	if (!path || !ptx)
		return g_test_skip("there is no shared/data/pump");
	struct place at = place_new();
	g_autofree char *e57 = g_strdup(shared_path("data/pump/pump.e57"));
	g_autoptr(GArray) scans = place_import(&at, e57);
	g_autoptr(GArray) others = place_import(&at, ptx);
	g_autoptr(points) p = place_points(&at, 1), q = place_points(&at, 2);
	g_assert_cmpuint(g_array_index(scans, struct imported, 0).points, ==, 155201);
	g_assert_cmpuint(p->columns, ==, 345);
	g_assert_cmpuint(p->rows, ==, 1074);
	g_assert_cmpuint(q->columns, ==, p->columns);
	g_assert_cmpuint(q->count, ==, p->count);
	for (uint64_t i = 0; i < p->count; i++) {
		const struct point_record *a = &p->record[i], *b = &q->record[i];
		const double at_m[3] = { b->x_m, b->y_m, b->z_m };
		g_assert_cmpint(a->cell == CELL_MEASURED, ==, b->cell == CELL_MEASURED);
		if (a->cell != CELL_MEASURED)
			continue;
		assert_close(a, at_m, 0.06);
		g_assert_cmpmem(a->rgb, 3, b->rgb, 3);
	}
	g_autofree char *folder = site_scan_path(at.site, 1),
			*picture = g_build_filename(folder, "picture-01.jpg", NULL), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(picture, &bytes, &length, NULL));
	g_assert_cmpuint(length, ==, 1504576);
	g_assert_cmpmem(bytes, 3, "\xff\xd8\xff", 3);
	place_clear(&at);
}

static void test_probe(void)
{
	const char *path = shared_path("vectors/e57_probe.e57");
	if (!path)
		return g_test_skip("there is no shared/vectors/e57_probe.e57");
	struct place at = place_new();
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(points) p = place_points(&at, 1);
	g_autoptr(manifest) m = place_manifest(&at, 1);
	g_assert_cmpuint(p->columns, ==, 300);
	g_assert_cmpuint(p->rows, ==, 79);
	g_assert_cmpuint(g_array_index(scans, struct imported, 0).points, ==, 23700 - 245);
	g_assert_cmpuint(p->have, ==, POINTS_HAVE_INTENSITY | POINTS_HAVE_COLOUR);
	manifest_assert_numbers(m, "given_pose.translation_m", 1.5, 0, 0);
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(grids); i++) {
		g_autofree char *path = g_strconcat("/import-e57-grid/", grids[i].path, NULL);
		g_test_add_data_func(path, &grids[i], test_grid);
	}
	g_test_add_func("/import-e57-grid/map", test_map);
	g_test_add_func("/import-e57-grid/none", test_no_grid);
	g_test_add_func("/import-e57-grid/sparse", test_sparse);
	g_test_add_func("/import-e57-grid/too-high", test_too_high);
	g_test_add_func("/import-e57-grid/row-no-number", test_row_no_number);
	g_test_add_func("/import-e57-grid/cloud", test_cloud);
	g_test_add_func("/import-e57-grid/all-invalid", test_all_invalid);
	g_test_add_func("/import-e57-grid/too-far", test_too_far);
	g_test_add_func("/import-e57-grid/pump", test_pump);
	g_test_add_func("/import-e57-grid/probe", test_probe);
	return g_test_run();
}
