/* Models of simulated sites: what is in them, that they do not depend on how they came about, and what stops or damages them. */
#include "process/model-part.h"
#include "tests/built-model.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>

/* ---- what is in it ---- */

/* Each point is one of its scan's, to a hundredth of a millimetre, and none is there twice. */
static void check_points(const char *path, uint64_t expected_points)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(model) m = model_open(path, &error);
	g_assert_no_error(error);
	g_autoptr(site) s = site_open(path, NULL);
	scan_data *d[SCANS] = { NULL };
	uint8_t *seen[SCANS] = { NULL };
	for (uint32_t k = 0; k < SCANS; k++) {
		d[k] = scan_data_load(s, k + 1, &error);
		seen[k] = g_malloc0(range_grid_cells(d[k]->grid));
	}
	uint64_t chunks, missed = 0;
	const struct model_chunk *c = model_chunks(m, &chunks);
	for (uint64_t i = 0; i < chunks; i++)
		for (uint32_t n = 0; n < c[i].points; n++) {
			const struct model_point *p = &model_points(m)[c[i].first + n];
			const range_grid *g = d[p->scan - 1]->grid;
			uint32_t cell = cell_of(&c[i], p, g, &truths[p->scan - 1]);
			if (cell == RANGE_GRID_NONE) {
				missed++;
				continue;
			}
			g_assert_cmpuint(p->intensity, ==, g->intensity[cell]);
			g_assert_cmpuint(seen[p->scan - 1][cell]++, ==, 0);
			g_assert_cmpint(
				abs(p->size - (int)(1e4f * range_grid_point_size_m(g, cell))), <=,
				1);
		}
	g_assert_cmpuint(missed, <=, expected_points / 1000);
	g_assert_cmpuint(model_count(m), ==, expected_points);
	g_assert_true(model_verify(m, &error));
	for (uint32_t k = 0; k < SCANS; k++) {
		scan_data_free(d[k]);
		g_free(seen[k]);
	}
}

static void test_points(void)
{
	g_autofree char *path = fresh_site();
	struct build_result r = build_some(path, SCANS);
	g_autoptr(site) s = site_open(path, NULL);
	uint64_t measured = 0;
	for (uint32_t k = 1; k <= SCANS; k++) {
		g_autoptr(scan_data) d = scan_data_load(s, k, NULL);
		measured += range_grid_count(d->grid);
	}
	g_assert_cmpuint(r.points + r.redundant, ==, measured);
	g_assert_cmpuint(r.redundant, >, measured / 20);
	g_assert_cmpuint(r.scans, ==, SCANS);
	g_assert_cmpuint(r.scans_rebuilt, ==, SCANS);
	check_points(path, r.points);
}

/* ---- it does not depend on how it came about ---- */

static void test_again(void)
{
	g_autofree char *path = fresh_site();
	build_some(path, SCANS);
	assert_same(path, whole_sum());
	struct build_result r = build_some(path, SCANS);
	g_assert_cmpuint(r.scans_rebuilt, ==, 0);
	g_assert_cmpuint(r.points_taken_over, ==, r.points);
	assert_same(path, whole_sum());
}

static void test_scan_by_scan(void)
{
	g_autofree char *path = fresh_site();
	for (uint32_t k = 1; k <= SCANS; k++)
		g_assert_cmpuint(build_some(path, k).scans, ==, k);
	assert_same(path, whole_sum());
	build_some(path, 2); /* and one less */
	g_autofree char *part = g_build_filename(path, "model/parts/0003.part", NULL);
	g_assert_false(g_file_test(part, G_FILE_TEST_EXISTS));
	build_some(path, SCANS);
	assert_same(path, whole_sum());
}

static void test_moved_and_back(void)
{
	g_autofree char *path = fresh_site();
	scan_graph *g = graph_of(SCANS);
	build(path, g, NULL);
	expect_why(path, g, NULL);
	placed(g, 1)->pose.translation_m[0] += 0.5;
	expect_why(path, g, "scan 2 stands elsewhere");
	build(path, g, NULL);
	g_autofree char *moved = sum_of(path);
	g_assert_cmpstr(moved, !=, whole_sum());
	scan_graph_free(g);
	build_some(path, SCANS);
	assert_same(path, whole_sum());
}

