#include "acquire/manifest.h"
#include "acquire/strict-json.h"
#include "firmware-io/files.h"
#include <math.h>
#include <string.h>

G_DEFINE_QUARK(manifest - error - quark, manifest_error)

struct manifest {
	char *path;
	JsonNode *root; /* an object */
};

static bool refuse(GError **error, const manifest *m, int code, const char *format, ...)
	G_GNUC_PRINTF(4, 5);

static bool refuse(GError **error, const manifest *m, int code, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, MANIFEST_ERROR, code, "%s: %s", m->path, what);
	return false;
}

manifest *manifest_new(const char *path)
{
	manifest *m = g_new0(manifest, 1);
	m->path = g_strdup(path);
	m->root = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(m->root, json_object_new());
	return m;
}

void manifest_free(manifest *m)
{
	if (!m)
		return;
	g_clear_pointer(&m->root, json_node_unref);
	g_free(m->path);
	g_free(m);
}

const char *manifest_path(const manifest *m)
{
	return m->path;
}

static bool check_schema(const manifest *m, int schema_max, GError **error)
{
	int64_t schema;
	if (!manifest_get_int(m, "schema", 1, INT32_MAX, &schema, error))
		return false;
	if (schema > schema_max)
		return refuse(error, m, MANIFEST_ERROR_SCHEMA,
			"was written by a later version (schema %d; this program knows %d)",
			(int)schema, schema_max);
	return true;
}

manifest *manifest_parse(
	const char *text, size_t length, const char *path, int schema_max, GError **error)
{
	g_autoptr(manifest) m = g_new0(manifest, 1);
	m->path = g_strdup(path);
	if (length == 0)
		return refuse(error, m, MANIFEST_ERROR_VALUE, "is empty"), NULL;
	if (length > MANIFEST_BYTES_MAX)
		return refuse(error, m, MANIFEST_ERROR_VALUE,
			       "has %zu bytes; a manifest has at most %d", length,
			       MANIFEST_BYTES_MAX),
		       NULL;
	m->root = strict_json_read(text, length, error);
	if (!m->root)
		return g_prefix_error(error, "%s: ", path), NULL;
	if (!JSON_NODE_HOLDS_OBJECT(m->root))
		return refuse(error, m, MANIFEST_ERROR_VALUE, "does not hold an object {...}"),
		       NULL;
	return schema_max == 0 || check_schema(m, schema_max, error) ? g_steal_pointer(&m) : NULL;
}

manifest *manifest_load(const char *path, int schema_max, GError **error)
{
	size_t length;
	g_autofree char *text = files_read(path, MANIFEST_BYTES_MAX, &length, error);
	return text ? manifest_parse(text, length, path, schema_max, error) : NULL;
}

bool manifest_save_as(const manifest *m, const char *path, GError **error)
{
	g_autofree char *text = manifest_to_text(m);
	return files_write(path, text, strlen(text), error);
}

bool manifest_save(const manifest *m, GError **error)
{
	return manifest_save_as(m, m->path, error);
}

char *manifest_to_text(const manifest *m)
{
	return strict_json_write(m->root);
}

JsonNode *manifest_get_node(const manifest *m, const char *key)
{
	g_assert(*key);
	g_auto(GStrv) names = g_strsplit(key, ".", -1);
	JsonNode *node = m->root;
	for (char **name = names; *name && node; name++)
		node = JSON_NODE_HOLDS_OBJECT(node)
			       ? json_object_get_member(json_node_get_object(node), *name)
			       : NULL;
	return node;
}

bool manifest_has(const manifest *m, const char *key)
{
	return manifest_get_node(m, key);
}

static JsonNode *find(const manifest *m, const char *key, GError **error)
{
	JsonNode *node = manifest_get_node(m, key);
	if (!node)
		refuse(error, m, MANIFEST_ERROR_MISSING, "'%s' is missing", key);
	return node;
}

static bool refuse_kind(
	GError **error, const manifest *m, const char *key, JsonNode *node, const char *wanted)
{
	return refuse(error, m, MANIFEST_ERROR_VALUE, "'%s' is %s; it must be %s", key,
		strict_json_kind(node), wanted);
}

