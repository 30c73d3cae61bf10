#include "acquire/site-removal.h"
#include "acquire/site.h"
#include "firmware-io/files.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <time.h>

/* .removed-3-NAME: the number tells those of one name apart. .gone-3-NAME: it is being deleted. */
#define REMOVED ".removed-"
#define GONE    ".gone-"

bool site_remove(const char *path, char **ret_hidden, GError **error)
{
	g_autoptr(GError) why = NULL;
	g_autofree char *folder = g_path_get_dirname(path), *name = g_path_get_basename(path);
	/* Its lock, where it is sound enough to have one. */
	g_autoptr(site) s = site_open_existing(path, &why);
	if (g_error_matches(why, G_IO_ERROR, G_IO_ERROR_BUSY) ||
		g_error_matches(why, G_IO_ERROR, G_IO_ERROR_NOT_FOUND) ||
		g_error_matches(why, G_IO_ERROR, G_IO_ERROR_PERMISSION_DENIED)) {
		g_propagate_error(error, g_steal_pointer(&why));
		return false;
	}
	for (unsigned n = 1;; n++) {
		g_autofree char *hidden = g_strdup_printf("%s/" REMOVED "%u-%s", folder, n, name);
		g_autoptr(GError) failed = NULL;
		if (files_rename_new(path, hidden, &failed)) {
			*ret_hidden = g_steal_pointer(&hidden);
			return true;
		}
		if (!g_error_matches(failed, G_IO_ERROR, G_IO_ERROR_EXISTS)) {
			g_propagate_error(error, g_steal_pointer(&failed));
			return false;
		}
	}
}

/* NULL: not a name of ours. */
static const char *name_in(const char *hidden_name, const char *prefix)
{
	const char *n = g_str_has_prefix(hidden_name, prefix) ? hidden_name + strlen(prefix) : "";
	size_t digits = strspn(n, "0123456789");
	return digits && n[digits] == '-' && n[digits + 1] ? n + digits + 1 : NULL;
}

bool site_restore(const char *hidden, char **ret_path, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(hidden),
			*hidden_name = g_path_get_basename(hidden);
	const char *name = name_in(hidden_name, REMOVED);
	if (!name || !g_file_test(hidden, G_FILE_TEST_IS_DIR)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "%s: is gone for good",
			name ? name : hidden);
		return false;
	}
	g_autofree char *path = g_build_filename(folder, name, NULL);
	if (!files_rename_new(hidden, path, error))
		return false;
	if (ret_path)
		*ret_path = g_steal_pointer(&path);
	return true;
}

static bool is_older(const char *path, double seconds)
{
	GStatBuf st;
	/* When it was renamed. */
	return !g_lstat(path, &st) && difftime(time(NULL), st.st_ctime) >= seconds;
}

void site_clear_removed(const char *folder, double older_than_s)
{
	g_autoptr(GPtrArray) names = files_names(folder, NULL);
	for (guint i = 0; names && i < names->len; i++) {
		const char *name = names->pdata[i];
		g_autofree char *path = g_build_filename(folder, name, NULL);
		if (name_in(name, REMOVED) && is_older(path, older_than_s)) {
			g_autofree char *gone =
				g_strdup_printf("%s/" GONE "%s", folder, name + strlen(REMOVED));
			/* At once out of reach of those who would bring it back. */
			if (files_remove_tree(gone, NULL) && files_rename_new(path, gone, NULL))
				files_remove_tree(gone, NULL);
		} else if (name_in(name, GONE))
			files_remove_tree(path, NULL);
	}
}
