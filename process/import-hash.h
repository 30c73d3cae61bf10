#ifndef PROCESS_IMPORT_HASH_H
#define PROCESS_IMPORT_HASH_H
/* SHA-256 of a file, beside other work. */
#include <glib.h>
#include <stdbool.h>

typedef struct import_hash import_hash;
/* Begins in a thread of its own. */
import_hash *import_hash_begin(const char *path);
/* Waits for it; caller frees the hash, in hex. The struct is freed. */
char *import_hash_end(import_hash *h, GError **error);
/* Stops and frees it; NULL is fine. */
void import_hash_free(import_hash *h);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(import_hash, import_hash_free)

#endif
