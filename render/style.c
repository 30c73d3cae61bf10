#include "render/style.h"
#include "firmware-io/files.h"
#include "render/nearest-name.h"
#include "render/style-private.h"
#include <stdlib.h>
#include <string.h>

#define BASES_MAX 16

G_DEFINE_QUARK(style - error - quark, style_error)

#define PAPER(field, row_type, ...)                                                                \
	{                                                                                          \
		.name = #field, .type = row_type, .offset = offsetof(struct style_paper, field),   \
		.unit = "", __VA_ARGS__                                                            \
	}
static const struct step_parameter paper_parameters[] = {
	PAPER(texture, PARAMETER_TEXTURE, .fallback_name = "cartridge",
		.help = "a name, or the path of a PNG"),
	PAPER(colour, PARAMETER_COLOUR, .fallback = 0xffffff, .help = "what nothing is drawn on"),
	PAPER(grain, PARAMETER_NUMBER, .most = 1, .slider_most = 1,
		.help = "how much the relief of the paper is seen"),
	PAPER(scale, PARAMETER_NUMBER, .least = 0.1, .most = 10, .slider_least = 0.5,
		.slider_most = 3, .fallback = 1, .help = "how large the texture is; 1: as it is"),
	{ NULL },
};

#define NUMBER(of, field, in, low, high, slider_low, slider_high, start, text)                     \
	{                                                                                          \
		.name = #field, .type = PARAMETER_NUMBER, .offset = offsetof(struct of, field),    \
		.unit = (in), .least = (low), .most = (high), .slider_least = (slider_low),        \
		.slider_most = (slider_high), .fallback = (start), .help = (text)                  \
	}
static const struct step_parameter light_parameters[] = {
	NUMBER(style_light, amount, "", 0, 1, 0, 1, 0,
		"how much of the lightness it decides; 0: there is no light"),
	NUMBER(style_light, azimuth_deg, "degrees", -360, 360, 0, 360, 315,
		"where it comes from: clockwise from the site's y axis, as on a compass"),
	NUMBER(style_light, elevation_deg, "degrees", -90, 90, 0, 90, 45, "above the ground"),
	{ NULL },
};

static const char *const focus_names[] = {
	[FOCUS_PLACE] = "place", [FOCUS_PICTURE] = "picture", [FOCUS_SEGMENT] = "segment", NULL
};
#define SITE_REACH_M 1e7
#define PLACE(field)                                                                               \
	NUMBER(style_focus, field, "m", -SITE_REACH_M, SITE_REACH_M, 0, 0, 0,                      \
		"its middle, in the site's coordinates")
static const struct step_parameter focus_parameters[] = {
	NUMBER(style_focus, amount, "", 0, 1, 0, 1, 0,
		"how much ink and colour fade to the paper far away from it"),
	NUMBER(style_focus, abstraction, "", 0, 8, 0, 3, 0,
		"so much larger and fewer strokes become far away; 1: twice as large"),
	NUMBER(style_focus, filters, "", 0, 1, 0, 1, 0,
		"how much filters that are for what is away, or near, keep to that"),
	{ .name = "on",
		.type = PARAMETER_CHOICE,
		.offset = offsetof(struct style_focus, on),
		.choices = focus_names,
		.unit = "",
		.help = "a place of the site, a place of the picture, or a segment" },
	NUMBER(style_focus, radius_m, "m", 0, 100000, 0.5, 30, 5, "all within it is drawn as ever"),
	NUMBER(style_focus, falloff_m, "m", 0.01, 100000, 0.5, 60, 10,
		"from there to where things are far away"),
	PLACE(x_m),
	PLACE(y_m),
	PLACE(z_m),
	NUMBER(style_focus, across, "", 0, 1, 0, 1, 0.5, "of the picture, from its left side"),
	NUMBER(style_focus, down, "", 0, 1, 0, 1, 0.5, "of the picture, from its upper side"),
	NUMBER(style_focus, radius_px, "px", 0, 10000, 20, 800, 200,
		"of the picture: all within it is drawn as ever"),
	NUMBER(style_focus, falloff_px, "px", 1, 10000, 20, 800, 300,
		"of the picture: from there to where things are far away"),
	NUMBER(style_focus, segment, "", 0, SEGMENTS_MAX, 0, 0, 0,
		"the number of the segment that it is on; 0: none"),
	{ NULL },
};

const struct style_section style_sections[] = {
	{ "paper", "what is drawn on", paper_parameters, offsetof(struct style_whole, paper) },
	{ "light", "a lamp far away, which all is darker behind", light_parameters,
		offsetof(struct style_whole, light) },
	{ "focus", "a place that is drawn whole, and less and less around it", focus_parameters,
		offsetof(struct style_whole, focus) },
	{ NULL },
};

/* ---- nodes ---- */

static void free_node(gpointer data)
{
	struct style_node *n = data;
	g_free(n->key);
	style_document_unref(n->document);
	g_free(n);
}

static struct style_node *new_node(const char *key, JsonNode *json, const style_document *d)
{
	struct style_node *n = g_new(struct style_node, 1);
	*n = (struct style_node){ g_strdup(key), json, style_document_ref((style_document *)d) };
	return n;
}

