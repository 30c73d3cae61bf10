/* PTX into a site: every cell where it belongs and every number as it stands in the text. */
#include "tests/import-made.h"
#include "tests/ptx-made.h"
#include "tests/support.h"
#include <stdlib.h>

#define SCENE "hall?seed=3&ares=360&camera=none&divergence_mrad=0"

/* ---- a simulated scan as every kind of file ---- */

struct variant {
	const char *path;
	bool rows_first, row_by_row, upwards, anticlockwise, colour, crlf;
};
static const struct variant variants[] = {
	{ "usual", .upwards = true, .colour = true },
	{ "downwards", .colour = false },
	{ "anticlockwise", .upwards = true, .anticlockwise = true, .colour = true },
	{ "downwards-anticlockwise", .anticlockwise = true },
	{ "rows-first-by-row", .rows_first = true, .row_by_row = true, .colour = true },
	{ "rows-first-by-row-upwards", .rows_first = true, .row_by_row = true, .upwards = true,
		.anticlockwise = true },
	{ "rows-first-by-column", .rows_first = true, .upwards = true, .colour = true },
	{ "columns-first-by-row", .row_by_row = true, .crlf = true },
};

/* Every third row and column of a simulated scan. */
struct cells {
	uint32_t columns, rows;
	struct point_record *record;
};

