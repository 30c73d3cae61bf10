/* Values of parameters. */
#include "render/colour-text.h"
#include "render/nearest-name.h"
#include "render/pencil-box.h"
#include "render/style-reader.h"
#include "render/xtoon.h"
#include <math.h>
#include <string.h>

/* As JSON has it, whatever the language. */
static char *number_text(double value)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	return g_strdup(g_ascii_formatd(text, sizeof text, "%g", value));
}

/* "1 to 400 px". */
static char *range_text(const struct step_parameter *p)
{
	g_autofree char *least = number_text(p->least), *most = number_text(p->most);
	return g_strdup_printf("%s to %s%s%s", least, most, *p->unit ? " " : "", p->unit);
}

static bool is_number(JsonNode *node)
{
	return JSON_NODE_HOLDS_VALUE(node) &&
	       (json_node_get_value_type(node) == G_TYPE_INT64 ||
		       json_node_get_value_type(node) == G_TYPE_DOUBLE);
}

static bool refuse_number(
	style_reader *r, const struct step_parameter *p, JsonNode *node, double value)
{
	g_autofree char *range = range_text(p), *written = number_text(value);
	return style_reader_refuse(r, node, "%s is too %s; it goes from %s", written,
		value > p->most ? "much" : "little", range);
}

static bool read_number(style_reader *r, const struct step_parameter *p, JsonNode *node, float *ret)
{
	if (!is_number(node)) {
		g_autofree char *range = range_text(p);
		g_autofree char *wanted = g_strdup_printf("a number from %s", range);
		return style_reader_wrong(r, node, wanted);
	}
	double value = json_node_get_double(node);
	if (!(value >= p->least && value <= p->most))
		return refuse_number(r, p, node, value);
	*ret = (float)value + 0.0f; /* -0 is 0: steps are compared by their bytes */
	return true;
}

