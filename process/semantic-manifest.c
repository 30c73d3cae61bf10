#include "process/semantic-manifest.h"
#include "acquire/manifest.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#define TILE_LEAST 8
#define TILE_MOST  16384

const char *const semantic_channel_names[SEMANTIC_CHANNELS] = { "range_m", "intensity", "red",
	"green", "blue", "height_m", "normal_x", "normal_y", "normal_z", "curvature", "measured" };

static bool refuse(GError **error, const manifest *m, const char *format, ...) G_GNUC_PRINTF(3, 4);

static bool refuse(GError **error, const manifest *m, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE, "%s: %s", manifest_path(m), what);
	return false;
}

static int find_name(const char *const *names, unsigned count, const char *name)
{
	for (unsigned i = 0; i < count; i++)
		if (strcmp(names[i], name) == 0)
			return (int)i;
	return -1;
}

static JsonArray *list_of(const manifest *m, const char *key, unsigned most, GError **error)
{
	JsonNode *node = manifest_get_node(m, key);
	if (!node) {
		g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_MISSING, "%s: '%s' is missing",
			manifest_path(m), key);
		return NULL;
	}
	JsonArray *list = JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	unsigned length = list ? json_array_get_length(list) : 0;
	if (length >= 1 && length <= most)
		return list;
	refuse(error, m, "'%s' must be a list of 1 to %u", key, most);
	return NULL;
}

static const char *text_of(JsonNode *node)
{
	return node && JSON_NODE_HOLDS_VALUE(node) &&
			       json_node_get_value_type(node) == G_TYPE_STRING
		       ? json_node_get_string(node)
		       : NULL;
}

static bool number_of(JsonNode *node, float *ret)
{
	GType type = node && JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node) : 0;
	if (type != G_TYPE_INT64 && type != G_TYPE_DOUBLE)
		return false;
	*ret = (float)json_node_get_double(node);
	return isfinite(*ret);
}

/* ---- channels ---- */

static bool read_weights(
	const manifest *m, JsonObject *o, unsigned at, struct semantic_input *ret, GError **error)
{
	JsonNode *mean = json_object_get_member(o, "mean"),
		 *scale = json_object_get_member(o, "scale");
	if (mean && !number_of(mean, &ret->mean))
		return refuse(error, m, "'channels', entry %u: 'mean' must be a number", at + 1);
	if (scale && !number_of(scale, &ret->scale))
		return refuse(error, m, "'channels', entry %u: 'scale' must be a number", at + 1);
	return true;
}

static bool read_channel(
	const manifest *m, JsonNode *node, unsigned at, struct semantic_input *ret, GError **error)
{
	JsonObject *o = JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
	const char *name = text_of(o ? json_object_get_member(o, "name") : node);
	*ret = (struct semantic_input){ .scale = 1 };
	if (!name)
		return refuse(error, m,
			"'channels', entry %u: must be a name, or an object with a 'name'", at + 1);
	int channel = find_name(semantic_channel_names, SEMANTIC_CHANNELS, name);
	if (channel < 0)
		return refuse(
			error, m, "'channels', entry %u: there is no channel \"%s\"", at + 1, name);
	ret->channel = (enum semantic_channel)channel;
	return !o || read_weights(m, o, at, ret, error);
}

static bool read_channels(const manifest *m, semantic_manifest *ret, GError **error)
{
	JsonArray *list = list_of(m, "channels", SEMANTIC_CHANNELS, error);
	unsigned count = list ? json_array_get_length(list) : 0;
	for (unsigned i = 0; i < count; i++) {
		struct semantic_input *input = &ret->input[i];
		if (!read_channel(m, json_array_get_element(list, i), i, input, error))
			return false;
		for (unsigned k = 0; k < i; k++)
			if (ret->input[k].channel == input->channel)
				return refuse(error, m, "'channels': \"%s\" is there twice",
					semantic_channel_names[input->channel]);
	}
	ret->inputs = count;
	return list;
}

/* ---- classes ---- */

static bool read_classes(const manifest *m, semantic_manifest *ret, GError **error)
{
	JsonArray *list = list_of(m, "classes", SEMANTIC_CLASSES_MAX, error);
	unsigned count = list ? json_array_get_length(list) : 0;
	ret->class_name = g_new0(char *, count + 1);
	for (unsigned i = 0; i < count; i++) {
		const char *name = text_of(json_array_get_element(list, i));
		if (!name || !*name)
			return refuse(error, m, "'classes', entry %u: must be a name", i + 1);
		if (find_name((const char *const *)ret->class_name, i, name) >= 0)
			return refuse(error, m, "'classes': \"%s\" is there twice", name);
		int kind = segment_class_find(name);
		ret->class_name[i] = g_strdup(name);
		ret->kind[i] = kind < 0 ? CLASS_OTHER : (enum segment_class)kind;
	}
	ret->classes = count;
	return list;
}

static bool read_scores(const manifest *m, semantic_manifest *ret, GError **error)
{
	if (!manifest_has(m, "scores"))
		return true;
	const char *scores = manifest_get_string(m, "scores", error);
	if (!scores)
		return false;
	ret->probabilities = strcmp(scores, "probabilities") == 0;
	return ret->probabilities || strcmp(scores, "logits") == 0 ||
	       refuse(error, m, "'scores' must be \"logits\" or \"probabilities\"");
}

/* ---- tiles ---- */

static bool read_tile(const manifest *m, semantic_manifest *ret, GError **error)
{
	if (!manifest_has(m, "tile"))
		return true;
	JsonNode *node = manifest_get_node(m, "tile");
	JsonArray *list = JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	float side[2] = { 0 };
	bool good = list && json_array_get_length(list) == 2;
	for (unsigned i = 0; i < 2 && good; i++)
		good = number_of(json_array_get_element(list, i), &side[i]) &&
		       side[i] >= TILE_LEAST && side[i] <= TILE_MOST && side[i] == floorf(side[i]);
	if (!good)
		return refuse(error, m,
			"'tile' must be columns and rows, whole numbers of %d to %d", TILE_LEAST,
			TILE_MOST);
	ret->tile_columns = (uint32_t)side[0];
	ret->tile_rows = (uint32_t)side[1];
	return true;
}

static bool read_overlap(const manifest *m, semantic_manifest *ret, GError **error)
{
	int64_t overlap = 0;
	if (manifest_has(m, "overlap") &&
		!manifest_get_int(m, "overlap", 0, TILE_MOST / 2 - 1, &overlap, error))
		return false;
	uint32_t least = MIN(ret->tile_columns, ret->tile_rows);
	if (least && 2 * overlap >= least)
		return refuse(error, m, "'overlap' must be less than half of the tile");
	ret->overlap = (uint32_t)overlap;
	return true;
}

semantic_manifest *semantic_manifest_parse(
	const char *text, size_t length, const char *path, GError **error)
{
	g_autoptr(manifest) m = manifest_parse(text, length, path, 0, error);
	if (!m)
		return NULL;
	g_autoptr(semantic_manifest) ret = g_new0(semantic_manifest, 1);
	if (!read_channels(m, ret, error) || !read_classes(m, ret, error) ||
		!read_scores(m, ret, error) || !read_tile(m, ret, error) ||
		!read_overlap(m, ret, error))
		return NULL;
	return g_steal_pointer(&ret);
}

void semantic_manifest_free(semantic_manifest *m)
{
	if (!m)
		return;
	g_strfreev(m->class_name);
	g_free(m);
}
