/* What people change about segments: on a simulated site, on disk, undone, and once more after segments were found anew. */
#include "tests/onnx-made.h"
#include "tests/segment-desk.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

static char *tree_text(const char *path)
{
	g_autofree char *file = segments_path(path);
	char *text = NULL;
	g_assert_true(g_file_get_contents(file, &text, NULL, NULL));
	return text;
}

/* ---- tests ---- */

static void test_rename(struct desk *d, gconstpointer data)
{
	uint32_t tree = large_leaf(d, CLASS_VEGETATION, 0);
	g_autoptr(segment_edit) e = edit_of(d, EDIT_RENAME, tree, 0);
	(void)data;
	e->name = g_strdup("Old oak");
	change(d, e, NULL);
	g_assert_cmpstr(node_of(d, tree)->name, ==, "Old oak");
	stand_up(d);
	sit_down(d);
	g_assert_cmpstr(node_of(d, tree)->name, ==, "Old oak");
	g_autoptr(segment_edit) class =
		edit_of(d, EDIT_RENAME, segment_of_class(CLASS_BUILDING), 0);
	class->name = g_strdup("Houses");
	change(d, class, "*is a class*");
}

static void test_merge(struct desk *d, gconstpointer data)
{
	uint32_t a = large_leaf(d, CLASS_VEGETATION, 0), b = large_leaf(d, CLASS_BUILDING, 0);
	uint64_t had = node_of(d, a)->points + node_of(d, b)->points;
	uint64_t buildings = node_of(d, segment_of_class(CLASS_BUILDING))->points,
		 lost = node_of(d, b)->points;
	double area = node_of(d, a)->area_m2 + node_of(d, b)->area_m2;
	g_autoptr(segment_edit) e = edit_of(d, EDIT_MERGE, a, b);
	(void)data;
	e->name = g_strdup("Both");
	change(d, e, NULL);
	g_assert_cmpuint(node_of(d, a)->points, ==, had);
	g_assert_cmpfloat_with_epsilon(node_of(d, a)->area_m2, area, 1e-6);
	g_assert_cmpstr(node_of(d, a)->name, ==, "Both");
	g_assert_cmpint(node_of(d, a)->class, ==, CLASS_VEGETATION);
	g_assert_null(node_of(d, b));
	g_assert_cmpuint(
		node_of(d, segment_of_class(CLASS_BUILDING))->points, ==, buildings - lost);
	g_autoptr(segment_edit) self = edit_of(d, EDIT_MERGE, a, a);
	change(d, self, "*are not apart*");
}

/* A building with parts becomes one leaf. */
static void test_merge_parts(struct desk *d, gconstpointer data)
{
	uint32_t wall = large_leaf(d, CLASS_BUILDING, 0), building = node_of(d, wall)->parent;
	uint32_t tree = large_leaf(d, CLASS_VEGETATION, 0);
	uint64_t had = node_of(d, building)->points + node_of(d, tree)->points;
	(void)data;
	g_assert_cmpuint(building, >=, SEGMENT_FIRST);
	g_autoptr(segment_edit) e = edit_of(d, EDIT_MERGE, building, tree);
	change(d, e, NULL);
	g_assert_null(node_of(d, wall));
	g_assert_true(segments_is_leaf(segment_editor_tree(d->editor), building));
	g_assert_cmpuint(node_of(d, building)->points, ==, had);
}

static void test_move(struct desk *d, gconstpointer data)
{
	uint32_t wall = large_leaf(d, CLASS_BUILDING, 0), building = node_of(d, wall)->parent,
		 tree = large_leaf(d, CLASS_VEGETATION, 0);
	uint64_t had = node_of(d, tree)->points, moved = node_of(d, building)->points;
	(void)data;
	g_autoptr(segment_edit) e = edit_of(d, EDIT_MOVE, tree, 0);
	e->class = CLASS_STRUCTURE;
	change(d, e, NULL);
	g_assert_cmpint(node_of(d, tree)->class, ==, CLASS_STRUCTURE);
	g_assert_cmpuint(node_of(d, tree)->parent, ==, segment_of_class(CLASS_STRUCTURE));
	g_assert_cmpuint(node_of(d, segment_of_class(CLASS_STRUCTURE))->points, >=, had);
	g_autoptr(segment_edit) under = edit_of(d, EDIT_MOVE, tree, building);
	change(d, under, NULL);
	g_assert_cmpint(node_of(d, tree)->class, ==, CLASS_BUILDING);
	g_assert_cmpuint(node_of(d, building)->points, ==, moved + had);
	g_autoptr(segment_edit) circle = edit_of(d, EDIT_MOVE, building, building);
	change(d, circle, "*into itself*");
	g_autoptr(segment_edit) leaf = edit_of(d, EDIT_MOVE, tree, wall);
	change(d, leaf, "*has points of its own*");
}

