/* The tree of segments: what it answers, and its file: what was saved comes back, what is no tree is refused in a sentence. */
#include "acquire/manifest.h"
#include "firmware-io/files.h"
#include "process/segments.h"
#include "tests/simulated.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

static char *site_folder;

/* Two trees, a house of two parts. */
static segments *make(void)
{
	static const double low[3] = { -1.5, 2, 0 }, high[3] = { 3, 4.25, 6 },
			    low2[3] = { 0, -7, 1 }, high2[3] = { 1, 9, 2 };
	segments *s = segments_new();
	uint32_t vegetation = segment_of_class(CLASS_VEGETATION);
	uint32_t tree = segments_add(s, vegetation, "Tree 1", "rules");
	segments_add(s, vegetation, "Tree \"2\" ä", "labels");
	uint32_t house = segments_add(s, segment_of_class(CLASS_BUILDING), "Building 1", "rules");
	uint32_t wall = segments_add(s, house, "Wall 1", "rules");
	segments_add(s, house, "Details", "user");
	segments_find(s, tree)->found = 77;
	segments_add_labels(s, 3, 0xDEADBEEF);
	segments_add_labels(s, 7, 0);
	s->next = 99;
	segments_count(s, tree, 100, low, high, 12.5);
	segments_count(s, wall, 11, low2, high2, 2.25);
	g_free(s->key);
	s->key = g_strdup("abc");
	g_free(s->edits);
	s->edits = g_strdup("1 2 5");
	return s;
}

static void test_tree(void)
{
	g_autoptr(segments) s = make();
	uint32_t tree = SEGMENT_FIRST, house = tree + 2, wall = tree + 3, details = tree + 4;
	g_assert_cmpint(segments_find(s, wall)->class, ==, CLASS_BUILDING);
	g_assert_null(segments_find(s, 99));
	g_assert_null(segments_find(s, 0));
	g_assert_true(segments_is_leaf(s, wall) && segments_is_leaf(s, tree));
	g_assert_false(segments_is_leaf(s, house) || segments_is_leaf(s, SEGMENT_SITE));
	g_assert_true(segments_is_above(s, SEGMENT_SITE, wall));
	g_assert_true(segments_is_above(s, segment_of_class(CLASS_BUILDING), wall));
	g_assert_true(segments_is_above(s, wall, wall));
	g_assert_false(segments_is_above(s, wall, house));
	g_assert_false(segments_is_above(s, house, tree));
	g_assert_false(segments_is_above(s, house, 99));
	g_autofree char *name = segments_name(s, wall), *class = segments_name(s, 3),
			*whole = segments_name(s, 1), *none = segments_name(s, 99);
	g_assert_cmpstr(name, ==, "Buildings / Building 1 / Wall 1");
	g_assert_cmpstr(class, ==, "Buildings");
	g_assert_cmpstr(whole, ==, "Site");
	g_assert_cmpstr(none, ==, "");
	/* numbers below the last stay free, so that a number means one thing */
	segments_remove(s, tree + 1);
	g_assert_null(segments_find(s, tree + 1));
	g_assert_cmpuint(segments_add(s, house, "Roof", "user"), ==, 99);
	g_assert_cmpuint(s->next, ==, 100);
	segments_remove(s, wall);
	g_assert_false(segments_is_leaf(s, house));
	g_assert_cmpuint(segments_find(s, details)->parent, ==, house);
}

static void test_sums(void)
{
	g_autoptr(segments) s = make();
	const struct segment *whole = segments_find(s, SEGMENT_SITE);
	g_assert_cmpuint(whole->points, ==, 111);
	g_assert_cmpfloat(whole->area_m2, ==, 14.75);
	g_assert_cmpfloat(whole->low_m[1], ==, -7);
	g_assert_cmpfloat(whole->high_m[2], ==, 6);
	g_assert_cmpuint(segments_find(s, segment_of_class(CLASS_BUILDING))->points, ==, 11);
	g_assert_cmpuint(segments_find(s, segment_of_class(CLASS_WATER))->points, ==, 0);
	segments_clear_sums(s);
	for (guint i = 0; i < s->nodes->len; i++) {
		const struct segment *node = &g_array_index(s->nodes, struct segment, i);
		g_assert_cmpuint(node->points, ==, 0);
		g_assert_true(node->low_m[0] > node->high_m[0]);
	}
}

