#ifndef RENDER_KIOSK_DRIVES_H
#define RENDER_KIOSK_DRIVES_H
/* Drives that people plug in: what is mounted below /media, /run/media and /mnt. Main thread. */
#include <glib.h>
#include <stdbool.h>

typedef struct drive drive;
struct drive {
	char *path, *name;              /* name: the last part of path */
	double free_bytes, total_bytes; /* 0 both: not known */
	bool is_writable;
};
void drive_free(drive *d); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(drive, drive_free)

/* Of struct drive, by name; frees what is in it. folders: instead, each folder in these is a drive; NULL ends them, NULL: what is
 * mounted. */
GPtrArray *drives_list(char *const *folders);
/* Is path below one of the places where drives are mounted? */
bool drives_is_place(const char *path);
/* Brings to the drive what is still in memory; may take long, any thread. */
bool drive_sync(const char *path, GError **error);

/* changed is called from the main loop when a drive came or went. */
typedef struct drives_watch drives_watch;
drives_watch *drives_watch_new(
	char *const *folders, void (*changed)(gpointer user_data), gpointer user_data);
void drives_watch_free(drives_watch *w); /* NULL is fine */

#endif
