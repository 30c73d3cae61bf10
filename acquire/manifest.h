#ifndef ACQUIRE_MANIFEST_H
#define ACQUIRE_MANIFEST_H
/* A manifest is a small JSON file that says what stands beside it (site.json, scan.json). Loading
 * keeps every key, also those of later versions; saving replaces the file as a whole: a reader sees
 * the old or the new one, also after a power cut. Every getter fails with one sentence that names
 * the file and the key ("sites/oak/site.json: 'created' is missing"). Key paths are dotted:
 * "panorama.columns"; a key that itself has a dot is kept, but cannot be named. Not thread-safe.
 *
 * Errors of the text are of JSON_PARSER_ERROR, those of the file of G_IO_ERROR, those of a value of
 * MANIFEST_ERROR. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct manifest manifest;
/* Of json-glib, which most of those who include this do without. */
typedef struct _JsonNode JsonNode;

#define MANIFEST_BYTES_MAX (32 << 20)

#define MANIFEST_ERROR (manifest_error_quark())
GQuark manifest_error_quark(void);
enum manifest_error {
	MANIFEST_ERROR_MISSING, /* the key is not there */
	MANIFEST_ERROR_VALUE,   /* of another type, or outside its range */
	MANIFEST_ERROR_SCHEMA,  /* written by a later version of this program */
};

manifest *manifest_new(const char *path); /* empty, not yet on disk */
/* Refuses a file that is missing, empty, larger than MANIFEST_BYTES_MAX, not UTF-8, not JSON as
 * strict-json.h has it ("site.json: line 3, column 14: a colon is expected here"), not an object,
 * without a 'schema', or of a schema newer than schema_max. */
manifest *manifest_load(const char *path, int schema_max, GError **error);
/* The same for text at hand; path is what messages and manifest_save use. schema_max 0: the text
 * has no schema number. */
manifest *manifest_parse(
	const char *text, size_t length, const char *path, int schema_max, GError **error);
/* Writes .NAME.new beside, syncs, renames, syncs the folder. One at a time may save a file. */
bool manifest_save(const manifest *m, GError **error);
bool manifest_save_as(const manifest *m, const char *path, GError **error); /* m keeps its path */
const char *manifest_path(const manifest *m);
void manifest_free(manifest *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(manifest, manifest_free)

bool manifest_has(const manifest *m, const char *key);
/* false with a sentence when missing, of another type, not a number, or outside min..max. 3.0 is an
 * integer, 3 a number. */
bool manifest_get_int(
	const manifest *m, const char *key, int64_t min, int64_t max, int64_t *ret, GError **error);
bool manifest_get_number(
	const manifest *m, const char *key, double min, double max, double *ret, GError **error);
/* What these two return is owned by m; the second is NULL when missing. */
const char *manifest_get_string(const manifest *m, const char *key, GError **error);
JsonNode *manifest_get_node(const manifest *m, const char *key);

/* Setters make the objects on the way, in place of what else stands there. A number that is not
 * finite becomes null. */
void manifest_set_int(manifest *m, const char *key, int64_t value);
void manifest_set_number(manifest *m, const char *key, double value);
void manifest_set_string(manifest *m, const char *key, const char *value);
void manifest_set_node(manifest *m, const char *key, JsonNode *value); /* takes value */
void manifest_remove(manifest *m, const char *key);                    /* if it is there */
char *manifest_to_text(const manifest *m); /* indented, ends in a newline; caller frees */

#endif
