/* The JSON Schema of styles, for editors: what there is, its ranges, and what it means. */
#include "acquire/strict-json.h"
#include "render/pencil-box.h"
#include "render/style.h"
#include "render/xtoon.h"
#include <math.h>

static JsonObject *text_schema(const char *type, const char *description)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "type", type);
	if (description)
		json_object_set_string_member(o, "description", description);
	return o;
}

static JsonObject *pattern_schema(const char *pattern, const char *description)
{
	JsonObject *o = text_schema("string", description);
	json_object_set_string_member(o, "pattern", pattern);
	return o;
}

static JsonObject *reference(const char *to)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "$ref", to);
	return o;
}

/* "items", or each member of an object. */
static JsonObject *all_schema(const char *type, const char *of, JsonObject *each, const char *text)
{
	JsonObject *o = text_schema(type, text);
	json_object_set_object_member(o, of, each);
	return o;
}

static JsonObject *constant_schema(const char *value, const char *description)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "const", value);
	json_object_set_string_member(o, "description", description);
	return o;
}

/* Whole numbers are written as such. */
static void set_number(JsonObject *o, const char *key, double value)
{
	if (value == rint(value))
		json_object_set_int_member(o, key, (gint64)value);
	else
		json_object_set_double_member(o, key, value);
}

static void set_choices(JsonObject *o, const struct step_parameter *p)
{
	JsonArray *names = json_array_new();
	for (size_t i = 0; p->choices[i]; i++)
		json_array_add_string_element(names, p->choices[i]);
	json_object_set_array_member(o, "enum", names);
	json_object_set_string_member(o, "default", p->choices[(size_t)p->fallback]);
}

/* "#rrggbb" */
static JsonObject *colour_schema(const char *text)
{
	return pattern_schema("^#[0-9a-fA-F]{6}$", text);
}

static JsonObject *part_schema(const char *text)
{
	JsonObject *o = text_schema("number", text);
	json_object_set_int_member(o, "minimum", 0);
	json_object_set_int_member(o, "maximum", 1);
	return o;
}

static JsonObject *stop_schema(void)
{
	JsonObject *o = text_schema("object", NULL), *p = json_object_new();
	JsonArray *required = json_array_new();
	json_object_set_object_member(p, "brightness", part_schema("how light points are"));
	json_object_set_object_member(p, "depth",
		part_schema("how far away they are, from near_m to far_m; without it, at any"));
	json_object_set_object_member(p, "colour", colour_schema("without it, that of ink"));
	json_object_set_object_member(
		p, "chance", part_schema("that strokes have to be drawn; without it 1"));
	json_array_add_string_element(required, "brightness");
	json_object_set_object_member(o, "properties", p);
	json_object_set_array_member(o, "required", required);
	json_object_set_boolean_member(o, "additionalProperties", FALSE);
	return o;
}

/* A list of so many, beside what else it may be. */
static void set_list(JsonObject *o, JsonObject *each, guint least, guint most)
{
	json_object_set_object_member(o, "items", each);
	json_object_set_int_member(o, "minItems", least);
	json_object_set_int_member(o, "maxItems", most);
}

static void set_default_list(JsonObject *o, const struct step_parameter *p)
{
	json_object_set_member(o, "default", json_from_string(p->fallback_name, NULL));
}

/* A list, or the path of a PNG. */
static void set_xtoon(JsonObject *o, const struct step_parameter *p)
{
	JsonArray *types = json_array_new();
	json_array_add_string_element(types, "array");
	json_array_add_string_element(types, "string");
	json_object_set_array_member(o, "type", types);
	set_list(o, stop_schema(), 1, XTOON_STOPS_MAX);
	json_object_set_string_member(o, "pattern", "^.*\\.png$");
	set_default_list(o, p);
}