static void test_full(void)
{
	g_autoptr(segments) s = segments_new();
	for (uint32_t i = SEGMENT_FIRST; i <= SEGMENTS_MAX; i++)
		g_assert_cmpuint(segments_add(s, 2, "Thing", "rules"), ==, i);
	g_assert_cmpuint(segments_add(s, 2, "Thing", "rules"), ==, 0);
	/* all were used once; what is free may be used again then, and only then */
	segments_remove(s, 500);
	segments_remove(s, SEGMENTS_MAX);
	g_assert_cmpuint(segments_add(s, 2, "Thing", "rules"), ==, 500);
	g_assert_cmpuint(segments_add(s, 2, "Thing", "rules"), ==, SEGMENTS_MAX);
	g_assert_cmpuint(segments_add(s, 2, "Thing", "rules"), ==, 0);
	for (guint i = 1; i < s->nodes->len; i++)
		g_assert_cmpuint(g_array_index(s->nodes, struct segment, i).id, >,
			g_array_index(s->nodes, struct segment, i - 1).id);
}

static void test_renumber(void)
{
	g_autoptr(segments) s = make();
	g_autofree uint16_t *becomes = g_new0(uint16_t, SEGMENTS_MAX + 1);
	uint32_t tree = SEGMENT_FIRST, house = tree + 2, wall = tree + 3, details = tree + 4;
	becomes[tree] = 400;
	becomes[tree + 1] = (uint16_t)details;
	becomes[house] = 300;
	becomes[wall] = (uint16_t)tree;
	becomes[details] = 299;
	segments_renumber(s, becomes);
	g_assert_cmpstr(segments_find(s, 400)->name, ==, "Tree 1");
	g_assert_cmpuint(segments_find(s, 400)->points, ==, 100);
	g_assert_cmpuint(segments_find(s, 400)->parent, ==, segment_of_class(CLASS_VEGETATION));
	g_assert_cmpuint(segments_find(s, tree)->parent, ==, 300);
	g_assert_cmpuint(segments_find(s, 299)->parent, ==, 300);
	g_assert_cmpstr(segments_find(s, details)->name, ==, "Tree \"2\" ä");
	g_assert_null(segments_find(s, house));
	g_assert_cmpuint(s->next, ==, 401);
	g_assert_cmpuint(segments_add(s, 300, "Roof", "user"), ==, 401);
}

static void assert_equal(const segments *a, const segments *b)
{
	g_assert_cmpstr(a->key, ==, b->key);
	g_assert_cmpstr(a->edits, ==, b->edits);
	g_assert_cmpuint(a->next, ==, b->next);
	g_assert_cmpmem(a->labels->data, a->labels->len * sizeof(struct labels_checksum),
		b->labels->data, b->labels->len * sizeof(struct labels_checksum));
	g_assert_cmpuint(a->nodes->len, ==, b->nodes->len);
	for (guint i = 0; i < a->nodes->len; i++) {
		const struct segment *p = &g_array_index(a->nodes, struct segment, i),
				     *q = &g_array_index(b->nodes, struct segment, i);
		g_assert_cmpuint(p->id, ==, q->id);
		g_assert_cmpuint(p->parent, ==, q->parent);
		g_assert_cmpuint(p->found, ==, q->found);
		g_assert_cmpint(p->class, ==, q->class);
		g_assert_cmpstr(p->name, ==, q->name);
		g_assert_cmpstr(p->made_by, ==, q->made_by);
		g_assert_cmpuint(p->points, ==, q->points);
		g_assert_cmpfloat(p->area_m2, ==, q->area_m2);
		g_assert_cmpmem(p->low_m, sizeof p->low_m, q->low_m, sizeof q->low_m);
		g_assert_cmpmem(p->high_m, sizeof p->high_m, q->high_m, sizeof q->high_m);
	}
}

static void test_round_trip(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) s = make();
	g_autoptr(segments) copy = segments_copy(s);
	assert_equal(s, copy);
	segments_save(s, site_folder, &error);
	g_assert_no_error(error);
	g_autoptr(segments) back = segments_load(site_folder, &error);
	g_assert_no_error(error);
	assert_equal(s, back);
	g_assert_true(segments_has_labels(back, 3, 0xDEADBEEF) && segments_has_labels(back, 7, 0));
	g_assert_false(segments_has_labels(back, 3, 0) || segments_has_labels(back, 4, 0));
}

