/* Lists of steps: how they are read, inherited and overridden. */
#include "render/nearest-name.h"
#include "render/style-private.h"
#include <string.h>

void step_list_clear(struct step_list *list)
{
	memset(list, 0, sizeof *list);
	list->steps[0] = step_defaults(step_kind_find("mask"));
	list->count = 1;
}

struct step *step_list_find(struct step_list *list, const char *id)
{
	for (uint32_t i = 0; i < list->count; i++)
		if (strcmp(list->steps[i].id, id) == 0)
			return &list->steps[i];
	return NULL;
}

/* ---- a step ---- */

/* "texture" of lines: strokes have one. */
static const char *kind_with(const char *parameter)
{
	for (const struct step_kind *k = step_kinds; k->name; k++)
		if (step_parameter_find(k->parameters, parameter))
			return k->name;
	return NULL;
}

static bool refuse_parameter(
	style_reader *r, const struct step_kind *kind, const char *key, JsonNode *value)
{
	g_autoptr(GPtrArray) known = g_ptr_array_new();
	const char *other = kind_with(key);
	if (other)
		return style_reader_refuse(
			r, value, "'%s' has no such parameter; '%s' has", kind->name, other);
	for (const struct step_parameter *p = kind->parameters; p->name; p++)
		g_ptr_array_add(known, (gpointer)p->name);
	g_ptr_array_add(known, NULL);
	g_autofree char *of = g_strdup_printf("'%s'", kind->name);
	return style_reader_unknown(r, key, value, of, (const char *const *)known->pdata);
}

static bool read_parameter(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	struct step *step = user_data;
	const struct step_parameter *p = step_parameter_find(step->kind->parameters, key);
	return p ? style_reader_parameter(r, p, value, step->bytes)
		 : refuse_parameter(r, step->kind, key, value);
}

static bool read_step_member(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	struct step *step = user_data;
	if (strcmp(key, "step") == 0)
		return true;
	if (strcmp(key, "id"))
		return read_parameter(r, key, value, step);
	const char *id = style_reader_name(r, value, "an id");
	if (id && step->kind->stage == STEP_MASK && strcmp(id, step->id))
		return style_reader_refuse(r, value, "the id of a mask is always 'mask'");
	step->id = id ? g_intern_string(id) : step->id;
	return id;
}

static bool read_change_member(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	if (strcmp(key, "step") == 0 || strcmp(key, "id") == 0)
		return style_reader_refuse(
			r, value, "a step stays what it is; remove it, and add another one");
	return read_parameter(r, key, value, user_data);
}

bool step_list_read_change(struct step *step, style_reader *r, JsonNode *change)
{
	return style_reader_object(r, change, "an object of parameters") &&
	       style_reader_each(r, change, read_change_member, step);
}

static const struct step_kind *read_kind(style_reader *r, JsonNode *node)
{
	const char *names[STEP_KINDS_MAX + 1] = { NULL };
	for (size_t i = 0; step_kinds[i].name; i++)
		names[i] = step_kinds[i].name;
	JsonNode *value = json_object_get_member(json_node_get_object(node), "step");
	if (!value) {
		style_reader_refuse(r, node,
			"'step' is missing; 'pleinair styles --steps' tells what there is");
		return NULL;
	}
	style_reader_enter(r, "step");
	const char *name = style_reader_text(r, value, "the name of a step");
	const struct step_kind *kind = name ? step_kind_find(name) : NULL;
	if (name && !kind) {
		g_autofree char *quoted = style_reader_quote(name),
				*hint = nearest_name_hint(name, names);
		style_reader_refuse(r, value, "there is no step '%s'%s", quoted, hint);
	}
	return kind;
}

static bool read_step(style_reader *r, JsonNode *node, struct step *ret)
{
	gsize was = r->path->len;
	if (!style_reader_object(r, node, "a step {\"step\": ...}"))
		return false;
	const struct step_kind *kind = read_kind(r, node);
	if (!kind)
		return false;
	style_reader_leave(r, was);
	*ret = step_defaults(kind);
	return style_reader_each(r, node, read_step_member, ret);
}

/* ---- a list ---- */

static bool add_mask(
	struct step_list *list, style_reader *r, JsonNode *node, const struct step *mask)
{
	if (list->mask_given)
		return style_reader_refuse(
			r, node, "there is a mask already, and only one in a pipeline; change it");
	list->steps[0] = *mask;
	list->mask_given = 1;
	return true;
}

/* A picture has filters, and how it is composed; nothing else has the latter. */
static bool is_in_place(style_reader *r, JsonNode *node, const struct step *step)
{
	bool is_picture = g_str_has_prefix(r->path->str, "segments.picture.");
	bool composes = step->kind == step_kind_find("composite");
	if (is_picture ? composes || step->kind->stage == STEP_FILTER : !composes)
		return true;
	return style_reader_refuse(r, node,
		is_picture ? "'%s' is of points; a picture has filters alone"
			   : "'%s' is of \"picture\" alone",
		step->kind->name);
}

