#include "acquire/site-private.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <fcntl.h>
#include <json-glib/json-glib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* The folder's own, also of "." and of "oak/"; made printable. Caller frees. */
static char *site_name(const char *path)
{
	g_autofree char *whole = g_canonicalize_filename(path, NULL);
	g_autofree char *name = g_path_get_basename(whole);
	return g_filename_display_name(name);
}

bool site_refuse(GError **error, const site *s, int code, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_autofree char *name = site_name(s->path);
	g_set_error(error, G_IO_ERROR, code, "site %s: %s", name, what);
	return false;
}

static site *site_new(const char *path)
{
	site *s = g_new0(site, 1);
	s->path = g_strdup(path);
	s->scans_path = g_build_filename(s->path, "scans", NULL);
	s->lock_fd = -1;
	return s;
}

void site_free(site *s)
{
	if (!s)
		return;
	if (s->lock_fd >= 0)
		close(s->lock_fd);
	g_clear_pointer(&s->m, manifest_free);
	g_free(s->scans_path);
	g_free(s->path);
	g_free(s);
}

const char *site_path(const site *s)
{
	return s->path;
}

const manifest *site_manifest(const site *s)
{
	return s->m;
}

/* ---- site.json ---- */

static char *manifest_file(const site *s)
{
	return g_build_filename(s->path, "site.json", NULL);
}

static bool check_manifest(const manifest *m, GError **error)
{
	const char *units = manifest_get_string(m, "units", error);
	if (!units || !manifest_get_string(m, "name", error) ||
		!manifest_get_string(m, "id", error) || !manifest_get_string(m, "created", error))
		return false;
	if (strcmp(units, "metres") == 0)
		return true;
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE,
		"%s: 'units' is \"%s\"; this program knows \"metres\"", manifest_path(m), units);
	return false;
}

static bool load_manifest(site *s, GError **error)
{
	g_autofree char *path = manifest_file(s);
	s->m = manifest_load(path, SITE_SCHEMA, error);
	return s->m && check_manifest(s->m, error);
}

static bool has_manifest(const site *s)
{
	g_autofree char *path = manifest_file(s);
	struct stat st;
	return lstat(path, &st) == 0;
}

bool site_set(site *s, const char *key, JsonNode *value, GError **error)
{
	g_assert(s->lock_fd >= 0);
	JsonNode *before = manifest_get_node(s->m, key);
	g_autoptr(JsonNode) kept = before ? json_node_copy(before) : NULL;
	if (value)
		manifest_set_node(s->m, key, value);
	else
		manifest_remove(s->m, key);
	if (manifest_save(s->m, error))
		return true;
	if (kept)
		manifest_set_node(s->m, key, g_steal_pointer(&kept));
	else
		manifest_remove(s->m, key);
	return false;
}

site *site_open(const char *path, GError **error)
{
	g_autoptr(site) s = site_new(path);
	g_autoptr(GPtrArray) names = files_names(path, error);
	if (!names)
		return NULL;
	if (!has_manifest(s)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"%s: is not a site: there is no site.json in it", path);
		return NULL;
	}
	return load_manifest(s, error) ? g_steal_pointer(&s) : NULL;
}

/* ---- opening for writing ---- */

static bool take_lock(site *s, GError **error)
{
	s->lock_fd = open(s->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (s->lock_fd < 0)
		return files_fail(error, s->path, "open the folder");
	if (flock(s->lock_fd, LOCK_EX | LOCK_NB) == 0)
		return true;
	if (errno != EWOULDBLOCK)
		return files_fail(error, s->path, "lock the folder");
	return site_refuse(error, s, G_IO_ERROR_BUSY, "another program is writing to it");
}

static bool check_writable(const site *s, GError **error)
{
	if (access(s->path, W_OK | X_OK))
		return files_fail(error, s->path, "write in the folder");
	if (access(s->scans_path, W_OK | X_OK) && errno != ENOENT)
		return files_fail(error, s->scans_path, "write in the folder");
	return true;
}

/* What site_open_for_writing itself may have left when it was killed: scans/ without scans,
 * site.json's other name. */
static bool is_own_beginning(const site *s, const char *name)
{
	if (strcmp(name, "scans") == 0) {
		g_autoptr(GPtrArray) scans = files_names(s->scans_path, NULL);
		return scans && scans->len == 0;
	}
	return strcmp(name, ".site.json.new") == 0 || strcmp(name, "lost+found") == 0;
}

static bool check_empty(const site *s, GError **error)
{
	g_autoptr(GPtrArray) names = files_names(s->path, error);
	if (!names)
		return false;
	for (unsigned i = 0; i < names->len; i++)
		if (!is_own_beginning(s, names->pdata[i])) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_EMPTY,
				"%s: is not a site: it has files but no site.json", s->path);
			return false;
		}
	return true;
}

/* site.json comes last: with it the site is whole. */
static bool make_site(const site *s, GError **error)
{
	g_autofree char *path = manifest_file(s), *name = site_name(s->path);
	g_autofree char *id = g_uuid_string_random();
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	g_autofree char *created = g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
	g_autoptr(manifest) m = manifest_new(path);
	manifest_set_int(m, "schema", SITE_SCHEMA);
	manifest_set_string(m, "name", name);
	manifest_set_string(m, "id", id);
	manifest_set_string(m, "created", created);
	manifest_set_string(m, "units", "metres");
	return check_empty(s, error) && files_make_folder(s->scans_path, error) &&
	       manifest_save(m, error);
}

/* Remains that cannot be removed do no harm but for their room, so the site can be used. */
static bool remove_remains(const site *s, GError **error)
{
	g_autoptr(GPtrArray) names = site_names_in_scans(s, error);
	for (unsigned i = 0; names && i < names->len; i++) {
		g_autofree char *path = site_path_in_scans(s, names->pdata[i]);
		g_autoptr(GError) why = NULL;
		if (site_read_scan_name(names->pdata[i]).state == REMAINS &&
			!files_remove_tree(path, &why))
			g_message("%s", why->message);
	}
	return names;
}

site *site_open_for_writing(const char *path, GError **error)
{
	g_autoptr(site) s = site_new(path);
	s->made_folder = access(path, F_OK) && errno == ENOENT;
	if (!files_make_folder(path, error) || !take_lock(s, error) || !check_writable(s, error))
		return NULL;
	s->made = !has_manifest(s);
	if (s->made && !make_site(s, error))
		return NULL;
	if (!load_manifest(s, error) || !files_make_folder(s->scans_path, error) ||
		!remove_remains(s, error))
		return NULL;
	return g_steal_pointer(&s);
}

site *site_open_existing(const char *path, GError **error)
{
	g_autoptr(site) as_it_is = site_open(path, error);
	return as_it_is ? site_open_for_writing(path, error) : NULL;
}

void site_discard_new(site *s)
{
	g_autofree char *path = manifest_file(s);
	/* A folder that holds anything does not go. */
	if (!s->made || rmdir(s->scans_path))
		return;
	unlink(path);
	if (s->made_folder)
		rmdir(s->path);
}
