#include "render/style-edit.h"
#include "firmware-io/files.h"
#include "render/step-json.h"
#include "render/title-name.h"
#include <errno.h>
#include <glib/gstdio.h>
#include <string.h>

struct style_edit {
	JsonObject *root;
};

static style_edit *take(JsonObject *root)
{
	style_edit *e = g_new0(style_edit, 1);
	e->root = root;
	return e;
}

static char *own_path(const char *site_path, const char *name)
{
	g_autofree char *file = g_strconcat(name, ".json", NULL);
	return g_build_filename(site_path, "styles", file, NULL);
}

style_edit *style_edit_new(const char *style_name, const char *site_path, GError **error)
{
	g_autofree char *path = own_path(site_path, style_name), *text = NULL;
	if (g_file_get_contents(path, &text, NULL, NULL))
		return style_edit_parse(text, error);
	g_autoptr(style) base = style_find(style_name, site_path, error);
	if (!base)
		return NULL;
	JsonObject *root = json_object_new();
	json_object_set_int_member(root, "schema", STYLE_SCHEMA);
	json_object_set_string_member(root, "title", base->title ? base->title : style_name);
	json_object_set_string_member(root, "source", "user");
	json_object_set_string_member(root, "base", style_name);
	json_object_set_object_member(root, "segments", json_object_new());
	return take(root);
}

style_edit *style_edit_parse(const char *text, GError **error)
{
	g_autoptr(JsonNode) node = json_from_string(text, error);
	if (!node && error && *error)
		return NULL;
	if (!node || !JSON_NODE_HOLDS_OBJECT(node)) {
		g_set_error_literal(error, STYLE_ERROR, STYLE_ERROR_JSON, "the style is no object");
		return NULL;
	}
	return take(json_node_dup_object(node));
}

void style_edit_free(style_edit *e)
{
	if (!e)
		return;
	json_object_unref(e->root);
	g_free(e);
}

/* ---- nodes ---- */

/* NULL: there is none, or no object. */
static JsonObject *object_in(JsonObject *o, const char *key)
{
	JsonNode *n = json_object_get_member(o, key);
	return n && JSON_NODE_HOLDS_OBJECT(n) ? json_node_get_object(n) : NULL;
}

static JsonObject *object_made(JsonObject *o, const char *key)
{
	JsonObject *in = object_in(o, key);
	if (in)
		return in;
	in = json_object_new();
	json_object_set_object_member(o, key, in);
	return in;
}

/* The step with this id in a list of a node; NULL: it is not there. */
static JsonObject *step_in(JsonObject *node, const char *list, const char *id)
{
	JsonNode *n = json_object_get_member(node, list);
	JsonArray *steps = n && JSON_NODE_HOLDS_ARRAY(n) ? json_node_get_array(n) : NULL;
	for (guint i = 0; steps && i < json_array_get_length(steps); i++) {
		JsonNode *each = json_array_get_element(steps, i);
		if (!JSON_NODE_HOLDS_OBJECT(each))
			continue;
		JsonObject *step = json_node_get_object(each);
		const char *name = json_object_get_string_member_with_default(
			step, "id", json_object_get_string_member_with_default(step, "step", ""));
		if (!strcmp(name, id))
			return step;
	}
	return NULL;
}

void style_edit_change(style_edit *e, const char *node, const char *step_id, const char *parameter,
	JsonNode *value)
{
	JsonObject *n = object_made(object_made(e->root, "segments"), node);
	/* Where the node lists the step, it is said there. */
	JsonObject *step = step_in(n, "steps", step_id);
	if (!step)
		step = step_in(n, "add", step_id);
	if (!step)
		step = object_made(object_made(n, "change"), step_id);
	json_object_set_member(step, parameter, value);
}

void style_edit_set(style_edit *e, const char *section, const char *parameter, JsonNode *value)
{
	json_object_set_member(object_made(e->root, section), parameter, value);
}

/* json_node_copy shares the objects. */
static JsonNode *own_copy(JsonNode *n)
{
	g_autofree char *text = json_to_string(n, FALSE);
	return json_from_string(text, NULL);
}

void style_edit_take_accents(style_edit *e, const style_edit *from)
{
	static const char *const accents[] = { "light", "focus" };
	for (size_t i = 0; i < G_N_ELEMENTS(accents); i++) {
		JsonNode *n = json_object_get_member(from->root, accents[i]);
		if (n && !json_object_has_member(e->root, accents[i]))
			json_object_set_member(e->root, accents[i], own_copy(n));
	}
}

void style_edit_set_steps(style_edit *e, const char *node, const GArray *steps)
{
	JsonArray *list = json_array_new();
	for (guint i = 0; i < steps->len; i++)
		json_array_add_object_element(
			list, step_to_json(&g_array_index(steps, struct step, i)));
	JsonObject *n = json_object_new();
	json_object_set_array_member(n, "steps", list);
	json_object_set_object_member(object_made(e->root, "segments"), node, n);
}

void style_edit_reset(style_edit *e, const char *node)
{
	JsonObject *nodes = object_in(e->root, "segments");
	if (nodes)
		json_object_remove_member(nodes, node);
}

/* ---- the style ---- */

char *style_edit_text(const style_edit *e)
{
	g_autoptr(JsonNode) node = json_node_init_object(json_node_alloc(), e->root);
	return json_to_string(node, TRUE);
}

style *style_edit_style(const style_edit *e, const char *site_path, GError **error)
{
	g_autofree char *text = style_edit_text(e);
	return style_parse_for(text, "the style", site_path, error);
}

/* ---- saving ---- */

static char *free_name(const char *title, const char *site_path)
{
	g_auto(GStrv) taken = style_names(site_path);
	g_autofree char *name = title_name(title, 40, "style");
	if (!g_strv_contains((const char *const *)taken, name))
		return g_steal_pointer(&name);
	for (int n = 2;; n++) {
		g_autofree char *other = g_strdup_printf("%s-%d", name, n);
		if (!g_strv_contains((const char *const *)taken, other))
			return g_steal_pointer(&other);
	}
}

bool style_edit_save(const style_edit *e, const char *site_path, const char *title, char **ret_name,
	GError **error)
{
	g_autofree char *text = style_edit_text(e);
	g_autoptr(style_edit) own = style_edit_parse(text, error);
	if (!own)
		return false;
	json_object_set_string_member(own->root, "title", title);
	g_autoptr(style) good = style_edit_style(own, site_path, error);
	if (!good)
		return false;
	g_autofree char *name = free_name(title, site_path), *path = own_path(site_path, name);
	g_autofree char *folder = g_path_get_dirname(path), *saved = style_edit_text(own);
	if (g_mkdir_with_parents(folder, 0777)) {
		int why = errno;
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(why), "%s: %s", folder,
			g_strerror(why));
		return false;
	}
	if (!files_write(path, saved, strlen(saved), error))
		return false;
	*ret_name = g_steal_pointer(&name);
	return true;
}
