/* Numbers of segments that people made, and how changes find what they speak of when segments are found anew. */
#include "tests/segment-desk.h"
#include <json-glib/json-glib.h>

/* NULL: none. */
static void set(struct desk *d, const char *key, const char *value)
{
	g_autoptr(GError) error = NULL;
	g_assert_true(site_set(d->site, key, value ? json_from_string(value, NULL) : NULL, &error));
	process_segments(d);
	stand_up(d);
	sit_down(d);
	check_whole(d);
}

/* Cells of scan 1 with this leaf, every other of the columns; name: of the segment that they become. */
static uint32_t draw(struct desk *d, uint32_t leaf, unsigned odd, const char *name)
{
	uint64_t count;
	g_autoptr(segment_edit) e = segment_edit_new(EDIT_DRAW);
	const uint16_t *labels = segment_editor_leaves(d->editor, 1, &count);
	g_autoptr(scan_data) scan = scan_data_load(d->site, 1, NULL);
	e->scan = 1;
	e->class = CLASS_WATER;
	e->name = g_strdup(name);
	for (uint64_t i = 0; i < count; i++) {
		struct cell_run one = { (uint32_t)i, 1 };
		if (labels[i] == leaf && i % scan->grid->columns / 16 % 2 == odd)
			g_array_append_val(e->runs, one);
	}
	change(d, e, NULL);
	g_assert_cmpuint(e->made->len, ==, 1);
	return ((const struct segment_ref *)e->made->pdata[0])->id;
}

static uint32_t named(const struct desk *d, const char *name)
{
	const segments *tree = segment_editor_tree(d->editor);
	uint32_t id = 0;
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		if (strcmp(node->name, name))
			continue;
		g_assert_cmpuint(id, ==, 0);
		id = node->id;
	}
	return id;
}

/* What people made keeps its numbers, and what the computer finds does not get them. */
static void test_numbers(struct desk *d, gconstpointer data)
{
	uint32_t wall = large_leaf(d, CLASS_BUILDING, 0), a = large_leaf(d, CLASS_VEGETATION, 0),
		 b = large_leaf(d, CLASS_VEGETATION, 1);
	(void)data;
	uint32_t pond = draw(d, wall, 0, "Pond");
	g_autoptr(segment_edit) merge = edit_of(d, EDIT_MERGE, a, b);
	merge->name = g_strdup("Grove");
	change(d, merge, NULL);
	g_assert_cmpuint(merge->made->len, ==, 0);
	g_autoptr(segment_edit) split = edit_of(d, EDIT_SPLIT, a, 0);
	split->gap_m = 0.5;
	split->points_min = 200;
	change(d, split, NULL);
	uint32_t part = named(d, "Grove, part 1"), other = named(d, "Grove, part 2");
	g_assert_true(part && other && split->made->len >= 2);
	g_autoptr(segment_edit) name = edit_of(d, EDIT_RENAME, part, 0);
	name->name = g_strdup("Old oak");
	change(d, name, NULL);
	uint32_t next = segment_editor_tree(d->editor)->next;
	static const char *const gaps_m[] = { "0.2", "0.25", "0.15" };
	for (size_t i = 0; i < G_N_ELEMENTS(gaps_m); i++) {
		set(d, "segmentation.gap_m", gaps_m[i]);
		g_assert_cmpuint(named(d, "Pond"), ==, pond);
		g_assert_cmpuint(named(d, "Old oak"), ==, part);
		g_assert_cmpuint(named(d, "Grove, part 2"), ==, other);
		g_autofree char *path = segments_automatic_path(d->path);
		g_autoptr(segments) found = segments_load_file(path, NULL);
		g_assert_null(segments_find(found, pond));
		g_assert_null(segments_find(found, part));
		g_assert_cmpuint(segment_editor_tree(d->editor)->next, >=, next);
	}
}

/* A number that was undone is that of the same, or of nothing. */
static void test_undone_numbers(struct desk *d, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	uint32_t wall = large_leaf(d, CLASS_BUILDING, 0);
	(void)data;
	uint32_t pond = draw(d, wall, 0, "Pond");
	g_assert_true(segment_editor_undo(d->editor, &error));
	g_assert_null(node_of(d, pond));
	g_assert_true(segment_editor_redo(d->editor, &error));
	g_assert_cmpuint(named(d, "Pond"), ==, pond);
	g_assert_true(segment_editor_undo(d->editor, &error));
	g_assert_cmpuint(draw(d, wall, 1, "Lake"), !=, pond);
	stand_up(d);
	sit_down(d);
	uint32_t lake = named(d, "Lake");
	set(d, "segmentation.gap_m", "0.2");
	g_assert_null(node_of(d, pond));
	g_assert_cmpuint(named(d, "Lake"), ==, lake);
}

/* Back at parameters of before, a change of that time finds what it speaks of also when the number of that has gone. */
static void test_back_again(struct desk *d, gconstpointer data)
{
	(void)data;
	for (unsigned k = 0; k < 3; k++) {
		g_autofree char *text = g_strdup_printf("Plant %u", k);
		g_autoptr(segment_edit) name =
			edit_of(d, EDIT_RENAME, large_leaf(d, CLASS_VEGETATION, k), 0);
		name->name = g_strdup(text);
		change(d, name, NULL);
	}
	uint32_t was = named(d, "Plant 0");
	set(d, "segmentation.points_min", "10000000");
	set(d, "segmentation", NULL);
	g_assert_null(node_of(d, was));
	for (unsigned k = 0; k < 3; k++) {
		g_autofree char *text = g_strdup_printf("Plant %u", k);
		g_assert_cmpuint(named(d, text), >=, SEGMENT_FIRST);
	}
}

/* A name that a person gave counts while it is; without it, the thing is called what it was called before. */
static void test_names(struct desk *d, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	uint32_t tree = large_leaf(d, CLASS_VEGETATION, 1);
	g_autofree char *was = g_strdup(node_of(d, tree)->name);
	g_autoptr(segment_edit) name = edit_of(d, EDIT_RENAME, tree, 0);
	(void)data;
	name->name = g_strdup("Old oak");
	change(d, name, NULL);
	set(d, "segmentation.gap_m", "0.16");
	g_assert_cmpuint(named(d, "Old oak"), ==, tree);
	g_assert_cmpuint(named(d, was), ==, 0);
	g_assert_true(segment_editor_undo(d->editor, &error));
	g_assert_cmpuint(named(d, was), ==, tree);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	ADD_AT_DESK("/segment-edit-numbers/found-anew", test_numbers);
	ADD_AT_DESK("/segment-edit-numbers/undone", test_undone_numbers);
	ADD_AT_DESK("/segment-edit-numbers/back-again", test_back_again);
	ADD_AT_DESK("/segment-edit-numbers/names", test_names);
	return g_test_run();
}
