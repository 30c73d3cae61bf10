#include "render/kiosk/exports.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>

#define REMOVED ".removed"

void export_item_free(export_item *e)
{
	if (!e)
		return;
	g_free(e->path);
	g_free(e->name);
	g_free(e);
}

char *exports_folder(const char *site)
{
	return g_build_filename(site, "exports", NULL);
}

/* ---- the list ---- */

static enum export_kind kind_of(const char *name)
{
	static const struct {
		const char *ending;
		enum export_kind kind;
	} kinds[] = {
		{ ".png", EXPORT_PICTURE },
		{ ".jpg", EXPORT_PICTURE },
		{ ".svg", EXPORT_DRAWING },
		{ ".pdf", EXPORT_DRAWING },
		{ ".mp4", EXPORT_FILM },
		{ ".webm", EXPORT_FILM },
		{ ".html", EXPORT_REPORT },
		{ ".e57", EXPORT_POINTS },
		{ ".ptx", EXPORT_POINTS },
		{ ".las", EXPORT_POINTS },
		{ ".ply", EXPORT_POINTS },
		{ ".pcd", EXPORT_POINTS },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++)
		if (g_str_has_suffix(name, kinds[i].ending))
			return kinds[i].kind;
	return EXPORT_OTHER;
}

/* The JSON that is written beside a page: NULL when name is no page. */
static char *companion_of(const char *name)
{
	if (!g_str_has_suffix(name, ".html"))
		return NULL;
	return g_strdup_printf("%.*s.json", (int)(strlen(name) - strlen(".html")), name);
}

static bool goes_along(const char *folder, const char *name)
{
	if (!g_str_has_suffix(name, ".json"))
		return false;
	g_autofree char *page =
		g_strdup_printf("%.*s.html", (int)(strlen(name) - strlen(".json")), name);
	g_autofree char *path = g_build_filename(folder, page, NULL);
	return g_file_test(path, G_FILE_TEST_EXISTS);
}

/* Folders in folders are not looked into: what is made here has none. */
static void measure_folder(export_item *e)
{
	g_autoptr(GDir) dir = g_dir_open(e->path, 0, NULL);
	const char *name;
	e->kind = EXPORT_FOLDER;
	e->files = 0;
	e->bytes = 0;
	while (dir && (name = g_dir_read_name(dir))) {
		g_autofree char *path = g_build_filename(e->path, name, NULL);
		GStatBuf s;
		if (*name == '.' || g_stat(path, &s) || !S_ISREG(s.st_mode))
			continue;
		e->files++;
		e->bytes += (double)s.st_size;
	}
}

static double size_of_companion(const char *folder, const char *name)
{
	g_autofree char *companion = companion_of(name);
	g_autofree char *path = companion ? g_build_filename(folder, companion, NULL) : NULL;
	GStatBuf s;
	return path && !g_stat(path, &s) ? (double)s.st_size : 0;
}

static export_item *item_at(const char *folder, const char *name)
{
	g_autofree char *path = g_build_filename(folder, name, NULL);
	GStatBuf s;
	if (*name == '.' || g_stat(path, &s) || goes_along(folder, name))
		return NULL;
	export_item *e = g_new0(export_item, 1);
	e->path = g_steal_pointer(&path);
	e->name = g_strdup(name);
	e->kind = kind_of(name);
	e->files = 1;
	e->bytes = (double)s.st_size + size_of_companion(folder, name);
	e->changed_us = (int64_t)s.st_mtim.tv_sec * G_USEC_PER_SEC + s.st_mtim.tv_nsec / 1000;
	if (S_ISDIR(s.st_mode))
		measure_folder(e);
	return e;
}

static int newest_first(gconstpointer a, gconstpointer b)
{
	const export_item *const *one = a, *const *other = b;
	if ((*one)->changed_us != (*other)->changed_us)
		return (*one)->changed_us > (*other)->changed_us ? -1 : 1;
	return strcmp((*one)->name, (*other)->name);
}

