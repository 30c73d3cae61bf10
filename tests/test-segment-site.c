/* The segments of whole sites: when they are due, that they come to the same however they are made, that each point has one leaf, and
 * what sites they are made of. */
#include "acquire/manifest.h"
#include "firmware-io/files.h"
#include "process/build-model.h"
#include "tests/import-made.h"
#include "tests/segmented-site.h"
#include <omp.h>

/* ---- all of it ---- */

/* SHA-256 over the files of the segments. */
static char *sum_of(const char *path)
{
	g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
	g_autofree char *folder = g_build_filename(path, "segments", NULL);
	g_autoptr(GPtrArray) names = files_names(folder, NULL);
	g_assert_cmpuint(names->len, >, 0);
	for (guint i = 0; i < names->len; i++) {
		g_autofree char *file = g_build_filename(folder, names->pdata[i], NULL),
				*bytes = NULL;
		gsize length;
		g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
		g_checksum_update(sum, names->pdata[i], -1);
		g_checksum_update(sum, (guchar *)bytes, (gssize)length);
	}
	return g_strdup(g_checksum_get_string(sum));
}

/* A site that was segmented as a whole at once. */
static const char *whole_site(void)
{
	static char *path;
	if (!path) {
		path = fresh_site();
		g_autoptr(scan_graph) g = graph_of(STATIONS);
		segment(path, g);
	}
	return path;
}

static const char *whole_sum(void)
{
	static char *sum;
	return sum ? sum : (sum = sum_of(whole_site()));
}

static void assert_whole(const char *path)
{
	g_autofree char *sum = sum_of(path);
	g_assert_cmpstr(sum, ==, whole_sum());
}

static void assert_alike(const struct segment *a, const struct segment *b)
{
	g_assert_true(a && b);
	g_assert_cmpint(a->class, ==, b->class);
	g_assert_cmpuint(a->points, ==, b->points);
	g_assert_cmpfloat(a->area_m2, ==, b->area_m2);
	g_assert_cmpmem(a->low_m, sizeof a->low_m, b->low_m, sizeof b->low_m);
	g_assert_cmpmem(a->high_m, sizeof a->high_m, b->high_m, sizeof b->high_m);
}

/* The same things, whatever their numbers. */
static void assert_whole_but_numbers(const char *path)
{
	g_autoptr(segments) tree = segments_load(path, NULL),
			    whole = segments_load(whole_site(), NULL);
	g_autofree uint16_t *is = g_new0(uint16_t, SEGMENTS_MAX + 1);
	g_assert_cmpuint(tree->nodes->len, ==, whole->nodes->len);
	for (uint32_t scan = 1; scan <= STATIONS; scan++) {
		uint64_t count, other;
		g_autofree uint16_t *a = labels_in(path, scan, &count),
				    *b = labels_in(whole_site(), scan, &other);
		g_assert_cmpuint(count, ==, other);
		for (uint64_t i = 0; i < count; i++) {
			is[a[i]] = is[a[i]] ? is[a[i]] : b[i];
			g_assert_cmpuint(is[a[i]], ==, b[i]);
		}
	}
	for (uint32_t id = SEGMENT_FIRST; id <= SEGMENTS_MAX; id++)
		if (is[id])
			assert_alike(segments_find(tree, id), segments_find(whole, is[id]));
}

/* ---- what is in them ---- */

static void test_leaves(void)
{
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	struct segment_site_result r = segment(path, g);
	check_leaves(path, g);
	uint64_t sum = 0;
	for (int c = 0; c < SEGMENT_CLASSES; c++)
		sum += r.class_points[c];
	g_assert_cmpuint(sum, ==, r.points);
	g_assert_cmpuint(r.things, >, 10);
	g_assert_cmpuint(r.class_points[CLASS_BUILDING], >, r.points / 10);
	g_assert_cmpuint(r.class_points[CLASS_TERRAIN], >, r.points / 10);
}

/* ---- when they are due ---- */

static void test_due(void)
{
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) two = graph_of(2);
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	static const char *const changed = "scans, or how to tell things apart, have changed";
	expect_why(path, two, "there are no segments yet");
	segment(path, two);
	expect_why(path, two, NULL);
	expect_why(path, g, changed);
	segment(path, g);
	expect_why(path, g, NULL);
	assert_whole_but_numbers(path);
	struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, 1);
	p->pose.translation_m[0] += 0.01;
	expect_why(path, g, changed);
	p->pose.translation_m[0] = true_pose[2].translation_m[0];
	expect_why(path, g, NULL);
	p->group = 0;
	expect_why(path, g, changed);
}

static void test_parameters(void)
{
	static const struct {
		const char *key, *value;
	} changes[] = { { "segmentation.gap_m", "0.25" }, { "segmentation.points_min", "200" },
		{ "segmentation.labels", "false" } };
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	segment(path, g);
	for (size_t i = 0; i < G_N_ELEMENTS(changes); i++) {
		set(path, changes[i].key, changes[i].value);
		expect_why(path, g, "scans, or how to tell things apart, have changed");
		segment(path, g);
		expect_why(path, g, NULL);
		g_autofree char *sum = sum_of(path);
		g_assert_cmpstr(sum, !=, whole_sum());
		set(path, "segmentation", NULL);
	}
	segment(path, g);
	assert_whole_but_numbers(path);
}

