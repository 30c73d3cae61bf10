/* Segments of a site that are found anew, as after another scan: what is the same keeps its number and its name, no number or name of
 * what is gone is given to anything else, and files that say the same stay. */
#define STATIONS 4
#include "process/model-inputs.h"
#include "process/segment-things.h"
#include "tests/segmented-site.h"
#include <glib/gstdio.h>
#include <omp.h>
#include <string.h>

/* ---- two results, compared ---- */

/* Points of scans of both, by node, and of what two nodes have in common. */
struct both {
	segments *was, *now;
	uint64_t was_points[SEGMENTS_MAX + 1], now_points[SEGMENTS_MAX + 1];
	GHashTable *common; /* was << 16 | now */
};

static struct both *both_new(const char *was, const char *now, uint32_t scans)
{
	struct both *b = g_new0(struct both, 1);
	b->was = segments_load(was, NULL);
	b->now = segments_load(now, NULL);
	b->common = g_hash_table_new(NULL, NULL);
	for (uint32_t scan = 1; scan <= scans; scan++) {
		uint64_t count, other;
		g_autofree uint16_t *x = labels_in(was, scan, &count),
				    *y = labels_in(now, scan, &other);
		g_assert_cmpuint(count, ==, other);
		for (uint64_t i = 0; i < count; i++) {
			for (uint32_t p = x[i]; p >= SEGMENT_FIRST;
				p = segments_find(b->was, p)->parent)
				b->was_points[p]++;
			for (uint32_t q = y[i]; q >= SEGMENT_FIRST;
				q = segments_find(b->now, q)->parent) {
				b->now_points[q]++;
				for (uint32_t p = x[i]; p >= SEGMENT_FIRST;
					p = segments_find(b->was, p)->parent) {
					gpointer k = GUINT_TO_POINTER(p << 16 | q);
					gsize n =
						GPOINTER_TO_SIZE(g_hash_table_lookup(b->common, k));
					g_hash_table_insert(b->common, k, GSIZE_TO_POINTER(n + 1));
				}
			}
		}
	}
	return b;
}

static void both_free(struct both *b)
{
	segments_free(b->was);
	segments_free(b->now);
	g_hash_table_unref(b->common);
	g_free(b);
}
typedef struct both both;
G_DEFINE_AUTOPTR_CLEANUP_FUNC(both, both_free)

static double share_of(const struct both *b, uint32_t was, uint32_t now)
{
	double common = (double)GPOINTER_TO_SIZE(
		g_hash_table_lookup(b->common, GUINT_TO_POINTER(was << 16 | now)));
	return common / ((double)b->was_points[was] + (double)b->now_points[now] - common);
}

static bool is_part(const struct segment *node)
{
	return node->parent >= SEGMENT_FIRST;
}

/* Whether they can be the same: two things, two parts, or what is left over of one class. */
static bool are_of_a_kind(const struct segment *x, const struct segment *y)
{
	bool rest = segment_things_is_rest(x);
	if (rest != segment_things_is_rest(y))
		return false;
	return rest ? x->class == y->class : is_part(x) == is_part(y);
}

struct kept {
	unsigned same, kept, gone, new, named;
};

/* Without its number. */
static char *kind_of(const struct segment *node)
{
	g_autofree char *kind = g_strdup(node->name);
	size_t end = strlen(kind);
	while (end && g_ascii_isdigit(kind[end - 1]))
		end--;
	return g_strdup_printf("%u %.*s", node->parent, (int)end, kind);
}

static bool are_called_the_same(const struct segment *x, const struct segment *y)
{
	return x->parent == y->parent && strcmp(x->name, y->name) == 0;
}

/* The same of the same kind is called the same; no two are, and nothing is called as another thing was. Returns how many have kept
 * a name. */
static unsigned check_names(const struct both *b)
{
	unsigned kept = 0;
	for (guint i = 0; i < b->now->nodes->len; i++) {
		const struct segment *y = &g_array_index(b->now->nodes, struct segment, i);
		const struct segment *x = segments_find(b->was, y->id);
		g_autofree char *is = kind_of(y), *had = x ? kind_of(x) : NULL;
		if (y->id < SEGMENT_FIRST)
			continue;
		if (had && strcmp(is, had) == 0)
			g_assert_cmpstr(y->name, ==, x->name);
		kept += had && strcmp(is, had) == 0 && !segment_things_is_rest(y);
		for (guint n = 0; n < i; n++)
			g_assert_false(are_called_the_same(
				y, &g_array_index(b->now->nodes, struct segment, n)));
		for (guint n = 0; n < b->was->nodes->len; n++) {
			const struct segment *other =
				&g_array_index(b->was->nodes, struct segment, n);
			g_assert_false(other->id != y->id && are_called_the_same(y, other) &&
				       g_ascii_isdigit(y->name[strlen(y->name) - 1]));
		}
	}
	return kept;
}

