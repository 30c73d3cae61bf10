#include "render/kiosk/drives.h"
#include "firmware-io/files.h"
#include <fcntl.h>
#include <gio/gio.h>
#include <gio/gunixmounts.h>
#include <string.h>
#include <unistd.h>

void drive_free(drive *d)
{
	if (!d)
		return;
	g_free(d->path);
	g_free(d->name);
	g_free(d);
}

bool drives_is_place(const char *path)
{
	static const char *const places[] = { "/media/", "/run/media/", "/mnt/" };
	for (size_t i = 0; i < G_N_ELEMENTS(places); i++)
		if (g_str_has_prefix(path, places[i]) && path[strlen(places[i])])
			return true;
	return !g_strcmp0(path, "/mnt");
}

static drive *drive_at(const char *path)
{
	drive *d = g_new0(drive, 1);
	g_autoptr(GFile) file = g_file_new_for_path(path);
	g_autoptr(GFileInfo) info = g_file_query_filesystem_info(file, "filesystem::*", NULL, NULL);
	d->path = g_strdup(path);
	d->name = g_path_get_basename(path);
	d->is_writable = access(path, W_OK) == 0;
	if (!info)
		return d;
	d->free_bytes =
		(double)g_file_info_get_attribute_uint64(info, G_FILE_ATTRIBUTE_FILESYSTEM_FREE);
	d->total_bytes =
		(double)g_file_info_get_attribute_uint64(info, G_FILE_ATTRIBUTE_FILESYSTEM_SIZE);
	return d;
}

static void add_folders_in(GPtrArray *drives, const char *folder)
{
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	const char *name;
	while (dir && (name = g_dir_read_name(dir))) {
		g_autofree char *path = g_build_filename(folder, name, NULL);
		if (*name != '.' && g_file_test(path, G_FILE_TEST_IS_DIR))
			g_ptr_array_add(drives, drive_at(path));
	}
}

static void add_mounted(GPtrArray *drives)
{
	GList *mounts = g_unix_mounts_get(NULL);
	for (GList *m = mounts; m; m = m->next) {
		const char *path = g_unix_mount_get_mount_path(m->data);
		if (drives_is_place(path))
			g_ptr_array_add(drives, drive_at(path));
	}
	g_list_free_full(mounts, (GDestroyNotify)g_unix_mount_free);
}

static int by_name(gconstpointer a, gconstpointer b)
{
	const drive *const *one = a, *const *other = b;
	return g_utf8_collate((*one)->name, (*other)->name);
}

GPtrArray *drives_list(char *const *folders)
{
	GPtrArray *drives = g_ptr_array_new_with_free_func((GDestroyNotify)drive_free);
	if (!folders)
		add_mounted(drives);
	for (; folders && *folders; folders++)
		add_folders_in(drives, *folders);
	g_ptr_array_sort(drives, by_name);
	return drives;
}

bool drive_sync(const char *path, GError **error)
{
	int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	bool good = fd >= 0 && syncfs(fd) == 0;
	if (!good)
		files_fail(error, path, "bring to the drive what is in memory");
	if (fd >= 0)
		close(fd);
	return good;
}

/* ---- coming and going ---- */

struct drives_watch {
	void (*changed)(gpointer user_data);
	gpointer user_data;
	GUnixMountMonitor *mounts;
	GPtrArray *folders; /* of GFileMonitor */
};

static void changed(drives_watch *w)
{
	w->changed(w->user_data);
}

static void watch_folder(drives_watch *w, const char *path)
{
	g_autoptr(GFile) file = g_file_new_for_path(path);
	GFileMonitor *m = g_file_monitor_directory(file, G_FILE_MONITOR_WATCH_MOVES, NULL, NULL);
	if (!m)
		return;
	g_signal_connect_swapped(m, "changed", G_CALLBACK(changed), w);
	g_ptr_array_add(w->folders, m);
}

drives_watch *drives_watch_new(
	char *const *folders, void (*ask_again)(gpointer user_data), gpointer user_data)
{
	drives_watch *w = g_new0(drives_watch, 1);
	w->changed = ask_again;
	w->user_data = user_data;
	w->folders = g_ptr_array_new_with_free_func(g_object_unref);
	if (!folders) {
		w->mounts = g_unix_mount_monitor_get();
		g_signal_connect_swapped(w->mounts, "mounts-changed", G_CALLBACK(changed), w);
	}
	for (; folders && *folders; folders++)
		watch_folder(w, *folders);
	return w;
}

void drives_watch_free(drives_watch *w)
{
	if (!w)
		return;
	if (w->mounts)
		g_signal_handlers_disconnect_by_data(w->mounts, w);
	for (guint i = 0; i < w->folders->len; i++)
		g_signal_handlers_disconnect_by_data(g_ptr_array_index(w->folders, i), w);
	g_clear_object(&w->mounts);
	g_ptr_array_unref(w->folders);
	g_free(w);
}