/* Fewer things when each needs more points, and none of those that count has fewer. */
static void test_points_min(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(1);
	uint32_t things = segment(path, g).things;
	set(path, "segmentation.points_min", "500");
	uint32_t fewer = segment(path, g).things;
	g_test_message("%u things, %u of 500 points", things, fewer);
	g_assert_cmpuint(fewer, <, things);
	g_autoptr(segments) tree = segments_load(path, &error);
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		if (g_str_has_prefix(node->name, "Structure ") ||
			g_str_has_prefix(node->name, "Thing "))
			g_assert_cmpuint(node->points, >=, 500);
	}
}

static void test_bad_parameters(void)
{
	static const char *const bad[][2] = { { "segmentation.gap_m", "0" },
		{ "segmentation.gap_m", "-1" }, { "segmentation.gap_m", "1000" },
		{ "segmentation.gap_m", "\"wide\"" }, { "segmentation.points_min", "0" },
		{ "segmentation.points_min", "2.5" }, { "segmentation.points_min", "1e12" },
		{ "segmentation.points_min", "true" }, { "segmentation.labels", "\"no\"" },
		{ "segmentation.labels", "[false]" }, { "segmentation.labels", "1" } };
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(1);
	for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(GError) again = NULL;
		set(path, bad[i][0], bad[i][1]);
		g_autoptr(site) s = site_open_existing(path, NULL);
		struct segment_site_result result;
		bool due;
		char *why = NULL;
		g_test_message("%s: %s", bad[i][0], bad[i][1]);
		g_assert_false(segment_site(s, g, NULL, &result, &error));
		g_assert_false(segment_site_is_due(s, g, &due, &why, &again));
		g_assert_nonnull(strstr(error->message, bad[i][0]));
		g_assert_nonnull(strstr(error->message, "site.json"));
		g_assert_null(strchr(error->message, '\n'));
		g_assert_cmpstr(error->message, ==, again->message);
		g_clear_pointer(&s, site_free);
		set(path, "segmentation", NULL);
	}
}

/* ---- stopped, damaged ---- */

struct stopper {
	int left, calls;
	double last;
};

static bool stop_later(double fraction, const char *doing, gpointer user_data)
{
	struct stopper *s = user_data;
	g_assert_nonnull(doing);
	g_assert_cmpfloat(fraction, >=, s->last);
	g_assert_cmpfloat(fraction, <=, 1);
	s->last = fraction;
	s->calls++;
	return s->left-- > 0;
}

static void test_stopped(void)
{
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	for (int after = 0;; after++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(site) s = site_open_existing(path, NULL);
		struct stopper stopper = { .left = after };
		struct segment_site_options options = { stop_later, &stopper };
		struct segment_site_result result;
		bool done = segment_site(s, g, &options, &result, &error);
		if (done) {
			g_assert_cmpint(after, >=, 6);
			break;
		}
		g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
		g_clear_pointer(&s, site_free);
		expect_why(path, g, "there are no segments yet");
	}
	expect_why(path, g, NULL);
	assert_whole(path);
}

enum harm { HARM_CUT, HARM_GONE, HARM_FLIPPED, HARMS };

static void damage(const char *path, const char *name, enum harm harm)
{
	g_autofree char *file = g_build_filename(path, "segments", name, NULL), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
	bytes[length / 3] ^= harm == HARM_FLIPPED ? 4 : 0; /* in the first section */
	if (harm == HARM_GONE)
		g_assert_cmpint(g_unlink(file), ==, 0);
	else
		g_assert_true(g_file_set_contents(
			file, bytes, (gssize)(harm == HARM_CUT ? length * 2 / 3 : length), NULL));
}

static void test_damaged(void)
{
	static const struct {
		const char *file, *why, *why_gone;
	} cases[] = { { "0002.segments", "the segments of scan 2 cannot be read",
			      "the segments of scan 2 cannot be read" },
		{ "segments.json", "the segments cannot be read", "the segments cannot be read" },
		{ "automatic.json", "the segments cannot be read", "there are no segments yet" } };
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	segment(path, g);
	for (size_t i = 0; i < HARMS * G_N_ELEMENTS(cases); i++) {
		enum harm harm = (enum harm)(i % HARMS);
		if (harm == HARM_FLIPPED && g_str_has_suffix(cases[i / HARMS].file, ".json"))
			continue; /* which may be a text as good as it was */
		damage(path, cases[i / HARMS].file, harm);
		expect_why(path, g,
			harm == HARM_GONE ? cases[i / HARMS].why_gone : cases[i / HARMS].why);
		segment(path, g);
		expect_why(path, g, NULL);
		assert_whole(path);
	}
}

