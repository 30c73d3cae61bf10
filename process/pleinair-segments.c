/* pleinair segments SITE: the tree of segments, and what people change about it. */
#include "acquire/cli.h"
#include "process/components.h"
#include "process/scribble.h"
#include "process/segment-editor.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COMMAND     "segments"
#define DRAW_RADIUS 1.0

static gboolean json;
static char *name, *class_name;
static double gap_m = 0.3, radius = DRAW_RADIUS;
static int level, points_min = 60, into;
static GArray *strokes; /* of struct drawn */

/* A stroke as it was typed. */
struct drawn {
	enum scribble_side side;
	GArray *points; /* of struct scribble_point */
};

static bool read_stroke(const char *text, GArray *ret)
{
	g_auto(GStrv) words = g_strsplit_set(text, " ;", -1);
	for (char **word = words; *word; word++) {
		char *end;
		struct scribble_point p;
		if (!**word)
			continue;
		p.column = (float)g_ascii_strtod(*word, &end);
		if (end == *word || *end != ',')
			return false;
		char *row = end + 1;
		p.row = (float)g_ascii_strtod(row, &end);
		if (end == row || *end || !isfinite(p.column) || !isfinite(p.row))
			return false;
		g_array_append_val(ret, p);
	}
	return ret->len;
}

static gboolean take_stroke(const char *option, const char *value, gpointer data, GError **error)
{
	struct drawn d = { strcmp(option, "--outside") ? SCRIBBLE_INSIDE : SCRIBBLE_OUTSIDE,
		g_array_new(FALSE, FALSE, sizeof(struct scribble_point)) };
	(void)data;
	if (!read_stroke(value, d.points)) {
		g_array_unref(d.points);
		g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
			"%s takes places of the panorama as \"COLUMN,ROW COLUMN,ROW ...\", not %s",
			option, value);
		return FALSE;
	}
	if (!strokes)
		strokes = g_array_new(FALSE, FALSE, sizeof(struct drawn));
	g_array_append_val(strokes, d);
	return TRUE;
}

static const GOptionEntry entries[] = {
	{ "name", 'n', 0, G_OPTION_ARG_STRING, &name, "merge, draw: what the segment is called",
		"NAME" },
	{ "gap", 'g', 0, G_OPTION_ARG_DOUBLE, &gap_m,
		"split: the smallest gap that divides (default 0.3)", "M" },
	{ "level", 'l', 0, G_OPTION_ARG_INT, &level,
		"split: the gap as the level of an octree around the whole site", "L" },
	{ "points", 'p', 0, G_OPTION_ARG_INT, &points_min,
		"split: parts have so many points at least (default 60)", "N" },
	{ "inside", 'i', 0, G_OPTION_ARG_CALLBACK, (gpointer)take_stroke,
		"draw: a stroke over what is meant; any number of them", "\"C,R C,R ...\"" },
	{ "outside", 'o', 0, G_OPTION_ARG_CALLBACK, (gpointer)take_stroke,
		"draw: a stroke over what is not meant", "\"C,R C,R ...\"" },
	{ "radius", 'r', 0, G_OPTION_ARG_DOUBLE, &radius,
		"draw: of the brush, in cells (default 1)", "R" },
	{ "class", 'c', 0, G_OPTION_ARG_STRING, &class_name, "draw: a new segment of this class",
		"CLASS" },
	{ "into", 0, 0, G_OPTION_ARG_INT, &into, "draw: into this segment", "ID" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the tree as JSON", NULL },
	{ NULL },
};

/* ---- showing ---- */

static void print_node(const segments *tree, const struct segment *node, int depth)
{
	double size[3] = { 0 };
	for (int k = 0; k < 3 && node->points; k++)
		size[k] = node->high_m[k] - node->low_m[k];
	g_autofree char *indented = g_strdup_printf("%*s%s", 2 * depth, "", node->name);
	printf("%6u  %-36s %12" G_GUINT64_FORMAT " %11.1f   %.1f x %.1f x %.1f%s\n", node->id,
		indented, node->points, node->area_m2, size[0], size[1], size[2],
		strcmp(node->made_by, "user") ? "" : "   by you");
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *child = &g_array_index(tree->nodes, struct segment, i);
		if (child->parent == node->id && child->points)
			print_node(tree, child, depth + 1);
	}
}

