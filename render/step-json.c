#include "render/step-json.h"
#include <math.h>
#include <string.h>

/* As many digits as tell floats apart, no more. */
static double short_number(float value)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	for (int digits = 3; digits <= 9; digits++) {
		g_autofree char *format = g_strdup_printf("%%.%dg", digits);
		g_ascii_formatd(text, sizeof text, format, (double)value);
		if ((float)g_ascii_strtod(text, NULL) == value)
			break;
	}
	return g_ascii_strtod(text, NULL);
}

static JsonNode *string_node(const char *text)
{
	return json_node_init_string(json_node_alloc(), text);
}

static JsonNode *number_node(float value)
{
	double v = short_number(value);
	if (v == floor(v) && fabs(v) < 1e15)
		return json_node_init_int(json_node_alloc(), (gint64)v);
	return json_node_init_double(json_node_alloc(), v);
}

JsonNode *step_parameter_to_json(const struct step_parameter *p, const void *from)
{
	const uint8_t *at = (const uint8_t *)from + p->offset;
	const char *name;
	float number;
	int32_t which;
	char colour[8];
	switch (p->type) {
	case PARAMETER_NUMBER: memcpy(&number, at, sizeof number); return number_node(number);
	case PARAMETER_CHOICE:
		memcpy(&which, at, sizeof which);
		return string_node(p->choices[which]);
	case PARAMETER_BOOLEAN:
		memcpy(&which, at, sizeof which);
		return json_node_init_boolean(json_node_alloc(), which != 0);
	case PARAMETER_COLOUR:
		g_snprintf(colour, sizeof colour, "#%02x%02x%02x", at[0], at[1], at[2]);
		return string_node(colour);
	case PARAMETER_TEXTURE:
	case PARAMETER_MODEL: memcpy(&name, at, sizeof name); return string_node(name ? name : "");
	case PARAMETER_XTOON:
	case PARAMETER_PENCILS:
		memcpy(&name, at, sizeof name);
		return *name == '[' ? json_from_string(name, NULL) : string_node(name);
	}
	return json_node_init_null(json_node_alloc());
}

static bool is_default(const struct step *s, const struct step_parameter *p)
{
	struct step plain = step_defaults(s->kind);
	g_autoptr(JsonNode) a = step_parameter_to_json(p, s->bytes);
	g_autoptr(JsonNode) b = step_parameter_to_json(p, plain.bytes);
	return json_node_equal(a, b);
}

JsonObject *step_to_json(const struct step *s)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "step", s->kind->name);
	if (s->id && strcmp(s->id, s->kind->name) != 0)
		json_object_set_string_member(o, "id", s->id);
	for (const struct step_parameter *p = s->kind->parameters; p->name; p++)
		if (!is_default(s, p))
			json_object_set_member(o, p->name, step_parameter_to_json(p, s->bytes));
	return o;
}
