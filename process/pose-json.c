#include "process/pose-json.h"
#include <json-glib/json-glib.h>
#include <math.h>

static JsonNode *node_of(JsonArray *array)
{
	JsonNode *node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, array);
	return node;
}

bool json_read_numbers(JsonNode *node, size_t count, double *ret)
{
	JsonArray *array = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	if (!array || json_array_get_length(array) != count)
		return false;
	for (unsigned i = 0; i < count; i++) {
		JsonNode *element = json_array_get_element(array, i);
		GType type = JSON_NODE_HOLDS_VALUE(element) ? json_node_get_value_type(element) : 0;
		if (type != G_TYPE_INT64 && type != G_TYPE_DOUBLE)
			return false;
		ret[i] = json_node_get_double(element);
		if (!isfinite(ret[i]))
			return false;
	}
	return true;
}

JsonNode *json_write_numbers(const double *number, size_t count)
{
	JsonArray *array = json_array_sized_new((guint)count);
	for (size_t i = 0; i < count; i++)
		json_array_add_double_element(array, isfinite(number[i]) ? number[i] : 0);
	return node_of(array);
}

static bool read_rotation(JsonNode *node, double ret[3][3])
{
	JsonArray *rows = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	if (!rows || json_array_get_length(rows) != 3)
		return false;
	for (unsigned i = 0; i < 3; i++)
		if (!json_read_numbers(json_array_get_element(rows, i), 3, ret[i]))
			return false;
	return true;
}

bool json_read_pose(JsonNode *node, struct pose *ret)
{
	JsonObject *o = node && JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
	if (!o || !read_rotation(json_object_get_member(o, "rotation"), ret->rotation) ||
		!json_read_numbers(
			json_object_get_member(o, "translation_m"), 3, ret->translation_m) ||
		!pose_is_rigid(ret, 1e-4))
		return false;
	/* What this program wrote is read back bit by bit. */
	if (!pose_is_rigid(ret, 1e-9))
		pose_orthonormalise(ret);
	return true;
}

JsonNode *json_write_pose(const struct pose *p)
{
	JsonObject *o = json_object_new();
	JsonArray *rows = json_array_new();
	for (int i = 0; i < 3; i++)
		json_array_add_element(rows, json_write_numbers(p->rotation[i], 3));
	json_object_set_array_member(o, "rotation", rows);
	json_object_set_member(o, "translation_m", json_write_numbers(p->translation_m, 3));
	JsonNode *node = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(node, o);
	return node;
}