static JsonObject *node_json(const struct segment *node)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "id", node->id);
	json_object_set_int_member(o, "parent", node->parent);
	json_object_set_string_member(o, "name", node->name);
	json_object_set_string_member(o, "class", segment_classes[node->class].name);
	json_object_set_string_member(o, "made_by", node->made_by);
	json_object_set_int_member(o, "points", (gint64)node->points);
	json_object_set_double_member(o, "area_m2", node->area_m2);
	JsonArray *box = json_array_new();
	for (int k = 0; k < 6 && node->points; k++)
		json_array_add_double_element(box, k < 3 ? node->low_m[k] : node->high_m[k - 3]);
	json_object_set_array_member(o, "box_m", box);
	return o;
}

static void show(const segments *tree)
{
	if (!json) {
		printf("%6s  %-36s %12s %11s   %s\n", "ID", "NAME", "POINTS", "AREA m2", "SIZE m");
		print_node(tree, segments_find(tree, SEGMENT_SITE), 0);
		return;
	}
	JsonObject *o = json_object_new();
	JsonArray *list = json_array_new();
	for (guint i = 0; i < tree->nodes->len; i++)
		json_array_add_object_element(
			list, node_json(&g_array_index(tree->nodes, struct segment, i)));
	json_object_set_array_member(o, "segments", list);
	cli_print_json(o);
}

/* ---- what to change ---- */

struct editing {
	site *site;
	segment_editor *editor;
	char **words; /* behind what to do */
	int count;
};

static bool number_of(const char *word, uint32_t *ret, GError **error)
{
	guint64 value;
	if (!g_ascii_string_to_unsigned(word, 10, 1, G_MAXUINT32, &value, NULL)) {
		g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
			"%s is not the number of anything", word);
		return false;
	}
	*ret = (uint32_t)value;
	return true;
}

static bool refer(struct editing *w, segment_edit *e, const char *word, GError **error)
{
	uint32_t id;
	return number_of(word, &id, error) && segment_editor_refer(w->editor, e, id, error);
}

static bool do_rename(struct editing *w, GError **error)
{
	g_autoptr(segment_edit) e = segment_edit_new(EDIT_RENAME);
	e->name = g_strdup(w->words[1]);
	return refer(w, e, w->words[0], error) && segment_editor_change(w->editor, e, error);
}

static bool do_merge(struct editing *w, GError **error)
{
	g_autoptr(segment_edit) e = segment_edit_new(EDIT_MERGE);
	e->name = g_strdup(name);
	for (int i = 0; i < w->count; i++)
		if (!refer(w, e, w->words[i], error))
			return false;
	return segment_editor_change(w->editor, e, error);
}

static bool do_split(struct editing *w, GError **error)
{
	g_autoptr(segment_edit) e = segment_edit_new(EDIT_SPLIT);
	const struct segment *whole = segments_find(segment_editor_tree(w->editor), SEGMENT_SITE);
	double side_m = 0;
	for (int k = 0; k < 3; k++)
		side_m = fmax(side_m, whole->high_m[k] - whole->low_m[k]);
	e->gap_m = level > 0 ? octree_cell_m(side_m, (unsigned)level) : gap_m;
	e->points_min = (uint32_t)points_min;
	return refer(w, e, w->words[0], error) && segment_editor_change(w->editor, e, error);
}

