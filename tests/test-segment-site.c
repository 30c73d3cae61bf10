/* The segments of whole sites: when they are due, that they come to the same however they are made, that each point has one leaf, and
 * what sites they are made of. */
#include "acquire/manifest.h"
#include "firmware-io/files.h"
#include "process/build-model.h"
#include "process/scan-geometry.h"
#include "process/scan-points.h"
#include "process/segment-site.h"
#include "tests/import-made.h"
#include "tests/placed-scans.h"
#include <omp.h>
#include <stdlib.h>

#define STATIONS 3
#define SCENE    "court?seed=21&ares=360&camera=none&divergence_mrad=0&station=%d"

/* ---- sites ---- */

static struct pose true_pose[STATIONS + 1];

static void scan_station(const char *path, int station)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *description = g_strdup_printf(SCENE, station);
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	simulated_scan(path, description, &options, NULL, NULL, &result, &partial, &error);
	g_assert_no_error(error);
	true_pose[station] = true_pose_of(description);
}

/* After the site was made: it tells the poses. */
static scan_graph *graph_of(int scans)
{
	g_assert_cmpfloat(true_pose[1].rotation[2][2], >, 0);
	scan_graph *g = scan_graph_new();
	for (int k = 1; k <= scans; k++) {
		struct placed_scan p = { .number = (uint32_t)k,
			.group = 1,
			.pose = k <= STATIONS ? true_pose[k] : POSE_IDENTITY };
		g_array_append_val(g->scans, p);
	}
	return g;
}

static char *copy_of(const char *path)
{
	g_autofree char *folder = simulated_folder();
	char *copy = g_build_filename(folder, "site", NULL);
	g_autofree char *command = g_strdup_printf("cp -a '%s' '%s'", path, copy);
	g_assert_cmpint(system(command), ==, 0);
	return copy;
}

/* A copy of a site with STATIONS scans and their geometry; caller frees. */
static char *fresh_site(void)
{
	static char *made;
	if (!made) {
		g_autoptr(GError) error = NULL;
		g_autofree char *folder = simulated_folder();
		made = g_build_filename(folder, "site", NULL);
		for (int k = 1; k <= STATIONS; k++)
			scan_station(made, k);
		g_autoptr(site) s = site_open_existing(made, &error);
		g_autoptr(scan_graph) g = graph_of(STATIONS);
		uint32_t count;
		geometry_site(s, g, NULL, &count, &error);
		g_assert_no_error(error);
	}
	return copy_of(made);
}

static struct segment_site_result segment(const char *path, const scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	g_assert_no_error(error);
	struct segment_site_result result = { 0 };
	g_assert_true(segment_site(s, g, NULL, &result, &error));
	g_assert_no_error(error);
	return result;
}

static void expect_why(const char *path, const scan_graph *g, const char *wanted)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *why = NULL;
	g_autoptr(site) s = site_open(path, &error);
	bool due = false;
	g_assert_true(segment_site_is_due(s, g, &due, &why, &error));
	g_assert_no_error(error);
	g_assert_cmpstr(why, ==, wanted);
	g_assert_true(due == (why != NULL));
}

static void set(const char *path, const char *key, const char *value)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	site_set(s, key, value ? json_from_string(value, NULL) : NULL, &error);
	g_assert_no_error(error);
}

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

/* Of the whole site at once. */
static const char *whole_sum(void)
{
	static char *sum;
	if (!sum) {
		g_autofree char *path = fresh_site();
		g_autoptr(scan_graph) g = graph_of(STATIONS);
		segment(path, g);
		sum = sum_of(path);
	}
	return sum;
}

static void assert_whole(const char *path)
{
	g_autofree char *sum = sum_of(path);
	g_assert_cmpstr(sum, ==, whole_sum());
}

/* ---- what is in them ---- */

struct checked {
	uint64_t *points; /* by leaf */
	const segments *tree;
};

static void check_point(struct checked *c, const struct scan_points *p, uint64_t i, uint32_t leaf)
{
	double at[3];
	const struct segment *node = segments_find(c->tree, leaf);
	g_assert_true(node && segments_is_leaf(c->tree, leaf));
	scan_points_position(p, i, at);
	for (int k = 0; k < 3; k++) /* the file has millimetres */
		g_assert_true(at[k] > node->low_m[k] - 0.001 && at[k] < node->high_m[k] + 0.001);
	c->points[leaf]++;
}

