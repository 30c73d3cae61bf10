#ifndef RENDER_KIOSK_DRIVE_FILES_H
#define RENDER_KIOSK_DRIVE_FILES_H
/* What other scanners and programs left on the drives: files of points and meshes that a site can take in. Without GTK. */
#include <gio/gio.h>
#include <stdbool.h>

typedef struct drive_file drive_file;
struct drive_file {
	char *path, *name, *place; /* place: the drive, and the folder on it ("STICK/monday") */
	const char *format;        /* as process/import.h names it; static */
	bool is_mesh;
	double bytes;
};
void drive_file_free(drive_file *f); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(drive_file, drive_file_free)

#define DRIVE_FILES_MOST 300
/* Of drive_file, by place and name; frees what is in it. folders: as drives_list takes them. Looks into folders, but not at what is
 * hidden or a link, and into each file's beginning: any thread, and not the main one. *ret_all: false where there are more than
 * DRIVE_FILES_MOST, or folders deeper than are looked into. */
GPtrArray *drive_files_list(char *const *folders, GCancellable *cancellable, bool *ret_all);

#endif
