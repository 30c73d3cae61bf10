#ifndef PROCESS_COPY_FILE_H
#define PROCESS_COPY_FILE_H
/* One file, copied and read back. Errors are of G_IO_ERROR. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct copy_watcher {
	bool (*goes_on)(uint64_t bytes, gpointer user_data); /* false: G_IO_ERROR_CANCELLED */
	gpointer user_data;
};
/* SHA-256 in hex; caller frees. */
char *copy_file_hash(const char *path, const struct copy_watcher *w, GError **error);
/* By way of .NAME.part beside it, which is gone after an error. What is read back comes from the drive where the kernel lets go of
 * what it remembers. SHA-256 in hex; caller frees. */
char *copy_file(const char *from, const char *to, const struct copy_watcher *w, GError **error);

#endif