/* Three kilometres do not fit the finest lattice. */
static void test_far_apart(void)
{
	g_autofree char *path = fresh_site();
	scan_graph *g = graph_of(SCANS);
	placed(g, 2)->pose.translation_m[1] += 3000;
	struct build_result r = build(path, g, NULL), again = build(path, g, NULL);
	g_assert_cmpuint(again.scans_rebuilt, ==, 0);
	/* When the distant one comes last the others need not be looked at again, and it makes no difference. */
	g_autofree char *other = fresh_site(), *sum = sum_of(path);
	build_some(other, 2);
	build(other, g, NULL);
	assert_same(other, sum);
	scan_graph_free(g);
	g_autoptr(model) m = model_open(path, NULL);
	g_assert_cmpfloat(
		json_object_get_double_member(product_manifest(model_file(m)), "lattice_m"), ==,
		0.004);
	g_assert_cmpuint(model_count(m), ==, r.points);
	build_some(path, SCANS);
	assert_same(path, whole_sum());
}

/* A house apart: what changes at one leaves the pieces of the other as they were. */
static void test_taken_over(void)
{
	g_autofree char *path = fresh_site(), *other = fresh_site();
	scan_graph *apart = graph_of(SCANS), *two = graph_of(2);
	placed(apart, 1)->pose.translation_m[1] += 100;
	placed(two, 1)->pose = placed(apart, 1)->pose;
	uint64_t first = build_some(path, 1).points;
	struct build_result r = build(path, two, NULL), s = build(path, apart, NULL);
	uint64_t second = r.points - first;
	g_assert_cmpuint(r.points_taken_over, >, first * 9 / 10);
	g_assert_cmpuint(r.points_taken_over, <=, first);
	g_assert_cmpuint(s.points_taken_over, >, second * 9 / 10);
	g_assert_cmpuint(s.points_taken_over, <, second + first);
	g_assert_cmpuint(build(other, apart, NULL).points_taken_over, ==, 0);
	g_autofree char *sum = sum_of(path);
	assert_same(other, sum);
	scan_graph_free(apart);
	scan_graph_free(two);
}

static void test_threads_and_memory(void)
{
	static const int threads[] = { 1, 3 };
	for (size_t i = 0; i < G_N_ELEMENTS(threads); i++) {
		g_autofree char *path = fresh_site();
		scan_graph *g = graph_of(SCANS);
		struct build_options little = { .memory_bytes = 1 << 20 };
		int before = omp_get_max_threads();
		omp_set_num_threads(threads[i]);
		build(path, g, i ? &little : NULL);
		omp_set_num_threads(before);
		scan_graph_free(g);
		assert_same(path, whole_sum());
	}
}

/* ---- stopped, damaged ---- */

struct stopper {
	int calls, stop_at;
	double last;
};

static bool count_calls(double fraction, const char *doing, gpointer user_data)
{
	struct stopper *s = user_data;
	g_assert_cmpfloat(fraction, >=, s->last);
	g_assert_cmpfloat(fraction, <=, 1);
	g_assert_nonnull(doing);
	s->last = fraction;
	return ++s->calls != s->stop_at;
}

static void test_stopped_anywhere(void)
{
	g_autofree char *path = fresh_site(), *file = model_path(path);
	scan_graph *g = graph_of(SCANS);
	int stops = 0;
	for (bool done = false; !done; stops++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(site) s = site_open(path, NULL);
		struct stopper stop = { .stop_at = stops + 1 };
		struct build_options o = { .progress = count_calls, .user_data = &stop };
		struct build_result r;
		done = build_model(s, g, &o, &r, &error);
		if (!done) {
			g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
			g_assert_false(g_file_test(file, G_FILE_TEST_EXISTS));
		} else {
			g_assert_cmpuint(r.scans_rebuilt, ==, 0); /* it had all been done before */
		}
		g_assert_cmpint(stops, <, 100);
	}
	scan_graph_free(g);
	g_assert_cmpint(stops, >, 2 * SCANS);
	assert_same(path, whole_sum());
}