GPtrArray *exports_list(const char *site)
{
	g_autofree char *folder = exports_folder(site);
	GPtrArray *all = g_ptr_array_new_with_free_func((GDestroyNotify)export_item_free);
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	const char *name;
	while (dir && (name = g_dir_read_name(dir))) {
		export_item *e = item_at(folder, name);
		if (e)
			g_ptr_array_add(all, e);
	}
	g_ptr_array_sort(all, newest_first);
	return all;
}

static int by_text(gconstpointer a, gconstpointer b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

char **exports_pictures_in(const char *folder)
{
	GPtrArray *paths = g_ptr_array_new();
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	const char *name;
	while (dir && (name = g_dir_read_name(dir)))
		if (*name != '.' && kind_of(name) == EXPORT_PICTURE)
			g_ptr_array_add(paths, g_build_filename(folder, name, NULL));
	g_ptr_array_sort(paths, by_text);
	g_ptr_array_add(paths, NULL);
	return (char **)g_ptr_array_free(paths, FALSE);
}

/* ---- new ones ---- */

static bool is_taken(const GPtrArray *taken, const char *path)
{
	for (guint i = 0; taken && i < taken->len; i++)
		if (!g_strcmp0(g_ptr_array_index(taken, i), path))
			return true;
	return g_file_test(path, G_FILE_TEST_EXISTS);
}

char *exports_free_path(const char *site, const char *stem, const char *ending,
	const GPtrArray *taken, GError **error)
{
	g_autofree char *folder = exports_folder(site);
	if (!files_make_folder(folder, error))
		return NULL;
	for (unsigned n = 1;; n++) {
		g_autofree char *name = n == 1 ? g_strdup_printf("%s.%s", stem, ending)
					       : g_strdup_printf("%s-%u.%s", stem, n, ending);
		g_autofree char *path = g_build_filename(folder, name, NULL);
		if (!is_taken(taken, path))
			return g_steal_pointer(&path);
	}
}

/* ---- put aside ---- */

static bool move(const char *from, const char *to, const char *name, GError **error)
{
	g_autofree char *old = g_build_filename(from, name, NULL);
	g_autofree char *new = g_build_filename(to, name, NULL);
	if (g_file_test(new, G_FILE_TEST_EXISTS)) {
		errno = EEXIST;
		return files_fail(error, new, "move there");
	}
	return !g_rename(old, new) || files_fail(error, old, "move");
}

/* Whether the companion is there or not, what counts is the file itself. */
static bool move_both(const char *from, const char *to, const char *name, GError **error)
{
	g_autofree char *companion = companion_of(name);
	if (!move(from, to, name, error))
		return false;
	if (companion)
		move(from, to, companion, NULL);
	return true;
}

char *exports_remove(const char *site, const char *name, GError **error)
{
	g_autofree char *folder = exports_folder(site);
	g_autofree char *removed = g_build_filename(folder, REMOVED, NULL);
	/* One folder each: what has the same name may be removed twice. */
	g_autofree char *aside = g_build_filename(removed, "XXXXXX", NULL);
	if (!files_make_folder(removed, error))
		return NULL;
	if (!g_mkdtemp(aside)) {
		files_fail(error, aside, "make");
		return NULL;
	}
	return move_both(folder, aside, name, error) ? g_steal_pointer(&aside) : NULL;
}

bool exports_restore(const char *site, const char *aside, const char *name, GError **error)
{
	g_autofree char *folder = exports_folder(site);
	return move_both(aside, folder, name, error);
}

bool exports_forget_removed(const char *site, GError **error)
{
	g_autofree char *folder = exports_folder(site);
	g_autofree char *removed = g_build_filename(folder, REMOVED, NULL);
	return !g_file_test(removed, G_FILE_TEST_EXISTS) || files_remove_tree(removed, error);
}
