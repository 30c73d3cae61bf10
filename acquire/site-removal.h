#ifndef ACQUIRE_SITE_REMOVAL_H
#define ACQUIRE_SITE_REMOVAL_H
/* Sites that are removed, and may still be wanted back: they stay beside the others for a while, under a name that lists of sites
 * pass over. A crash loses none: one is either there, or hidden, or on its way out. Errors are of G_IO_ERROR. Any thread. */
#include <glib.h>
#include <stdbool.h>

/* Hides a site, also one that cannot be read. Refused while somebody writes into it. *ret_hidden: where it now is; caller frees. */
bool site_remove(const char *path, char **ret_hidden, GError **error);
/* Brings it back under the name that it had. G_IO_ERROR_NOT_FOUND when it is gone for good, G_IO_ERROR_EXISTS when another one is
 * called so by now. *ret_path: caller frees; may be NULL. */
bool site_restore(const char *hidden, char **ret_path, GError **error);
/* Deletes what was removed from a folder of sites that long ago. What cannot be deleted stays for the next time. */
void site_clear_removed(const char *folder, double older_than_s);

#endif
