#ifndef ACQUIRE_STRICT_JSON_H
#define ACQUIRE_STRICT_JSON_H
/* JSON (RFC 8259) to and from json-glib's tree, for files that must read back as they were written.
 * json-glib's own parser is not used because of what it lets through: 010 is read as 8, 1e999 as
 * "inf" (which it then cannot read), numbers beyond 64 bits wrap, "\u0000" cuts a string, the first
 * of two equal keys is dropped, comments and a second document are skipped, and deep nesting
 * overflows the stack. */
#include <json-glib/json-glib.h>
#include <stddef.h>

#define STRICT_JSON_DEPTH_MAX 64

/* The tree, or NULL and an error of JSON_PARSER_ERROR "line 3, column 14: a key is there twice"
 * (columns in characters, from 1). Refused beside what RFC 8259 refuses: text that is not UTF-8,
 * nesting beyond STRICT_JSON_DEPTH_MAX, equal keys, numbers beyond int64_t or double, \u0000 and
 * halves of surrogate pairs. A leading byte order mark is passed over. Integers and other numbers
 * stay distinct, keys keep their order. */
JsonNode *strict_json_read(const char *text, size_t length, GError **error);
/* The same, and the line that each value of the tree begins on, from 1, so that what is wrong with it can be told later: from
 * JsonNode * to GUINT_TO_POINTER(line); caller unrefs. A node that is changed or copied has none. */
JsonNode *strict_json_read_lines(
	const char *text, size_t length, GHashTable **ret_lines, GError **error);

/* What it is, for people: "a text", "a list". */
const char *strict_json_kind(JsonNode *node);

/* Indented, with a newline at the end; caller frees. Numbers are the shortest that read back the
 * same; what is not finite is written as null, since JSON has no word for it. */
char *strict_json_write(JsonNode *root);

#endif