static bool add_step(
	struct step_list *list, style_reader *r, JsonNode *node, const struct step *step)
{
	if (!is_in_place(r, node, step))
		return false;
	if (step->kind->stage == STEP_MASK)
		return add_mask(list, r, node, step);
	for (uint32_t i = 1; i < list->count && step->kind->stage == STEP_COMPOSITE; i++)
		if (list->steps[i].kind == step->kind)
			return style_reader_refuse(r, node,
				"there is '%s' already, and only one in a pipeline; change it",
				step->kind->name);
	if (step_list_find(list, step->id))
		return style_reader_refuse(r, node,
			"there is a step with the id '%s' already; give this one another \"id\"",
			step->id);
	if (list->count == G_N_ELEMENTS(list->steps))
		return style_reader_refuse(r, node,
			"this is one step too many; a pipeline has at most %d beside the mask",
			PIPELINE_STEPS_MAX);
	list->steps[list->count++] = *step;
	return true;
}

bool step_list_read(struct step_list *list, style_reader *r, JsonNode *steps)
{
	JsonArray *array = style_reader_list(r, steps, "a list of steps");
	for (guint i = 0; array && i < json_array_get_length(array); i++) {
		struct step step;
		JsonNode *node = json_array_get_element(array, i);
		gsize was = style_reader_enter_element(r, i);
		if (!read_step(r, node, &step) || !add_step(list, r, node, &step))
			return false;
		style_reader_leave(r, was);
	}
	return array;
}

/* ---- what a node does to it ---- */

static bool refuse_id(struct step_list *list, style_reader *r, const char *id, JsonNode *node)
{
	const char *ids[2 + PIPELINE_STEPS_MAX] = { NULL };
	for (uint32_t i = 0; i < list->count; i++)
		ids[i] = list->steps[i].id;
	g_autofree char *quoted = style_reader_quote(id), *hint = nearest_name_hint(id, ids);
	return style_reader_refuse(
		r, node, "no step with the id '%s' is inherited here%s", quoted, hint);
}

static bool remove_step(struct step_list *list, style_reader *r, JsonNode *node)
{
	const char *id = style_reader_text(r, node, "the id of a step");
	struct step *step = id ? step_list_find(list, id) : NULL;
	if (!id)
		return false;
	if (!step)
		return refuse_id(list, r, id, node);
	if (step == list->steps)
		return style_reader_refuse(r, node, "every pipeline has a mask; change it");
	list->count--;
	memmove(step, step + 1, (size_t)(list->steps + list->count - step) * sizeof *step);
	memset(&list->steps[list->count], 0, sizeof *step);
	return true;
}

static bool remove_steps(struct step_list *list, style_reader *r, JsonNode *node)
{
	JsonArray *array = style_reader_list(r, node, "a list of ids");
	for (guint i = 0; array && i < json_array_get_length(array); i++) {
		gsize was = style_reader_enter_element(r, i);
		if (!remove_step(list, r, json_array_get_element(array, i)))
			return false;
		style_reader_leave(r, was);
	}
	return array;
}

static bool change_step(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	struct step *step = step_list_find(user_data, key);
	return step ? step_list_read_change(step, r, value) : refuse_id(user_data, r, key, value);
}

static bool change_steps(struct step_list *list, style_reader *r, JsonNode *node)
{
	return style_reader_object(r, node, "an object of ids") &&
	       style_reader_each(r, node, change_step, list);
}

static bool replace_steps(struct step_list *list, style_reader *r, JsonNode *node)
{
	step_list_clear(list);
	return step_list_read(list, r, node);
}

/* In this order, so that a step can be removed and another of its id be added. */
static const struct {
	const char *name;
	bool (*apply)(struct step_list *list, style_reader *r, JsonNode *node);
} actions[] = { { "steps", replace_steps }, { "remove", remove_steps }, { "change", change_steps },
	{ "add", step_list_read } };

bool step_list_apply(struct step_list *list, const struct style_node *node, GError **error)
{
	g_autoptr(style_reader) r = style_reader_new(node->document, error);
	JsonObject *object = json_node_get_object(node->json);
	style_reader_enter(r, "segments");
	style_reader_enter(r, node->key);
	for (size_t i = 0; i < G_N_ELEMENTS(actions); i++) {
		JsonNode *value = json_object_get_member(object, actions[i].name);
		gsize was = style_reader_enter(r, actions[i].name);
		if (value && !actions[i].apply(list, r, value))
			return false;
		style_reader_leave(r, was);
	}
	return true;
}
