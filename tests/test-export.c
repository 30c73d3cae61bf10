/* What was exported imports again: the same points to the format's own resolution, poses, rows and columns, colours, intensity, classes;
 * what does not go well leaves everything as it was. */
#include "tests/exported-site.h"
#include "tests/support.h"

/* ---- as the scanner had it ---- */

static panorama *recorded(const exported *e, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	panorama *p = scan_load(e->site, number, false, &error);
	g_assert_no_error(error);
	return p;
}

static struct pose placed(uint32_t number)
{
	g_autofree char *description = g_strdup_printf(EXPORTED_SCENE "%u", number);
	return simulated_pose(description);
}

static double apart(const double a[3], const struct point_record *r, const double origin_m[3])
{
	double b[3] = { r->x_m + origin_m[0], r->y_m + origin_m[1], r->z_m + origin_m[2] };
	return fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
}

static void assert_same(const panorama *p, size_t cell, const struct point_record *r)
{
	g_assert_cmpuint(r->intensity, ==, p->intensity[cell]);
	g_assert_cmpmem(r->rgb, 3, p->rgb + 3 * cell, 3);
}

/* Cell for cell. */
static void assert_grid(
	const exported *e, const struct place *p, uint32_t number, uint32_t as, double most_m)
{
	static const double none[3];
	g_autoptr(panorama) was = recorded(e, number);
	g_autoptr(points) is = place_points(p, as);
	g_autoptr(GError) error = NULL;
	g_autoptr(scan_data) d = scan_data_peek(p->site, as, &error);
	uint64_t count = 0;
	g_assert_no_error(error);
	g_assert_cmpuint(is->columns, ==, was->desc.columns);
	g_assert_cmpuint(is->rows, ==, was->desc.rows);
	for (uint32_t row = 0; row < is->rows; row++)
		for (uint32_t c = 0; c < is->columns; c++) {
			size_t i = panorama_index(was, row, c);
			double at_m[3];
			g_assert_cmpint(is->record[i].cell == CELL_MEASURED, ==,
				was->cell[i] == CELL_MEASURED);
			if (was->cell[i] != CELL_MEASURED)
				continue;
			panorama_point(was, row, c, at_m);
			g_assert_cmpfloat(apart(at_m, &is->record[i], none), <=, most_m);
			assert_same(was, i, &is->record[i]);
			count++;
		}
	g_assert_cmpuint(count, >, 20000);
	struct pose wanted = placed(number), between = pose_between(&wanted, &d->given_pose);
	g_assert_cmpfloat(pose_angle_rad(&between), <, 1e-9);
	g_assert_cmpfloat(pose_distance_m(&between), <, 2e-6);
}

/* ---- grids ---- */

static const struct grids {
	const char *name;
	bool one; /* scan at a time */
	double most_m;
} grids[] = { { "hall.e57", false, 0.51e-6 }, { "hall.ptx", false, 0.51e-6 },
	{ "hall.e57", true, 0.51e-6 }, { "hall.ptx", true, 0.51e-6 }, { "hall.ply", true, 4e-6 },
	{ "hall.pcd", true, 4e-6 } };

static void test_grids(gconstpointer data)
{
	const struct grids *g = data;
	g_auto(exported) e = exported_new();
	for (uint32_t number = g->one ? 2 : 1; number <= (g->one ? 2 : 1); number++) {
		struct export_options o = { .scans = &number, .scan_count = g->one };
		struct export_result r;
		o.scans = g->one ? &number : NULL;
		g_autofree char *path = exported_write(&e, g->name, &o, &r);
		GArray *scans;
		struct place p = exported_import(path, &scans);
		g_assert_cmpuint(scans->len, ==, g->one ? 1 : 2);
		g_assert_cmpuint(r.stations, ==, scans->len);
		for (uint32_t k = 0; k < scans->len; k++)
			assert_grid(&e, &p, number + k, k + 1, g->most_m);
		g_array_unref(scans);
		place_clear(&p);
		export_result_clear(&r);
	}
}

/* ---- all in one frame ---- */

