#include "process/segments.h"
#include "acquire/manifest.h"
#include "acquire/strict-json.h"
#include "firmware-io/crc32c.h"
#include <math.h>
#include <string.h>

#define SCHEMA 1

static void clear_segment(gpointer data)
{
	struct segment *s = data;
	g_free(s->name);
	g_free(s->made_by);
}

static segments *new_empty(void)
{
	segments *s = g_new0(segments, 1);
	s->nodes = g_array_new(FALSE, TRUE, sizeof(struct segment));
	g_array_set_clear_func(s->nodes, clear_segment);
	s->labels = g_array_new(FALSE, FALSE, sizeof(struct labels_checksum));
	s->next = SEGMENT_FIRST;
	s->key = g_strdup("");
	s->edits = g_strdup("");
	return s;
}

static struct segment *node_at(const segments *s, guint i)
{
	return &g_array_index(s->nodes, struct segment, i);
}

static const double nowhere_low[3] = { INFINITY, INFINITY, INFINITY },
		    nowhere_high[3] = { -INFINITY, -INFINITY, -INFINITY };

static struct segment new_node(uint32_t id, uint32_t parent, enum segment_class class,
	const char *name, const char *made_by)
{
	struct segment node = { .id = id,
		.parent = parent,
		.class = class,
		.name = g_strdup(name),
		.made_by = g_strdup(made_by) };
	memcpy(node.low_m, nowhere_low, sizeof node.low_m);
	memcpy(node.high_m, nowhere_high, sizeof node.high_m);
	return node;
}

segments *segments_new(void)
{
	segments *s = new_empty();
	struct segment whole = new_node(SEGMENT_SITE, 0, CLASS_OTHER, "Site", "rules");
	g_array_append_val(s->nodes, whole);
	for (int class = 0; class < SEGMENT_CLASSES; class ++) {
		struct segment node =
			new_node(segment_of_class((enum segment_class) class), SEGMENT_SITE,
				(enum segment_class) class, segment_classes[class].title, "rules");
		g_array_append_val(s->nodes, node);
	}
	return s;
}

segments *segments_copy(const segments *s)
{
	segments *copy = new_empty();
	g_free(copy->key);
	copy->key = g_strdup(s->key);
	g_free(copy->edits);
	copy->edits = g_strdup(s->edits);
	copy->next = s->next;
	g_array_append_vals(copy->labels, s->labels->data, s->labels->len);
	for (guint i = 0; i < s->nodes->len; i++) {
		struct segment node = *node_at(s, i);
		node.name = g_strdup(node.name);
		node.made_by = g_strdup(node.made_by);
		g_array_append_val(copy->nodes, node);
	}
	return copy;
}

void segments_free(segments *s)
{
	if (!s)
		return;
	g_array_unref(s->nodes);
	g_array_unref(s->labels);
	g_free(s->key);
	g_free(s->edits);
	g_free(s);
}

