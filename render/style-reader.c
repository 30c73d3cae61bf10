#include "render/style-reader.h"
#include "acquire/strict-json.h"
#include "render/nearest-name.h"
#include <string.h>

#define QUOTED_LETTERS_MAX 60
#define WORDS_BYTES_MAX    1000
#define NAME_LETTERS_MAX   64

/* ---- a document ---- */

static void clear_document(gpointer data)
{
	style_document *d = data;
	g_free(d->file);
	g_free(d->folder);
	g_clear_pointer(&d->root, json_node_unref);
	g_clear_pointer(&d->lines, g_hash_table_unref);
}

style_document *style_document_ref(style_document *d)
{
	return g_atomic_rc_box_acquire(d);
}

void style_document_unref(style_document *d)
{
	if (d)
		g_atomic_rc_box_release_full(d, clear_document);
}

style_document *style_document_parse(
	const char *text, size_t length, const char *file, const char *folder, GError **error)
{
	g_autoptr(GError) wrong = NULL;
	g_autoptr(style_document) d = g_atomic_rc_box_new0(style_document);
	d->file = g_strdup(file);
	d->folder = g_strdup(folder);
	d->root = strict_json_read_lines(text, length, &d->lines, &wrong);
	if (!d->root)
		g_set_error(error, STYLE_ERROR, STYLE_ERROR_JSON, "%s %s", file, wrong->message);
	return d->root ? g_steal_pointer(&d) : NULL;
}

/* ---- where we are ---- */

style_reader *style_reader_new(const style_document *d, GError **error)
{
	style_reader *r = g_new(style_reader, 1);
	*r = (style_reader){ d, g_string_new(NULL), error };
	return r;
}

void style_reader_free(style_reader *r)
{
	if (!r)
		return;
	g_string_free(r->path, TRUE);
	g_free(r);
}

static bool is_bare(const char *key)
{
	const char *c = key;
	while (g_ascii_isalnum(*c) || (*c && strchr("_-#$", *c)))
		c++;
	return *key && !*c && c - key <= QUOTED_LETTERS_MAX;
}

gsize style_reader_enter(style_reader *r, const char *key)
{
	gsize was = r->path->len;
	g_autofree char *quoted = style_reader_quote(key);
	if (is_bare(key))
		g_string_append_printf(r->path, "%s%s", was ? "." : "", key);
	else
		g_string_append_printf(r->path, "[\"%s\"]", quoted);
	return was;
}

gsize style_reader_enter_element(style_reader *r, guint i)
{
	gsize was = r->path->len;
	g_string_append_printf(r->path, "[%u]", i);
	return was;
}

void style_reader_leave(style_reader *r, gsize was)
{
	g_string_truncate(r->path, was);
}

bool style_reader_refuse(style_reader *r, JsonNode *at, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *what = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	guint line = GPOINTER_TO_UINT(g_hash_table_lookup(r->document->lines, at));
	g_set_error(r->error, STYLE_ERROR, STYLE_ERROR_FIELD, "%s line %u: %s%s%s",
		r->document->file, line, r->path->str, r->path->len ? ": " : "", what);
	return false;
}

char *style_reader_quote(const char *text)
{
	g_autoptr(GString) quoted = g_string_new(NULL);
	guint letters = 0;
	for (const char *c = text; *c; c = g_utf8_next_char(c)) {
		if (letters++ == QUOTED_LETTERS_MAX) {
			g_string_append(quoted, "...");
			break;
		}
		gunichar letter = g_utf8_get_char(c);
		g_string_append_unichar(quoted, g_unichar_isprint(letter) ? letter : 0xfffd);
	}
	return g_string_free(g_steal_pointer(&quoted), FALSE);
}

/* ---- values ---- */

bool style_reader_wrong(style_reader *r, JsonNode *node, const char *wanted)
{
	return style_reader_refuse(
		r, node, "this is %s; it must be %s", strict_json_kind(node), wanted);
}

JsonObject *style_reader_object(style_reader *r, JsonNode *node, const char *wanted)
{
	if (JSON_NODE_HOLDS_OBJECT(node))
		return json_node_get_object(node);
	return style_reader_wrong(r, node, wanted), NULL;
}

JsonArray *style_reader_list(style_reader *r, JsonNode *node, const char *wanted)
{
	if (JSON_NODE_HOLDS_ARRAY(node))
		return json_node_get_array(node);
	return style_reader_wrong(r, node, wanted), NULL;
}

static bool is_of(JsonNode *node, GType type)
{
	return JSON_NODE_HOLDS_VALUE(node) && json_node_get_value_type(node) == type;
}

const char *style_reader_text(style_reader *r, JsonNode *node, const char *wanted)
{
	if (is_of(node, G_TYPE_STRING))
		return json_node_get_string(node);
	return style_reader_wrong(r, node, wanted), NULL;
}

static bool is_printable(const char *text)
{
	for (; *text; text = g_utf8_next_char(text))
		if (!g_unichar_isprint(g_utf8_get_char(text)))
			return false;
	return true;
}

const char *style_reader_words(style_reader *r, JsonNode *node)
{
	const char *text = style_reader_text(r, node, "a text");
	if (!text)
		return NULL;
	if (!*text || strlen(text) > WORDS_BYTES_MAX)
		return style_reader_refuse(r, node, "a text has 1 to %d bytes; this one has %zu",
			       WORDS_BYTES_MAX, strlen(text)),
		       NULL;
	if (!is_printable(text))
		return style_reader_refuse(
			       r, node, "line breaks and control characters cannot be in it"),
		       NULL;
	return text;
}

bool style_reader_is_name(const char *text)
{
	const char *c = text;
	while (g_ascii_isalnum(*c) || *c == '-' || *c == '_')
		c++;
	return *text && !*c && c - text <= NAME_LETTERS_MAX;
}

const char *style_reader_name(style_reader *r, JsonNode *node, const char *wanted)
{
	const char *text = style_reader_text(r, node, wanted);
	if (!text || style_reader_is_name(text))
		return text;
	g_autofree char *quoted = style_reader_quote(text);
	style_reader_refuse(r, node,
		"'%s' is not %s; it has letters, digits, '-' and '_', and at most %d of them",
		quoted, wanted, NAME_LETTERS_MAX);
	return NULL;
}

bool style_reader_each(style_reader *r, JsonNode *object, style_reader_member read, void *user_data)
{
	JsonObjectIter iter;
	const char *key;
	JsonNode *value;
	json_object_iter_init_ordered(&iter, json_node_get_object(object));
	while (json_object_iter_next_ordered(&iter, &key, &value)) {
		gsize was = style_reader_enter(r, key);
		if (!read(r, key, value, user_data))
			return false;
		style_reader_leave(r, was);
	}
	return true;
}

bool style_reader_unknown(
	style_reader *r, const char *key, JsonNode *value, const char *of, const char *const *known)
{
	g_autofree char *hint = nearest_name_hint(key, known);
	return style_reader_refuse(r, value, "%s has no such field%s", of, hint);
}