static bool is_number(JsonNode *node)
{
	return JSON_NODE_HOLDS_VALUE(node) &&
	       (json_node_get_value_type(node) == G_TYPE_INT64 ||
		       json_node_get_value_type(node) == G_TYPE_DOUBLE);
}

/* A double is taken only where it stands for one integer: beyond 2^53 it does for several. */
static bool to_int(JsonNode *node, int64_t *ret)
{
	if (json_node_get_value_type(node) == G_TYPE_INT64)
		return *ret = json_node_get_int(node), true;
	double value = json_node_get_double(node);
	if (fabs(value) > 0x1p53 || value != rint(value))
		return false;
	*ret = (int64_t)value;
	return true;
}

bool manifest_get_int(
	const manifest *m, const char *key, int64_t min, int64_t max, int64_t *ret, GError **error)
{
	JsonNode *node = find(m, key, error);
	int64_t value;
	if (!node)
		return false;
	if (!is_number(node))
		return refuse_kind(error, m, key, node, "a whole number");
	if (!to_int(node, &value))
		return refuse(error, m, MANIFEST_ERROR_VALUE,
			"'%s' is %g; it must be a whole number", key, json_node_get_double(node));
	if (value < min || value > max)
		return refuse(error, m, MANIFEST_ERROR_VALUE,
			"'%s' is %" G_GINT64_FORMAT "; it must be %" G_GINT64_FORMAT
			" to %" G_GINT64_FORMAT,
			key, value, min, max);
	*ret = value;
	return true;
}

bool manifest_get_number(
	const manifest *m, const char *key, double min, double max, double *ret, GError **error)
{
	JsonNode *node = find(m, key, error);
	if (!node)
		return false;
	if (!is_number(node))
		return refuse_kind(error, m, key, node, "a number");
	double value = json_node_get_double(node);
	if (!(value >= min && value <= max))
		return refuse(error, m, MANIFEST_ERROR_VALUE, "'%s' is %g; it must be %g to %g",
			key, value, min, max);
	*ret = value;
	return true;
}

const char *manifest_get_string(const manifest *m, const char *key, GError **error)
{
	JsonNode *node = find(m, key, error);
	if (!node)
		return NULL;
	if (JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_STRING)
		return json_node_get_string(node);
	refuse_kind(error, m, key, node, "a text");
	return NULL;
}

static JsonObject *object_in(JsonObject *parent, const char *name)
{
	JsonNode *node = json_object_get_member(parent, name);
	if (!node || !JSON_NODE_HOLDS_OBJECT(node))
		json_object_set_object_member(parent, name, json_object_new());
	return json_object_get_object_member(parent, name);
}

void manifest_set_node(manifest *m, const char *key, JsonNode *value)
{
	g_assert(*key);
	g_auto(GStrv) names = g_strsplit(key, ".", -1);
	JsonObject *object = json_node_get_object(m->root);
	char **name = names;
	for (; name[1]; name++)
		object = object_in(object, *name);
	json_object_set_member(object, *name, value);
}

void manifest_remove(manifest *m, const char *key)
{
	g_assert(*key);
	g_auto(GStrv) names = g_strsplit(key, ".", -1);
	JsonObject *object = json_node_get_object(m->root);
	char **name = names;
	for (; name[1]; name++) {
		JsonNode *node = json_object_get_member(object, *name);
		if (!node || !JSON_NODE_HOLDS_OBJECT(node))
			return;
		object = json_node_get_object(node);
	}
	if (json_object_has_member(object, *name))
		json_object_remove_member(object, *name);
}

void manifest_set_int(manifest *m, const char *key, int64_t value)
{
	manifest_set_node(m, key, json_node_init_int(json_node_alloc(), value));
}

void manifest_set_number(manifest *m, const char *key, double value)
{
	manifest_set_node(m, key, json_node_init_double(json_node_alloc(), value));
}

void manifest_set_string(manifest *m, const char *key, const char *value)
{
	manifest_set_node(m, key, json_node_init_string(json_node_alloc(), value));
}