static struct kept check_kept(const struct both *b)
{
	struct kept k = { 0 };
	for (guint i = 0; i < b->now->nodes->len; i++) {
		const struct segment *y = &g_array_index(b->now->nodes, struct segment, i);
		if (y->id < SEGMENT_FIRST)
			continue;
		for (guint n = 0; n < b->was->nodes->len; n++) {
			const struct segment *x = &g_array_index(b->was->nodes, struct segment, n);
			if (x->id < SEGMENT_FIRST || !are_of_a_kind(x, y) ||
				!(share_of(b, x->id, y->id) > 0.5))
				continue;
			k.same++;
			k.kept += x->id == y->id;
		}
		const struct segment *before = segments_find(b->was, y->id);
		k.new += !before;
		/* what has a number of before is what had it; what has none, one that none had */
		if (!before)
			g_assert_cmpuint(y->id, >=, b->was->next);
		else if (!segment_things_is_rest(before))
			g_assert_cmpfloat(share_of(b, y->id, y->id), >, 0.33);
		else
			g_assert_true(are_of_a_kind(before, y));
	}
	for (guint n = 0; n < b->was->nodes->len; n++)
		k.gone +=
			!segments_find(b->now, g_array_index(b->was->nodes, struct segment, n).id);
	g_assert_cmpuint(b->now->next, >=, b->was->next);
	k.named = check_names(b);
	g_test_message("%u of %u that are the same by half keep their numbers; %u are gone, %u "
		       "new; %u keep their names",
		k.kept, k.same, k.gone, k.new, k.named);
	g_assert_cmpuint(k.kept, ==, k.same);
	return k;
}

/* ---- tests ---- */

static char *sum_of_file(const char *path, const char *name)
{
	g_autofree char *file = g_build_filename(path, "segments", name, NULL), *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
	return g_compute_checksum_for_data(G_CHECKSUM_SHA256, (guchar *)bytes, length);
}

static void test_fourth_scan(void)
{
	g_autofree char *path = fresh_site(), *was = NULL, *twin = NULL, *from_nothing = NULL;
	g_autoptr(scan_graph) three = graph_of(3), four = graph_of(4);
	segment(path, three);
	was = copy_of(path);
	twin = copy_of(path);
	segment(path, four);
	check_leaves(path, four);
	g_autoptr(both) b = both_new(was, path, 3);
	struct kept k = check_kept(b);
	g_assert_cmpuint(k.same, >=, 40);
	g_assert_cmpuint(k.named, >=, 40);
	/* from nothing, numbers are others */
	from_nothing = fresh_site();
	segment(from_nothing, four);
	g_autoptr(both) other = both_new(was, from_nothing, 3);
	unsigned same = 0;
	for (uint32_t id = SEGMENT_FIRST; id <= SEGMENTS_MAX; id++)
		same += b->was_points[id] && share_of(other, id, id) > 0.5;
	g_test_message("%u without the numbers of before", same);
	g_assert_cmpuint(same, <, k.same / 2);
	/* the same from the same, on any number of threads */
	int threads = omp_get_max_threads();
	omp_set_num_threads(3);
	segment(twin, four);
	omp_set_num_threads(threads);
	static const char *const names[] = { "automatic.json", "segments.json", "0001.segments",
		"0004.segments" };
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++) {
		g_autofree char *x = sum_of_file(path, names[i]), *y = sum_of_file(twin, names[i]);
		g_assert_cmpstr(x, ==, y);
	}
}

