/* First looks at simulated sites: when there are some, what is in them, and that the model comes out the same with and without. */
#include "process/model-look.h"
#include "tests/built-model.h"

static char *look_path(const char *path)
{
	return g_build_filename(path, "model", "look.model", NULL);
}

static bool is_due(const char *path, scan_graph *g, char **ret_why)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	bool due;
	g_assert_true(model_look_is_due(s, g, &due, ret_why, &error));
	g_assert_no_error(error);
	g_assert_true(due == (*ret_why != NULL));
	return due;
}

static void expect_due(const char *path, scan_graph *g, const char *expected)
{
	g_autofree char *why = NULL;
	is_due(path, g, &why);
	g_assert_cmpstr(why, ==, expected);
}

static struct look_result look_at(const char *path, scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	struct look_result r;
	model_look_make(s, g, NULL, &r, &error);
	g_assert_no_error(error);
	return r;
}

static void place(const char *path, scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	scan_graph_save(g, s, "placed", &error);
	g_assert_no_error(error);
}

static model *open_drawn(const char *path, bool *ret_is_look)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	model *m = model_look_open(s, ret_is_look, &error);
	g_assert_no_error(error);
	return m;
}

static bool is_look(const char *path)
{
	bool ret;
	g_autoptr(model) m = open_drawn(path, &ret);
	return ret;
}

/* All but one scan in the model, and a look at that one; caller frees both. */
static char *looked_at(scan_graph **ret_graph, struct look_result *ret)
{
	char *path = fresh_site();
	build_some(path, SCANS - 1);
	*ret_graph = graph_of(SCANS);
	place(path, *ret_graph);
	*ret = look_at(path, *ret_graph);
	return path;
}

/* ---- when ---- */

static void test_when(void)
{
	struct look_result r;
	scan_graph *g;
	g_autofree char *path = looked_at(&g, &r), *file = look_path(path);
	g_assert_true(is_look(path));
	expect_due(path, g, NULL);
	g_assert_cmpint(remove(file), ==, 0);
	g_assert_false(is_look(path));
	expect_due(path, g, "scan 3 is new");
	placed(g, 0)->pose.translation_m[0] += 0.5; /* the model has it elsewhere */
	expect_due(path, g, NULL);
	scan_graph_free(g);
	build_some(path, SCANS);
	g = graph_of(SCANS);
	expect_due(path, g, NULL);
	scan_graph_free(g);
}

/* A scan that is placed no more is not looked at any longer. */
static void test_taken_back(void)
{
	struct look_result r;
	scan_graph *g;
	g_autofree char *path = looked_at(&g, &r);
	placed(g, SCANS - 1)->group = 0;
	place(path, g);
	g_assert_false(is_look(path));
	placed(g, SCANS - 1)->group = 1;
	place(path, g);
	g_assert_true(is_look(path));
	placed(g, SCANS - 1)->pose.translation_m[1] += 0.01;
	place(path, g);
	g_assert_false(is_look(path));
	expect_due(path, g, "scan 3 is new");
	scan_graph_free(g);
}

static void test_damaged(void)
{
	struct look_result r;
	scan_graph *g;
	g_autofree char *path = looked_at(&g, &r), *file = look_path(path);
	g_assert_true(g_file_set_contents(file, "PLPRODUC", 8, NULL));
	g_assert_false(is_look(path));
	expect_due(path, g, "scan 3 is new");
	scan_graph_free(g);
}

/* ---- what ---- */

static double nearest_m(const model *m, const double at[3])
{
	double nearest = INFINITY;
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(m, &chunks);
	for (uint64_t i = 0; i < chunks; i++)
		for (uint32_t n = 0; n < c[i].points; n++) {
			const struct model_point *p = &model_points(m)[c[i].first + n];
			double off2 = 0;
			for (int k = 0; k < 3; k++)
				off2 += pow(c[i].centre_m[k] + (double)p->position_m[k] - at[k], 2);
			nearest = fmin(nearest, off2);
		}
	return sqrt(nearest);
}