static bool read_node(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	style *s = user_data;
	if (!style_node_check(r, key, value))
		return false;
	g_ptr_array_add(s->nodes, new_node(key, value, r->document));
	return true;
}

/* Those of the base come first, so that what alters them is applied later. */
static void inherit_nodes(style *s, const style *base)
{
	g_autoptr(GHashTable) replaced = g_hash_table_new(g_str_hash, g_str_equal);
	for (guint i = 0; i < s->nodes->len; i++) {
		const struct style_node *own = style_node_at(s, i);
		if (json_object_has_member(json_node_get_object(own->json), "steps"))
			g_hash_table_add(replaced, own->key);
	}
	for (guint i = 0, at = 0; i < base->nodes->len; i++) {
		const struct style_node *n = style_node_at(base, i);
		if (!g_hash_table_contains(replaced, n->key))
			g_ptr_array_insert(
				s->nodes, (gint)at++, new_node(n->key, n->json, n->document));
	}
}

/* ---- fields ---- */

static bool take_words(style_reader *r, JsonNode *value, char **ret)
{
	const char *text = style_reader_words(r, value);
	g_free(*ret);
	*ret = g_strdup(text);
	return text;
}

static bool read_name(style_reader *r, JsonNode *value, style *s)
{
	const char *name = style_reader_name(r, value, "a name of a style");
	if (name && s->path && strcmp(name, s->name))
		return style_reader_refuse(r, value,
			"a style has the name of its file, '%s'; leave this out", s->name);
	g_free(s->name);
	s->name = g_strdup(name);
	return name;
}

static bool read_title(style_reader *r, JsonNode *value, style *s)
{
	return take_words(r, value, &s->title);
}

static bool read_source(style_reader *r, JsonNode *value, style *s)
{
	return take_words(r, value, &s->source);
}

static bool read_description(style_reader *r, JsonNode *value, style *s)
{
	return take_words(r, value, &s->description);
}

#define SECTION_MEMBERS_MAX 16

struct reading {
	const struct style_section *section;
	void *into;
};

static bool read_member(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	const struct reading *to = user_data;
	const struct step_parameter *all = to->section->parameters,
				    *p = step_parameter_find(all, key);
	const char *known[SECTION_MEMBERS_MAX + 1] = { NULL };
	if (p)
		return style_reader_parameter(r, p, value, to->into);
	for (int n = 0; all[n].name && n < SECTION_MEMBERS_MAX; n++)
		known[n] = all[n].name;
	return style_reader_unknown(r, key, value, to->section->name, known);
}

static bool read_section(
	style_reader *r, const struct style_section *section, JsonNode *value, style *s)
{
	struct reading to = { section, (char *)&s->whole + section->offset };
	return style_reader_object(r, value, "an object") &&
	       style_reader_each(r, value, read_member, &to);
}

static bool read_segments(style_reader *r, JsonNode *value, style *s)
{
	return style_reader_object(r, value, "an object of nodes") &&
	       style_reader_each(r, value, read_node, s);
}

/* These were read before. */
static bool read_nothing(style_reader *r, JsonNode *value, style *s)
{
	(void)r;
	(void)value;
	(void)s;
	return true;
}

static const struct field {
	const char *name;
	bool (*read)(style_reader *r, JsonNode *value, style *s);
} fields[] = {
	{ "$schema", read_nothing }, /* for editors */
	{ "schema", read_nothing },
	{ "name", read_name },
	{ "title", read_title },
	{ "source", read_source },
	{ "description", read_description },
	{ "base", read_nothing },
	{ "segments", read_segments },
};

static bool read_field(style_reader *r, const char *key, JsonNode *value, void *user_data)
{
	const char *names[G_N_ELEMENTS(fields) + SECTION_MEMBERS_MAX + 1] = { NULL };
	size_t known = 0;
	for (size_t i = 0; i < G_N_ELEMENTS(fields); i++) {
		if (strcmp(fields[i].name, key) == 0)
			return fields[i].read(r, value, user_data);
		names[known++] = fields[i].name;
	}
	for (const struct style_section *n = style_sections; n->name; n++) {
		if (strcmp(n->name, key) == 0)
			return read_section(r, n, value, user_data);
		names[known++] = n->name;
	}
	return style_reader_unknown(r, key, value, "a style", names);
}

/* ---- what is read before all else ---- */

static bool read_schema(style_reader *r, JsonNode *root)
{
	JsonNode *value = json_object_get_member(json_node_get_object(root), "schema");
	if (!value)
		return style_reader_refuse(r, root, "'schema' is missing; it is %d", STYLE_SCHEMA);
	gsize was = style_reader_enter(r, "schema");
	if (!JSON_NODE_HOLDS_VALUE(value) || json_node_get_value_type(value) != G_TYPE_INT64)
		return style_reader_wrong(r, value, "a whole number");
	gint64 schema = json_node_get_int(value);
	if (schema != STYLE_SCHEMA)
		return style_reader_refuse(r, value,
			schema > STYLE_SCHEMA ? "a later version made this style; this one knows %d"
					      : "it is %d",
			STYLE_SCHEMA);
	style_reader_leave(r, was);
	return true;
}

