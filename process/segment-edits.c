#include "process/segment-edits.h"
#include "acquire/manifest.h"
#include "firmware-io/files.h"
#include "process/product.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#define SCHEMA  1
#define KIND    "segment-edit"
#define VERSION 1

const char *const segment_op_names[SEGMENT_OPS] = { "rename", "merge", "split", "move", "draw" };

/* ---- one change ---- */

static void free_ref(gpointer data)
{
	struct segment_ref *r = data;
	g_array_unref(r->anchors);
	g_free(r);
}

segment_edit *segment_edit_new(enum segment_op op)
{
	segment_edit *e = g_new0(segment_edit, 1);
	e->op = op;
	e->class = -1;
	e->segments = g_ptr_array_new_with_free_func(free_ref);
	e->made = g_ptr_array_new_with_free_func(free_ref);
	e->runs = g_array_new(FALSE, FALSE, sizeof(struct cell_run));
	return e;
}

void segment_edit_free(segment_edit *e)
{
	if (!e)
		return;
	g_free(e->time);
	g_free(e->base);
	g_free(e->name);
	g_ptr_array_unref(e->segments);
	g_ptr_array_unref(e->made);
	g_array_unref(e->runs);
	g_free(e);
}

struct segment_ref *segment_edit_add_ref(GPtrArray *list, uint32_t id, uint32_t up)
{
	struct segment_ref *r = g_new(struct segment_ref, 1);
	*r = (struct segment_ref){ id, up,
		g_array_new(FALSE, FALSE, sizeof(struct segment_anchor)) };
	g_ptr_array_add(list, r);
	return r;
}

/* ---- its file ---- */

static char *edit_path(const site *s, uint32_t number)
{
	return g_strdup_printf("%s/edits/%04u.edit", site_path(s), number);
}

static JsonArray *write_refs(const GPtrArray *refs)
{
	JsonArray *list = json_array_new();
	for (guint i = 0; i < refs->len; i++) {
		const struct segment_ref *r = refs->pdata[i];
		JsonObject *o = json_object_new();
		JsonArray *anchors = json_array_new();
		for (guint k = 0; k < r->anchors->len; k++) {
			const struct segment_anchor *a =
				&g_array_index(r->anchors, struct segment_anchor, k);
			json_array_add_int_element(anchors, a->scan);
			json_array_add_int_element(anchors, a->cell);
		}
		json_object_set_int_member(o, "id", r->id);
		json_object_set_int_member(o, "up", r->up);
		json_object_set_array_member(o, "anchors", anchors);
		json_array_add_object_element(list, o);
	}
	return list;
}

static JsonObject *write_edit(const segment_edit *e)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "op", segment_op_names[e->op]);
	json_object_set_string_member(o, "time", e->time);
	json_object_set_string_member(o, "base", e->base ? e->base : "");
	json_object_set_array_member(o, "segments", write_refs(e->segments));
	if (e->made->len)
		json_object_set_array_member(o, "made", write_refs(e->made));
	if (e->name)
		json_object_set_string_member(o, "name", e->name);
	if (e->class >= 0)
		json_object_set_string_member(o, "class", segment_classes[e->class].name);
	json_object_set_double_member(o, "gap_m", e->gap_m);
	json_object_set_int_member(o, "points_min", e->points_min);
	json_object_set_int_member(o, "scan", e->scan);
	return o;
}

static bool save_edit(const segment_edit *e, const char *path, GError **error)
{
	g_autoptr(product_writer) w = product_writer_new(path, error);
	return w && product_writer_begin(w, "runs", sizeof(struct cell_run), error) &&
	       product_writer_append(w, e->runs->data, e->runs->len, error) &&
	       product_writer_finish(w, KIND, VERSION, write_edit(e), error);
}

static bool is_of(JsonNode *node, GType type)
{
	return node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == type;
}

static const char *text_in(JsonObject *o, const char *key)
{
	JsonNode *node = json_object_get_member(o, key);
	return is_of(node, G_TYPE_STRING) ? json_node_get_string(node) : NULL;
}

static bool number_in(JsonObject *o, const char *key, uint32_t *ret)
{
	JsonNode *node = json_object_get_member(o, key);
	int64_t value = is_of(node, G_TYPE_INT64) ? json_node_get_int(node) : -1;
	if (value < 0 || value > G_MAXUINT32)
		return false;
	*ret = (uint32_t)value;
	return true;
}