static const struct merged {
	const char *name;
	double most_m;
} merged[] = { { "hall.las", 0.501e-4 }, { "hall.ply", 4e-6 }, { "hall.pcd", 4e-6 } };

static void test_merged(gconstpointer data)
{
	const struct merged *m = data;
	g_auto(exported) e = exported_new();
	struct export_options o = { 0 };
	struct export_result r;
	GArray *scans;
	g_autofree char *path = exported_write(&e, m->name, &o, &r);
	struct place p = exported_import(path, &scans);
	g_autoptr(points) is = place_points(&p, 1);
	g_autoptr(manifest) about = place_manifest(&p, 1);
	double origin_m[3];
	uint64_t at = 0;
	JsonArray *origin = json_node_get_array(manifest_get_node(about, "points.origin_m"));
	for (guint i = 0; i < 3; i++)
		origin_m[i] = json_array_get_double_element(origin, i);
	for (uint32_t number = 1; number <= 2; number++) {
		g_autoptr(panorama) was = recorded(&e, number);
		struct pose pose = placed(number);
		for (uint32_t row = 0; row < was->desc.rows; row++)
			for (uint32_t c = 0; c < was->desc.columns; c++) {
				size_t i = panorama_index(was, row, c);
				double at_m[3];
				if (was->cell[i] != CELL_MEASURED)
					continue;
				panorama_point(was, row, c, at_m);
				pose_apply(&pose, at_m, at_m);
				g_assert_cmpuint(at, <, is->count);
				g_assert_cmpfloat(
					apart(at_m, &is->record[at], origin_m), <=, m->most_m);
				assert_same(was, i, &is->record[at++]);
			}
	}
	g_assert_cmpuint(at, ==, is->count);
	g_assert_cmpuint(r.points, ==, at);
	g_assert_cmpfloat(r.resolution_m, <=, 2 * m->most_m);
	g_array_unref(scans);
	place_clear(&p);
	export_result_clear(&r);
}

/* ---- classes, echoes and the map ---- */

/* LAS 1.2, format 3, of points on a map. */
static GByteArray *las_of_map(void)
{
	GByteArray *b = g_byte_array_new();
	uint8_t h[227] = "LASF", r[34] = { 0 };
	double scale = 0.001, offset[3] = { 512000, 5412000, 400 };
	uint32_t count = 400, first = sizeof h;
	uint16_t header = sizeof h, record = sizeof r;
	h[24] = 1;
	h[25] = 2;
	memcpy(h + 94, &header, 2);
	memcpy(h + 96, &first, 4);
	h[104] = 3;
	memcpy(h + 105, &record, 2);
	memcpy(h + 107, &count, 4);
	for (int i = 0; i < 3; i++) {
		memcpy(h + 131 + 8 * i, &scale, 8);
		memcpy(h + 155 + 8 * i, &offset[i], 8);
	}
	g_byte_array_append(b, h, sizeof h);
	for (uint32_t i = 0; i < count; i++) {
		int32_t xyz[3] = { (int32_t)(i % 20 * 1234 + 5), (int32_t)(i / 20 * 777),
			(int32_t)(i % 7) };
		uint16_t intensity = (uint16_t)(i * 160),
			 rgb[3] = { (uint16_t)(i % 256 * 257), 0, 65535 };
		memcpy(r, xyz, 12);
		memcpy(r + 12, &intensity, 2);
		r[14] = (uint8_t)(1 + i % 3);
		r[15] = (uint8_t)(i % 15);
		memcpy(r + 28, rgb, 6);
		g_byte_array_append(b, r, sizeof r);
	}
	return b;
}

static const char *const of_map[] = { "map.e57", "map.las", "map.ply", "map.pcd" };