static bool do_move(struct editing *w, GError **error)
{
	g_autoptr(segment_edit) e = segment_edit_new(EDIT_MOVE);
	e->class = segment_class_find(w->words[1]);
	return refer(w, e, w->words[0], error) &&
	       (e->class >= 0 || refer(w, e, w->words[1], error)) &&
	       segment_editor_change(w->editor, e, error);
}

static bool do_undo(struct editing *w, GError **error)
{
	return segment_editor_undo(w->editor, error);
}

static bool do_redo(struct editing *w, GError **error)
{
	return segment_editor_redo(w->editor, error);
}

static bool do_log(struct editing *w, GError **error)
{
	const segment_edits *edits = segment_editor_edits(w->editor);
	for (guint i = 0; i < edits->done->len + edits->undone->len; i++) {
		bool is_done = i < edits->done->len;
		uint32_t number =
			is_done ? g_array_index(edits->done, uint32_t, i)
				: g_array_index(edits->undone, uint32_t,
					  edits->undone->len - 1 - (i - edits->done->len));
		g_autoptr(segment_edit) e = segment_edits_read(w->site, number, error);
		if (!e)
			return false;
		g_autoptr(GString) of = g_string_new(NULL);
		for (guint k = 0; k < e->segments->len; k++)
			g_string_append_printf(
				of, " %u", ((struct segment_ref *)e->segments->pdata[k])->id);
		printf("%4u  %s  %s%s%s%s%s\n", number, e->time ? e->time : "-",
			segment_op_names[e->op], of->str, e->name ? " " : "",
			e->name ? e->name : "", is_done ? "" : "  (undone)");
	}
	return true;
}

/* ---- drawing ---- */

static bool draw_strokes(const scan_data *d, const uint16_t *leaf, GArray *runs, GError **error)
{
	gint64 began = g_get_monotonic_time();
	g_autoptr(scribble) s = scribble_new(d->grid, NULL, leaf, NULL);
	double ready_ms = 1e-3 * (double)(g_get_monotonic_time() - began), worst_ms = 0;
	for (guint i = 0; i < strokes->len; i++) {
		const struct drawn *stroke = &g_array_index(strokes, struct drawn, i);
		struct scribble_stroke line = { stroke->side,
			(const struct scribble_point *)(void *)stroke->points->data,
			stroke->points->len, (float)radius };
		began = g_get_monotonic_time();
		scribble_draw(s, &line);
		worst_ms = fmax(worst_ms, 1e-3 * (double)(g_get_monotonic_time() - began));
	}
	const uint8_t *selected = scribble_selected(s);
	for (size_t i = 0, cells = range_grid_cells(d->grid); i < cells;) {
		size_t from = i;
		while (i < cells && selected[i])
			i++;
		struct cell_run run = { (uint32_t)from, (uint32_t)(i - from) };
		if (run.count)
			g_array_append_val(runs, run);
		i += i == from;
	}
	if (!json)
		printf("%zu cells are selected; %.0f ms to begin with, %.0f ms a stroke at most\n",
			scribble_count(s), ready_ms, worst_ms);
	if (!runs->len)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"nothing is selected: draw over points, not over the sky");
	return runs->len;
}

static bool do_draw(struct editing *w, GError **error)
{
	g_autoptr(segment_edit) e = segment_edit_new(EDIT_DRAW);
	uint64_t count;
	if (!number_of(w->words[0], &e->scan, error))
		return false;
	const uint16_t *leaf = segment_editor_leaves(w->editor, e->scan, &count);
	if (!leaf) {
		g_set_error(
			error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "there is no scan %u", e->scan);
		return false;
	}
	g_autoptr(scan_data) d = scan_data_load(w->site, e->scan, error);
	if (!d)
		return false;
	if (!d->grid) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_SUPPORTED,
			"scan %u has no panorama to draw on", e->scan);
		return false;
	}
	e->class = class_name ? segment_class_find(class_name) : -1;
	e->name = g_strdup(name);
	return (e->class >= 0 || segment_editor_refer(w->editor, e, (uint32_t)into, error)) &&
	       draw_strokes(d, leaf, e->runs, error) && segment_editor_change(w->editor, e, error);
}