static void take_over(style *s, const style *base)
{
	s->whole = base->whole;
	g_free(s->source);
	s->source = g_strdup(base->source);
}

/* *ret: the base, or NULL when there is none. */
static bool read_base(
	style_reader *r, JsonNode *root, const struct style_loading *loading, style **ret)
{
	JsonNode *value = json_object_get_member(json_node_get_object(root), "base");
	g_autoptr(GError) wrong = NULL;
	if (!value)
		return true;
	gsize was = style_reader_enter(r, "base");
	const char *name = style_reader_words(r, value);
	if (!name)
		return false;
	*ret = style_find_in(name, r->document->folder, loading->site_path, loading, &wrong);
	if (!*ret)
		return style_reader_refuse(r, value, "%s", wrong->message);
	style_reader_leave(r, was);
	return true;
}

/* ---- the whole ---- */

static style *new_style(const char *name, const char *path)
{
	style *s = g_new0(style, 1);
	s->name = g_strdup(name);
	s->path = g_strdup(path);
	s->source = g_strdup("user");
	s->description = g_strdup("");
	s->nodes = g_ptr_array_new_with_free_func(free_node);
	for (const struct style_section *n = style_sections; n->name; n++)
		step_parameters_fill(n->parameters, (char *)&s->whole + n->offset);
	return s;
}

void style_free(style *s)
{
	if (!s)
		return;
	g_free(s->name);
	g_free(s->title);
	g_free(s->source);
	g_free(s->description);
	g_free(s->path);
	g_ptr_array_unref(s->nodes);
	g_free(s);
}

static bool read_style(
	style *s, const style_document *d, const struct style_loading *loading, GError **error)
{
	g_autoptr(style_reader) r = style_reader_new(d, error);
	g_autoptr(style) base = NULL;
	if (!style_reader_object(r, d->root, "an object {...}") || !read_schema(r, d->root) ||
		!read_base(r, d->root, loading, &base))
		return false;
	if (base)
		take_over(s, base);
	if (!style_reader_each(r, d->root, read_field, s))
		return false;
	if (base)
		inherit_nodes(s, base);
	if (!s->nodes->len)
		return style_reader_refuse(
			r, d->root, "nothing is drawn; it needs \"segments\", or a \"base\"");
	if (!s->title)
		s->title = g_strdup(s->name);
	return style_check(s, error);
}

/* "pencil" of "styles/pencil.json". */
static char *name_of_path(const char *path)
{
	char *name = g_path_get_basename(path);
	if (g_str_has_suffix(name, ".json"))
		name[strlen(name) - strlen(".json")] = '\0';
	return name;
}

static style *parse(const char *text, size_t length, const char *file, const char *path,
	const struct style_loading *loading, GError **error)
{
	g_autofree char *name = name_of_path(file),
			*folder = path ? g_path_get_dirname(path) : NULL;
	g_autoptr(style) s = new_style(name, path);
	if (length > STYLE_BYTES_MAX) {
		g_set_error(error, STYLE_ERROR, STYLE_ERROR_JSON,
			"%s has %zu bytes; a style has at most %d", file, length, STYLE_BYTES_MAX);
		return NULL;
	}
	g_autoptr(style_document) d = style_document_parse(text, length, file, folder, error);
	return d && read_style(s, d, loading, error) ? g_steal_pointer(&s) : NULL;
}

style *style_parse(const char *text, gssize length, const char *name_for_errors, GError **error)
{
	struct style_loading nothing = { 0 };
	return parse(text, length < 0 ? strlen(text) : (size_t)length, name_for_errors, NULL,
		&nothing, error);
}

style *style_parse_for(
	const char *text, const char *name_for_errors, const char *site_path, GError **error)
{
	struct style_loading site = { .site_path = site_path };
	return parse(text, strlen(text), name_for_errors, NULL, &site, error);
}

/* Links may make a circle too, so it is looked for by true paths. */
static bool check_circle(const struct style_loading *loading, GError **error)
{
	int depth = 1;
	for (const struct style_loading *l = loading->user; l; l = l->user, depth++)
		if (g_strcmp0(l->path, loading->path) == 0 || depth == BASES_MAX) {
			g_set_error(error, STYLE_ERROR, STYLE_ERROR_FIELD,
				depth == BASES_MAX ? "%s is the base of too many bases"
						   : "%s is based on what it is the base of",
				loading->path);
			return false;
		}
	return true;
}

style *style_load_in(
	const char *path, const char *site_path, const struct style_loading *user, GError **error)
{
	size_t length;
	g_autofree char *text = files_read(path, STYLE_BYTES_MAX, &length, error);
	char *true_path = text ? realpath(path, NULL) : NULL;
	struct style_loading loading = { site_path, true_path, user };
	style *s = text && check_circle(&loading, error)
			   ? parse(text, length, path, path, &loading, error)
			   : NULL;
	free(true_path);
	return s;
}

style *style_load(const char *path, GError **error)
{
	return style_load_in(path, NULL, NULL, error);
}