static JsonObject *parameter_schema(const struct step_parameter *p)
{
	static const char *const types[] = { [PARAMETER_NUMBER] = "number",
		[PARAMETER_CHOICE] = "string",
		[PARAMETER_BOOLEAN] = "boolean",
		[PARAMETER_COLOUR] = "string",
		[PARAMETER_TEXTURE] = "string",
		[PARAMETER_MODEL] = "string",
		[PARAMETER_XTOON] = "array",
		[PARAMETER_PENCILS] = "array" };
	g_autofree char *help =
		*p->unit ? g_strdup_printf("%s (%s)", p->help, p->unit) : g_strdup(p->help);
	g_autofree char *colour = g_strdup_printf("#%06x", (unsigned)p->fallback);
	JsonObject *o = text_schema(types[p->type], help);
	switch (p->type) {
	case PARAMETER_NUMBER:
		set_number(o, "minimum", p->least);
		set_number(o, "maximum", p->most);
		set_number(o, "default", p->fallback);
		break;
	case PARAMETER_CHOICE: set_choices(o, p); break;
	case PARAMETER_BOOLEAN:
		json_object_set_boolean_member(o, "default", p->fallback != 0);
		break;
	case PARAMETER_COLOUR:
		json_object_set_string_member(o, "pattern", "^#[0-9a-fA-F]{6}$");
		json_object_set_string_member(o, "default", colour);
		break;
	case PARAMETER_TEXTURE:
		json_object_set_string_member(o, "pattern", "^([A-Za-z0-9_-]{1,64}|.*\\.png)$");
		json_object_set_string_member(o, "default", p->fallback_name);
		break;
	case PARAMETER_MODEL: json_object_set_string_member(o, "pattern", "^.*\\.onnx$"); break;
	case PARAMETER_XTOON: set_xtoon(o, p); break;
	case PARAMETER_PENCILS:
		set_list(o, colour_schema(NULL), 0, PENCIL_BOX_MOST);
		set_default_list(o, p);
		break;
	}
	return o;
}

/* Nothing but these. */
static JsonObject *closed_schema(JsonObject *properties, const char *description)
{
	JsonObject *o = text_schema("object", description);
	json_object_set_object_member(o, "properties", properties);
	json_object_set_boolean_member(o, "additionalProperties", FALSE);
	return o;
}

static JsonObject *parameters(const struct step_parameter *p)
{
	JsonObject *o = json_object_new();
	for (; p->name; p++)
		json_object_set_object_member(o, p->name, parameter_schema(p));
	return o;
}

static JsonArray *one_name(const char *name)
{
	JsonArray *names = json_array_new();
	json_array_add_string_element(names, name);
	return names;
}

static JsonObject *kind_schema(const struct step_kind *k)
{
	JsonObject *properties = parameters(k->parameters);
	json_object_set_object_member(properties, "step", constant_schema(k->name, k->help));
	json_object_set_object_member(properties, "id",
		k->stage == STEP_MASK
			? constant_schema("mask", "what overrides name it by")
			: pattern_schema("^[A-Za-z0-9_-]{1,64}$",
				  "what overrides name it by; the name of its kind when left out"));
	JsonObject *o = closed_schema(properties, k->help);
	json_object_set_string_member(o, "title", k->title);
	json_object_set_array_member(o, "required", one_name("step"));
	return o;
}

/* The same parameters, each by reference. */
static JsonObject *change_schema(const struct step_kind *k)
{
	JsonObject *properties = json_object_new();
	for (const struct step_parameter *p = k->parameters; p->name; p++) {
		g_autofree char *to = g_strdup_printf("#/$defs/%s/properties/%s", k->name, p->name);
		json_object_set_object_member(properties, p->name, reference(to));
	}
	return closed_schema(properties, NULL);
}

static JsonObject *steps_schema(const char *description)
{
	return all_schema("array", "items", reference("#/$defs/step"), description);
}