static void turn_a_bit(const char *folder, const char *name, long at)
{
	g_autofree char *path = g_build_filename(folder, name, NULL);
	FILE *f = fopen(path, "r+b");
	g_assert_nonnull(f);
	fseek(f, at, SEEK_SET);
	int byte = fgetc(f);
	fseek(f, at, SEEK_SET);
	fputc(byte ^ 16, f);
	fclose(f);
}

static void test_damaged(void)
{
	static const struct {
		const char *name;
		long at;
	} damages[] = { { "model/parts/0002.part", 5000 }, { "model/parts/0001.overlap", 1000 },
		{ "model/parts/0003.part", 9 }, { "model/points.model", 20 } };
	g_autofree char *path = fresh_site();
	scan_graph *g = graph_of(SCANS);
	build(path, g, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(damages); i++) {
		turn_a_bit(path, damages[i].name, damages[i].at);
		expect_why(path, g, i == 3 ? "the model cannot be read" : NULL);
		build(path, g, NULL);
		assert_same(path, whole_sum());
	}
	scan_graph_free(g);
}

/* As versions 1 and 2 were: points end after the leaf. */
static void write_earlier(const char *path, int version)
{
	static const struct {
		uint8_t bytes[32];
	} earlier[2];
	static const struct model_chunk chunk = { .points = 2 };
	g_autofree char *file = model_path(path);
	g_autoptr(product_writer) w = product_writer_new(file, NULL);
	write_section(w, "points", sizeof earlier[0], earlier, 2);
	write_section(w, "chunks", sizeof chunk, &chunk, 1);
	g_assert_true(product_writer_finish(w, MODEL_KIND, version, json_object_new(), NULL));
}

static void test_earlier(void)
{
	g_autofree char *path = fresh_site();
	scan_graph *g = graph_of(SCANS);
	build(path, g, NULL);
	for (int version = 1; version < MODEL_VERSION; version++) {
		g_autoptr(GError) error = NULL;
		write_earlier(path, version);
		g_assert_null(model_open(path, &error));
		g_assert_error(error, PRODUCT_ERROR, PRODUCT_ERROR_VERSION);
		g_assert_nonnull(strstr(error->message, "earlier version"));
		expect_why(path, g, "the model was written by another version of this program");
		g_assert_cmpuint(build(path, g, NULL).points_taken_over, ==, 0);
		assert_same(path, whole_sum());
	}
	scan_graph_free(g);
}

/* The second scan's part as if an earlier version had made it. */
static void write_earlier_part(const char *path)
{
	static const struct {
		const char *name;
		uint32_t bytes;
	} sections[] = { { "points", sizeof(struct part_point) }, { "run_end", sizeof(uint64_t) },
		{ "cell", sizeof(uint32_t) }, { "sum", sizeof(struct part_sum) } };
	g_autofree char *file = g_build_filename(path, "model/parts/0002.part", NULL);
	g_autoptr(product) was = product_open(file, MODEL_PART_KIND, MODEL_PART_VERSION, NULL);
	g_autoptr(product_writer) w = product_writer_new(file, NULL);
	JsonObject *made = json_object_new(), *from = product_manifest(was);
	json_object_set_string_member(made, "key", json_object_get_string_member(from, "key"));
	json_object_set_int_member(
		made, "level_needed", json_object_get_int_member(from, "level_needed"));
	for (size_t i = 0; i < G_N_ELEMENTS(sections); i++) {
		uint64_t count;
		const void *all =
			product_section(was, sections[i].name, sections[i].bytes, &count, NULL);
		write_section(w, sections[i].name, sections[i].bytes, all, count);
	}
	g_assert_true(
		product_writer_finish(w, MODEL_PART_KIND, MODEL_PART_VERSION - 1, made, NULL));
}

