/* What the features of scans leave in a model's points. */
#include "tests/built-model.h"
#include <json-glib/json-glib.h>

static void random_direction(GRand *r, int16_t ret[2])
{
	double z = g_rand_double_range(r, -1, 1), a = g_rand_double_range(r, 0, 2 * G_PI);
	double level = sqrt(1 - z * z);
	model_pack_normal(
		(float[3]){ (float)(level * cos(a)), (float)(level * sin(a)), (float)z }, ret);
}

/* Of each cell something else, of every kind and flag, with and without directions and curvatures. */
static void write_features(const char *path, uint32_t number, uint64_t count)
{
	g_autoptr(GRand) r = g_rand_new_with_seed(number);
	g_autofree char *folder = g_build_filename(path, "features", NULL);
	g_autofree char *file = g_strdup_printf("%s/%04u.features", folder, number);
	g_autofree uint8_t *degree = g_new(uint8_t, count), *kind = g_new(uint8_t, count),
			   *flags = g_new(uint8_t, count);
	g_autofree int16_t(*direction)[2] = g_malloc_n(count, sizeof *direction);
	g_autofree int16_t(*principal)[2] = g_malloc_n(count, sizeof *principal);
	g_autofree uint16_t *line_error = g_new0(uint16_t, count);
	g_autofree float *k1 = g_new(float, count), *k2 = g_new(float, count);
	for (uint64_t i = 0; i < count; i++) {
		degree[i] = (uint8_t)g_rand_int_range(r, 0, 256);
		kind[i] = (uint8_t)g_rand_int_range(r, 0, FEATURE_KINDS);
		flags[i] = (uint8_t)g_rand_int_range(r, 0, 2 * FEATURE_INTENSITY_EDGE);
		bool has_curvature = g_rand_int_range(r, 0, 4);
		random_direction(r, direction[i]);
		random_direction(r, principal[i]);
		if (kind[i] != FEATURE_DIRECTED)
			direction[i][0] = direction[i][1] = MODEL_NORMAL_NONE;
		if (!has_curvature)
			principal[i][0] = principal[i][1] = MODEL_NORMAL_NONE;
		k1[i] = has_curvature ? (float)g_rand_double_range(r, -200, 200) : NAN;
		k2[i] = has_curvature ? k1[i] * (float)g_rand_double_range(r, -1, 1) : NAN;
	}
	g_assert_true(files_make_folder(folder, NULL));
	g_autoptr(product_writer) w = product_writer_new(file, NULL);
	write_section(w, "degree", 1, degree, count);
	write_section(w, "kind", 1, kind, count);
	write_section(w, "flags", 1, flags, count);
	write_section(w, "direction", 4, direction, count);
	write_section(w, "line_error", 2, line_error, count);
	write_section(w, "k1", 4, k1, count);
	write_section(w, "k2", 4, k2, count);
	write_section(w, "principal", 4, principal, count);
	JsonObject *made = json_object_new();
	json_object_set_double_member(made, "dither_per_m2", 90);
	json_object_set_double_member(made, "tone_exponent", 1.5);
	g_assert_true(
		product_writer_finish(w, SCAN_FEATURES_KIND, SCAN_FEATURES_VERSION, made, NULL));
}

static void expect_tone(const char *path, double dither_per_m2, double tone_exponent)
{
	g_autoptr(model) m = model_open(path, NULL);
	JsonObject *made = product_manifest(model_file(m));
	g_assert_cmpfloat(json_object_get_double_member(made, "dither_per_m2"), ==, dither_per_m2);
	g_assert_cmpfloat(json_object_get_double_member(made, "tone_exponent"), ==, tone_exponent);
}

/* Scan 2 tilted and turned, so that its frame is not the site's in any axis. */
static scan_graph *tilted_graph(void)
{
	scan_graph *g = graph_of(SCANS);
	struct pose *p = &placed(g, 1)->pose;
	*p = pose_perturb(p, (double[6]){ 0.4, -0.3, 0.9, 0.5, 0.2, -0.1 });
	g_assert_cmpfloat(pose_angle_rad(p), >, 0.5);
	return g;
}

static void expect_none(const int16_t packed[2])
{
	g_assert_cmpint(packed[0], ==, MODEL_NORMAL_NONE);
	g_assert_cmpint(packed[1], ==, MODEL_NORMAL_NONE);
}

