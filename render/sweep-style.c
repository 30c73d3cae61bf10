/* The styles of a sweep, and what is said of them. */
#include "render/step-json.h"
#include "render/style-edit.h"
#include "render/sweep.h"
#include <string.h>

/* Where values of another style are taken from. */
struct found {
	const struct step_parameter *parameter;
	const void *from;
};

/* ---- a style's own values ---- */

static bool find_in_section(
	const style *s, const char *section, const char *name, struct found *ret)
{
	for (const struct style_section *n = style_sections; n->name; n++)
		if (!strcmp(n->name, section)) {
			ret->parameter = step_parameter_find(n->parameters, name);
			ret->from = (const char *)&s->whole + n->offset;
			return ret->parameter;
		}
	return false;
}

static bool find_in_steps(const GArray *steps, const char *id, const char *name, struct found *ret)
{
	for (guint i = 0; i < steps->len; i++) {
		const struct step *step = &g_array_index(steps, struct step, i);
		if (strcmp(step->id, id))
			continue;
		ret->parameter = step_parameter_find(step->kind->parameters, name);
		ret->from = step->bytes;
		return ret->parameter;
	}
	return false;
}

/* As the site has it in that style, or its picture; caller unrefs. */
static JsonNode *value_of_style(const char *other, const char *step, const char *name,
	const char *site_path, GError **error)
{
	struct found f;
	g_autoptr(style) s = style_find(other, site_path, error);
	g_autoptr(GArray) steps = s ? style_steps(s, NULL, SEGMENT_SITE, error) : NULL;
	g_autoptr(GArray) filters = steps ? style_steps(s, NULL, STYLE_PICTURE, error) : NULL;
	if (!filters)
		return NULL;
	if (find_in_section(s, step, name, &f) || find_in_steps(steps, step, name, &f) ||
		find_in_steps(filters, step, name, &f))
		return step_parameter_to_json(f.parameter, f.from);
	g_set_error(error, STYLE_ERROR, STYLE_ERROR_FIELD, "the style '%s' has no %s.%s", other,
		step, name);
	return NULL;
}

/* ---- values ---- */

/* JSON where it is JSON, else a text. */
static JsonNode *value_from_text(const char *text)
{
	JsonNode *node = json_from_string(text, NULL);
	return node ? node : json_node_init_string(json_node_alloc(), text);
}

static bool is_section(const char *name)
{
	for (const struct style_section *n = style_sections; n->name; n++)
		if (!strcmp(n->name, name))
			return true;
	return false;
}

/* The node that has a step with this id: the site, else the picture. */
static const char *node_of(const style_edit *e, const char *id, const char *site_path)
{
	g_autoptr(style) s = style_edit_style(e, site_path, NULL);
	g_autoptr(GArray) filters = s ? style_steps(s, NULL, STYLE_PICTURE, NULL) : NULL;
	for (guint i = 0; filters && i < filters->len; i++)
		if (strcmp(g_array_index(filters, struct step, i).id, id) == 0)
			return "picture";
	return "site";
}

static bool set_parameter(
	style_edit *e, const char *name, const char *value, const char *site_path, GError **error)
{
	g_auto(GStrv) parts = g_strsplit(name, ".", 2);
	if (!strcmp(value, "-"))
		return true;
	JsonNode *node = *value == '@'
				 ? value_of_style(value + 1, parts[0], parts[1], site_path, error)
				 : value_from_text(value);
	if (!node)
		return false;
	if (is_section(parts[0]))
		style_edit_set(e, parts[0], parts[1], node);
	else
		style_edit_change(e, node_of(e, parts[0], site_path), parts[0], parts[1], node);
	return true;
}

/* The reader tells the line of a text that nobody has written; what is behind it counts. */
static void shorten(GError *e)
{
	static const char *const paths[] = { "segments.site.change.", "segments.picture.change." };
	const char *line = strstr(e->message, " line "), *at = NULL;
	for (size_t n = 0; n < G_N_ELEMENTS(paths) && !at; n++) {
		at = strstr(e->message, paths[n]);
		at = at ? at + strlen(paths[n]) : NULL;
	}
	if (!at && line && (at = strstr(line, ": ")))
		at += 2;
	if (!at)
		return;
	char *shorter = g_strdup(at);
	g_free(e->message);
	e->message = shorter;
}

style *sweep_style(const sweep *s, guint i, const char *site_path, GError **error)
{
	g_autoptr(GError) wrong = NULL;
	g_autoptr(style_edit) e = style_edit_new(sweep_value(s, "style", i), site_path, error);
	if (!e)
		return NULL;
	for (guint k = 0; k < s->parameters->len; k++) {
		const struct sweep_parameter *p = s->parameters->pdata[k];
		if (strchr(p->name, '.') &&
			!set_parameter(e, p->name, sweep_value(s, p->name, i), site_path, error))
			return NULL;
	}
	style *made = style_edit_style(e, site_path, &wrong);
	if (!made) {
		shorten(wrong);
		g_propagate_prefixed_error(
			error, g_steal_pointer(&wrong), "%s: ", sweep_value(s, "style", i));
	}
	return made;
}

/* ---- what is said ---- */

/* "12 px"; lists are as long as they are, styles and files have their names. */
static char *value_text(const char *value)
{
	g_autoptr(JsonNode) node = json_from_string(value, NULL);
	if (node && JSON_NODE_HOLDS_ARRAY(node)) {
		guint count = json_array_get_length(json_node_get_array(node));
		return count ? g_strdup_printf("%u", count) : g_strdup("none");
	}
	if (node && JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == G_TYPE_STRING)
		return json_node_dup_string(node);
	g_autofree char *base = g_path_get_basename(*value == '@' ? value + 1 : value);
	if (g_str_has_suffix(base, ".json"))
		base[strlen(base) - strlen(".json")] = '\0';
	return g_steal_pointer(&base);
}

static void append(GString *to, const char *name, const char *value)
{
	if (!strcmp(value, "-"))
		return;
	g_autofree char *text = value_text(value);
	const char *dot = strchr(name, '.');
	bool own = !strcmp(name, "style") || !strcmp(name, "view") || !strcmp(name, "site");
	g_string_append_printf(
		to, "%s%s%s%s", to->len ? ", " : "", own ? "" : dot + 1, own ? "" : " ", text);
}

char *sweep_label(const sweep *s, guint i)
{
	g_autoptr(GString) text = g_string_new(NULL);
	for (guint k = 0; k < s->parameters->len; k++) {
		const struct sweep_parameter *p = s->parameters->pdata[k];
		if (p->values->len > 1 && strcmp(p->name, "site"))
			append(text, p->name, p->values->pdata[i]);
	}
	if (!text->len)
		g_string_append(text, s->count > 1 ? "as it is" : sweep_value(s, "style", 0));
	return g_strdup(text->str);
}

char *sweep_fixed(const sweep *s)
{
	g_autoptr(GString) text = g_string_new(NULL);
	for (guint k = 0; k < s->parameters->len; k++) {
		const struct sweep_parameter *p = s->parameters->pdata[k];
		if (p->values->len == 1)
			append(text, p->name, p->values->pdata[0]);
	}
	return g_strdup(text->str);
}