static void test_earlier_part(void)
{
	g_autofree char *path = fresh_site(), *file = model_path(path);
	scan_graph *g = graph_of(SCANS);
	build(path, g, NULL);
	g_assert_cmpint(g_unlink(file), ==, 0);
	g_assert_cmpuint(build(path, g, NULL).scans_rebuilt, ==, 0);
	write_earlier_part(path);
	g_assert_cmpint(g_unlink(file), ==, 0);
	g_assert_cmpuint(build(path, g, NULL).scans_rebuilt, ==, 1);
	assert_same(path, whole_sum());
	scan_graph_free(g);
}

/* ---- which scans ---- */

static void test_due(void)
{
	g_autofree char *path = fresh_site();
	scan_graph *none = graph_of(0), *two = graph_of(2), *all = graph_of(SCANS);
	expect_why(path, none, NULL);
	expect_why(path, two, "there is no model yet");
	build(path, two, NULL);
	expect_why(path, two, NULL);
	expect_why(path, all, "scan 3 is new");
	expect_why(path, none, "a scan is not in it any more");
	g_assert_cmpuint(build(path, none, NULL).points, ==, 0);
	expect_why(path, none, NULL);
	scan_graph_free(none);
	scan_graph_free(two);
	scan_graph_free(all);
}

/* What nothing ties together does not stand in one frame. */
static void test_groups(void)
{
	g_autofree char *path = fresh_site();
	scan_graph *g = graph_of(SCANS);
	placed(g, 0)->group = 2;
	struct build_result r = build(path, g, NULL);
	g_assert_cmpuint(r.scans, ==, 2);
	g_assert_cmpuint(r.scans_left_out, ==, 1);
	g_autoptr(model) m = model_open(path, NULL);
	for (uint64_t i = 0; i < model_count(m); i++)
		g_assert_cmpuint(model_points(m)[i].scan, !=, 1);
	placed(g, 1)->group = 0;
	g_assert_cmpuint(build(path, g, NULL).scans, ==, 1);
	scan_graph_free(g);
}

/* ---- clouds ---- */

/* As the geometry of a cloud is: without normals here, but with the points' sizes. */
static void write_geometry(const char *path, uint32_t number, const GArray *sizes)
{
	g_autofree char *folder = g_build_filename(path, "geometry", NULL);
	g_autofree char *file = g_strdup_printf("%s/%04u.geometry", folder, number);
	g_autofree float *none = g_new(float, sizes->len);
	g_autofree int16_t *normal = g_new(int16_t, 2 * sizes->len);
	for (guint i = 0; i < sizes->len; i++) {
		none[i] = NAN;
		normal[2 * i] = normal[2 * i + 1] = MODEL_NORMAL_NONE;
	}
	g_assert_true(files_make_folder(folder, NULL));
	g_autoptr(product_writer) w = product_writer_new(file, NULL);
	const struct {
		const char *name;
		const void *data;
	} sections[] = { { "normal", normal }, { "plane_error", none }, { "curvature", none },
		{ "point_size", sizes->data } };
	for (size_t i = 0; i < G_N_ELEMENTS(sections); i++) {
		g_assert_true(product_writer_begin(w, sections[i].name, 4, NULL));
		g_assert_true(product_writer_append(w, sections[i].data, sizes->len, NULL));
	}
	g_assert_true(product_writer_finish(
		w, SCAN_GEOMETRY_KIND, SCAN_GEOMETRY_VERSION, json_object_new(), NULL));
}