/* Scan by scan, forth and back: numbers that are gone do not come back for anything else. */
static void test_one_by_one(void)
{
	static const int counts[] = { 1, 2, 3, 4, 2, 4, 1 };
	g_autofree char *path = fresh_site();
	g_autofree bool *is_gone = g_new0(bool, SEGMENTS_MAX + 1);
	for (size_t i = 0; i < G_N_ELEMENTS(counts); i++) {
		g_autofree char *was = copy_of(path);
		g_autoptr(scan_graph) g = graph_of(counts[i]);
		segment(path, g);
		if (!i)
			continue;
		g_autoptr(both) b = both_new(was, path, (uint32_t)MIN(counts[i - 1], counts[i]));
		check_kept(b);
		for (uint32_t id = SEGMENT_FIRST; id <= SEGMENTS_MAX; id++) {
			g_assert_false(is_gone[id] && segments_find(b->now, id));
			is_gone[id] |= segments_find(b->was, id) && !segments_find(b->now, id);
		}
	}
}

static void test_gap(void)
{
	static const char *const gaps_m[] = { "0.2", "0.3", NULL };
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(3);
	segment(path, g);
	for (size_t i = 0; i < G_N_ELEMENTS(gaps_m); i++) {
		g_autofree char *was = copy_of(path);
		set(path, "segmentation", NULL);
		if (gaps_m[i])
			set(path, "segmentation.gap_m", gaps_m[i]);
		segment(path, g);
		check_leaves(path, g);
		g_autoptr(both) b = both_new(was, path, 3);
		g_assert_cmpuint(check_kept(b).same, >=, 20);
	}
}

/* ---- files ---- */

struct file_state {
	uint64_t inode;
	uint32_t checksum;
};

static struct file_state state_of(const char *path, uint32_t scan)
{
	g_autoptr(site) s = site_open(path, NULL);
	g_autoptr(scan_segments) l = scan_segments_open(s, scan, NULL);
	GStatBuf at;
	g_assert_cmpint(g_stat(product_path(l->file), &at), ==, 0);
	return (struct file_state){ at.st_ino, product_checksum(l->file) };
}

static void assert_untouched(const char *path, uint32_t scan, const struct file_state *was)
{
	struct file_state now = state_of(path, scan);
	g_assert_cmpuint(now.inode, ==, was->inode);
	g_assert_cmpuint(now.checksum, ==, was->checksum);
}

/* A parameter that changes nothing here; other things are found, but no file is written. */
static void test_same_labels(void)
{
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) g = graph_of(3);
	struct file_state was[4];
	segment(path, g);
	for (uint32_t scan = 1; scan <= 3; scan++)
		was[scan] = state_of(path, scan);
	set(path, "segmentation.labels", "false");
	expect_why(path, g, "scans, or how to tell things apart, have changed");
	segment(path, g);
	expect_why(path, g, NULL);
	for (uint32_t scan = 1; scan <= 3; scan++)
		assert_untouched(path, scan, &was[scan]);
}

/* A scan that is added far away leaves the files of the others alone, though it has the largest things of all. */
static void test_far_scan(void)
{
	g_autofree char *path = fresh_site();
	g_autoptr(scan_graph) two = graph_of(2), four = graph_of(4);
	struct file_state was[3];
	for (int k = 2; k < 4; k++)
		for (int axis = 0; axis < 2; axis++)
			g_array_index(four->scans, struct placed_scan, k)
				.pose.translation_m[axis] += 400;
	segment(path, two);
	for (uint32_t scan = 1; scan <= 2; scan++)
		was[scan] = state_of(path, scan);
	segment(path, four);
	check_leaves(path, four);
	for (uint32_t scan = 1; scan <= 2; scan++)
		assert_untouched(path, scan, &was[scan]);
	/* so neither are the parts of the model that have these points */
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(model_inputs) inputs = model_inputs_new(s, four, &error);
	g_assert_no_error(error);
	g_autofree char *key = g_strdup(model_inputs_at(inputs, 0)->part_key);
	g_autofree char *third = g_strdup(model_inputs_at(inputs, 2)->part_key);
	g_clear_pointer(&s, site_free);
	segment(path, two);
	s = site_open(path, &error);
	g_autoptr(model_inputs) less = model_inputs_new(s, two, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(model_inputs_at(less, 0)->part_key, ==, key);
	g_assert_cmpstr(third, !=, key);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/segments-anew/fourth-scan", test_fourth_scan);
	g_test_add_func("/segments-anew/one-by-one", test_one_by_one);
	g_test_add_func("/segments-anew/gap", test_gap);
	g_test_add_func("/segments-anew/same-labels", test_same_labels);
	g_test_add_func("/segments-anew/far-scan", test_far_scan);
	return g_test_run();
}
