/* Any bytes as what people changed about the segments of a small site: SITE/edits/. What is accepted is made, refused or left out, and
 * then every point is in one leaf of a tree that counts it, is written, and reads back. The first byte of the input tells what
 * follows: 'l' the list, edits.json, where change 2 is there; else change 1: its manifest, and after a zero byte its runs. */
#include "firmware-io/files.h"
#include "process/import.h"
#include "process/segment-site.h"
#include "process/segment-state.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#define COLUMNS 12
#define ROWS    8

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* ---- a site ---- */

static char *folder;
static site *place;
static scan_graph *graph;

static void clear(void)
{
	scan_graph_free(graph);
	site_free(place);
	files_remove_tree(folder, NULL);
	g_free(folder);
}

/* A floor, and two boxes on it; the second scan stands a little aside. */
static char *made_scans(void)
{
	GString *text = g_string_new(NULL);
	for (int scan = 0; scan < 2; scan++) {
		g_string_append_printf(
			text, "%d\n%d\n%g 0 0\n1 0 0\n0 1 0\n0 0 1\n", COLUMNS, ROWS, 0.1 * scan);
		g_string_append_printf(text, "1 0 0 0\n0 1 0 0\n0 0 1 0\n%g 0 0 1\n", 0.1 * scan);
		for (int c = 0; c < COLUMNS; c++)
			for (int r = 0; r < ROWS; r++) {
				bool is_box = r >= 4 && (c / 3) % 2;
				g_string_append_printf(text, "%g %g %g 0.5\n", 3.0 + 0.2 * r,
					0.2 * c + (is_box ? 0 : 0.01), is_box ? 0.2 * r : -1.0);
			}
	}
	return g_string_free(text, FALSE);
}

/* A change: a manifest, and after a zero byte runs. false: it has no manifest. */
static bool write_edit(const char *name, const uint8_t *data, size_t size)
{
	const uint8_t *end = memchr(data, 0, size);
	size_t length = end ? (size_t)(end - data) : size;
	size_t runs = (size - length) / sizeof(struct cell_run);
	g_autofree struct cell_run *run = g_new0(struct cell_run, runs + 1);
	g_autoptr(JsonParser) parser = json_parser_new();
	g_autofree char *path = g_build_filename(site_path(place), "edits", name, NULL);
	if (!json_parser_load_from_data(parser, (const char *)data, (gssize)length, NULL) ||
		!json_parser_get_root(parser) ||
		!JSON_NODE_HOLDS_OBJECT(json_parser_get_root(parser)))
		return false;
	if (runs)
		memcpy(run, end + 1, MIN(runs * sizeof *run, size - length - 1));
	g_autoptr(product_writer) w = product_writer_new(path, NULL);
	return product_writer_begin(w, "runs", sizeof *run, NULL) &&
	       product_writer_append(w, run, runs, NULL) &&
	       product_writer_finish(w, "segment-edit", 1,
		       json_object_ref(json_node_get_object(json_parser_get_root(parser))), NULL);
}

static void set_up(void)
{
	static const char second[] = "{\"op\": \"rename\", \"segments\": [{\"id\": 17, \"up\": 0, "
				     "\"anchors\": [1, 28]}], \"name\": \"Box\", "
				     "\"points_min\": 0, \"scan\": 0}";
	g_autoptr(GError) error = NULL;
	g_autofree char *text = made_scans();
	folder = g_dir_make_tmp("fuzz-edits-XXXXXX", NULL);
	g_autofree char *file = g_build_filename(folder, "scans.ptx", NULL);
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	g_autofree char *edits = g_build_filename(path, "edits", NULL);
	struct import_options options = { 0 };
	struct segment_site_result found;
	atexit(clear);
	g_assert_true(g_file_set_contents(file, text, -1, NULL));
	place = site_open_for_writing(path, &error);
	g_assert_no_error(error);
	g_array_unref(import_file(place, file, &options, &error));
	g_assert_no_error(error);
	g_assert_true(
		site_set(place, "segmentation.points_min", json_from_string("1", NULL), &error));
	graph = scan_graph_new();
	for (uint32_t k = 1; k <= 2; k++) {
		struct placed_scan p = { .number = k, .group = 1, .pose = POSE_IDENTITY };
		g_array_append_val(graph->scans, p);
	}
	g_assert_true(segment_site(place, graph, NULL, &found, &error));
	g_assert_no_error(error);
	g_assert_cmpuint(found.things, >=, 2);
	g_assert_true(files_make_folder(edits, NULL));
	g_assert_true(write_edit("0002.edit", (const uint8_t *)second, sizeof second));
}

/* ---- what holds always ---- */

static void check(const segment_state *s)
{
	g_autofree uint64_t *in_leaf = g_new0(uint64_t, SEGMENTS_MAX + 1);
	for (guint i = 0; i < s->scans->scans->len; i++)
		for (uint64_t k = 0; k < s->label[i].count; k++)
			in_leaf[s->label[i].leaf[k]]++;
	for (uint32_t id = 1; id <= SEGMENTS_MAX; id++)
		g_assert_true(!in_leaf[id] ||
			      (segments_find(s->tree, id) && segments_is_leaf(s->tree, id)));
	for (guint i = 0; i < s->tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(s->tree->nodes, struct segment, i);
		uint64_t below = 0;
		for (uint32_t id = 1; id <= SEGMENTS_MAX; id++)
			if (in_leaf[id] && segments_is_above(s->tree, node->id, id))
				below += in_leaf[id];
		g_assert_cmpuint(node->points, ==, below);
	}
}

/* ---- an input ---- */

static void write_list(const char *text, size_t size)
{
	g_autofree char *path = g_build_filename(site_path(place), "edits", "edits.json", NULL);
	g_assert_true(g_file_set_contents(path, text, (gssize)size, NULL));
}

static void apply(void)
{
	g_autoptr(GError) error = NULL, broken = NULL;
	g_autoptr(segment_edits) edits = segment_edits_load(place, &error);
	g_assert_true((edits == NULL) == (error != NULL));
	g_autoptr(segment_scans) scans = segment_scans_new(place, graph, NULL);
	g_autoptr(segment_state) state = segment_state_load_automatic(place, scans, NULL);
	if (!edits)
		return;
	g_autofree char *done = segment_edits_done(edits);
	bool good = segment_state_apply_all(state, edits, &broken);
	g_assert_true(good == (broken == NULL));
	if (!good)
		return;
	check(state);
	g_assert_true(segment_state_save(state, done, &error));
	g_autoptr(segment_state) again = segment_state_load(place, scans, &error);
	g_assert_no_error(error);
	check(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char one[] = "{\"schema\": 1, \"done\": [1], \"undone\": []}";
	if (!folder)
		set_up();
	g_autofree char *first = g_build_filename(site_path(place), "edits", "0001.edit", NULL);
	if (size < 2 || size > 4096)
		return 0;
	unlink(first);
	if (data[0] == 'l')
		write_list((const char *)data + 1, size - 1);
	else if (write_edit("0001.edit", data + 1, size - 1))
		write_list(one, sizeof one - 1);
	else
		return 0;
	apply();
	return 0;
}