static bool read_choice(
	style_reader *r, const struct step_parameter *p, JsonNode *node, int32_t *ret)
{
	g_autofree char *all = g_strjoinv(", ", (char **)p->choices);
	g_autofree char *wanted = g_strconcat("one of ", all, NULL);
	const char *text = style_reader_text(r, node, wanted);
	if (!text)
		return false;
	for (int32_t i = 0; p->choices[i]; i++)
		if (strcmp(p->choices[i], text) == 0)
			return *ret = i, true;
	const char *nearest = nearest_name(text, p->choices);
	g_autofree char *quoted = style_reader_quote(text);
	return style_reader_refuse(r, node, "there is no '%s'; it is %s%s%s%s", quoted, wanted,
		nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

static bool read_boolean(style_reader *r, JsonNode *node, int32_t *ret)
{
	if (!JSON_NODE_HOLDS_VALUE(node) || json_node_get_value_type(node) != G_TYPE_BOOLEAN)
		return style_reader_wrong(r, node, "true or false");
	*ret = json_node_get_boolean(node);
	return true;
}

static bool read_colour(style_reader *r, JsonNode *node, uint8_t ret[4])
{
	const char *text = style_reader_text(r, node, "a colour \"#rrggbb\"");
	if (!text)
		return false;
	if (!colour_of_text(text, ret)) {
		g_autofree char *quoted = style_reader_quote(text);
		return style_reader_refuse(
			r, node, "'%s' is no colour; colours are \"#rrggbb\"", quoted);
	}
	ret[3] = 255;
	return true;
}

static bool is_path(const char *text)
{
	return strchr(text, '/') || g_str_has_suffix(text, ".png");
}

/* From the folder of the style's file. */
static const char *intern_path(const style_reader *r, const char *text)
{
	const char *folder = r->document->folder;
	g_autofree char *path = folder && !g_path_is_absolute(text)
					? g_build_filename(folder, text, NULL)
					: g_strdup(text);
	return g_intern_string(path);
}

/* Whether there is such a texture is asked when it is drawn with. */
static bool read_texture(style_reader *r, JsonNode *node, const char **ret)
{
	const char *text = style_reader_words(r, node);
	if (!text)
		return false;
	if (!is_path(text)) {
		text = style_reader_name(r, node, "the name of a texture, or the path of a PNG");
		*ret = text ? g_intern_string(text) : *ret;
		return text;
	}
	if (!g_str_has_suffix(text, ".png"))
		return style_reader_refuse(r, node, "a texture is the path of a .png");
	*ret = intern_path(r, text);
	return true;
}

/* Whether there is such a file, and what is in it, is asked when it is drawn with. */
static bool read_model(style_reader *r, JsonNode *node, const char **ret)
{
	const char *text = style_reader_words(r, node);
	if (!text)
		return false;
	if (!g_str_has_suffix(text, ".onnx"))
		return style_reader_refuse(r, node, "a network is the path of a .onnx");
	*ret = intern_path(r, text);
	return true;
}

/* ---- lists ---- */

/* Kept as JSON, each once, so that steps can be compared. */
static const char *intern_json(JsonNode *node)
{
	g_autofree char *text = json_to_string(node, FALSE);
	return g_intern_string(text);
}

static const char *const stop_fields[] = { "brightness", "depth", "colour", "chance", NULL };

static bool read_stop_field(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	static const struct step_parameter part = { .least = 0, .most = 1, .unit = "" };
	uint8_t colour[4];
	float number;
	bool *has_brightness = user_data;
	if (strcmp(key, "colour") == 0)
		return read_colour(r, value, colour);
	*has_brightness |= strcmp(key, "brightness") == 0;
	for (const char *const *known = stop_fields; *known; known++)
		if (strcmp(key, *known) == 0)
			return read_number(r, &part, value, &number);
	return style_reader_unknown(r, key, value, "a stop", stop_fields);
}

static bool read_stop(style_reader *r, JsonNode *node)
{
	bool has_brightness = false;
	if (!style_reader_object(r, node, "a stop, with \"brightness\" and more") ||
		!style_reader_each(r, node, read_stop_field, &has_brightness))
		return false;
	return has_brightness || style_reader_refuse(r, node, "\"brightness\" is missing");
}

static bool read_each(style_reader *r, JsonNode *node, guint least, guint most,
	bool (*read)(style_reader *r, JsonNode *node))
{
	JsonArray *list = style_reader_list(r, node, "a list");
	guint count = list ? json_array_get_length(list) : 0;
	if (!list)
		return false;
	if (count < least || count > most)
		return style_reader_refuse(
			r, node, "it has %u to %u elements; these are %u", least, most, count);
	for (guint i = 0; i < count; i++) {
		gsize was = style_reader_enter_element(r, i);
		if (!read(r, json_array_get_element(list, i)))
			return false;
		style_reader_leave(r, was);
	}
	return true;
}

static bool read_xtoon(style_reader *r, JsonNode *node, const char **ret)
{
	if (JSON_NODE_HOLDS_VALUE(node)) {
		const char *path = NULL;
		if (!read_texture(r, node, &path))
			return false;
		if (!is_path(path))
			return style_reader_refuse(
				r, node, "it is a list of stops, or the path of a .png");
		*ret = path;
		return true;
	}
	if (!read_each(r, node, 1, XTOON_STOPS_MAX, read_stop))
		return false;
	*ret = intern_json(node);
	return true;
}

static bool read_pencil(style_reader *r, JsonNode *node)
{
	uint8_t colour[4];
	return read_colour(r, node, colour);
}

static bool read_pencils(style_reader *r, JsonNode *node, const char **ret)
{
	if (!read_each(r, node, 0, PENCIL_BOX_MOST, read_pencil))
		return false;
	*ret = intern_json(node);
	return true;
}

/* ---- all ---- */

bool style_reader_parameter(
	style_reader *r, const struct step_parameter *p, JsonNode *value, void *into)
{
	void *at = (char *)into + p->offset;
	switch (p->type) {
	case PARAMETER_NUMBER: return read_number(r, p, value, at);
	case PARAMETER_CHOICE: return read_choice(r, p, value, at);
	case PARAMETER_BOOLEAN: return read_boolean(r, value, at);
	case PARAMETER_COLOUR: return read_colour(r, value, at);
	case PARAMETER_XTOON: return read_xtoon(r, value, at);
	case PARAMETER_MODEL: return read_model(r, value, at);
	case PARAMETER_PENCILS: return read_pencils(r, value, at);
	default: return read_texture(r, value, at);
	}
}