/* Every point has exactly one leaf that exists, in its box; the sums are right all the way up. */
static void check_leaves(const char *path, const scan_graph *g)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(segments) tree = segments_load(path, &error);
	g_assert_no_error(error);
	g_autofree uint64_t *sum = g_new0(uint64_t, SEGMENTS_MAX + 1);
	struct checked c = { sum, tree };
	uint64_t all = 0;
	for (guint n = 0; n < g->scans->len; n++) {
		const struct placed_scan *placed = &g_array_index(g->scans, struct placed_scan, n);
		g_autoptr(scan_data) d = scan_data_load(s, placed->number, &error);
		g_autoptr(scan_segments) labels = scan_segments_open(s, placed->number, &error);
		g_assert_no_error(error);
		g_assert_true(product_verify(labels->file, &error));
		struct scan_points p =
			scan_points_of(d, NULL, placed->group ? &placed->pose : &POSE_IDENTITY);
		g_assert_cmpuint(labels->count, ==, p.count);
		g_assert_cmpmem(labels->leaf, 2 * p.count, labels->automatic, 2 * p.count);
		for (uint64_t i = 0; i < p.count; i++) {
			g_assert_true((labels->leaf[i] != SEGMENT_NONE) == scan_points_has(&p, i));
			if (labels->leaf[i] == SEGMENT_NONE)
				continue;
			all++;
			check_point(&c, &p, i, labels->leaf[i]);
		}
	}
	g_assert_cmpuint(segments_find(tree, SEGMENT_SITE)->points, ==, all);
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		uint64_t below = 0;
		for (uint32_t leaf = 1; leaf <= SEGMENTS_MAX; leaf++)
			if (sum[leaf] && segments_is_above(tree, node->id, leaf))
				below += sum[leaf];
		g_assert_cmpuint(node->points, ==, below);
		g_assert_true(node->id < SEGMENT_FIRST || node->points);
	}
}

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
	assert_whole(path);
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
	assert_whole(path);
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