/* Where a node of this number is, or would be. */
static guint place_of(const segments *s, uint32_t id)
{
	guint low = 0, high = s->nodes->len;
	while (low < high) {
		guint middle = (low + high) / 2;
		if (node_at(s, middle)->id < id)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

struct segment *segments_find(const segments *s, uint32_t id)
{
	guint at = place_of(s, id);
	return at < s->nodes->len && node_at(s, at)->id == id ? node_at(s, at) : NULL;
}

/* 0: all are in use. */
static uint32_t free_number(const segments *s)
{
	uint32_t id = s->next;
	if (id <= SEGMENTS_MAX)
		return id;
	for (id = SEGMENT_FIRST; id <= SEGMENTS_MAX; id++)
		if (!segments_find(s, id))
			return id;
	return 0;
}

uint32_t segments_add(segments *s, uint32_t parent, const char *name, const char *made_by)
{
	const struct segment *above = segments_find(s, parent);
	uint32_t id = free_number(s);
	g_assert(above);
	if (!id)
		return 0;
	struct segment node = new_node(id, parent, above->class, name, made_by);
	g_array_insert_val(s->nodes, place_of(s, id), node);
	s->next = MAX(s->next, id + 1);
	return id;
}

void segments_remove(segments *s, uint32_t id)
{
	g_assert(segments_find(s, id) && segments_is_leaf(s, id));
	g_array_remove_index(s->nodes, place_of(s, id));
}

static gint by_id(gconstpointer a, gconstpointer b)
{
	const struct segment *x = a, *y = b;
	return (x->id > y->id) - (x->id < y->id);
}

void segments_renumber(segments *s, const uint16_t *becomes)
{
	for (guint i = 0; i < s->nodes->len; i++) {
		struct segment *node = node_at(s, i);
		node->id = node->id < SEGMENT_FIRST ? node->id : becomes[node->id];
		node->parent = node->parent < SEGMENT_FIRST ? node->parent : becomes[node->parent];
		s->next = MAX(s->next, node->id + 1);
	}
	g_array_sort(s->nodes, by_id);
}

bool segments_is_leaf(const segments *s, uint32_t id)
{
	for (guint i = 0; i < s->nodes->len; i++)
		if (node_at(s, i)->parent == id)
			return false;
	return true;
}

bool segments_is_above(const segments *s, uint32_t a, uint32_t b)
{
	const struct segment *node = segments_find(s, b);
	while (node && node->id != a)
		node = segments_find(s, node->parent);
	return node;
}

uint8_t *segments_classes(const segments *s)
{
	uint8_t *classes = g_malloc0(SEGMENTS_MAX + 1);
	for (guint n = 0; n < s->nodes->len; n++) {
		const struct segment *node = &g_array_index(s->nodes, struct segment, n);
		classes[node->id] = (uint8_t)node->class;
	}
	return classes;
}

uint32_t segments_classes_checksum(const uint8_t *leaf_class)
{
	return leaf_class ? crc32c(0, leaf_class, SEGMENTS_MAX + 1) : 0;
}

char *segments_name(const segments *s, uint32_t id)
{
	const struct segment *node = segments_find(s, id);
	if (!node || id == SEGMENT_SITE || node->parent == SEGMENT_SITE)
		return g_strdup(node ? node->name : "");
	g_autofree char *above = segments_name(s, node->parent);
	return g_strdup_printf("%s / %s", above, node->name);
}

/* ---- labels ---- */

void segments_add_labels(segments *s, uint32_t scan, uint32_t checksum)
{
	struct labels_checksum l = { scan, checksum };
	g_array_append_val(s->labels, l);
}

bool segments_has_labels(const segments *s, uint32_t scan, uint32_t checksum)
{
	for (guint i = 0; i < s->labels->len; i++) {
		const struct labels_checksum *l =
			&g_array_index(s->labels, struct labels_checksum, i);
		if (l->scan == scan)
			return l->checksum == checksum;
	}
	return false;
}

/* ---- sums ---- */

void segments_clear_sums(segments *s)
{
	for (guint i = 0; i < s->nodes->len; i++) {
		struct segment *node = node_at(s, i);
		node->points = 0;
		node->area_m2 = 0;
		memcpy(node->low_m, nowhere_low, sizeof node->low_m);
		memcpy(node->high_m, nowhere_high, sizeof node->high_m);
	}
}

void segments_count(segments *s, uint32_t leaf, uint64_t points, const double low_m[3],
	const double high_m[3], double area_m2)
{
	for (struct segment *node = segments_find(s, leaf); node;
		node = segments_find(s, node->parent)) {
		node->points += points;
		node->area_m2 += area_m2;
		for (int k = 0; k < 3; k++) {
			node->low_m[k] = fmin(node->low_m[k], low_m[k]);
			node->high_m[k] = fmax(node->high_m[k], high_m[k]);
		}
	}
}

/* ---- the file ---- */

char *segments_path(const char *site_path)
{
	return g_build_filename(site_path, "segments", "segments.json", NULL);
}

static JsonArray *write_place(const double at_m[3])
{
	JsonArray *a = json_array_new();
	for (int k = 0; k < 3; k++)
		json_array_add_double_element(a, round(at_m[k] * 1000) / 1000);
	return a;
}

static JsonObject *write_node(const struct segment *node)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "id", node->id);
	json_object_set_int_member(o, "parent", node->parent);
	json_object_set_string_member(o, "class", segment_classes[node->class].name);
	json_object_set_string_member(o, "name", node->name);
	json_object_set_string_member(o, "made_by", node->made_by);
	if (node->found)
		json_object_set_int_member(o, "found", node->found);
	json_object_set_int_member(o, "points", (gint64)node->points);
	json_object_set_double_member(o, "area_m2", round(node->area_m2 * 1000) / 1000);
	if (!node->points)
		return o;
	json_object_set_array_member(o, "low_m", write_place(node->low_m));
	json_object_set_array_member(o, "high_m", write_place(node->high_m));
	return o;
}

char *segments_automatic_path(const char *site_path)
{
	return g_build_filename(site_path, "segments", "automatic.json", NULL);
}

static JsonNode *write_labels(const segments *s)
{
	JsonArray *list = json_array_new();
	for (guint i = 0; i < s->labels->len; i++) {
		const struct labels_checksum *l =
			&g_array_index(s->labels, struct labels_checksum, i);
		JsonObject *o = json_object_new();
		json_object_set_int_member(o, "scan", l->scan);
		json_object_set_int_member(o, "checksum", l->checksum);
		json_array_add_object_element(list, o);
	}
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, list);
	return node;
}