/* The same line within a tenth of a degree, once the scan's is turned by its pose. */
static void expect_line(const struct pose *pose, const int16_t of_scan[2], const int16_t got[2])
{
	float from[3], to[3];
	double turned[3], cosine = 0;
	if (of_scan[0] == MODEL_NORMAL_NONE && of_scan[1] == MODEL_NORMAL_NONE) {
		expect_none(got);
		return;
	}
	model_unpack_normal(of_scan, from);
	model_unpack_normal(got, to);
	for (int i = 0; i < 3; i++) {
		turned[i] = 0;
		for (int k = 0; k < 3; k++)
			turned[i] += pose->rotation[i][k] * from[k];
		cosine += turned[i] * to[i];
	}
	g_assert_cmpfloat(fabs(cosine), >, cos(0.1 * G_PI / 180));
}

static void expect_curvature(float of_scan, uint16_t got)
{
	float value = model_unpack_half(got);
	g_assert_true(isnan(of_scan) == isnan(value));
	g_assert_false(fabsf(value - of_scan) > fabsf(of_scan) / 2048 + 1e-7f);
}

static void expect_no_features(const struct model_point *p)
{
	g_assert_cmpuint(p->feature, ==, 0);
	g_assert_cmpuint(p->kind, ==, FEATURE_NONE);
	g_assert_cmpuint(p->flags, ==, 0);
	g_assert_cmpuint(p->k1, ==, MODEL_HALF_NONE);
	g_assert_cmpuint(p->k2, ==, MODEL_HALF_NONE);
	expect_none(p->direction);
	expect_none(p->principal);
}

/* Of scan 2 what its features say, of the others nothing. Returns how many points have been told. */
static uint64_t check_features(const char *path, const struct pose *pose)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(model) m = model_open(path, &error);
	g_autoptr(scan_data) d = scan_data_load(s, 2, &error);
	g_autoptr(scan_features) f = scan_features_open(s, 2, &error);
	g_assert_no_error(error);
	uint64_t chunks, told = 0;
	const struct model_chunk *c = model_chunks(m, &chunks);
	for (uint64_t i = 0; i < chunks; i++)
		for (uint32_t n = 0; n < c[i].points; n++) {
			const struct model_point *p = &model_points(m)[c[i].first + n];
			g_assert_cmpuint(p->spacing, >=, p->size / 2);
			if (p->scan != 2) {
				expect_no_features(p);
				continue;
			}
			uint32_t cell = cell_of(&c[i], p, d->grid, pose);
			if (cell == RANGE_GRID_NONE)
				continue;
			told++;
			g_assert_cmpuint(p->feature, ==, f->degree[cell]);
			g_assert_cmpuint(p->kind, ==, f->kind[cell]);
			g_assert_cmpuint(p->flags, ==, f->flags[cell]);
			expect_line(pose, f->direction[cell], p->direction);
			expect_line(pose, f->principal[cell], p->principal);
			expect_curvature(f->k1[cell], p->k1);
			expect_curvature(f->k2[cell], p->k2);
		}
	return told;
}

static void add_features(const char *path)
{
	g_autoptr(site) s = site_open(path, NULL);
	g_autoptr(scan_data) d = scan_data_load(s, 2, NULL);
	write_features(path, 2, range_grid_cells(d->grid));
}

/* They come after the model was made, or before, at once or scan by scan, on any number of threads. */
static void test_features(void)
{
	g_autofree char *path = fresh_site(), *other = fresh_site();
	scan_graph *g = tilted_graph();
	build(path, g, NULL);
	const struct features_options defaults = features_defaults(NULL);
	expect_tone(path, defaults.dither_per_m2, defaults.tone_exponent);
	add_features(path);
	expect_why(path, g, "scan 2 has new features");
	g_assert_cmpuint(build(path, g, NULL).scans_rebuilt, ==, 1);
	expect_why(path, g, NULL);
	expect_tone(path, 90, 1.5);
	uint64_t told = check_features(path, &placed(g, 1)->pose);
	g_test_message("%" G_GUINT64_FORMAT " points of scan 2", told);
	g_assert_cmpuint(told, >, 10000);

	g_autofree char *sum = sum_of(path);
	int before = omp_get_max_threads();
	add_features(other);
	omp_set_num_threads(1);
	for (uint32_t k = 1; k <= SCANS; k++) {
		g_array_set_size(g->scans, 0);
		scan_graph *all = tilted_graph();
		g_array_append_vals(g->scans, all->scans->data, k);
		scan_graph_free(all);
		build(other, g, NULL);
	}
	omp_set_num_threads(before);
	assert_same(other, sum);
	scan_graph_free(g);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/model-features/taken-over", test_features);
	return g_test_run();
}