/* What the new scan saw is there, near enough for the points' own size. */
static void check_whole(const model *m, const scan_data *d)
{
	const range_grid *g = d->grid;
	uint32_t looked = 0, missed = 0;
	for (size_t i = 0; i < range_grid_cells(g); i += 127) {
		double at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		if (!(g->range_m[i] > 0))
			continue;
		pose_apply(&truths[SCANS - 1], at, at);
		looked++;
		missed += nearest_m(m, at) > 0.06 + 3 * (double)range_grid_point_size_m(g, i);
	}
	g_assert_cmpuint(looked, >, 100);
	g_assert_cmpuint(missed, <=, looked / 20);
}

static void test_what(void)
{
	struct look_result r;
	scan_graph *g;
	bool is;
	g_autofree char *path = looked_at(&g, &r);
	g_autoptr(GError) error = NULL;
	g_autoptr(model) m = open_drawn(path, &is), whole = model_open(path, NULL);
	g_autoptr(site) s = site_open(path, NULL);
	g_autoptr(scan_data) d = scan_data_load(s, SCANS, NULL);
	uint64_t of_scan[SCANS + 1] = { 0 };
	g_assert_true(is);
	g_assert_true(model_verify(m, &error));
	g_assert_no_error(error);
	g_assert_cmpuint(model_count(m), ==, r.points);
	g_assert_nonnull(model_in_short(m).tones);
	for (uint64_t i = 0; i < r.points; i++)
		of_scan[model_points(m)[i].scan]++;
	g_assert_cmpuint(of_scan[SCANS], ==, r.points_new);
	g_assert_cmpuint(r.scans, ==, SCANS);
	g_assert_cmpuint(r.scans_new, ==, 1);
	/* What others saw better is not among them. */
	g_assert_cmpuint(r.points_new, >, range_grid_count(d->grid) / 20);
	g_assert_cmpuint(r.points_new, <, range_grid_count(d->grid));
	g_assert_cmpuint(r.points, <, model_count(whole) + r.points_new);
	check_whole(m, d);
	scan_graph_free(g);
}

static char *look_sum(const char *path)
{
	g_autofree char *file = look_path(path), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
	return g_compute_checksum_for_data(G_CHECKSUM_SHA256, (guchar *)bytes, length);
}

static void test_threads(void)
{
	struct look_result r;
	scan_graph *g;
	g_autofree char *path = looked_at(&g, &r), *sum = look_sum(path);
	for (int threads = 1; threads <= 5; threads += 2) {
		omp_set_num_threads(threads);
		look_at(path, g);
		g_autofree char *again = look_sum(path);
		g_assert_cmpstr(again, ==, sum);
	}
	omp_set_num_threads(omp_get_num_procs());
	scan_graph_free(g);
}

/* Of the first scan there is no model yet. */
static void test_first(void)
{
	g_autofree char *path = fresh_site();
	scan_graph *g = graph_of(1);
	place(path, g);
	expect_due(path, g, "scan 1 is new");
	struct look_result r = look_at(path, g);
	g_assert_cmpuint(r.points, ==, r.points_new);
	g_assert_true(is_look(path));
	build(path, g, NULL);
	g_assert_false(is_look(path));
	scan_graph_free(g);
}

/* ---- what comes after ---- */

static void test_after(void)
{
	struct look_result r;
	scan_graph *g;
	g_autofree char *path = looked_at(&g, &r), *file = look_path(path);
	expect_why(path, g, "scan 3 is new");
	build(path, g, NULL);
	assert_same(path, whole_sum());
	g_assert_false(g_file_test(file, G_FILE_TEST_EXISTS));
	g_assert_false(is_look(path));
	scan_graph_free(g);
}

/* Killed between the two, the look is of a model that is no more. */
static void test_killed(void)
{
	struct look_result r;
	scan_graph *g;
	g_autofree char *path = looked_at(&g, &r), *file = look_path(path), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
	build(path, g, NULL);
	g_assert_true(g_file_set_contents(file, bytes, (gssize)length, NULL));
	g_assert_false(is_look(path));
	scan_graph_free(g);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/model-look/when", test_when);
	g_test_add_func("/model-look/taken-back", test_taken_back);
	g_test_add_func("/model-look/damaged", test_damaged);
	g_test_add_func("/model-look/what", test_what);
	g_test_add_func("/model-look/threads", test_threads);
	g_test_add_func("/model-look/first", test_first);
	g_test_add_func("/model-look/after", test_after);
	g_test_add_func("/model-look/killed", test_killed);
	return g_test_run();
}
