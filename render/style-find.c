/* Where styles are. */
#include "render/nearest-name.h"
#include "render/style-private.h"
#include <string.h>

static void add_folder(GPtrArray *folders, char *folder)
{
	g_ptr_array_add(folders, folder);
}

static void add_listed(GPtrArray *folders, const char *list)
{
	g_auto(GStrv) listed = g_strsplit(list ? list : "", G_SEARCHPATH_SEPARATOR_S, -1);
	for (char **folder = listed; *folder; folder++)
		if (**folder)
			add_folder(folders, g_strdup(*folder));
}

static char *shipped_folder(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : "."),
			*above = g_path_get_dirname(folder);
	return g_build_filename(above, "share", "pleinair", "styles", NULL);
}

GPtrArray *style_folders(const char *site_path)
{
	GPtrArray *folders = g_ptr_array_new_with_free_func(g_free);
	if (site_path)
		add_folder(folders, g_build_filename(site_path, "styles", NULL));
	add_listed(folders, g_getenv("PLEINAIR_STYLES"));
	add_folder(folders, g_build_filename(g_get_user_data_dir(), "pleinair", "styles", NULL));
	add_folder(folders, shipped_folder());
	return folders;
}

/* Other files, and names that could not be typed, are passed over. */
static void add_names(GHashTable *names, const char *folder)
{
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	for (const char *file; dir && (file = g_dir_read_name(dir));) {
		if (!g_str_has_suffix(file, ".json"))
			continue;
		char *name = g_strndup(file, strlen(file) - strlen(".json"));
		if (style_reader_is_name(name))
			g_hash_table_add(names, name);
		else
			g_free(name);
	}
}

static int compare_names(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static char **names_in(const GPtrArray *folders)
{
	g_autoptr(GHashTable) names = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	guint count;
	for (guint i = 0; i < folders->len; i++)
		add_names(names, folders->pdata[i]);
	char **list = (char **)g_hash_table_get_keys_as_array(names, &count);
	g_hash_table_steal_all(names);
	qsort(list, count, sizeof *list, compare_names);
	return list;
}

char **style_names(const char *site_path)
{
	g_autoptr(GPtrArray) folders = style_folders(site_path);
	return names_in(folders);
}

static bool is_path(const char *name)
{
	return strchr(name, '/') || g_str_has_suffix(name, ".json");
}

/* NULL: it is in none of them. */
static char *path_in(const GPtrArray *folders, const char *name)
{
	g_autofree char *file = g_strconcat(name, ".json", NULL);
	for (guint i = 0; i < folders->len; i++) {
		g_autofree char *path = g_build_filename(folders->pdata[i], file, NULL);
		if (g_file_test(path, G_FILE_TEST_EXISTS))
			return g_steal_pointer(&path);
	}
	return NULL;
}

static void refuse(const char *name, const GPtrArray *folders, GError **error)
{
	g_auto(GStrv) names = names_in(folders);
	g_autofree char *quoted = style_reader_quote(name),
			*hint = nearest_name_hint(name, (const char *const *)names);
	g_set_error(
		error, STYLE_ERROR, STYLE_ERROR_UNKNOWN, "there is no style '%s'%s", quoted, hint);
}

style *style_find_in(const char *name, const char *folder, const char *site_path,
	const struct style_loading *user, GError **error)
{
	if (is_path(name)) {
		g_autofree char *path = folder && !g_path_is_absolute(name)
						? g_build_filename(folder, name, NULL)
						: g_strdup(name);
		return style_load_in(path, site_path, user, error);
	}
	g_autoptr(GPtrArray) folders = style_folders(site_path);
	if (folder)
		g_ptr_array_insert(folders, 0, g_strdup(folder));
	g_autofree char *path = style_reader_is_name(name) ? path_in(folders, name) : NULL;
	if (!path)
		return refuse(name, folders, error), NULL;
	return style_load_in(path, site_path, user, error);
}

style *style_find(const char *name, const char *site_path, GError **error)
{
	return style_find_in(name, NULL, site_path, NULL, error);
}