bool segments_save(const segments *s, const char *site_path, GError **error)
{
	g_autofree char *path = segments_path(site_path);
	return segments_save_file(s, path, error);
}

bool segments_save_file(const segments *s, const char *path, GError **error)
{
	g_autoptr(manifest) m = manifest_new(path);
	JsonArray *nodes = json_array_new();
	for (guint i = 0; i < s->nodes->len; i++)
		json_array_add_object_element(nodes, write_node(node_at(s, i)));
	manifest_set_int(m, "schema", SCHEMA);
	manifest_set_string(m, "key", s->key);
	manifest_set_string(m, "edits", s->edits);
	manifest_set_int(m, "next", s->next);
	manifest_set_node(m, "labels", write_labels(s));
	manifest_set_node(m, "segments", json_node_init_array(json_node_alloc(), nodes));
	json_array_unref(nodes);
	return manifest_save(m, error);
}

static bool refuse(const char *path, guint i, const char *what, GError **error)
{
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE, "%s: segment %u of the list %s",
		path, i + 1, what);
	return false;
}

static bool is_number(JsonNode *node)
{
	return JSON_NODE_HOLDS_VALUE(node) &&
	       (json_node_get_value_type(node) == G_TYPE_INT64 ||
		       json_node_get_value_type(node) == G_TYPE_DOUBLE);
}

static bool read_place(JsonObject *o, const char *key, double ret_m[3])
{
	JsonNode *node = json_object_get_member(o, key);
	JsonArray *a = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	if (!a)
		return !node;
	for (guint k = 0; k < 3; k++) {
		JsonNode *number =
			k < json_array_get_length(a) ? json_array_get_element(a, k) : NULL;
		if (!number || !is_number(number) ||
			!(isfinite(ret_m[k] = json_node_get_double(number))))
			return false;
	}
	return json_array_get_length(a) == 3;
}

static const char *text_of(JsonObject *o, const char *key)
{
	JsonNode *node = json_object_get_member(o, key);
	return node && JSON_NODE_HOLDS_VALUE(node) &&
			       json_node_get_value_type(node) == G_TYPE_STRING
		       ? json_node_get_string(node)
		       : NULL;
}

static bool read_number(JsonObject *o, const char *key, double max, double *ret)
{
	JsonNode *node = json_object_get_member(o, key);
	if (!node || !is_number(node))
		return false;
	*ret = json_node_get_double(node);
	return *ret >= 0 && *ret <= max;
}

static bool read_whole(JsonObject *o, const char *key, double max, double *ret)
{
	return read_number(o, key, max, ret) && *ret == floor(*ret);
}

static bool read_node(segments *s, JsonNode *json, const char *path, GError **error)
{
	guint i = s->nodes->len;
	double id, parent, points, area_m2, found = 0;
	if (!JSON_NODE_HOLDS_OBJECT(json))
		return refuse(path, i, "is not an object", error);
	JsonObject *o = json_node_get_object(json);
	const char *class = text_of(o, "class"), *name = text_of(o, "name"),
		   *by = text_of(o, "made_by");
	if (!class || segment_class_find(class) < 0)
		return refuse(path, i, "has no class that there is", error);
	if (!name || !by)
		return refuse(path, i, "has no 'name' or no 'made_by'", error);
	if (!read_whole(o, "id", SEGMENTS_MAX, &id) ||
		!read_whole(o, "parent", SEGMENTS_MAX, &parent) ||
		!read_whole(o, "points", 1e15, &points) ||
		!read_number(o, "area_m2", 1e15, &area_m2))
		return refuse(
			path, i, "has no 'id', 'parent', 'points' or 'area_m2' that can be", error);
	if (json_object_has_member(o, "found") && !read_whole(o, "found", SEGMENTS_MAX, &found))
		return refuse(path, i, "has a 'found' that cannot be", error);
	if (id < SEGMENT_SITE || (i && id <= node_at(s, i - 1)->id))
		return refuse(path, i, "has not a larger number than the one before", error);
	struct segment node = new_node((uint32_t)id, (uint32_t)parent,
		(enum segment_class)segment_class_find(class), name, by);
	node.found = (uint32_t)found;
	node.points = (uint64_t)points;
	node.area_m2 = area_m2;
	g_array_append_val(s->nodes, node);
	return (read_place(o, "low_m", node_at(s, i)->low_m) &&
		       read_place(o, "high_m", node_at(s, i)->high_m)) ||
	       refuse(path, i, "has a box that is none", error);
}