static JsonObject *node_schema(void)
{
	JsonObject *p = json_object_new();
	json_object_set_object_member(
		p, "steps", steps_schema("what is drawn, instead of all that is inherited"));
	json_object_set_object_member(p, "remove",
		all_schema("array", "items", text_schema("string", NULL),
			"ids of inherited steps that are left out"));
	json_object_set_object_member(p, "change",
		all_schema("object", "additionalProperties", reference("#/$defs/change"),
			"other parameters of inherited steps, by their ids"));
	json_object_set_object_member(
		p, "add", steps_schema("what is drawn after what is inherited"));
	return closed_schema(p, "what is drawn of a segment and all below it");
}

/* Of each kind its own, and what may be either of them: a step, a change. */
static JsonObject *definitions(void)
{
	JsonObject *o = json_object_new(), *step = json_object_new(), *change = json_object_new();
	JsonArray *steps = json_array_new(), *changes = json_array_new();
	for (const struct step_kind *k = step_kinds; k->name; k++) {
		g_autofree char *changed = g_strconcat("change-", k->name, NULL),
				*to = g_strconcat("#/$defs/", k->name, NULL),
				*to_changed = g_strconcat("#/$defs/", changed, NULL);
		json_object_set_object_member(o, k->name, kind_schema(k));
		json_object_set_object_member(o, changed, change_schema(k));
		json_array_add_object_element(steps, reference(to));
		json_array_add_object_element(changes, reference(to_changed));
	}
	json_object_set_array_member(step, "oneOf", steps);
	json_object_set_array_member(change, "anyOf", changes);
	json_object_set_object_member(o, "step", step);
	json_object_set_object_member(o, "change", change);
	json_object_set_object_member(o, "node", node_schema());
	return o;
}

static JsonObject *segments_schema(void)
{
	JsonObject *p = json_object_new();
	json_object_set_object_member(p, "site", reference("#/$defs/node"));
	json_object_set_object_member(p, "picture", reference("#/$defs/node"));
	for (int class = 0; class < SEGMENT_CLASSES; class ++)
		json_object_set_object_member(
			p, segment_classes[class].name, reference("#/$defs/node"));
	JsonObject *o = text_schema("object",
		"the site, classes, segments by their names, or by # and their numbers; and the "
		"picture of all of them, which filters may work on");
	json_object_set_object_member(o, "properties", p);
	json_object_set_object_member(o, "additionalProperties", reference("#/$defs/node"));
	return o;
}

static JsonObject *style_properties(void)
{
	JsonObject *o = json_object_new(), *schema = json_object_new();
	json_object_set_int_member(schema, "const", STYLE_SCHEMA);
	json_object_set_object_member(o, "$schema", text_schema("string", "for editors"));
	json_object_set_object_member(o, "schema", schema);
	json_object_set_object_member(o, "name",
		pattern_schema("^[A-Za-z0-9_-]{1,64}$", "that of the file; may be left out"));
	json_object_set_object_member(o, "title", text_schema("string", "for people"));
	json_object_set_object_member(
		o, "source", text_schema("string", "a paper, or pleinair; default: user"));
	json_object_set_object_member(o, "description", text_schema("string", "for people"));
	json_object_set_object_member(
		o, "base", text_schema("string", "the name of a style that this one alters"));
	for (const struct style_section *n = style_sections; n->name; n++)
		json_object_set_object_member(
			o, n->name, closed_schema(parameters(n->parameters), n->help));
	json_object_set_object_member(o, "segments", segments_schema());
	return o;
}

char *style_schema(void)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "$schema", "https://json-schema.org/draft/2020-12/schema");
	json_object_set_string_member(o, "title", "A style of pleinair, see pleinair-style(5)");
	json_object_set_string_member(o, "type", "object");
	json_object_set_array_member(o, "required", one_name("schema"));
	json_object_set_object_member(o, "properties", style_properties());
	json_object_set_boolean_member(o, "additionalProperties", FALSE);
	json_object_set_object_member(o, "$defs", definitions());
	g_autoptr(JsonNode) root = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(root, o);
	return strict_json_write(root);
}
