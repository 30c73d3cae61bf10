#ifndef FIRMWARE_IO_FILES_H
#define FIRMWARE_IO_FILES_H
/* What the disk must not forget. A function that returns true has put its change on the disk: a
 * power cut after it does not undo it, and one during it leaves the state before or the state
 * after. Errors are of G_IO_ERROR, one sentence that begins with the path. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>

/* Puts a G_IO_ERROR from errno: "PATH: cannot WHAT: No such file or directory". Returns false, so
 * that it can be returned. */
bool files_fail(GError **error, const char *path, const char *what);

bool files_sync_folder(const char *path, GError **error); /* the names in it */

/* Renames and syncs the folder; both paths are in the same one. `to` must not exist:
 * G_IO_ERROR_EXISTS. */
bool files_rename_new(const char *from, const char *to, GError **error);

/* Replaces or makes a file as a whole, by way of .NAME.new beside it. One that a killed writer left
 * there is written over, so there must be one writer of this file at a time. */
bool files_write(const char *path, const void *bytes, size_t length, GError **error);
/* The same for a file that must not exist yet: G_IO_ERROR_EXISTS. */
bool files_create(const char *path, const void *bytes, size_t length, GError **error);

/* Makes the last folder of path. True when it is there already. */
bool files_make_folder(const char *path, GError **error);

/* The names in a folder but for . and .., sorted; caller frees (they go with the array). */
GPtrArray *files_names(const char *path, GError **error);

/* Opens for reading what is a plain file, and refuses the rest ("PATH: is a folder") without ever
 * blocking on it. -1 and an error, or the descriptor; *ret_size may be NULL. */
int files_open_plain(const char *path, size_t *ret_size, GError **error);

/* The whole file with a zero byte behind it; caller frees. Refuses one of more than max bytes. */
char *files_read(const char *path, size_t max, size_t *ret_length, GError **error);

/* Removes a file or folder and all that is in it. Links are removed, not followed. True when there
 * is none. */
bool files_remove_tree(const char *path, GError **error);

#endif