/* The points of scan 1, where they stand in the site, as a cloud without order. */
static uint32_t add_cloud(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	g_autoptr(scan_data) d = scan_data_load(s, 1, &error);
	uint32_t number;
	g_autofree char *folder = site_stage_scan(s, &number, &error);
	g_autofree char *ply = g_build_filename(folder, "points.ply", NULL);
	g_autofree char *json = g_build_filename(folder, "scan.json", NULL);
	g_autoptr(points_writer) w = points_writer_new(ply, 0, 0, &error);
	g_autoptr(GArray) sizes = g_array_new(FALSE, FALSE, sizeof(float));
	for (size_t i = 0; i < range_grid_cells(d->grid); i++) {
		double at[3] = { d->grid->x_m[i], d->grid->y_m[i], d->grid->z_m[i] };
		if (!(d->grid->range_m[i] > 0))
			continue;
		pose_apply(&truths[0], at, at);
		struct point_record r = { .x_m = at[0],
			.y_m = at[1],
			.z_m = at[2],
			.rgb = { 10, 20, 30 },
			.classification = 6,
			.cell = CELL_MEASURED };
		g_assert_true(points_writer_append(w, &r, 1, &error));
		float size = range_grid_point_size_m(d->grid, i);
		g_array_append_val(sizes, size);
	}
	g_assert_true(points_writer_finish(w, &error));
	g_autofree char *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(ply, &bytes, &length, NULL));
	g_autofree char *sha =
		g_compute_checksum_for_data(G_CHECKSUM_SHA256, (guchar *)bytes, length);
	g_autofree char *text = g_strdup_printf(
		"{\"schema\":1,\"number\":%u,\"created\":\"2026-01-01T00:00:00Z\",\"kind\":"
		"\"imported\","
		"\"points\":{\"count\":%" G_GUINT64_FORMAT ",\"columns\":0,\"rows\":0},"
		"\"files\":{\"points.ply\":{\"bytes\":%zu,\"sha256\":\"%s\"}}}",
		number, (uint64_t)sizes->len, length, sha);
	g_assert_true(files_write(json, text, strlen(text), &error));
	g_autoptr(GPtrArray) folders = g_ptr_array_new();
	g_ptr_array_add(folders, folder);
	site_add_staged(s, folders, &error);
	g_assert_no_error(error);
	write_geometry(path, number, sizes);
	return number;
}

/* A cloud that lies on what scans saw adds next to nothing. */
static void test_cloud(void)
{
	g_autofree char *path = fresh_site();
	g_assert_cmpuint(add_cloud(path), ==, SCANS + 1);
	struct build_result without = build_some(path, SCANS);
	struct build_result with = build_some(path, SCANS + 1);
	g_assert_cmpuint(with.redundant, >, without.redundant + without.points / 10);
	g_autoptr(model) m = model_open(path, NULL);
	uint64_t of_cloud = 0;
	for (uint64_t i = 0; i < model_count(m); i++) {
		const struct model_point *p = &model_points(m)[i];
		if (p->scan != SCANS + 1)
			continue;
		of_cloud++;
		g_assert_cmpuint(p->classification, ==, 6);
		g_assert_cmpmem(p->rgba, 4, ((uint8_t[]){ 10, 20, 30, 255 }), 4);
	}
	g_assert_cmpuint(of_cloud, >, 1000);
	g_test_message("%" G_GUINT64_FORMAT " of the cloud, %" G_GUINT64_FORMAT
		       " in all, %" G_GUINT64_FORMAT " without it",
		of_cloud, with.points, without.points);
	g_assert_cmpuint(with.points, >, without.points - without.points / 20);
	g_assert_cmpuint(with.points, <, without.points + without.points / 20);
	g_autofree char *sum = sum_of(path);
	build_some(path, SCANS + 1);
	assert_same(path, sum);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/build-model/points", test_points);
	g_test_add_func("/build-model/again", test_again);
	g_test_add_func("/build-model/scan-by-scan", test_scan_by_scan);
	g_test_add_func("/build-model/moved-and-back", test_moved_and_back);
	g_test_add_func("/build-model/far-apart", test_far_apart);
	g_test_add_func("/build-model/taken-over", test_taken_over);
	g_test_add_func("/build-model/threads-and-memory", test_threads_and_memory);
	g_test_add_func("/build-model/earlier", test_earlier);
	g_test_add_func("/build-model/earlier-part", test_earlier_part);
	g_test_add_func("/build-model/stopped-anywhere", test_stopped_anywhere);
	g_test_add_func("/build-model/damaged", test_damaged);
	g_test_add_func("/build-model/due", test_due);
	g_test_add_func("/build-model/groups", test_groups);
	g_test_add_func("/build-model/cloud", test_cloud);
	return g_test_run();
}