static JsonArray *list_in(JsonObject *o, const char *key)
{
	JsonNode *node = json_object_get_member(o, key);
	return node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
}

static bool read_ref(GPtrArray *list, JsonNode *node)
{
	uint32_t id, up;
	JsonObject *o = JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
	JsonArray *anchors = o ? list_in(o, "anchors") : NULL;
	if (!anchors || !number_in(o, "id", &id) || !number_in(o, "up", &up) ||
		json_array_get_length(anchors) % 2)
		return false;
	struct segment_ref *r = segment_edit_add_ref(list, id, up);
	for (guint i = 0; i < json_array_get_length(anchors); i += 2) {
		JsonNode *scan = json_array_get_element(anchors, i),
			 *cell = json_array_get_element(anchors, i + 1);
		if (!is_of(scan, G_TYPE_INT64) || !is_of(cell, G_TYPE_INT64))
			return false;
		struct segment_anchor a = { (uint32_t)json_node_get_int(scan),
			(uint32_t)json_node_get_int(cell) };
		g_array_append_val(r->anchors, a);
	}
	return true;
}

static bool read_refs(GPtrArray *list, JsonArray *refs)
{
	for (guint i = 0; refs && i < json_array_get_length(refs); i++)
		if (!read_ref(list, json_array_get_element(refs, i)))
			return false;
	return true;
}

static int op_of(const char *name)
{
	for (int i = 0; name && i < SEGMENT_OPS; i++)
		if (strcmp(name, segment_op_names[i]) == 0)
			return i;
	return -1;
}

/* How many segments each kind of change speaks of, at least and at most; draw also needs a class or a segment. */
static bool is_whole(const segment_edit *e)
{
	guint n = e->segments->len;
	switch (e->op) {
	case EDIT_RENAME: return n == 1 && e->name && e->name[0];
	case EDIT_MERGE: return n >= 2;
	case EDIT_SPLIT: return n == 1 && e->gap_m > 0 && isfinite(e->gap_m);
	case EDIT_MOVE: return n + (e->class >= 0) == 2 && n;
	default: return n + (e->class >= 0) == 1 && e->runs->len;
	}
}

static segment_edit *parse_edit(JsonObject *o, const struct cell_run *runs, uint64_t count)
{
	int op = op_of(text_in(o, "op"));
	const char *class = text_in(o, "class");
	JsonNode *gap = json_object_get_member(o, "gap_m");
	JsonArray *refs = list_in(o, "segments");
	if (op < 0 || !refs || (class && segment_class_find(class) < 0))
		return NULL;
	g_autoptr(segment_edit) e = segment_edit_new((enum segment_op)op);
	e->time = g_strdup(text_in(o, "time"));
	e->base = g_strdup(text_in(o, "base"));
	e->name = g_strdup(text_in(o, "name"));
	e->class = class ? segment_class_find(class) : -1;
	e->gap_m = gap && JSON_NODE_HOLDS_VALUE(gap) ? json_node_get_double(gap) : 0;
	if (!number_in(o, "points_min", &e->points_min) || !number_in(o, "scan", &e->scan))
		return NULL;
	if (!read_refs(e->segments, refs) || !read_refs(e->made, list_in(o, "made")))
		return NULL;
	g_array_append_vals(e->runs, runs, (guint)count);
	return is_whole(e) ? g_steal_pointer(&e) : NULL;
}

segment_edit *segment_edits_read(const site *s, uint32_t number, GError **error)
{
	g_autofree char *path = edit_path(s, number);
	g_autoptr(product) p = product_open(path, KIND, VERSION, error);
	uint64_t count;
	const struct cell_run *runs =
		p && product_verify(p, error)
			? product_section(p, "runs", sizeof(struct cell_run), &count, error)
			: NULL;
	if (!runs)
		return NULL;
	segment_edit *e = parse_edit(product_manifest(p), runs, count);
	if (e)
		e->number = number;
	else
		g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
			"%s: does not tell what was changed", path);
	return e;
}

/* ---- which of them count ---- */

void segment_edits_free(segment_edits *e)
{
	if (!e)
		return;
	g_array_unref(e->done);
	g_array_unref(e->undone);
	g_free(e);
}

