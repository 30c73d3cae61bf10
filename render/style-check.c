/* What can be told of a style without a site. */
#include "render/style-private.h"
#include <string.h>

/* ---- nodes by themselves ---- */

static bool check_key(style_reader *r, const char *key, JsonNode *node)
{
	guint64 id;
	if (!*key)
		return style_reader_refuse(r, node, "a node without a name");
	if (*key != '#' || g_ascii_string_to_unsigned(key + 1, 10, 1, SEGMENTS_MAX, &id, NULL))
		return true;
	return style_reader_refuse(
		r, node, "behind a # stands the number of a segment, 1 to %u", SEGMENTS_MAX);
}

static bool check_steps(style_reader *r, JsonNode *node)
{
	struct step_list list;
	step_list_clear(&list);
	return step_list_read(&list, r, node);
}

static bool check_change(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	(void)key;
	(void)user_data;
	return style_reader_object(r, value, "an object of parameters");
}

static bool check_changes(style_reader *r, JsonNode *node)
{
	return style_reader_object(r, node, "an object of ids") &&
	       style_reader_each(r, node, check_change, NULL);
}

static bool check_removed(style_reader *r, JsonNode *node)
{
	JsonArray *array = style_reader_list(r, node, "a list of ids");
	for (guint i = 0; array && i < json_array_get_length(array); i++) {
		gsize was = style_reader_enter_element(r, i);
		if (!style_reader_text(r, json_array_get_element(array, i), "the id of a step"))
			return false;
		style_reader_leave(r, was);
	}
	return array;
}

static bool check_member(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	static const char *const known[] = { "steps", "change", "remove", "add", NULL };
	JsonObject *node = user_data;
	if (!g_strv_contains(known, key))
		return style_reader_unknown(r, key, value, "a node", known);
	if (json_object_has_member(node, "steps") && strcmp(key, "steps"))
		return style_reader_refuse(r, value,
			"'steps' replaces all that is inherited, so nothing else can stand beside "
			"it");
	return strcmp(key, "change") == 0   ? check_changes(r, value)
	       : strcmp(key, "remove") == 0 ? check_removed(r, value)
					    : check_steps(r, value);
}

bool style_node_check(style_reader *r, const char *key, JsonNode *node)
{
	JsonObject *object = style_reader_object(
		r, node, "an object with \"steps\", or with \"change\", \"remove\" and \"add\"");
	return object && check_key(r, key, node) &&
	       style_reader_each(r, node, check_member, object);
}

/* ---- nodes in a tree ---- */

static bool apply_all(const style *s, const char *key, struct step_list *list, GError **error)
{
	for (guint i = 0; i < s->nodes->len; i++)
		if (strcmp(style_node_at(s, i)->key, key) == 0 &&
			!step_list_apply(list, style_node_at(s, i), error))
			return false;
	return true;
}

static bool check_classes(const style *s, GError **error)
{
	struct step_list site, list;
	step_list_clear(&list);
	if (!apply_all(s, "picture", &list, error))
		return false;
	step_list_clear(&site);
	if (!apply_all(s, "site", &site, error))
		return false;
	for (int class = 0; class < SEGMENT_CLASSES; class ++) {
		list = site;
		if (!apply_all(s, segment_classes[class].name, &list, error))
			return false;
	}
	return true;
}

static bool is_class(const char *key)
{
	return strcmp(key, "site") == 0 || strcmp(key, "picture") == 0 ||
	       segment_class_find(key) >= 0;
}

/* Parameters do not count here: one of each id and kind is enough. */
static void collect_step(GArray *steps, const struct step *step)
{
	for (guint i = 0; i < steps->len; i++) {
		const struct step *other = &g_array_index(steps, struct step, i);
		if (other->id == step->id && other->kind == step->kind)
			return;
	}
	g_array_append_vals(steps, step, 1);
}

/* All steps that a style has anywhere: what a thing may inherit. */
static void collect(const style *s, GArray *steps)
{
	static const char *const lists[] = { "steps", "add" };
	struct step mask = step_defaults(step_kind_find("mask"));
	g_array_append_val(steps, mask);
	for (guint i = 0; i < s->nodes->len * G_N_ELEMENTS(lists); i++) {
		const struct style_node *node = style_node_at(s, i / G_N_ELEMENTS(lists));
		JsonNode *json = json_object_get_member(
			json_node_get_object(node->json), lists[i % G_N_ELEMENTS(lists)]);
		g_autoptr(style_reader) r = style_reader_new(node->document, NULL);
		struct step_list list;
		step_list_clear(&list);
		if (!json || !step_list_read(&list, r, json))
			continue;
		for (uint32_t k = 1; k < list.count; k++)
			collect_step(steps, &list.steps[k]);
	}
}

/* true: it can be a change of the step. The first thing that is wrong is kept. */
static bool can_change(style_reader *r, const struct step *step, JsonNode *change, GError **wrong)
{
	GError **error = r->error;
	gsize was = r->path->len;
	struct step copy = *step;
	r->error = *wrong ? NULL : wrong;
	bool can = step_list_read_change(&copy, r, change);
	r->error = error;
	style_reader_leave(r, was);
	return can;
}

static bool has_id(const GArray *steps, const char *id)
{
	for (guint i = 0; i < steps->len; i++)
		if (strcmp(g_array_index(steps, struct step, i).id, id) == 0)
			return true;
	return false;
}

static bool refuse_id(style_reader *r, const char *id, JsonNode *at)
{
	g_autofree char *quoted = style_reader_quote(id);
	return style_reader_refuse(r, at, "no step of this style has the id '%s'", quoted);
}

static bool check_thing_change(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	const GArray *steps = user_data;
	g_autoptr(GError) wrong = NULL;
	for (guint i = 0; i < steps->len; i++) {
		const struct step *step = &g_array_index(steps, struct step, i);
		if (strcmp(step->id, key) == 0 && can_change(r, step, value, &wrong))
			return true;
	}
	if (!wrong)
		return refuse_id(r, key, value);
	g_propagate_error(r->error, g_steal_pointer(&wrong));
	return false;
}

static bool check_thing_removed(style_reader *r, JsonArray *ids, const GArray *steps)
{
	for (guint i = 0; i < json_array_get_length(ids); i++) {
		JsonNode *id = json_array_get_element(ids, i);
		gsize was = style_reader_enter_element(r, i);
		if (!has_id(steps, json_node_get_string(id)))
			return refuse_id(r, json_node_get_string(id), id);
		style_reader_leave(r, was);
	}
	return true;
}

static bool check_thing(const struct style_node *node, GArray *steps, GError **error)
{
	g_autoptr(style_reader) r = style_reader_new(node->document, error);
	JsonObject *object = json_node_get_object(node->json);
	JsonNode *change = json_object_get_member(object, "change"),
		 *removed = json_object_get_member(object, "remove");
	style_reader_enter(r, "segments");
	style_reader_enter(r, node->key);
	gsize was = style_reader_enter(r, "change");
	if (change && !style_reader_each(r, change, check_thing_change, steps))
		return false;
	style_reader_leave(r, was);
	style_reader_enter(r, "remove");
	return !removed || check_thing_removed(r, json_node_get_array(removed), steps);
}

bool style_check(const style *s, GError **error)
{
	g_autoptr(GArray) steps = g_array_new(FALSE, FALSE, sizeof(struct step));
	if (!check_classes(s, error))
		return false;
	collect(s, steps);
	for (guint i = 0; i < s->nodes->len; i++)
		if (!is_class(style_node_at(s, i)->key) &&
			!check_thing(style_node_at(s, i), steps, error))
			return false;
	return true;
}