/* A cloud with classes and echoes, in coordinates of a map: exact but in PCD, which says so. */
static void test_map(gconstpointer data)
{
	const char *name = data;
	bool is_pcd = g_str_has_suffix(name, ".pcd");
	g_autoptr(GByteArray) las = las_of_map();
	struct place from = place_new();
	g_autofree char *path = place_write(&from, "map-in.las", las->data, las->len),
			*out = g_build_filename(from.folder, name, NULL);
	g_autoptr(GArray) in = place_import(&from, path);
	g_autoptr(points) was = place_points(&from, 1);
	g_autoptr(GError) error = NULL;
	struct export_options o = { 0 };
	struct export_result r;
	bool good = export_site(from.site, out, &o, &r, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	GArray *scans;
	struct place p = exported_import(out, &scans);
	g_autoptr(points) is = place_points(&p, 1);
	const double *a = g_array_index(in, struct imported, 0).position_m,
		     *b = g_array_index(scans, struct imported, 0).position_m;
	g_assert_cmpuint(is->count, ==, was->count);
	for (uint64_t i = 0; i < is->count; i++) {
		const struct point_record *x = &was->record[i], *y = &is->record[i];
		double moved_m[3] = { x->x_m + a[0], x->y_m + a[1], x->z_m + a[2] };
		if (is_pcd) /* the site's own */
			memcpy(moved_m, &(double[3]){ x->x_m, x->y_m, x->z_m }, sizeof moved_m);
		g_assert_cmpfloat(apart(moved_m, y, b), <=, is_pcd ? 2e-6 : 1e-6);
		g_assert_cmpuint(x->intensity, ==, y->intensity);
		g_assert_cmpmem(x->rgb, 3, y->rgb, 3);
		g_assert_cmpuint(x->classification, ==, y->classification);
		g_assert_cmpuint(x->return_number, ==, y->return_number);
	}
	g_assert_cmpuint(r.notes->len, ==, is_pcd || g_str_has_suffix(name, ".las"));
	g_assert_true(!is_pcd || strstr(r.notes->pdata[0], "add 512000 5412000 400 m"));
	g_array_unref(scans);
	place_clear(&p);
	place_clear(&from);
	export_result_clear(&r);
}

/* ---- which stations, and where ---- */

static void test_raw(void)
{
	g_auto(exported) e = exported_new();
	struct export_options o = { .raw = true };
	struct export_result r;
	GArray *scans;
	g_autofree char *path = exported_write(&e, "raw.e57", &o, &r);
	struct place p = exported_import(path, &scans);
	g_assert_cmpuint(scans->len, ==, 2);
	for (guint i = 0; i < scans->len; i++)
		g_assert_false(g_array_index(scans, struct imported, i).has_pose);
	exported_assert_refused(&e, "raw.las", &o, "would put all 2 scans onto one another");
	uint32_t one = 2;
	o.scans = &one;
	o.scan_count = 1;
	g_autofree char *las = exported_write(&e, "raw.las", &o, &r);
	g_array_unref(scans);
	place_clear(&p);
	g_assert_true(g_file_test(las, G_FILE_TEST_IS_REGULAR));
}

static void test_not_aligned(void)
{
	g_auto(exported) e = exported_new();
	struct export_options o = { 0 };
	struct export_result r;
	exported_place(e.site, 2, false);
	g_autofree char *path = exported_write(&e, "part.e57", &o, &r);
	g_assert_cmpuint(r.stations, ==, 1);
	g_assert_cmpuint(r.notes->len, ==, 1);
	g_assert_nonnull(strstr(r.notes->pdata[0], "scan 2 is not aligned with the others"));
	export_result_clear(&r);
	uint32_t unknown = 7;
	o = (struct export_options){ .scans = &unknown, .scan_count = 1 };
	exported_assert_refused(&e, "none.e57", &o, "has no scan 7");
}

/* A scan that came later, with a pose of its own, is not in the frame of those that were aligned before anybody compared them. */
static void test_came_later(void)
{
	g_auto(exported) e = exported_new();
	g_autoptr(GByteArray) las = las_of_map();
	g_autofree char *path = exported_file(&e, "later.las");
	g_autoptr(GError) error = NULL;
	struct import_options how = { 0 };
	struct export_options o = { 0 };
	struct export_result r;
	g_assert_true(g_file_set_contents(path, (const char *)las->data, las->len, &error));
	g_autoptr(GArray) scans = import_file(e.site, path, &how, &error);
	g_assert_no_error(error);
	g_autofree char *out = exported_write(&e, "out.e57", &o, &r);
	g_assert_cmpuint(r.stations, ==, 2);
	g_assert_nonnull(strstr(r.notes->pdata[0], "scan 3 is not aligned with the others"));
	export_result_clear(&r);
}

static void test_clouds(void)
{
	g_autoptr(GByteArray) las = las_of_map();
	struct place from = place_new();
	g_autofree char *path = place_write(&from, "map-in.las", las->data, las->len);
	g_array_unref(place_import(&from, path));
	exported e = { from.folder, from.site_path, from.site };
	struct export_options o = { 0 };
	exported_assert_refused(&e, "cloud.ptx", &o, "has no scan with rows and columns");
	exported_assert_refused(&e, "cloud.dwg", &o, "must end in .e57");
	exported_assert_refused(&e, "nowhere/cloud.las", &o, "there is no folder");
	place_clear(&from);
}

/* ---- thinned ---- */

static const char *const thinned[] = { "thin.las", "thin.e57", "thin.ptx" };

static void test_spacing(gconstpointer data)
{
	g_auto(exported) e = exported_new();
	struct export_options o = { .spacing_m = 0.25 }, all = { 0 };
	struct export_result r, whole;
	GArray *scans;
	g_autofree char *path = exported_write(&e, data, &o, &r),
			*full = exported_write(&e, "all.las", &all, &whole);
	g_assert_cmpuint(r.points + r.left_out, ==, whole.points);
	g_assert_cmpuint(r.points, <, whole.points / 4);
	struct place p = exported_import(path, &scans);
	g_autoptr(GArray) at = g_array_new(false, false, 3 * sizeof(double));
	for (guint k = 0; k < scans->len; k++) {
		g_autoptr(points) is = place_points(&p, k + 1);
		bool moved = scans->len > 1;
		struct pose pose = placed(k + 1);
		for (uint64_t i = 0; i < is->count; i++) {
			double m[3] = { is->record[i].x_m, is->record[i].y_m, is->record[i].z_m };
			if (moved)
				pose_apply(&pose, m, m);
			if (is->record[i].cell == CELL_MEASURED)
				g_array_append_val(at, m);
		}
	}
	g_assert_cmpuint(at->len, ==, r.points);
	const double *v = (const double *)(gpointer)at->data;
	for (guint i = 0; i < at->len; i++)
		for (guint k = 0; k < i; k++) {
			double d[3] = { v[3 * i] - v[3 * k], v[3 * i + 1] - v[3 * k + 1],
				v[3 * i + 2] - v[3 * k + 2] };
			g_assert_cmpfloat(
				d[0] * d[0] + d[1] * d[1] + d[2] * d[2], >, 0.2495 * 0.2495);
		}
	g_array_unref(scans);
	place_clear(&p);
	g_assert_nonnull(full);
}

/* ---- what goes wrong ---- */

struct spoiling {
	const exported *e;
	const char *beside;
	double where; /* 0..1 of the file */
	bool done;
};

/* While the file is read back, one of its bytes becomes another. */
static bool spoil(double fraction, const char *doing, gpointer user_data)
{
	struct spoiling *s = user_data;
	(void)fraction;
	if (s->done || strcmp(doing, "reading back"))
		return true;
	g_autofree char *path = exported_file(s->e, s->beside);
	FILE *f = fopen(path, "r+");
	g_assert_nonnull(f);
	fseek(f, 0, SEEK_END);
	long middle = (long)((double)ftell(f) * s->where);
	fseek(f, middle, SEEK_SET);
	int byte = fgetc(f);
	fseek(f, middle, SEEK_SET);
	fputc(byte ^ 0x11, f);
	fclose(f);
	s->done = true;
	return true;
}

static const char *const spoilt[] = { "x.e57", "x.ptx", "x.las", "x.ply", "x.pcd" };

static void test_spoilt(gconstpointer data)
{
	g_auto(exported) e = exported_new();
	g_autofree char *beside = g_strdup_printf(".%s.partial", (const char *)data);
	struct spoiling s = { &e, beside, 0.75, false };
	struct export_options o = { .progress = spoil, .user_data = &s };
	exported_assert_refused(&e, data, &o, beside);
	g_assert_true(s.done);
}

/* Behind the points: which cells they are of. */
static void test_spoilt_grid(void)
{
	g_auto(exported) e = exported_new();
	struct spoiling s = { &e, ".x.ply.partial", 0.97, false };
	uint32_t first = 1;
	struct export_options o = {
		.scans = &first, .scan_count = 1, .raw = true, .progress = spoil, .user_data = &s
	};
	exported_assert_refused(&e, "x.ply", &o, "its grid is not as it was written");
	g_assert_true(s.done);
}

static bool stop(double fraction, const char *doing, gpointer user_data)
{
	(void)doing;
	(void)user_data;
	return fraction < 0.5;
}

static void test_stopped(void)
{
	g_auto(exported) e = exported_new();
	g_autofree char *path = exported_file(&e, "x.e57");
	struct export_options o = { .progress = stop };
	g_assert_true(g_file_set_contents(path, "as it was", -1, NULL));
	exported_assert_refused(&e, "x.e57", &o, "stopped");
}

/* ---- pictures ---- */

static void test_pictures(void)
{
	g_auto(exported) e = exported_new();
	struct export_options o = { 0 };
	struct export_result r;
	GArray *scans;
	g_autofree char *path = exported_write(&e, "hall.e57", &o, &r);
	struct place p = exported_import(path, &scans);
	for (uint32_t k = 1; k <= 2; k++) {
		g_autoptr(manifest) m = place_manifest(&p, k);
		JsonArray *all = json_node_get_array(manifest_get_node(m, "pictures"));
		JsonObject *one = json_array_get_object_element(all, 0);
		g_autofree char *folder = site_scan_path(p.site, k),
				*file = g_build_filename(
					folder, json_object_get_string_member(one, "file"), NULL);
		g_assert_cmpuint(json_array_get_length(all), ==, 1);
		g_assert_cmpstr(json_object_get_string_member(one, "kind"), ==, "spherical");
		g_assert_cmpint(json_object_get_int_member(one, "width"), ==,
			2 * json_object_get_int_member(one, "height"));
		g_assert_true(json_object_has_member(one, "pose"));
		g_assert_true(g_file_test(file, G_FILE_TEST_IS_REGULAR));
	}
	/* They go along when the new site is exported. */
	g_autofree char *again = exported_file(&e, "again.e57");
	g_autoptr(GError) error = NULL;
	bool good = export_site(p.site, again, &o, &r, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	GArray *more;
	struct place q = exported_import(again, &more);
	for (uint32_t k = 1; k <= 2; k++) {
		g_autofree char *a = site_scan_path(p.site, k), *b = site_scan_path(q.site, k),
				*in_a = NULL, *in_b = NULL;
		g_autofree char *of_a = g_build_filename(a, "picture-01.png", NULL),
				*of_b = g_build_filename(b, "picture-01.png", NULL);
		gsize length_a, length_b;
		g_assert_true(g_file_get_contents(of_a, &in_a, &length_a, NULL));
		g_assert_true(g_file_get_contents(of_b, &in_b, &length_b, NULL));
		g_assert_cmpmem(in_a, length_a, in_b, length_b);
		assert_grid(&e, &q, k, k, 1.1e-6);
	}
	g_array_unref(scans);
	g_array_unref(more);
	place_clear(&p);
	place_clear(&q);
}

/* ---- real ---- */

static void test_pump(void)
{
	const char *path = shared_path("data/pump/pump.e57");
	if (!path)
		return g_test_skip("there is no shared/data/pump");
	struct place from = place_new();
	g_array_unref(place_import(&from, path));
	g_autoptr(points) was = place_points(&from, 1);
	static const char *const names[] = { "pump.e57", "pump.ptx", "pump.ply", "pump.pcd" };
	for (gsize n = 0; n < G_N_ELEMENTS(names); n++) {
		g_autofree char *out = g_build_filename(from.folder, names[n], NULL);
		g_autoptr(GError) error = NULL;
		struct export_options o = { 0 };
		struct export_result r;
		GArray *scans;
		bool good = export_site(from.site, out, &o, &r, &error);
		g_assert_no_error(error);
		g_assert_true(good);
		g_assert_cmpuint(r.points, ==, 155201);
		struct place p = exported_import(out, &scans);
		g_autoptr(points) is = place_points(&p, 1);
		static const double none[3];
		g_assert_cmpuint(is->count, ==, was->count);
		g_assert_cmpuint(is->columns, ==, 345);
		for (uint64_t i = 0; i < is->count; i++) {
			const struct point_record *x = &was->record[i];
			double m[3] = { x->x_m, x->y_m, x->z_m };
			g_assert_cmpint(x->cell, ==, is->record[i].cell);
			if (x->cell != CELL_MEASURED)
				continue;
			g_assert_cmpfloat(apart(m, &is->record[i], none), <=, 0.51e-6);
			g_assert_cmpuint(x->intensity, ==, is->record[i].intensity);
			g_assert_cmpmem(x->rgb, 3, is->record[i].rgb, 3);
		}
		g_array_unref(scans);
		place_clear(&p);
		export_result_clear(&r);
	}
	place_clear(&from);
}

static void test_autzen(void)
{
	const char *path = shared_path("data/aerial-colour/autzen_trim.las");
	if (!path)
		return g_test_skip("there is no shared/data/aerial-colour");
	struct place from = place_new();
	g_array_unref(place_import(&from, path));
	g_autofree char *out = g_build_filename(from.folder, "out.las", NULL);
	g_autoptr(GError) error = NULL;
	struct export_options o = { 0 };
	struct export_result r;
	GArray *scans;
	bool good = export_site(from.site, out, &o, &r, &error);
	g_assert_no_error(error);
	g_assert_true(good);
	struct place p = exported_import(out, &scans);
	g_autoptr(points) was = place_points(&from, 1), is = place_points(&p, 1);
	uint64_t ground = 0;
	g_assert_cmpuint(was->count, ==, is->count);
	for (uint64_t i = 0; i < is->count; i++) {
		g_assert_cmpuint(was->record[i].classification, ==, is->record[i].classification);
		g_assert_cmpmem(was->record[i].rgb, 3, is->record[i].rgb, 3);
		ground += is->record[i].classification == 2;
	}
	g_assert_cmpuint(is->count, ==, 110000);
	g_assert_cmpuint(ground, >, 0);
	g_array_unref(scans);
	place_clear(&p);
	place_clear(&from);
	export_result_clear(&r);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	for (gsize i = 0; i < G_N_ELEMENTS(grids); i++)
		commands_add("/export/grid", i, &grids[i], test_grids);
	for (gsize i = 0; i < G_N_ELEMENTS(merged); i++)
		commands_add("/export/merged", i, &merged[i], test_merged);
	for (gsize i = 0; i < G_N_ELEMENTS(of_map); i++)
		commands_add("/export/map", i, of_map[i], test_map);
	for (gsize i = 0; i < G_N_ELEMENTS(thinned); i++)
		commands_add("/export/spacing", i, thinned[i], test_spacing);
	for (gsize i = 0; i < G_N_ELEMENTS(spoilt); i++)
		commands_add("/export/spoilt", i, spoilt[i], test_spoilt);
	g_test_add_func("/export/raw", test_raw);
	g_test_add_func("/export/not-aligned", test_not_aligned);
	g_test_add_func("/export/came-later", test_came_later);
	g_test_add_func("/export/clouds", test_clouds);
	g_test_add_func("/export/spoilt-grid", test_spoilt_grid);
	g_test_add_func("/export/stopped", test_stopped);
	g_test_add_func("/export/pictures", test_pictures);
	g_test_add_func("/export/pump", test_pump);
	g_test_add_func("/export/autzen", test_autzen);
	return g_test_run();
}