/* ---- the command ---- */

static const struct action {
	const char *word;
	int least, most; /* words behind it */
	bool shows;      /* the tree, afterwards */
	bool (*run)(struct editing *w, GError **error);
} actions[] = {
	{ "rename", 2, 2, true, do_rename },
	{ "merge", 2, G_MAXINT, true, do_merge },
	{ "split", 1, 1, true, do_split },
	{ "move", 2, 2, true, do_move },
	{ "draw", 1, 1, true, do_draw },
	{ "undo", 0, 0, true, do_undo },
	{ "redo", 0, 0, true, do_redo },
	{ "log", 0, 0, false, do_log },
};

static const struct action *find_action(const char *word)
{
	for (size_t i = 0; i < G_N_ELEMENTS(actions); i++)
		if (strcmp(actions[i].word, word) == 0)
			return &actions[i];
	return NULL;
}

static int check_options(const struct action *a, int words)
{
	if (words < a->least || words > a->most)
		return cli_misuse(COMMAND, "%s takes %s%d of these numbers or words", a->word,
			a->most > a->least ? "at least " : "", a->least);
	if (class_name && segment_class_find(class_name) < 0)
		return cli_misuse(COMMAND, "--class=%s: there is no such class", class_name);
	if (!(gap_m > 0) || gap_m > 1000 || level < 0 || level > 21 || points_min < 1)
		return cli_misuse(
			COMMAND, "gaps go to 1000 m, levels from 1 to 21, points from 1 on");
	if (!(radius >= 0 && radius <= 1000))
		return cli_misuse(COMMAND, "the brush has a radius from 0 to 1000 cells");
	if (a->run != do_draw)
		return CLI_DONE;
	if (!strokes)
		return cli_misuse(COMMAND, "draw takes strokes: --inside \"COLUMN,ROW ...\"");
	if (!class_name == !into)
		return cli_misuse(
			COMMAND, "draw makes a new segment (--class) or adds to one (--into)");
	return CLI_DONE;
}

static int change(const char *path, const struct action *a, char **words, int count)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	g_autoptr(scan_graph) g = s ? scan_graph_load(s, &error) : NULL;
	g_autoptr(segment_editor) editor = g ? segment_editor_new(s, g, &error) : NULL;
	struct editing w = { s, editor, words, count };
	if (!editor || !a->run(&w, &error))
		return cli_fail(COMMAND, error);
	if (a->shows)
		show(segment_editor_tree(editor));
	return cli_done(COMMAND);
}

static int list(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(segments) tree = s ? segments_load(path, &error) : NULL;
	if (!tree)
		return cli_fail(COMMAND, error);
	show(tree);
	return cli_done(COMMAND);
}

int main(int argc, char **argv)
{
	int status;
	if (!cli_parse(COMMAND, "SITE [WHAT ...]",
		    "Shows the segments of a site, and changes them.",
		    "What can be done:\n"
		    "  rename ID NAME            merge ID ID...\n"
		    "  split ID                  where there are gaps\n"
		    "  move ID CLASS|ID          to another class, or under another segment\n"
		    "  draw SCAN                 a segment from strokes over the panorama\n"
		    "  undo, redo, log\n"
		    "Classes: building, vegetation, terrain, structure, water, other.\n",
		    entries, &argc, &argv, &status))
		return status;
	if (argc < 2 || !*argv[1])
		return cli_misuse(COMMAND, "which site?");
	if (argc == 2)
		return list(argv[1]);
	const struct action *a = find_action(argv[2]);
	if (!a)
		return cli_misuse(COMMAND, "%s: there is nothing of this name to do", argv[2]);
	status = check_options(a, argc - 3);
	return status ? status : change(argv[1], a, argv + 3, argc - 3);
}