static void test_missing(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *nowhere = g_build_filename(site_folder, "nowhere", NULL);
	g_assert_null(segments_load(nowhere, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
}

/* ---- what is refused ---- */

static char *text_of_made(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) s = make();
	g_autofree char *path = segments_path(site_folder);
	char *text;
	segments_save(s, site_folder, &error);
	g_assert_no_error(error);
	g_file_get_contents(path, &text, NULL, &error);
	g_assert_no_error(error);
	return text;
}

/* In the object of segment id, or in the whole file (id 0): key becomes value, or goes when that is NULL. */
static void change(JsonObject *file, gint64 id, const char *key, const char *value)
{
	JsonArray *list = json_object_get_array_member(file, "segments");
	JsonObject *o = file;
	for (guint i = 0; id && i < json_array_get_length(list); i++) {
		JsonObject *at = json_array_get_object_element(list, i);
		o = json_object_get_int_member(at, "id") == id ? at : o;
	}
	json_object_remove_member(o, key);
	if (value)
		json_object_set_member(o, key, json_from_string(value, NULL));
}

static const struct refusal {
	gint64 id;
	const char *key, *value, *words;
} refusals[] = {
	{ 16, "parent", "99", "segment 8 of the list does not belong to the site" },
	{ 16, "parent", "0", "segment 8 of the list does not belong to the site" },
	{ 16, "parent", "16", "segment 8 of the list does not belong to the site" },
	{ 18, "parent", "19", "segment 10 of the list does not belong to the site" },
	{ 16, "parent", "-1", "segment 8 of the list has no 'id', 'parent'" },
	{ 16, "parent", "2.5", "segment 8 of the list has no 'id', 'parent'" },
	{ 16, "parent", "\"2\"", "segment 8 of the list has no 'id', 'parent'" },
	{ 16, "parent", NULL, "segment 8 of the list has no 'id', 'parent'" },
	{ 1, "parent", "4", "segment 1 of the list" }, /* the site below one of its classes */
	{ 17, "id", "16", "segment 9 of the list has not a larger number" },
	{ 17, "id", "16.5", "segment 9 of the list has no 'id'" },
	{ 17, "id", "70000", "segment 9 of the list has no 'id'" },
	{ 17, "id", "0", "segment 9 of the list has not a larger number" },
	{ 17, "id", NULL, "segment 9 of the list has no 'id'" },
	{ 5, "id", "6", "segment 6 of the list has not a larger number" },
	{ 7, "id", "9", "the class water is missing" },
	{ 16, "class", "\"bird\"", "segment 8 of the list has no class that there is" },
	{ 16, "class", "4", "segment 8 of the list has no class that there is" },
	{ 16, "class", "null", "segment 8 of the list has no class that there is" },
	{ 16, "class", NULL, "segment 8 of the list has no class that there is" },
	{ 4, "class", "\"water\"", "segment 4 of the list" },
	{ 4, "parent", "3", "segment 4 of the list" },
	{ 16, "name", NULL, "segment 8 of the list has no 'name' or no 'made_by'" },
	{ 16, "name", "7", "segment 8 of the list has no 'name' or no 'made_by'" },
	{ 16, "made_by", NULL, "segment 8 of the list has no 'name' or no 'made_by'" },
	{ 16, "points", "-1", "segment 8 of the list has no 'id', 'parent', 'points'" },
	{ 16, "points", "0.5", "segment 8 of the list has no 'id', 'parent', 'points'" },
	{ 16, "area_m2", "true", "segment 8 of the list has no 'id', 'parent', 'points'" },
	{ 16, "low_m", "[1, 2]", "segment 8 of the list has a box that is none" },
	{ 16, "low_m", "[1, 2, 3, 4]", "segment 8 of the list has a box that is none" },
	{ 16, "low_m", "[1, 2, \"3\"]", "segment 8 of the list has a box that is none" },
	{ 16, "low_m", "[1, 2, null]", "segment 8 of the list has a box that is none" },
	{ 16, "high_m", "{}", "segment 8 of the list has a box that is none" },
	{ 0, "segments", NULL, "'segments' is not a list" },
	{ 0, "segments", "{}", "'segments' is not a list" },
	{ 0, "segments", "[]", "the class other is missing" },
	{ 0, "segments", "[4]", "segment 1 of the list is not an object" },
	{ 16, "found", "-1", "segment 8 of the list has a 'found' that cannot be" },
	{ 16, "found", "\"16\"", "segment 8 of the list has a 'found' that cannot be" },
	{ 16, "found", "65536", "segment 8 of the list has a 'found' that cannot be" },
	{ 0, "next", "20", "'next'" }, /* which a segment has */
	{ 0, "next", "65537", "'next'" },
	{ 0, "next", "\"99\"", "'next'" },
	{ 0, "labels", "{}", "'labels' is not a list" },
	{ 0, "labels", "7", "'labels' is not a list" },
	{ 0, "labels", "[7]", "'labels' has an entry without" },
	{ 0, "labels", "[{\"scan\": 1}]", "'labels' has an entry without" },
	{ 0, "labels", "[{\"scan\": 1, \"checksum\": -4}]", "'labels' has an entry without" },
	{ 0, "key", NULL, "'key'" },
	{ 0, "edits", "-1", "'edits'" },
	{ 0, "edits", NULL, "'edits'" },
	{ 0, "schema", "2", "schema" },
};

/* A file of before, which tells nothing of these. */
static void test_before(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *text = text_of_made(), *path = segments_path(site_folder);
	g_autoptr(JsonNode) node = json_from_string(text, NULL);
	change(json_node_get_object(node), 16, "found", NULL);
	change(json_node_get_object(node), 0, "next", NULL);
	change(json_node_get_object(node), 0, "labels", NULL);
	g_autofree char *changed = json_to_string(node, TRUE);
	g_assert_true(g_file_set_contents(path, changed, -1, NULL));
	g_autoptr(segments) s = segments_load(site_folder, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(s->next, ==, SEGMENT_FIRST + 5);
	g_assert_cmpuint(s->labels->len, ==, 0);
	g_assert_cmpuint(segments_find(s, SEGMENT_FIRST)->found, ==, 0);
}

static void expect_refused(const char *text, const char *words)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = segments_path(site_folder);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
	segments *s = segments_load(site_folder, &error);
	if (!error || !strstr(error->message, words))
		g_test_message(
			"\"%s\" has not \"%s\"", error ? error->message : "(accepted)", words);
	g_assert_null(s);
	g_assert_nonnull(strstr(error->message, words));
	g_assert_true(g_str_has_prefix(error->message, path));
	g_assert_null(strchr(error->message, '\n'));
}

static void test_refused(gconstpointer data)
{
	const struct refusal *r = data;
	g_autofree char *text = text_of_made();
	g_autoptr(JsonNode) node = json_from_string(text, NULL);
	change(json_node_get_object(node), r->id, r->key, r->value);
	g_autofree char *changed = json_to_string(node, TRUE);
	expect_refused(changed, r->words);
}

/* Wherever it is cut off, it is refused, and never read as less. */
static void test_cut(void)
{
	g_autofree char *text = text_of_made();
	for (size_t length = strlen(text) - 2; length; length -= length > 97 ? 97 : length) {
		g_autofree char *cut = g_strndup(text, length);
		expect_refused(cut, "");
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	site_folder = simulated_folder();
	g_autofree char *folder = g_build_filename(site_folder, "segments", NULL);
	g_assert_true(files_make_folder(folder, NULL));
	g_test_add_func("/segments/tree", test_tree);
	g_test_add_func("/segments/sums", test_sums);
	g_test_add_func("/segments/full", test_full);
	g_test_add_func("/segments/renumber", test_renumber);
	g_test_add_func("/segments/before", test_before);
	g_test_add_func("/segments/round-trip", test_round_trip);
	g_test_add_func("/segments/missing", test_missing);
	g_test_add_func("/segments/cut", test_cut);
	for (size_t i = 0; i < G_N_ELEMENTS(refusals); i++) {
		g_autofree char *path = g_strdup_printf("/segments/refused/%zu", i);
		g_test_add_data_func(path, &refusals[i], test_refused);
	}
	int status = g_test_run();
	g_free(site_folder);
	return status;
}