/* Two trees that were made one come apart again where there is a gap. */
static void test_split(struct desk *d, gconstpointer data)
{
	uint32_t a = large_leaf(d, CLASS_VEGETATION, 0), b = large_leaf(d, CLASS_VEGETATION, 1);
	uint64_t had = node_of(d, a)->points + node_of(d, b)->points;
	(void)data;
	g_autoptr(segment_edit) e = edit_of(d, EDIT_MERGE, a, b);
	change(d, e, NULL);
	g_autoptr(segment_edit) split = edit_of(d, EDIT_SPLIT, a, 0);
	split->gap_m = 0.5;
	split->points_min = 200;
	change(d, split, NULL);
	g_assert_false(segments_is_leaf(segment_editor_tree(d->editor), a));
	g_assert_cmpuint(node_of(d, a)->points, ==, had);
	g_autoptr(segment_edit) again = edit_of(d, EDIT_SPLIT, a, 0);
	again->gap_m = 0.5;
	again->points_min = 200;
	change(d, again, "*has parts already*");
	uint32_t tree = large_leaf(d, CLASS_VEGETATION, 0);
	g_autoptr(segment_edit) never = edit_of(d, EDIT_SPLIT, tree, 0);
	never->gap_m = 50;
	never->points_min = 1;
	change(d, never, "no gap of 50 m divides*");
}

/* The left half of a wall's cells in scan 1 becomes a segment; scan 2 has the same place in it. */
static void test_draw(struct desk *d, gconstpointer data)
{
	uint32_t wall = large_leaf(d, CLASS_BUILDING, 0);
	uint64_t count, others = 0;
	const uint16_t *leaf = segment_editor_leaves(d->editor, 1, &count);
	(void)data;
	g_autoptr(segment_edit) e = segment_edit_new(EDIT_DRAW);
	e->scan = 1;
	e->class = CLASS_STRUCTURE;
	e->name = g_strdup("Half a wall");
	g_autoptr(scan_data) scan = scan_data_load(d->site, 1, NULL);
	uint32_t columns = scan->grid->columns, low = columns, high = 0;
	for (uint64_t i = 0; i < count; i++)
		if (leaf[i] == wall) {
			low = MIN(low, (uint32_t)(i % columns));
			high = MAX(high, (uint32_t)(i % columns));
		}
	for (uint64_t i = 0; i < count; i++) {
		struct cell_run one = { (uint32_t)i, 1 };
		if (leaf[i] == wall && i % columns < (low + high) / 2)
			g_array_append_val(e->runs, one);
	}
	guint drawn = e->runs->len;
	change(d, e, NULL);
	uint32_t id = large_leaf(d, CLASS_STRUCTURE, 0);
	g_assert_cmpstr(node_of(d, id)->name, ==, "Half a wall");
	leaf = segment_editor_leaves(d->editor, 2, &count);
	for (uint64_t i = 0; i < count; i++)
		others += leaf[i] == id;
	g_assert_cmpuint(node_of(d, id)->points, ==, drawn + others);
	g_assert_cmpuint(others, >, 100);
	g_autoptr(segment_edit) nothing = segment_edit_new(EDIT_DRAW);
	struct cell_run sky = { 0, 1 };
	nothing->scan = 1;
	nothing->class = CLASS_OTHER;
	g_array_append_val(nothing->runs, sky);
	change(d, nothing, "no point of scan 1 is selected");
	nothing->scan = 9;
	change(d, nothing, "there is no scan 9");
}