static char *list_path(const site *s)
{
	return g_build_filename(site_path(s), "edits", "edits.json", NULL);
}

static bool read_list(const manifest *m, const char *key, GArray *ret, GError **error)
{
	JsonNode *node = manifest_get_node(m, key);
	JsonArray *list = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	bool good = list != NULL;
	for (guint i = 0; good && i < json_array_get_length(list); i++) {
		JsonNode *number = json_array_get_element(list, i);
		good = is_of(number, G_TYPE_INT64) && json_node_get_int(number) > 0 &&
		       json_node_get_int(number) < G_MAXUINT32;
		uint32_t value = good ? (uint32_t)json_node_get_int(number) : 0;
		g_array_append_val(ret, value);
	}
	if (!good)
		g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE,
			"%s: '%s' is not a list of numbers", manifest_path(m), key);
	return good;
}

segment_edits *segment_edits_load(const site *s, GError **error)
{
	g_autofree char *path = list_path(s);
	g_autoptr(segment_edits) e = g_new0(segment_edits, 1);
	e->done = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	e->undone = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	if (!g_file_test(path, G_FILE_TEST_EXISTS))
		return g_steal_pointer(&e);
	g_autoptr(manifest) m = manifest_load(path, SCHEMA, error);
	return m && read_list(m, "done", e->done, error) && read_list(m, "undone", e->undone, error)
		       ? g_steal_pointer(&e)
		       : NULL;
}

static JsonNode *write_list(const GArray *numbers)
{
	JsonArray *list = json_array_new();
	for (guint i = 0; i < numbers->len; i++)
		json_array_add_int_element(list, g_array_index(numbers, uint32_t, i));
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, list);
	return node;
}

static bool save_list(const segment_edits *e, const site *s, GError **error)
{
	g_autofree char *path = list_path(s);
	g_autoptr(manifest) m = manifest_new(path);
	manifest_set_int(m, "schema", SCHEMA);
	manifest_set_node(m, "done", write_list(e->done));
	manifest_set_node(m, "undone", write_list(e->undone));
	return manifest_save(m, error);
}

/* Above all that were ever written: files of what was undone stay. */
static bool find_number(const site *s, uint32_t *ret, GError **error)
{
	g_autofree char *folder = g_build_filename(site_path(s), "edits", NULL);
	g_autoptr(GPtrArray) names =
		files_make_folder(folder, error) ? files_names(folder, error) : NULL;
	*ret = 1;
	for (guint i = 0; names && i < names->len; i++)
		*ret = MAX(*ret, (uint32_t)g_ascii_strtoull(names->pdata[i], NULL, 10) + 1);
	return names;
}

static char *now_text(void)
{
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	return g_date_time_format_iso8601(now);
}

bool segment_edits_append(segment_edits *e, site *s, segment_edit *edit, GError **error)
{
	g_assert(is_whole(edit));
	if (!find_number(s, &edit->number, error))
		return false;
	g_free(edit->time);
	edit->time = now_text();
	g_autofree char *path = edit_path(s, edit->number);
	g_array_append_val(e->done, edit->number);
	g_array_set_size(e->undone, 0);
	return save_edit(edit, path, error) && save_list(e, s, error);
}

static bool move_last(
	segment_edits *e, site *s, GArray *from, GArray *to, const char *what, GError **error)
{
	if (!from->len) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "%s: there is nothing to %s",
			site_path(s), what);
		return false;
	}
	uint32_t number = g_array_index(from, uint32_t, from->len - 1);
	g_array_set_size(from, from->len - 1);
	g_array_append_val(to, number);
	return save_list(e, s, error);
}

bool segment_edits_undo(segment_edits *e, site *s, GError **error)
{
	return move_last(e, s, e->done, e->undone, "undo", error);
}

bool segment_edits_redo(segment_edits *e, site *s, GError **error)
{
	return move_last(e, s, e->undone, e->done, "do again", error);
}

char *segment_edits_done(const segment_edits *e)
{
	g_autoptr(GString) text = g_string_new(NULL);
	for (guint i = 0; i < e->done->len; i++)
		g_string_append_printf(
			text, "%s%u", i ? " " : "", g_array_index(e->done, uint32_t, i));
	return g_string_free(g_steal_pointer(&text), FALSE);
}