/* Labels that are whole, but of another run: as when it was cut off, and the scans are as they were before. */
static void test_other_labels(void)
{
	g_autofree char *path = fresh_site(), *other = copy_of(whole_site());
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	set(other, "segmentation.gap_m", "0.25");
	segment(other, g);
	segment(path, g);
	g_autofree char *command =
		g_strdup_printf("cp '%s/segments/0002.segments' '%s/segments/'", other, path);
	g_assert_cmpint(system(command), ==, 0);
	expect_why(path, g, "the segments of scan 2 are others");
	segment(path, g);
	expect_why(path, g, NULL);
	assert_whole(path);
}

/* Labels of a scan that is no more go; other files stay. */
static void test_strangers(void)
{
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) all = graph_of(STATIONS);
	g_autoptr(scan_graph) two = graph_of(2);
	g_autofree char *third = g_build_filename(path, "segments", "0003.segments", NULL),
			*other = g_build_filename(path, "segments", "notes.txt", NULL);
	segment(path, all);
	g_assert_true(g_file_test(third, G_FILE_TEST_EXISTS));
	g_assert_true(g_file_set_contents(other, "mine", -1, NULL));
	segment(path, two);
	g_assert_false(g_file_test(third, G_FILE_TEST_EXISTS));
	g_assert_true(g_file_test(other, G_FILE_TEST_EXISTS));
}

static void test_threads(void)
{
	for (int threads = 1; threads <= 5; threads += 2) {
		g_autofree char *path = fresh_site();
		g_autoptr(scan_graph) g = graph_of(STATIONS);
		int was = omp_get_max_threads();
		omp_set_num_threads(threads);
		segment(path, g);
		omp_set_num_threads(was);
		assert_whole(path);
	}
}

/* ---- sites of other kinds ---- */

static void test_no_geometry(void)
{
	g_autofree char *path = fresh_site();
	g_autofree char *folder = g_build_filename(path, "geometry", NULL);
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	g_assert_true(files_remove_tree(folder, NULL));
	segment(path, g);
	check_leaves(path, g);
	expect_why(path, g, NULL);
}

static void test_alone(void)
{
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	g_array_index(g->scans, struct placed_scan, 2).group = 0;
	segment(path, g);
	check_leaves(path, g);
	/* the other two are as they would be without it, but for their numbers */
	g_array_index(g->scans, struct placed_scan, 1).group = 0;
	g_array_index(g->scans, struct placed_scan, 0).group = 0;
	segment(path, g);
	check_leaves(path, g);
}

static void test_empty(void)
{
	struct place at = place_new();
	g_autoptr(scan_graph) g = scan_graph_new();
	struct segment_site_result r = { .things = 7 };
	g_autoptr(GError) error = NULL;
	bool due = true;
	char *why = NULL;
	g_assert_true(segment_site_is_due(at.site, g, &due, &why, &error));
	g_assert_false(due);
	g_assert_null(why);
	g_assert_true(segment_site(at.site, g, NULL, &r, &error));
	g_assert_no_error(error);
	g_assert_cmpuint(r.things, ==, 0);
	g_assert_cmpuint(r.points, ==, 0);
	place_clear(&at);
}

static void test_model(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(STATIONS);
	segment(path, g);
	{
		g_autoptr(site) s = site_open_existing(path, &error);
		struct build_result result;
		build_model(s, g, NULL, &result, &error);
		g_assert_no_error(error);
	}
	g_autoptr(segments) tree = segments_load(path, &error);
	g_autoptr(model) m = model_open(path, &error);
	g_assert_no_error(error);
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(m, &chunks);
	g_autofree bool *known = g_new0(bool, SEGMENTS_MAX + 1);
	unsigned leaves = 0;
	for (uint64_t i = 0; i < chunks; i++) {
		g_assert_true(segments_find(tree, c[i].leaf) && segments_is_leaf(tree, c[i].leaf));
		leaves += !known[c[i].leaf];
		known[c[i].leaf] = true;
		for (uint32_t n = 0; n < c[i].points; n++)
			g_assert_cmpuint(model_points(m)[c[i].first + n].leaf, ==, c[i].leaf);
	}
	g_assert_cmpuint(leaves, >, 10);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/segment-site/leaves", test_leaves);
	g_test_add_func("/segment-site/due", test_due);
	g_test_add_func("/segment-site/parameters", test_parameters);
	g_test_add_func("/segment-site/points-min", test_points_min);
	g_test_add_func("/segment-site/bad-parameters", test_bad_parameters);
	g_test_add_func("/segment-site/stopped", test_stopped);
	g_test_add_func("/segment-site/damaged", test_damaged);
	g_test_add_func("/segment-site/other-labels", test_other_labels);
	g_test_add_func("/segment-site/strangers", test_strangers);
	g_test_add_func("/segment-site/threads", test_threads);
	g_test_add_func("/segment-site/no-geometry", test_no_geometry);
	g_test_add_func("/segment-site/alone", test_alone);
	g_test_add_func("/segment-site/empty", test_empty);
	g_test_add_func("/segment-site/model", test_model);
	return g_test_run();
}