static struct cells *simulated_cells(void)
{
	static struct cells *made;
	g_autoptr(GError) error = NULL;
	struct scan_options options = { .device = "sim:" SCENE, .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	g_autofree char *folder = simulated_folder();
	if (made)
		return made;
	simulated_scan(folder, SCENE, &options, NULL, NULL, &result, &partial, &error);
	g_assert_no_error(error);
	g_autoptr(site) s = site_open(folder, &error);
	g_autoptr(panorama) p = scan_load(s, result.number, false, &error);
	g_assert_no_error(error);
	made = g_new0(struct cells, 1);
	made->columns = p->desc.columns / 3;
	made->rows = p->desc.rows / 3;
	made->record = g_new0(struct point_record, (size_t)made->columns * made->rows);
	for (uint32_t i = 0; i < made->rows * made->columns; i++) {
		uint32_t row = i / made->columns * 3, column = i % made->columns * 3;
		struct point_record *r = &made->record[i];
		double at_m[3];
		r->return_number = 1;
		if (p->cell[panorama_index(p, row, column)] != CELL_MEASURED)
			continue;
		panorama_point(p, row, column, at_m);
		r->cell = CELL_MEASURED;
		r->x_m = at_m[0];
		r->y_m = at_m[1];
		r->z_m = at_m[2];
		r->intensity = p->intensity[panorama_index(p, row, column)];
		r->rgb[0] = (uint8_t)(1 + i % 255);
		r->rgb[1] = (uint8_t)(i / 7);
	}
	return made;
}

static void add_head(GString *text, uint32_t first, uint32_t second, const char *transform)
{
	g_string_append_printf(text, "%u\n%u\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n%s", first, second,
		transform ? transform : "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
}

static void add_cell(GString *text, const struct point_record *r, bool colour)
{
	if (r->cell == CELL_MEASURED)
		g_string_append_printf(text, "%.17g %.17g %.17g %.7f", r->x_m, r->y_m, r->z_m,
			r->intensity / 65535.0);
	else
		g_string_append(text, "0 0 0 0.500000");
	if (colour)
		g_string_append_printf(text, " %u %u %u", r->rgb[0], r->rgb[1], r->rgb[2]);
	g_string_append_c(text, '\n');
}

static GString *ptx_of(const struct cells *c, const struct variant *v)
{
	GString *text = g_string_new(NULL);
	add_head(text, v->rows_first ? c->rows : c->columns, v->rows_first ? c->columns : c->rows,
		NULL);
	uint32_t outer = v->row_by_row ? c->rows : c->columns;
	uint32_t inner = v->row_by_row ? c->columns : c->rows;
	for (uint32_t i = 0; i < outer; i++)
		for (uint32_t j = 0; j < inner; j++) {
			uint32_t row = v->row_by_row ? i : j, column = v->row_by_row ? j : i;
			row = v->upwards ? c->rows - 1 - row : row;
			column = v->anticlockwise ? c->columns - 1 - column : column;
			add_cell(text, &c->record[(size_t)row * c->columns + column], v->colour);
		}
	if (v->crlf)
		g_string_replace(text, "\n", "\r\n", 0);
	return text;
}

static void test_variant(gconstpointer data)
{
	const struct variant *v = data;
	const struct cells *c = simulated_cells();
	g_autoptr(GString) text = ptx_of(c, v);
	struct place at = place_new();
	g_autofree char *path = place_write(&at, "hall.ptx", text->str, text->len);
	g_autoptr(GArray) scans = place_import(&at, path);
	const struct imported *i = &g_array_index(scans, struct imported, 0);
	g_autoptr(points) p = place_points(&at, 1);
	g_autoptr(manifest) m = place_manifest(&at, 1);
	g_assert_cmpuint(p->columns, ==, c->columns);
	g_assert_cmpuint(p->rows, ==, c->rows);
	g_assert_cmpuint(p->have, ==, POINTS_HAVE_INTENSITY | (v->colour ? POINTS_HAVE_COLOUR : 0));
	uint64_t measured = 0;
	for (size_t k = 0; k < p->count; k++) {
		struct point_record wanted = c->record[k];
		measured += wanted.cell == CELL_MEASURED;
		if (!v->colour)
			memset(wanted.rgb, 0, 3);
		g_assert_cmpmem(&p->record[k], sizeof wanted, &wanted, sizeof wanted);
	}
	g_assert_cmpuint(measured, >, 1000);
	g_assert_cmpuint(measured, <, p->count); /* there are holes in it */
	g_assert_cmpuint(i->points, ==, measured);
	manifest_assert_string(m, "source.grid.first", v->rows_first ? "rows" : "columns");
	manifest_assert_string(
		m, "source.grid.order", v->row_by_row ? "row by row" : "column by column");
	manifest_assert_string(m, "source.grid.rows_run", v->upwards ? "up" : "down");
	manifest_assert_string(
		m, "source.grid.columns_run", v->anticlockwise ? "anticlockwise" : "clockwise");
	manifest_assert_string(m, "source.grid.told_by", "points");
	g_assert_false(manifest_has(m, "given_pose"));
	place_clear(&at);
}

/* Half of the cells gone: the layout is still told. */
static void test_sparse(void)
{
	const struct cells *c = simulated_cells();
	struct cells few = { c->columns, c->rows,
		g_memdup2(c->record, (size_t)c->columns * c->rows * 32) };
	g_autoptr(GRand) rand = g_rand_new_with_seed(5);
	for (uint32_t i = 0; i < few.columns * few.rows; i++)
		if (g_rand_boolean(rand))
			few.record[i] = (struct point_record){ .return_number = 1 };
	struct place at = place_new();
	g_autoptr(GString) text = ptx_of(&few, &variants[5]);
	g_autofree char *path = place_write(&at, "hall.ptx", text->str, text->len);
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(points) p = place_points(&at, 1);
	g_assert_cmpuint(p->columns, ==, c->columns);
	for (size_t k = 0; k < p->count; k++)
		g_assert_cmpfloat(p->record[k].x_m, ==, few.record[k].x_m);
	g_free(few.record);
	place_clear(&at);
}

/* What reads sites reads this one. */
static void test_scan_data(void)
{
	g_autoptr(GError) error = NULL;
	struct place at = place_new();
	g_autoptr(GString) text = ptx_of(simulated_cells(), &variants[4]);
	g_autofree char *path = place_write(&at, "hall.ptx", text->str, text->len);
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(scan_data) d = scan_data_load(at.site, 1, &error);
	g_assert_no_error(error);
	g_assert_cmpint(d->kind, ==, SCAN_ORDERED);
	g_assert_cmpuint(d->grid->columns, ==, 250);
	g_assert_false(d->has_given_pose);
	place_clear(&at);
}

/* Where points tell nothing, it is as files usually have it, and said so. */
static void test_assumed(void)
{
	struct place at = place_new();
	const char *text = HEAD IDENTITY CELLS;
	g_autofree char *path = place_write(&at, "one.ptx", text, strlen(text));
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(manifest) m = place_manifest(&at, 1);
	g_autoptr(points) p = place_points(&at, 1);
	manifest_assert_string(m, "source.grid.told_by", "habit");
	g_assert_cmpuint(p->columns, ==, 2);
	g_assert_cmpuint(p->rows, ==, 2);
	g_assert_cmpfloat(p->record[0].z_m, ==, 0.5); /* the highest first */
	g_assert_nonnull(strstr(g_array_index(scans, struct imported, 0).grid, "(assumed)"));
	place_clear(&at);
}

/* One column, or two with a point in only one of them, are no grid that anything could be made of. */
static void test_list(gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	struct place at = place_new();
	const char *sizes = data;
	g_autofree char *text = g_strconcat(sizes, "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", TURNED,
		"1 2 0.1 0.5\n1 2 0.2 0.5\n0 0 0 0.5\n1 2 0.4 0.5\n",
		*sizes == '2' ? "0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n" : "", NULL);
	g_autofree char *path = place_write(&at, "list.ptx", text, strlen(text));
	g_autoptr(GArray) scans = place_import(&at, path);
	const struct imported *i = &g_array_index(scans, struct imported, 0);
	g_autoptr(scan_data) d = scan_data_load(at.site, 1, &error);
	g_assert_no_error(error);
	g_assert_cmpint(d->kind, ==, SCAN_CLOUD);
	g_assert_cmpuint(d->points->count, ==, 3);
	g_assert_cmpfloat(d->points->record[2].z_m, ==, 0.4); /* in the order of the file */
	g_assert_true(d->has_given_pose);
	g_assert_cmpfloat(i->position_m[2], ==, 31.125);
	g_assert_cmpstr(i->grid, ==, "given up: no points are neighbours in it");
	place_clear(&at);
}

/* ---- several scans, and where they stand ---- */

static void test_several(void)
{
	g_autoptr(GError) error = NULL;
	struct place at = place_new();
	const char *text = HEAD IDENTITY CELLS "\n" HEAD TURNED CELLS HEAD IDENTITY
					       "1 2 0.5 0.5 1 2 3\n1.01 2 0.4 0.25 1 2 3\n0 0 0 "
					       "0.5 0 0 0\n1.03 2.01 0.4 1 1 2 3\n \n\n";
	g_autofree char *path = place_write(&at, "three.ptx", text, strlen(text));
	g_autoptr(GArray) scans = place_import(&at, path);
	g_assert_cmpuint(scans->len, ==, 3);
	for (guint i = 0; i < 3; i++) {
		const struct imported *scan = &g_array_index(scans, struct imported, i);
		g_autoptr(points) p = place_points(&at, i + 1);
		g_assert_cmpuint(scan->number, ==, i + 1);
		g_assert_cmpuint(scan->in_file, ==, i + 1);
		g_assert_cmpuint(scan->points, ==, 3);
		g_assert_true(scan->has_pose); /* the identity too, since another has one */
		g_assert_cmpuint(p->have & POINTS_HAVE_COLOUR, ==, i == 2 ? POINTS_HAVE_COLOUR : 0);
		g_autoptr(manifest) m = place_manifest(&at, i + 1);
		int64_t in_file;
		g_assert_true(manifest_get_int(m, "source.scan", 1, 9, &in_file, NULL));
		g_assert_cmpint(in_file, ==, i + 1);
	}
	g_autoptr(manifest) m = place_manifest(&at, 2);
	manifest_assert_numbers(m, "given_pose.translation_m", 500010.25, 4000020.5, 31.125);
	manifest_assert_numbers(site_manifest(at.site), "origin_m", 0, 0, 0); /* of the first */
	/* x of the scanner goes to y of the file. */
	g_autoptr(scan_data) d = scan_data_peek(at.site, 2, &error);
	g_assert_no_error(error);
	double point_m[3] = { 1, 2, 3 };
	pose_apply(&d->given_pose, point_m, point_m);
	g_assert_cmpfloat(point_m[0], ==, 500010.25 - 2);
	g_assert_cmpfloat(point_m[1], ==, 4000020.5 + 1);
	place_clear(&at);
}

/* A number that cannot be given takes those before it back. */
static void test_rolled_back(void)
{
	g_autoptr(GError) error = NULL;
	struct place at = place_new();
	g_autoptr(GPtrArray) folders = g_ptr_array_new_with_free_func(g_free);
	for (uint32_t i = 1; i <= 3; i++) {
		uint32_t number;
		char *folder = site_stage_scan(at.site, &number, &error);
		g_assert_no_error(error);
		g_assert_cmpuint(number, ==, i);
		g_ptr_array_add(folders, folder);
		g_autofree char *json = g_build_filename(folder, "scan.json", NULL);
		g_assert_true(g_file_set_contents(json, "{}", -1, NULL));
	}
	g_autofree char *taken = site_scan_path(at.site, 3);
	g_assert_cmpint(g_mkdir(taken, 0777), ==, 0);
	g_autofree char *before = commands_snapshot(at.site_path);
	g_assert_false(site_add_staged(at.site, folders, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_EXISTS);
	g_autofree char *after = commands_snapshot(at.site_path);
	g_assert_cmpstr(before, ==, after);
	place_clear(&at);
}

static void test_site_origin(void)
{
	g_autoptr(GError) error = NULL;
	struct place at = place_new();
	const char *text = HEAD TURNED CELLS, *plain = HEAD IDENTITY CELLS;
	g_assert_true(site_set(
		at.site, "remark", json_node_init_string(json_node_alloc(), "kept"), &error));
	g_autofree char *before = place_write(&at, "plain.ptx", plain, strlen(plain));
	g_autofree char *path = place_write(&at, "turned.ptx", text, strlen(text));
	g_autoptr(GArray) first = place_import(&at, before);
	g_assert_false(manifest_has(site_manifest(at.site), "origin_m"));
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(site) s = site_open(at.site_path, &error); /* from the disk */
	g_assert_no_error(error);
	manifest_assert_numbers(site_manifest(s), "origin_m", 500010, 4000020, 31);
	manifest_assert_string(site_manifest(s), "remark", "kept");
	g_autoptr(scan_data) d = scan_data_peek(s, 2, &error);
	g_assert_no_error(error);
	g_assert_true(d->has_given_pose);
	g_assert_cmpfloat(d->given_pose.translation_m[0], ==, 0.25);
	g_assert_cmpfloat(d->given_pose.translation_m[2], ==, 0.125);
	g_autoptr(scan_data) none = scan_data_peek(s, 1, &error);
	g_assert_false(none->has_given_pose);
	place_clear(&at);
}

/* Map coordinates are no scanner's: exact, less whole metres, and not in order. */
static void test_map(void)
{
	struct place at = place_new();
	const char *text =
		HEAD IDENTITY "0 0 0 0.5\n637012.240000 849028.310000 431.660000 0.034912\n"
			      "0 0 0 0.5\n636896.330000 849087.700000 446.390000 0.004395\n";
	g_autofree char *path = place_write(&at, "map.ptx", text, strlen(text));
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(points) p = place_points(&at, 1);
	g_autoptr(manifest) m = place_manifest(&at, 1);
	g_assert_cmpuint(p->columns, ==, 0);
	g_assert_cmpuint(p->count, ==, 2);
	manifest_assert_numbers(m, "points.origin_m", 637012, 849028, 432);
	manifest_assert_numbers(m, "given_pose.translation_m", 637012, 849028, 432);
	g_assert_cmpfloat(p->record[0].x_m + 637012, ==, 637012.24);
	g_assert_cmpfloat(p->record[1].y_m + 849028, ==, 849087.70);
	g_assert_cmpfloat(p->record[1].z_m + 432, ==, 446.39);
	place_clear(&at);
}

/* A transform that no pose can say takes the points where it says, and they are no grid any more. */
static const struct applied {
	const char *path, *rows, *word;
	double second_m[3]; /* of the points, 1.01 2 0.4 in the file */
} applieds[] = {
	{ "scale", "1 0 0 0\n0 1 0 0\n0 0 2 0\n", "scales", { 1.01, 2, 0.8 } },
	{ "feet", "0.3048 0 0 0\n0 0.3048 0 0\n0 0 0.3048 0\n", "scales",
		{ 0.307848, 0.6096, 0.12192 } },
	{ "map-projection", "0.9996 0 0 0\n0 0.9996 0 0\n0 0 1 0\n", "scales",
		{ 1.009596, 1.9992, 0.4 } },
	{ "mirror", "1 0 0 0\n0 -1 0 0\n0 0 1 0\n", "mirrors", { 1.01, -2, 0.4 } },
	{ "shear", "1 0 0 0\n0.6 0.8 0 0\n0 0 1 0\n", "shears", { 2.21, 1.6, 0.4 } },
};

static void test_applied(gconstpointer data)
{
	const struct applied *a = data;
	static const double at_m[3] = { 600000.25, 800000, 400 };
	struct place at = place_new();
	g_autofree char *text = g_strconcat(
		HEAD, a->rows, "600000.25 800000 400 1\n" CELLS HEAD TURNED CELLS, NULL);
	g_autofree char *path = place_write(&at, "applied.ptx", text, strlen(text));
	g_autoptr(GArray) scans = place_import(&at, path);
	const struct imported *first = &g_array_index(scans, struct imported, 0),
			      *second = &g_array_index(scans, struct imported, 1);
	g_autoptr(points) p = place_points(&at, 1);
	g_autoptr(manifest) m = place_manifest(&at, 1);
	g_assert_cmpuint(first->points, ==, 3);
	g_assert_cmpuint(p->columns, ==, 0);
	g_assert_cmpuint(p->count, ==, 3);
	g_assert_nonnull(strstr(first->note, a->word));
	manifest_assert_string(m, "source.note", first->note);
	manifest_assert_string(m, "source.grid.kept", "no: a transform that is no motion");
	for (int k = 0; k < 3; k++) {
		g_assert_cmpfloat(first->position_m[k], ==, rint(first->position_m[k]));
		double placed_m = (&p->record[1].x_m)[k] + first->position_m[k];
		g_assert_cmpfloat(fabs(placed_m - at_m[k] - a->second_m[k]), <, 1e-9);
	}
	g_assert_null(second->note);
	g_assert_cmpuint(second->columns, ==, 2);
	place_clear(&at);
}

/* What other programs write as intensity: the scan's own range tells, and its neighbour in the file keeps its. */
static const struct intensities {
	const char *path, *of[3], *words; /* words NULL: nothing to say */
	uint16_t wanted[3];
} intensities[] = {
	{ "unit", { "0.5", "0.25", "1" }, NULL, { 32768, 16384, 65535 } },
	{ "byte", { "0", "51", "255" }, "0 to 255", { 0, 13107, 65535 } },
	{ "byte-not-black", { "51", "102", "255" }, "51 to 255", { 13107, 26214, 65535 } },
	{ "signed", { "-2048", "-1", "2047" }, "-2048 to 2047", { 0, 32759, 65535 } },
	{ "decibels", { "-30", "-17.5", "-5" }, "-30 to -5", { 0, 32768, 65535 } },
	{ "below", { "-0.25", "0.25", "0.75" }, "-0.25 to 0.75", { 0, 32768, 65535 } },
	{ "constant", { "-7", "-7", "-7" }, "-7 to -7", { 0, 0, 0 } },
};

static void test_intensities(gconstpointer data)
{
	const struct intensities *n = data;
	struct place at = place_new();
	g_autofree char *text = g_strdup_printf(HEAD IDENTITY
		"1 2 0.5 %s\n1.01 2 0.4 %s\n0 0 0 9999\n1.03 2.01 0.4 %s\n" HEAD IDENTITY CELLS,
		n->of[0], n->of[1], n->of[2]);
	g_autofree char *path = place_write(&at, "intensities.ptx", text, strlen(text));
	g_autoptr(GArray) scans = place_import(&at, path);
	const struct imported *i = &g_array_index(scans, struct imported, 0);
	g_autoptr(points) p = place_points(&at, 1), next = place_points(&at, 2);
	g_assert_cmpuint(i->points, ==, 3);
	g_assert_cmpuint(i->columns, ==, 2); /* still a grid */
	if (n->words)
		g_assert_nonnull(strstr(i->note, n->words));
	else
		g_assert_null(i->note);
	uint32_t next_sum = 0;
	for (size_t k = 0; k < 4; k++) {
		const struct point_record *r = &p->record[k];
		next_sum += next->record[k].intensity;
		int which = r->cell != CELL_MEASURED ? -1
			    : r->x_m == 1            ? 0
			    : r->x_m == 1.01         ? 1
						     : 2;
		g_assert_cmpuint(r->intensity, ==, which < 0 ? 0 : n->wanted[which]);
	}
	g_assert_cmpuint(next_sum, ==, 32768 + 16384 + 65535);
	g_assert_null(g_array_index(scans, struct imported, 1).note);
	place_clear(&at);
}

/* That it is beyond is met in the last cell, long after the first were given out; and with a transform to apply. */
static void test_intensity_late(void)
{
	struct place at = place_new();
	g_autoptr(GString) text = g_string_new(NULL);
	add_head(text, 300, 250, "2 0 0 0\n0 2 0 0\n0 0 2 0\n7 8 9 1\n");
	for (uint32_t k = 0; k < 300 * 250; k++)
		g_string_append_printf(text, "%u 1 0.5 %s\n", k, k == 74999 ? "100" : "0.5");
	g_autofree char *path = place_write(&at, "late.ptx", text->str, text->len);
	g_autoptr(GArray) scans = place_import(&at, path);
	const struct imported *i = &g_array_index(scans, struct imported, 0);
	g_autoptr(points) p = place_points(&at, 1);
	g_assert_cmpuint(i->points, ==, 75000);
	g_assert_cmpuint(p->count, ==, 75000);
	g_assert_nonnull(strstr(i->note, "scales"));
	g_assert_nonnull(strstr(i->note, "0.5 to 100"));
	for (uint32_t k = 0; k < 75000; k++) {
		g_assert_cmpfloat(p->record[k].x_m + i->position_m[0], ==, 7 + 2.0 * k);
		g_assert_cmpuint(p->record[k].intensity, ==, k == 74999 ? 65535 : 328);
	}
	place_clear(&at);
}

/* ---- real files ---- */

static void test_pump(void)
{
	const char *path = shared_path("data/pump/pump.ptx");
	if (!path)
		return g_test_skip("there is no shared/data/pump");
	struct place at = place_new();
	g_autoptr(GArray) scans = place_import(&at, path);
	const struct imported *i = &g_array_index(scans, struct imported, 0);
	g_autoptr(points) p = place_points(&at, 1);
	g_assert_cmpuint(i->points, ==, 155201);
	g_assert_cmpuint(p->columns, ==, 345);
	g_assert_cmpuint(p->rows, ==, 1074);
	/* Each cell against the text: columns of the file run upwards. */
	g_autofree char *text = NULL;
	g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
	char *at_line = text;
	for (int i_line = 0; i_line < 10; i_line++)
		at_line = strchr(at_line, '\n') + 1;
	for (uint32_t k = 0; k < 345 * 1074; k++) {
		const struct point_record *r =
			&p->record[(size_t)(1073 - k % 1074) * 345 + k / 1074];
		g_assert_cmpfloat(r->x_m, ==, g_ascii_strtod(at_line, &at_line));
		g_assert_cmpfloat(r->y_m, ==, g_ascii_strtod(at_line, &at_line));
		g_assert_cmpfloat(r->z_m, ==, g_ascii_strtod(at_line, &at_line));
		g_ascii_strtod(at_line, &at_line);
		for (int c = 0; c < 3; c++)
			g_assert_cmpuint(r->rgb[c], ==, strtoul(at_line, &at_line, 10));
	}
	place_clear(&at);
}

static void test_ouster(void)
{
	const char *path = shared_path("data/ouster-os2/os2.ptx");
	if (!path)
		return g_test_skip("there is no shared/data/ouster-os2");
	struct place at = place_new();
	g_autoptr(GArray) scans = place_import(&at, path);
	g_autoptr(points) p = place_points(&at, 1);
	g_assert_cmpuint(p->columns, ==, 1024);
	g_assert_cmpuint(p->rows, ==, 128);
	g_assert_cmpuint(p->have, ==, POINTS_HAVE_INTENSITY);
	/* Its beams are fixed: a row has one elevation, and they fall. */
	double before = G_PI;
	for (uint32_t row = 8; row < 128; row += 8) {
		double sum = 0;
		int count = 0;
		for (uint32_t c = 0; c < 1024; c++) {
			const struct point_record *r = &p->record[row * 1024 + c];
			sum += r->cell == CELL_MEASURED ? atan2(r->z_m, hypot(r->x_m, r->y_m)) : 0;
			count += r->cell == CELL_MEASURED;
		}
		g_assert_cmpint(count, >, 0);
		g_assert_cmpfloat(sum / count, <, before);
		before = sum / count;
	}
	place_clear(&at);
}

/* Its two scans are the same points: one as they are, one behind a transform that stretches heights. */
static void assert_scaled(struct place *at, const char *path)
{
	static const double wanted_m[4][3] = { { 637012.24, 849028.31, 431.66 },
		{ 636896.33, 849087.70, 446.39 }, { 636784.74, 849106.66, 426.71 },
		{ 636699.38, 848991.01, 425.39 } };
	g_autoptr(GArray) scans = place_import(at, path);
	g_assert_cmpuint(scans->len, ==, 2);
	for (guint s = 0; s < 2; s++) {
		const struct imported *i = &g_array_index(scans, struct imported, s);
		g_autoptr(points) p = place_points(at, i->number);
		g_assert_cmpuint(p->count, ==, 4);
		g_assert_cmpint(i->note != NULL, ==, s == 0);
		for (int k = 0; k < 12; k++) {
			double got_m = (&p->record[k / 3].x_m)[k % 3] + i->position_m[k % 3];
			g_assert_cmpfloat(fabs(got_m - wanted_m[k / 3][k % 3]), <, 1e-9);
		}
	}
}

static void test_conformance(void)
{
	struct place at = place_new();
	const char *colour = shared_path("data/ptx-conformance/1.2-with-color.ptx"),
		   *complex = shared_path("data/ptx-conformance/complex-transform.ptx"),
		   *plain = shared_path("data/ptx-conformance/no-color.ptx"),
		   *scaled = shared_path("data/ptx-conformance/multiple-and-transform.ptx");
	if (!colour || !complex || !plain || !scaled) {
		place_clear(&at);
		return g_test_skip("there is no shared/data/ptx-conformance");
	}
	g_autoptr(GArray) a = place_import(&at, colour), b = place_import(&at, complex),
			  c = place_import(&at, plain);
	g_assert_cmpuint(g_array_index(a, struct imported, 0).points, ==, 1065);
	g_assert_cmpuint(g_array_index(b, struct imported, 0).points, ==, 4);
	g_assert_cmpuint(g_array_index(b, struct imported, 0).columns, ==, 0); /* all in one */
	g_assert_true(g_array_index(b, struct imported, 0).has_pose);
	g_assert_cmpfloat(g_array_index(b, struct imported, 0).position_m[0], ==, -3.028748);
	g_assert_cmpuint(g_array_index(c, struct imported, 0).points, ==, 15);
	assert_scaled(&at, scaled);
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(variants); i++) {
		g_autofree char *path =
			g_strconcat("/import-ptx/simulated/", variants[i].path, NULL);
		g_test_add_data_func(path, &variants[i], test_variant);
	}
	g_test_add_func("/import-ptx/sparse", test_sparse);
	g_test_add_func("/import-ptx/scan-data", test_scan_data);
	g_test_add_func("/import-ptx/assumed", test_assumed);
	g_test_add_data_func("/import-ptx/list/column", "1\n4\n", test_list);
	g_test_add_data_func("/import-ptx/list/row", "4\n1\n", test_list);
	g_test_add_data_func("/import-ptx/list/half", "2\n4\n", test_list);
	g_test_add_func("/import-ptx/several", test_several);
	g_test_add_func("/import-ptx/rolled-back", test_rolled_back);
	g_test_add_func("/import-ptx/site-origin", test_site_origin);
	g_test_add_func("/import-ptx/map", test_map);
	for (size_t i = 0; i < G_N_ELEMENTS(applieds); i++) {
		g_autofree char *path = g_strconcat("/import-ptx/applied/", applieds[i].path, NULL);
		g_test_add_data_func(path, &applieds[i], test_applied);
	}
	for (size_t i = 0; i < G_N_ELEMENTS(intensities); i++) {
		g_autofree char *path =
			g_strconcat("/import-ptx/intensity/", intensities[i].path, NULL);
		g_test_add_data_func(path, &intensities[i], test_intensities);
	}
	g_test_add_func("/import-ptx/intensity/late", test_intensity_late);
	g_test_add_func("/import-ptx/pump", test_pump);
	g_test_add_func("/import-ptx/ouster", test_ouster);
	g_test_add_func("/import-ptx/conformance", test_conformance);
	return g_test_run();
}
