#include "acquire/strict-json.h"
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

struct parser {
	const char *text, *at, *end;
	int depth;
	GError **error;
	GHashTable *lines; /* NULL: nobody asks */
	const char *counted;
	unsigned line; /* of counted */
};

static JsonNode *read_value(struct parser *p);

/* NULL, so that it can be returned. */
static void *fail(struct parser *p, const char *where, const char *what)
{
	unsigned line = 1;
	const char *line_start = p->text;
	for (const char *c = p->text; c < where; c++)
		if (*c == '\n') {
			line++;
			line_start = c + 1;
		}
	g_set_error(p->error, JSON_PARSER_ERROR, JSON_PARSER_ERROR_PARSE, "line %u, column %ld: %s",
		line, g_utf8_strlen(line_start, where - line_start) + 1, what);
	return NULL;
}

/* What people try who come from other languages, where something else is wanted. */
static const char *unless_comment(const struct parser *p, const char *what)
{
	bool is_comment = p->end - p->at >= 2 && *p->at == '/' && strchr("/*", p->at[1]);
	return is_comment ? "there are no comments in JSON" : what;
}

static void skip_space(struct parser *p)
{
	while (p->at < p->end && strchr(" \t\r\n", *p->at))
		p->at++;
}

static bool take(struct parser *p, char c)
{
	if (p->at == p->end || *p->at != c)
		return false;
	p->at++;
	return true;
}

static bool take_digits(struct parser *p)
{
	const char *start = p->at;
	while (p->at < p->end && g_ascii_isdigit(*p->at))
		p->at++;
	return p->at > start;
}

static bool take_word(struct parser *p, const char *word)
{
	size_t length = strlen(word);
	if ((size_t)(p->end - p->at) < length || memcmp(p->at, word, length))
		return false;
	p->at += length;
	return true;
}

/* The text ends in a zero byte, so the conversions below stop at the number's end by themselves. */
static JsonNode *read_integer(struct parser *p, const char *start)
{
	errno = 0;
	gint64 value = g_ascii_strtoll(start, NULL, 10);
	if (errno == ERANGE)
		return fail(p, start, "this number does not fit in 64 bits");
	return json_node_init_int(json_node_alloc(), value);
}

static JsonNode *read_number(struct parser *p)
{
	const char *start = p->at;
	bool whole = true;
	take(p, '-');
	if (!take(p, '0') && !take_digits(p))
		return fail(p, start, unless_comment(p, "a value is expected here"));
	if (p->at < p->end && g_ascii_isdigit(*p->at))
		return fail(p, start, "a number must not begin with a zero");
	if (take(p, '.')) {
		whole = false;
		if (!take_digits(p))
			return fail(p, p->at, "a digit is expected here");
	}
	if (take(p, 'e') || take(p, 'E')) {
		whole = false;
		if (!take(p, '+'))
			take(p, '-');
		if (!take_digits(p))
			return fail(p, p->at, "a digit is expected here");
	}
	if (whole)
		return read_integer(p, start);
	double value = g_ascii_strtod(start, NULL);
	if (!isfinite(value))
		return fail(p, start, "this number is too large");
	return json_node_init_double(json_node_alloc(), value);
}

/* The four digits of \uXXXX, or -1. */
static int read_hex4(struct parser *p)
{
	int value = 0;
	if (p->end - p->at < 4)
		return -1;
	for (int i = 0; i < 4; i++) {
		int digit = g_ascii_xdigit_value(p->at[i]);
		if (digit < 0)
			return -1;
		value = value << 4 | digit;
	}
	p->at += 4;
	return value;
}

/* After \u; characters beyond FFFF come as two halves. */
static bool read_unicode(struct parser *p, GString *into)
{
	int c = read_hex4(p);
	if (c >= 0xd800 && c < 0xdc00) {
		int low = take_word(p, "\\u") ? read_hex4(p) : -1;
		c = low >= 0xdc00 && low < 0xe000 ? 0x10000 + ((c - 0xd800) << 10) + (low - 0xdc00)
						  : -1;
	}
	if (c <= 0 || (c >= 0xdc00 && c < 0xe000))
		return false;
	g_string_append_unichar(into, (gunichar)c);
	return true;
}

static bool read_escape(struct parser *p, GString *into)
{
	static const char letters[] = "\"\\/bfnrt", meanings[] = "\"\\/\b\f\n\r\t";
	if (p->at == p->end)
		return false;
	char c = *p->at++;
	if (c == 'u')
		return read_unicode(p, into);
	const char *letter = c ? strchr(letters, c) : NULL;
	if (letter)
		g_string_append_c(into, meanings[letter - letters]);
	return letter;
}

/* Caller frees. */
static char *read_string(struct parser *p)
{
	const char *start = p->at;
	if (!take(p, '"'))
		return fail(
			p, p->at, unless_comment(p, "a text in quotation marks is expected here"));
	g_autoptr(GString) into = g_string_new(NULL);
	while (!take(p, '"')) {
		const char *here = p->at;
		if (p->at == p->end)
			return fail(p, start, "this text has no closing quotation mark");
		if ((unsigned char)*p->at < 0x20)
			return fail(p, p->at, "a line break or control character inside a text");
		if (!take(p, '\\'))
			g_string_append_c(into, *p->at++);
		else if (!read_escape(p, into))
			return fail(p, here, "this is no escape that JSON knows");
	}
	return g_string_free(g_steal_pointer(&into), false);
}