static void test_undo(struct desk *d, gconstpointer data)
{
	g_autofree char *before = tree_text(d->path);
	g_autoptr(GError) error = NULL;
	uint32_t a = large_leaf(d, CLASS_VEGETATION, 0), b = large_leaf(d, CLASS_BUILDING, 0);
	(void)data;
	g_autoptr(segment_edit) merge = edit_of(d, EDIT_MERGE, a, b);
	change(d, merge, NULL);
	g_autoptr(segment_edit) name = edit_of(d, EDIT_RENAME, a, 0);
	name->name = g_strdup("All");
	change(d, name, NULL);
	g_autofree char *after = tree_text(d->path);
	for (int k = 0; k < 2; k++)
		g_assert_true(segment_editor_undo(d->editor, &error));
	check_whole(d);
	g_autofree char *undone = tree_text(d->path);
	g_assert_cmpstr(undone, ==, before);
	g_assert_false(segment_editor_undo(d->editor, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_clear_error(&error);
	for (int k = 0; k < 2; k++)
		g_assert_true(segment_editor_redo(d->editor, &error));
	g_autofree char *redone = tree_text(d->path);
	g_assert_cmpstr(redone, ==, after);
	g_assert_true(segment_editor_undo(d->editor, &error));
	g_autoptr(segment_edit) other = edit_of(d, EDIT_RENAME, a, 0);
	other->name = g_strdup("Another");
	change(d, other, NULL);
	g_assert_false(segment_editor_redo(d->editor, &error));
}

/* Other parameters give other numbers; what was changed is still of the same points. */
static void test_found_anew(struct desk *d, gconstpointer data)
{
	uint32_t tree = large_leaf(d, CLASS_VEGETATION, 0), wall = large_leaf(d, CLASS_BUILDING, 0);
	uint64_t count, same = 0, all = 0;
	g_autoptr(GError) error = NULL;
	(void)data;
	g_autoptr(segment_edit) name = edit_of(d, EDIT_RENAME, tree, 0);
	name->name = g_strdup("Old oak");
	change(d, name, NULL);
	g_autoptr(segment_edit) move = edit_of(d, EDIT_MOVE, wall, 0);
	move->class = CLASS_STRUCTURE;
	change(d, move, NULL);
	g_autofree uint16_t *was = NULL;
	const uint16_t *leaf = segment_editor_leaves(d->editor, 1, &count);
	was = g_memdup2(leaf, count * sizeof *leaf);
	JsonNode *gap = json_node_new(JSON_NODE_VALUE);
	json_node_set_double(gap, 0.2);
	g_assert_true(site_set(d->site, "segmentation.gap_m", gap, &error));
	segment_editor *none = segment_editor_new(d->site, d->graph, &error);
	g_assert_null(none);
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_INITIALIZED);
	process_segments(d);
	stand_up(d);
	sit_down(d);
	check_whole(d);
	leaf = segment_editor_leaves(d->editor, 1, &count);
	for (uint64_t i = 0; i < count; i++) {
		bool is = leaf[i] && strcmp(node_of(d, leaf[i])->name, "Old oak") == 0;
		all += is || was[i] == tree;
		same += is && was[i] == tree;
	}
	g_test_message(
		"%" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT " points are the same", same, all);
	g_assert_cmpfloat((double)same, >, 0.8 * (double)all);
	same = all = 0;
	for (uint64_t i = 0; i < count; i++) {
		all += was[i] == wall;
		same += was[i] == wall && node_of(d, leaf[i])->class == CLASS_STRUCTURE;
	}
	g_assert_cmpfloat((double)same, >, 0.9 * (double)all);
}

/* A change that is on disk, but not yet in the segments, as after a power cut. */
static void test_cut_off(struct desk *d, gconstpointer data)
{
	uint32_t tree = large_leaf(d, CLASS_VEGETATION, 0);
	g_autoptr(GError) error = NULL;
	bool due;
	g_autofree char *why = NULL;
	(void)data;
	g_autoptr(segment_edits) edits = segment_edits_load(d->site, &error);
	g_autoptr(segment_edit) e = edit_of(d, EDIT_RENAME, tree, 0);
	e->name = g_strdup("Cut");
	e->base = g_strdup(segment_editor_tree(d->editor)->key);
	g_assert_true(segment_edits_append(edits, d->site, e, &error));
	g_assert_true(segment_site_is_due(d->site, d->graph, &due, &why, &error));
	g_assert_true(due);
	process_segments(d);
	stand_up(d);
	sit_down(d);
	g_assert_cmpstr(node_of(d, tree)->name, ==, "Cut");
}

static void set_text(site *s, const char *key, const char *text)
{
	g_autoptr(GError) error = NULL;
	JsonNode *node = json_node_new(JSON_NODE_VALUE);
	json_node_set_string(node, text);
	g_assert_true(site_set(s, key, node, &error));
}

/* A network that takes all within 4 m for water, and is sure of the rest too. */
static void write_network(const char *folder)
{
	static const float weight[] = { -10, 0 }, bias[] = { 40, 0 };
	static const char told[] =
		"{\"channels\": [\"range_m\"], \"classes\": [\"water\", \"lawn\"]}";
	g_autofree char *net = g_build_filename(folder, "near.onnx", NULL);
	g_autofree char *beside = g_build_filename(folder, "near.json", NULL);
	GByteArray *graph = g_byte_array_new();
	put_convolution(graph, 0, 1, 1, 2, 1, 1, weight, bias);
	g_autoptr(GByteArray) onnx = model_of(graph, 1, 2, 1, 0, 0);
	g_assert_true(g_file_set_contents(net, (const char *)onnx->data, (gssize)onnx->len, NULL));
	g_assert_true(g_file_set_contents(beside, told, -1, NULL));
}

/* What somebody's model is sure of goes before the rules. */
static void test_model(struct desk *d, gconstpointer data)
{
	uint64_t count, near = 0;
	g_autoptr(GError) error = NULL;
	bool due;
	g_autofree char *why = NULL;
	(void)data;
	set_text(d->site, "segmentation.model", "near.onnx");
	g_assert_false(segment_site_is_due(d->site, d->graph, &due, &why, &error));
	g_assert_true(strstr(error->message, "near.onnx") != NULL);
	g_clear_error(&error);
	write_network(d->path);
	process_segments(d);
	stand_up(d);
	sit_down(d);
	check_whole(d);
	g_autoptr(scan_data) scan = scan_data_load(d->site, 1, NULL);
	const uint16_t *leaf = segment_editor_leaves(d->editor, 1, &count);
	for (uint64_t i = 0; i < count; i++) {
		float range_m = scan->grid->range_m[i];
		if (!(range_m > 0) || fabsf(range_m - 4) < 0.1f)
			continue;
		near += range_m < 4;
		g_assert_cmpint(
			node_of(d, leaf[i])->class, ==, range_m < 4 ? CLASS_WATER : CLASS_OTHER);
	}
	g_assert_cmpuint(near, >, 1000);
}

static void test_damage(struct desk *d, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(segment_edit) e = edit_of(d, EDIT_RENAME, large_leaf(d, CLASS_VEGETATION, 0), 0);
	(void)data;
	e->name = g_strdup("Soon gone");
	change(d, e, NULL);
	g_autofree char *file = g_build_filename(d->path, "edits", "0001.edit", NULL);
	g_autofree char *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(file, &bytes, &length, NULL));
	for (gsize cut = 0; cut < length; cut += 37) {
		g_assert_true(g_file_set_contents(file, bytes, (gssize)cut, NULL));
		g_assert_null(segment_edits_read(d->site, 1, &error));
		g_assert_nonnull(error);
		g_assert_true(g_str_has_prefix(error->message, file));
		g_clear_error(&error);
	}
	g_autofree char *list = g_build_filename(d->path, "edits", "edits.json", NULL);
	g_assert_true(g_file_set_contents(
		list, "{\"schema\":1,\"done\":[1,-2],\"undone\":[]}", -1, NULL));
	g_assert_null(segment_edits_load(d->site, &error));
	g_assert_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	ADD_AT_DESK("/segment-edits/rename", test_rename);
	ADD_AT_DESK("/segment-edits/merge", test_merge);
	ADD_AT_DESK("/segment-edits/merge-parts", test_merge_parts);
	ADD_AT_DESK("/segment-edits/move", test_move);
	ADD_AT_DESK("/segment-edits/split", test_split);
	ADD_AT_DESK("/segment-edits/draw", test_draw);
	ADD_AT_DESK("/segment-edits/undo", test_undo);
	ADD_AT_DESK("/segment-edits/found-anew", test_found_anew);
	ADD_AT_DESK("/segment-edits/cut-off", test_cut_off);
	ADD_AT_DESK("/segment-edits/model", test_model);
	ADD_AT_DESK("/segment-edits/damage", test_damage);
	return g_test_run();
}
