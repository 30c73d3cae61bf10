#include "acquire/strict-json.h"
#include <math.h>
#include <stdbool.h>
#include <string.h>

static void write_value(GString *out, JsonNode *node, int depth);

static void write_string(GString *out, const char *text)
{
	g_string_append_c(out, '"');
	for (const char *c = text; *c; c++) {
		if (*c == '"' || *c == '\\')
			g_string_append_printf(out, "\\%c", *c);
		else if (*c == '\n')
			g_string_append(out, "\\n");
		else if (g_ascii_iscntrl(*c))
			g_string_append_printf(out, "\\u%04x", (unsigned)*c);
		else
			g_string_append_c(out, *c);
	}
	g_string_append_c(out, '"');
}

static void write_double(GString *out, double value)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	if (!isfinite(value)) {
		g_string_append(out, "null");
		return;
	}
	for (int digits = 15; digits <= 17; digits++) {
		char format[8];
		g_snprintf(format, sizeof format, "%%.%dg", digits);
		g_ascii_formatd(text, sizeof text, format, value);
		if (g_ascii_strtod(text, NULL) == value)
			break;
	}
	/* Without a point it would come back as an integer. */
	g_string_append_printf(out, "%s%s", text, strpbrk(text, ".e") ? "" : ".0");
}

static void new_line(GString *out, int depth)
{
	g_string_append_c(out, '\n');
	for (int i = 0; i < depth; i++)
		g_string_append(out, "  ");
}

static void write_object(GString *out, JsonObject *object, int depth)
{
	JsonObjectIter iter;
	const char *key;
	JsonNode *value;
	const char *separator = "{";
	json_object_iter_init_ordered(&iter, object);
	while (json_object_iter_next_ordered(&iter, &key, &value)) {
		g_string_append(out, separator);
		new_line(out, depth + 1);
		write_string(out, key);
		g_string_append(out, ": ");
		write_value(out, value, depth + 1);
		separator = ",";
	}
	if (*separator == '{')
		g_string_append_c(out, '{');
	else
		new_line(out, depth);
	g_string_append_c(out, '}');
}

/* Plain values stand in one line: arrays are matrices and lists of numbers here. */
static void write_array(GString *out, JsonArray *array, int depth)
{
	unsigned length = json_array_get_length(array), nested = 0;
	for (unsigned i = 0; i < length; i++)
		nested += !JSON_NODE_HOLDS_VALUE(json_array_get_element(array, i)) &&
			  !JSON_NODE_HOLDS_NULL(json_array_get_element(array, i));
	g_string_append_c(out, '[');
	for (unsigned i = 0; i < length; i++) {
		if (i)
			g_string_append(out, nested ? "," : ", ");
		if (nested)
			new_line(out, depth + 1);
		write_value(out, json_array_get_element(array, i), depth + 1);
	}
	if (nested)
		new_line(out, depth);
	g_string_append_c(out, ']');
}

static void write_scalar(GString *out, JsonNode *node)
{
	GType type = json_node_get_value_type(node);
	if (type == G_TYPE_STRING)
		write_string(out, json_node_get_string(node));
	else if (type == G_TYPE_BOOLEAN)
		g_string_append(out, json_node_get_boolean(node) ? "true" : "false");
	else if (type == G_TYPE_DOUBLE)
		write_double(out, json_node_get_double(node));
	else
		g_string_append_printf(out, "%" G_GINT64_FORMAT, json_node_get_int(node));
}

static void write_value(GString *out, JsonNode *node, int depth)
{
	switch (json_node_get_node_type(node)) {
	case JSON_NODE_OBJECT: write_object(out, json_node_get_object(node), depth); break;
	case JSON_NODE_ARRAY: write_array(out, json_node_get_array(node), depth); break;
	case JSON_NODE_VALUE: write_scalar(out, node); break;
	default: g_string_append(out, "null");
	}
}

char *strict_json_write(JsonNode *root)
{
	GString *out = g_string_new(NULL);
	write_value(out, root, 0);
	g_string_append_c(out, '\n');
	return g_string_free(out, false);
}
