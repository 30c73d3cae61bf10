#include "render/bench-figure.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* style=figure-7a */
static bool matches(JsonNode *node, const char *condition)
{
	const char *equals = strchr(condition, '=');
	if (!equals || !JSON_NODE_HOLDS_OBJECT(node))
		return false;
	g_autofree char *key = g_strndup(condition, (gsize)(equals - condition));
	JsonNode *member = json_object_get_member(json_node_get_object(node), key);
	return member && JSON_NODE_HOLDS_VALUE(member) &&
	       json_node_get_value_type(member) == G_TYPE_STRING &&
	       strcmp(json_node_get_string(member), equals + 1) == 0;
}

static JsonNode *select_element(JsonArray *array, const char *step)
{
	g_auto(GStrv) conditions = g_strsplit(step, ";", -1);
	guint skip = 0;
	for (guint i = 0; i < json_array_get_length(array); i++) {
		JsonNode *node = json_array_get_element(array, i);
		bool good = true;
		guint wanted = 0;
		for (guint n = 0; conditions[n]; n++) {
			if (*conditions[n] == '#')
				wanted = (guint)atoi(conditions[n] + 1);
			else
				good = good && matches(node, conditions[n]);
		}
		if (good && skip++ == wanted)
			return node;
	}
	return NULL;
}

/* NAN: it is not there. */
static double number_of(JsonNode *node)
{
	GType type = node && JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node) : 0;
	if (type == G_TYPE_INT64)
		return (double)json_node_get_int(node);
	return type == G_TYPE_DOUBLE ? json_node_get_double(node) : NAN;
}

static double sum_of(JsonObject *o, const char *names)
{
	g_auto(GStrv) each = g_strsplit(names, "+", -1);
	double sum = 0;
	for (guint n = 0; each[n]; n++)
		sum += number_of(json_object_get_member(o, each[n]));
	return sum;
}

static const char *why_not(JsonNode *node, const char *before)
{
	if (!JSON_NODE_HOLDS_OBJECT(node))
		return before;
	return json_object_get_string_member_with_default(
		json_node_get_object(node), "why_not", before);
}

struct bench_figure bench_figure_find(JsonObject *root, const char *path)
{
	g_auto(GStrv) steps = g_strsplit(path, "/", -1);
	struct bench_figure f = { 0 };
	g_autoptr(JsonNode) top = json_node_new(JSON_NODE_OBJECT);
	JsonNode *node = top;
	if (!root)
		return f;
	json_node_set_object(top, root);
	double value = NAN;
	for (guint n = 0; node && steps[n]; n++) {
		f.why_not = why_not(node, f.why_not);
		bool last = !steps[n + 1];
		if (JSON_NODE_HOLDS_ARRAY(node)) {
			node = select_element(json_node_get_array(node), steps[n]);
			value = last ? number_of(node) : NAN;
		} else if (JSON_NODE_HOLDS_OBJECT(node) && last) {
			value = sum_of(json_node_get_object(node), steps[n]);
		} else {
			node = JSON_NODE_HOLDS_OBJECT(node)
				       ? json_object_get_member(
						 json_node_get_object(node), steps[n])
				       : NULL;
		}
	}
	f.there = isfinite(value);
	f.value = f.there ? value : 0;
	if (f.there)
		f.why_not = NULL;
	return f;
}