static void damage(const char *path, const char *name, bool remove)
{
	g_autofree char *file = g_build_filename(path, "segments", name, NULL), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
	if (remove)
		g_assert_cmpint(g_unlink(file), ==, 0);
	else
		g_assert_true(g_file_set_contents(file, bytes, (gssize)(length * 2 / 3), NULL));
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
	for (size_t i = 0; i < 2 * G_N_ELEMENTS(cases); i++) {
		damage(path, cases[i / 2].file, i % 2);
		expect_why(path, g, i % 2 ? cases[i / 2].why_gone : cases[i / 2].why);
		segment(path, g);
		expect_why(path, g, NULL);
		assert_whole(path);
	}
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

/* ---- a room of 5 x 7 x 3 m, exactly, as PTX ---- */

#define ROOM_COLUMNS 720
#define ROOM_ROWS    280
static const double room_m[3] = { 5, 7, 3 };
#define ROOM_AREA_M2 (2 * (5.0 * 7 + 5 * 3 + 7 * 3))

/* One scan, without the cap right below the tripod and above it. */
static void write_room(GString *to, double x, double y)
{
	const double eye[3] = { x, y, 1.6 };
	g_string_append_printf(to,
		"%d\n%d\n%g %g %g\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n%g %g %g 1\n",
		ROOM_COLUMNS, ROOM_ROWS, eye[0], eye[1], eye[2], eye[0], eye[1], eye[2]);
	for (int column = 0; column < ROOM_COLUMNS; column++)
		for (int row = 0; row < ROOM_ROWS; row++) {
			double azimuth = (column + 0.5) * 2 * G_PI / ROOM_COLUMNS,
			       up = ((row + 0.5) / ROOM_ROWS - 0.5) * 0.94 * G_PI;
			double d[3] = { sin(azimuth) * cos(up), cos(azimuth) * cos(up), sin(up) },
			       far = INFINITY;
			for (int k = 0; k < 3; k++)
				far = fmin(far, ((d[k] > 0 ? room_m[k] : 0) - eye[k]) / d[k]);
			g_string_append_printf(
				to, "%.5f %.5f %.5f 0.5\n", far * d[0], far * d[1], far * d[2]);
		}
}

static double area_of_room(int scans, bool geometry)
{
	struct place at = place_new();
	g_autoptr(GString) text = g_string_new(NULL);
	g_autoptr(GError) error = NULL;
	for (int k = 0; k < scans; k++)
		write_room(text, 1.8 + 1.4 * k, 2.5 + 2.1 * k);
	g_autofree char *file = place_write(&at, "room.ptx", text->str, text->len);
	g_array_unref(place_import(&at, file));
	g_autoptr(scan_graph) g = scan_graph_new();
	g_autoptr(GArray) given = scan_graph_given(at.site, &error);
	g_assert_cmpuint(given->len, ==, scans);
	for (guint i = 0; i < given->len; i++) {
		const struct scan_given *in = &g_array_index(given, struct scan_given, i);
		struct placed_scan p = { .number = in->number, .group = 1, .pose = in->pose };
		g_array_append_val(g->scans, p);
	}
	uint32_t made;
	struct segment_site_result r;
	if (geometry)
		geometry_site(at.site, g, NULL, &made, &error);
	g_assert_no_error(error);
	segment_site(at.site, g, NULL, &r, &error);
	g_assert_no_error(error);
	check_leaves(at.site_path, g);
	g_autoptr(segments) tree = segments_load(at.site_path, &error);
	const struct segment *whole = segments_find(tree, SEGMENT_SITE),
			     *floor = segments_find(tree, segment_of_class(CLASS_TERRAIN));
	double area = whole->area_m2;
	g_test_message("%d scans: %.1f of %.1f m2, its floor %.1f of 35", scans, area, ROOM_AREA_M2,
		floor->area_m2);
	for (int k = 0; k < 3; k++)
		g_assert_cmpfloat(fabs(whole->high_m[k] - whole->low_m[k] - room_m[k]), <, 0.01);
	if (geometry)
		g_assert_cmpfloat(fabs(floor->area_m2 - 35), <, 3.5);
	place_clear(&at);
	return area;
}

/* Each surface counts once, however many scans saw it. */
static void test_area(void)
{
	double one = area_of_room(1, true), two = area_of_room(2, true);
	g_assert_cmpfloat(fabs(one - ROOM_AREA_M2), <, 0.1 * ROOM_AREA_M2);
	g_assert_cmpfloat(fabs(two - ROOM_AREA_M2), <, 0.1 * ROOM_AREA_M2);
	/* without normals, as if all faced the scanner */
	double least = area_of_room(1, false);
	g_assert_cmpfloat(least, >, 0.5 * ROOM_AREA_M2);
	g_assert_cmpfloat(least, <, ROOM_AREA_M2);
}

/* ---- classes that came with the points ---- */

#define PUT(b, at, type, value) memcpy((b)->data + (at), &(type){ value }, sizeof(type))

/* LAS 1.2, format 0: a level field of 80 x 80 points, 0.5 m apart, whose classes go around. */
static GByteArray *las_field(const uint8_t *classes, unsigned count)
{
	enum { SIDE = 80, HEADER = 227, RECORD = 20 };
	GByteArray *b = g_byte_array_new();
	g_byte_array_set_size(b, HEADER + RECORD * SIDE * SIDE);
	memset(b->data, 0, b->len);
	memcpy(b->data, "LASF", 4);
	b->data[24] = 1;
	b->data[25] = 2;
	PUT(b, 94, uint16_t, HEADER);
	PUT(b, 96, uint32_t, HEADER);
	PUT(b, 105, uint16_t, RECORD);
	PUT(b, 107, uint32_t, SIDE * SIDE);
	for (int axis = 0; axis < 3; axis++)
		PUT(b, 131 + 8 * axis, double, 0.001);
	for (int i = 0; i < SIDE * SIDE; i++) {
		size_t at = HEADER + (size_t)RECORD * (size_t)i;
		PUT(b, at, int32_t, 500 * (i % SIDE));
		PUT(b, at + 4, int32_t, 500 * (i / SIDE));
		b->data[at + 14] = 9;
		b->data[at + 15] = classes[(unsigned)i % count];
	}
	return b;
}

/* With labels, each point is of the class that its file tells, where that tells one; without, all of a field is ground. */
static void test_labels(void)
{
	static const uint8_t classes[] = { 2, 6, 5, 1, 9, 7, 12, 17, 0 };
	static const int wanted[] = { CLASS_TERRAIN, CLASS_BUILDING, CLASS_VEGETATION,
		CLASS_TERRAIN, CLASS_WATER, CLASS_OTHER, CLASS_TERRAIN, CLASS_STRUCTURE,
		CLASS_TERRAIN };
	struct place at = place_new();
	g_autoptr(GError) error = NULL;
	g_autoptr(GByteArray) las = las_field(classes, G_N_ELEMENTS(classes));
	g_autofree char *file = place_write(&at, "field.las", las->data, las->len);
	g_array_unref(place_import(&at, file));
	g_autoptr(scan_graph) g = scan_graph_new();
	struct placed_scan p = { .number = 1, .group = 1, .pose = POSE_IDENTITY };
	g_array_append_val(g->scans, p);
	uint32_t made;
	geometry_site(at.site, g, NULL, &made, &error);
	g_assert_no_error(error);
	for (int labels = 1; labels >= 0; labels--) {
		struct segment_site_result r;
		site_set(at.site, "segmentation.labels",
			json_node_init_boolean(json_node_alloc(), labels), &error);
		segment_site(at.site, g, NULL, &r, &error);
		g_assert_no_error(error);
		check_leaves(at.site_path, g);
		g_autoptr(segments) tree = segments_load(at.site_path, &error);
		g_autoptr(scan_segments) s = scan_segments_open(at.site, 1, &error);
		g_autoptr(points) cloud = place_points(&at, 1);
		for (uint64_t i = 0; i < s->count; i++) {
			size_t k = 0;
			while (classes[k] != cloud->record[i].classification)
				k++;
			g_assert_cmpint(segments_find(tree, s->leaf[i])->class, ==,
				labels ? wanted[k] : CLASS_TERRAIN);
		}
	}
	place_clear(&at);
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
	g_test_add_func("/segment-site/strangers", test_strangers);
	g_test_add_func("/segment-site/threads", test_threads);
	g_test_add_func("/segment-site/no-geometry", test_no_geometry);
	g_test_add_func("/segment-site/alone", test_alone);
	g_test_add_func("/segment-site/empty", test_empty);
	g_test_add_func("/segment-site/model", test_model);
	g_test_add_func("/segment-site/area", test_area);
	g_test_add_func("/segment-site/labels", test_labels);
	return g_test_run();
}
