#ifndef RENDER_STYLE_READER_H
#define RENDER_STYLE_READER_H
/* Reads the JSON of styles. Whatever is wrong is told with the file, the line and the path of the field:
 * "pencil.json line 12: segments.site.steps[0].length_px: 900 is too much; it goes from 1 to 400 px". */
#include "render/style.h"
#include <json-glib/json-glib.h>

/* A file as it was read; const, and shared by all nodes that came from it. */
typedef struct style_document style_document;
struct style_document {
	char *file;        /* as messages name it */
	char *folder;      /* that relative paths are from; NULL: the current one */
	JsonNode *root;    /* an object */
	GHashTable *lines; /* strict-json.h */
};
style_document *style_document_parse(
	const char *text, size_t length, const char *file, const char *folder, GError **error);
style_document *style_document_ref(style_document *d);
void style_document_unref(style_document *d); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(style_document, style_document_unref)

typedef struct style_reader style_reader;
struct style_reader {
	const style_document *document;
	GString *path;
	GError **error; /* may be NULL */
};
style_reader *style_reader_new(const style_document *d, GError **error);
void style_reader_free(style_reader *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(style_reader, style_reader_free)

/* To a member or an element, and back; after a failure nobody needs to. */
gsize style_reader_enter(style_reader *r, const char *key);
gsize style_reader_enter_element(style_reader *r, guint i);
void style_reader_leave(style_reader *r, gsize was);
/* false, so that it can be returned. */
bool style_reader_refuse(style_reader *r, JsonNode *at, const char *format, ...)
	G_GNUC_PRINTF(3, 4);
/* Something that a person wrote, for a message: not too long, and without what moves the cursor; caller frees. */
char *style_reader_quote(const char *text);

/* "this is a text; it must be a list of steps"; false. */
bool style_reader_wrong(style_reader *r, JsonNode *node, const char *wanted);
/* NULL, and such an error, where it is none. */
JsonObject *style_reader_object(style_reader *r, JsonNode *node, const char *wanted);
JsonArray *style_reader_list(style_reader *r, JsonNode *node, const char *wanted);
const char *style_reader_text(style_reader *r, JsonNode *node, const char *wanted);
/* Text for people: not empty, without control characters; at most 1000 bytes. */
const char *style_reader_words(style_reader *r, JsonNode *node);
/* Letters, digits, '-' and '_', at most 64. */
bool style_reader_is_name(const char *text);
const char *style_reader_name(style_reader *r, JsonNode *node, const char *wanted);

/* Calls read for each member, in their order, inside of it. */
typedef bool (*style_reader_member)(
	style_reader *r, const char *key, JsonNode *value, void *user_data);
bool style_reader_each(
	style_reader *r, JsonNode *object, style_reader_member read, void *user_data);

/* The value of a parameter, into the struct that it is of. */
bool style_reader_parameter(
	style_reader *r, const struct step_parameter *p, JsonNode *value, void *into);
/* Refuses a field that there is none of; known: NULL-terminated, of what ("strokes"). */
bool style_reader_unknown(style_reader *r, const char *key, JsonNode *value, const char *of,
	const char *const *known);

#endif