/* The site is above all, and each class right below it. */
static bool stands_right(const struct segment *node)
{
	if (node->id == SEGMENT_SITE)
		return node->parent == 0;
	return node->id < segment_of_class(CLASS_OTHER) ||
	       node->id >= segment_of_class(SEGMENT_CLASSES) ||
	       (node->parent == SEGMENT_SITE && segment_of_class(node->class) == node->id);
}

/* Parents must stand before their children in number or not; no node may be above itself. */
static bool check_tree(const segments *s, const char *path, GError **error)
{
	for (guint i = 0; i < s->nodes->len; i++)
		if (!stands_right(node_at(s, i)))
			return refuse(path, i, "is not where the site or a class is", error);
	for (guint i = 0; i < s->nodes->len; i++) {
		const struct segment *node = node_at(s, i);
		guint steps = 0;
		while (node && node->id != SEGMENT_SITE && steps++ <= s->nodes->len)
			node = segments_find(s, node->parent);
		if (!node || steps > s->nodes->len)
			return refuse(path, i, "does not belong to the site", error);
	}
	for (int class = 0; class < SEGMENT_CLASSES; class ++)
		if (!segments_find(s, segment_of_class((enum segment_class) class))) {
			g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE,
				"%s: the class %s is missing", path, segment_classes[class].name);
			return false;
		}
	return true;
}

segments *segments_load(const char *site_path, GError **error)
{
	g_autofree char *path = segments_path(site_path);
	return segments_load_file(path, error);
}

static bool refuse_file(const char *path, const char *what, GError **error)
{
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE, "%s: %s", path, what);
	return false;
}

static bool read_nodes(segments *s, const manifest *m, GError **error)
{
	JsonNode *list = manifest_get_node(m, "segments");
	if (!list || !JSON_NODE_HOLDS_ARRAY(list))
		return refuse_file(manifest_path(m), "'segments' is not a list", error);
	JsonArray *nodes = json_node_get_array(list);
	for (guint i = 0; i < json_array_get_length(nodes); i++)
		if (!read_node(s, json_array_get_element(nodes, i), manifest_path(m), error))
			return false;
	return check_tree(s, manifest_path(m), error);
}

/* Files of before have no "next": what they had last counts then. */
static bool read_next(segments *s, const manifest *m, GError **error)
{
	int64_t least = MAX(node_at(s, s->nodes->len - 1)->id + 1, SEGMENT_FIRST), next = least;
	if (manifest_has(m, "next") &&
		!manifest_get_int(m, "next", least, SEGMENTS_MAX + 1, &next, error))
		return false;
	s->next = (uint32_t)next;
	return true;
}

static bool read_labels(segments *s, const manifest *m, GError **error)
{
	JsonNode *node = manifest_get_node(m, "labels");
	JsonArray *list = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	for (guint i = 0; list && i < json_array_get_length(list); i++) {
		JsonNode *one = json_array_get_element(list, i);
		double scan, checksum;
		if (!JSON_NODE_HOLDS_OBJECT(one) ||
			!read_whole(json_node_get_object(one), "scan", G_MAXUINT32, &scan) ||
			!read_whole(json_node_get_object(one), "checksum", G_MAXUINT32, &checksum))
			return refuse_file(manifest_path(m),
				"'labels' has an entry without 'scan' or 'checksum'", error);
		segments_add_labels(s, (uint32_t)scan, (uint32_t)checksum);
	}
	return list || !node || refuse_file(manifest_path(m), "'labels' is not a list", error);
}

segments *segments_load_file(const char *path, GError **error)
{
	g_autoptr(manifest) m = manifest_load(path, SCHEMA, error);
	g_autoptr(segments) s = new_empty();
	const char *key = m ? manifest_get_string(m, "key", error) : NULL;
	const char *edits = key ? manifest_get_string(m, "edits", error) : NULL;
	if (!edits)
		return NULL;
	g_free(s->key);
	g_free(s->edits);
	s->key = g_strdup(key);
	s->edits = g_strdup(edits);
	if (!read_nodes(s, m, error) || !read_next(s, m, error) || !read_labels(s, m, error))
		return NULL;
	return g_steal_pointer(&s);
}

bool segments_load_any(const char *site_path, segments **ret, GError **error)
{
	g_autoptr(GError) none = NULL;
	*ret = segments_load(site_path, &none);
	if (*ret || g_error_matches(none, G_FILE_ERROR, G_FILE_ERROR_NOENT) ||
		g_error_matches(none, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
		return true;
	g_propagate_error(error, g_steal_pointer(&none));
	return false;
}

bool segments_classes_load(const char *site_path, uint8_t **ret, GError **error)
{
	g_autoptr(segments) tree = NULL;
	if (!segments_load_any(site_path, &tree, error))
		return false;
	*ret = tree ? segments_classes(tree) : NULL;
	return true;
}
