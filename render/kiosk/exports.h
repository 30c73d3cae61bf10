#ifndef RENDER_KIOSK_EXPORTS_H
#define RENDER_KIOSK_EXPORTS_H
/* What was made of a site to be taken home: files and folders in SITE/exports. site is the folder's path. Errors are of
 * G_IO_ERROR. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

enum export_kind {
	EXPORT_PICTURE,
	EXPORT_DRAWING,
	EXPORT_FILM,
	EXPORT_REPORT,
	EXPORT_POINTS, /* for other programs */
	EXPORT_FOLDER, /* of pictures */
	EXPORT_OTHER,
};
typedef struct export_item export_item;
struct export_item {
	char *path, *name; /* name: in exports */
	enum export_kind kind;
	double bytes;
	uint32_t files;     /* 1, or of a folder those in it */
	int64_t changed_us; /* since 1970 */
};
void export_item_free(export_item *e); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(export_item, export_item_free)

char *exports_folder(const char *site); /* caller frees */
/* Of export_item, the newest first; none where nothing was made. Frees what is in it. What goes along with another (the JSON of a
 * report) is counted with it, and what is hidden or half written is left out. */
GPtrArray *exports_list(const char *site);
/* Paths of the pictures in a folder, sorted; free with g_strfreev. */
char **exports_pictures_in(const char *folder);
/* "oak-points", "png": the path of a file that is not there yet, "-2" and so on added as needed; taken (of char *, may be NULL) are
 * paths that are promised to others. Makes the folder. Caller frees. */
char *exports_free_path(const char *site, const char *stem, const char *ending,
	const GPtrArray *taken, GError **error);

/* Puts it aside, with what goes along with it. Returns where it is now: what exports_restore takes; caller frees. */
char *exports_remove(const char *site, const char *name, GError **error);
/* Refused (G_IO_ERROR_EXISTS) where one of that name was made meanwhile. */
bool exports_restore(const char *site, const char *aside, const char *name, GError **error);
/* What was put aside is gone. */
bool exports_forget_removed(const char *site, GError **error);

#endif