static bool read_member(struct parser *p, JsonObject *into)
{
	skip_space(p);
	const char *start = p->at;
	g_autofree char *key = read_string(p);
	if (!key)
		return false;
	if (json_object_has_member(into, key))
		return fail(p, start, "this key is there twice");
	skip_space(p);
	if (!take(p, ':'))
		return fail(p, p->at, unless_comment(p, "a colon is expected here"));
	JsonNode *value = read_value(p);
	if (value)
		json_object_set_member(into, key, value);
	return value;
}

static JsonNode *read_object(struct parser *p)
{
	g_autoptr(JsonObject) object = json_object_new();
	skip_space(p);
	if (!take(p, '}')) {
		do {
			if (!read_member(p, object))
				return NULL;
			skip_space(p);
		} while (take(p, ','));
		if (!take(p, '}'))
			return fail(p, p->at, unless_comment(p, "a comma or '}' is expected here"));
	}
	return json_node_init_object(json_node_alloc(), object);
}

static JsonNode *read_array(struct parser *p)
{
	g_autoptr(JsonArray) array = json_array_new();
	skip_space(p);
	if (!take(p, ']')) {
		do {
			JsonNode *value = read_value(p);
			if (!value)
				return NULL;
			json_array_add_element(array, value);
			skip_space(p);
		} while (take(p, ','));
		if (!take(p, ']'))
			return fail(p, p->at, unless_comment(p, "a comma or ']' is expected here"));
	}
	return json_node_init_array(json_node_alloc(), array);
}

static JsonNode *read_nested(struct parser *p, JsonNode *(*read)(struct parser *))
{
	if (p->depth == STRICT_JSON_DEPTH_MAX)
		return fail(p, p->at - 1, "this is nested too deeply");
	p->depth++;
	JsonNode *node = read(p);
	p->depth--;
	return node;
}

static JsonNode *read_any(struct parser *p)
{
	if (take(p, '{'))
		return read_nested(p, read_object);
	if (take(p, '['))
		return read_nested(p, read_array);
	if (take_word(p, "true"))
		return json_node_init_boolean(json_node_alloc(), true);
	if (take_word(p, "false"))
		return json_node_init_boolean(json_node_alloc(), false);
	if (take_word(p, "null"))
		return json_node_init_null(json_node_alloc());
	if (p->at == p->end || *p->at != '"')
		return read_number(p);
	g_autofree char *string = read_string(p);
	return string ? json_node_init_string(json_node_alloc(), string) : NULL;
}

/* Of p->at, which only moves on. */
static unsigned line_here(struct parser *p)
{
	for (; p->counted < p->at; p->counted++)
		p->line += *p->counted == '\n';
	return p->line;
}

static JsonNode *read_value(struct parser *p)
{
	skip_space(p);
	unsigned line = p->lines ? line_here(p) : 0;
	JsonNode *node = read_any(p);
	if (node && p->lines)
		g_hash_table_insert(p->lines, node, GUINT_TO_POINTER(line));
	return node;
}

static JsonNode *read_text(const char *text, size_t length, GHashTable *lines, GError **error)
{
	g_autofree char *copy = g_strndup(text, length);
	struct parser p = { .text = copy,
		.at = copy,
		.end = copy + length,
		.error = error,
		.lines = lines,
		.counted = copy,
		.line = 1 };
	const char *odd;
	if (!g_utf8_validate_len(copy, length, &odd))
		return fail(&p, odd, "this is not UTF-8 text");
	if (take_word(&p, "\xef\xbb\xbf"))
		p.text = p.at;
	g_autoptr(JsonNode) root = read_value(&p);
	if (!root)
		return NULL;
	skip_space(&p);
	if (p.at < p.end)
		return fail(&p, p.at, unless_comment(&p, "nothing more is expected here"));
	return g_steal_pointer(&root);
}

JsonNode *strict_json_read(const char *text, size_t length, GError **error)
{
	return read_text(text, length, NULL, error);
}

JsonNode *strict_json_read_lines(
	const char *text, size_t length, GHashTable **ret_lines, GError **error)
{
	g_autoptr(GHashTable) lines = g_hash_table_new(NULL, NULL);
	JsonNode *root = read_text(text, length, lines, error);
	if (root)
		*ret_lines = g_steal_pointer(&lines);
	return root;
}

const char *strict_json_kind(JsonNode *node)
{
	if (JSON_NODE_HOLDS_OBJECT(node))
		return "an object";
	if (JSON_NODE_HOLDS_ARRAY(node))
		return "a list";
	if (JSON_NODE_HOLDS_NULL(node))
		return "null";
	GType type = json_node_get_value_type(node);
	return type == G_TYPE_STRING    ? "a text"
	       : type == G_TYPE_BOOLEAN ? "true or false"
					: "a number";
}
