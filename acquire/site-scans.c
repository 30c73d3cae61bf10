#include "acquire/site-private.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Four digits, 0001 to 9999; else 0. */
static uint32_t read_number(const char *digits)
{
	uint32_t number = 0;
	for (int i = 0; i < 4; i++) {
		if (!g_ascii_isdigit(digits[i]))
			return 0;
		number = number * 10 + (uint32_t)(digits[i] - '0');
	}
	return number;
}

struct scan_name site_read_scan_name(const char *name)
{
	bool hidden = *name == '.';
	uint32_t number = read_number(name + hidden);
	if (!number)
		return (struct scan_name){ 0, FOREIGN };
	const char *rest = name + hidden + 4;
	if (!hidden && !*rest)
		return (struct scan_name){ number, FINISHED };
	if (!hidden)
		return (struct scan_name){ 0, FOREIGN };
	if (strcmp(rest, ".partial") == 0)
		return (struct scan_name){ number, PARTIAL };
	if (strcmp(rest, ".discarded") == 0 ||
		(g_str_has_prefix(rest, ".new.") && strlen(rest) == strlen(".new.XXXXXX")))
		return (struct scan_name){ number, REMAINS };
	return (struct scan_name){ 0, FOREIGN };
}

char *site_path_in_scans(const site *s, const char *name)
{
	return g_build_filename(s->scans_path, name, NULL);
}

GPtrArray *site_names_in_scans(const site *s, GError **error)
{
	/* A copy by a tool that leaves out empty folders is still a site. */
	if (access(s->scans_path, F_OK) && errno == ENOENT)
		return g_ptr_array_new();
	return files_names(s->scans_path, error);
}

char *site_scan_path(const site *s, uint32_t number)
{
	g_autofree char *name = g_strdup_printf("%04u", number);
	return site_path_in_scans(s, name);
}

char *site_partial_path(const site *s, uint32_t number)
{
	g_autofree char *name = g_strdup_printf(".%04u.partial", number);
	return site_path_in_scans(s, name);
}

/* A folder with a scan.json in it. */
static bool check_scan(const char *path, GError **error)
{
	g_autofree char *json = g_build_filename(path, "scan.json", NULL);
	struct stat st;
	if (stat(path, &st) || !S_ISDIR(st.st_mode)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_DIRECTORY,
			"%s: is not a scan's folder", path);
		return false;
	}
	if (stat(json, &st) == 0 && S_ISREG(st.st_mode))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
		"%s: is not a scan: there is no scan.json in it", path);
	return false;
}

GArray *site_scans(const site *s, GError **error)
{
	g_autoptr(GPtrArray) names = site_names_in_scans(s, error);
	g_autoptr(GArray) numbers = g_array_new(false, false, sizeof(uint32_t));
	for (unsigned i = 0; names && i < names->len; i++) {
		struct scan_name n = site_read_scan_name(names->pdata[i]);
		g_autofree char *path = site_path_in_scans(s, names->pdata[i]);
		if (n.state != FINISHED)
			continue;
		if (!check_scan(path, error))
			return NULL;
		g_array_append_val(numbers, n.number);
	}
	return names ? g_steal_pointer(&numbers) : NULL;
}

bool site_find_partial(const site *s, uint32_t *ret_number, GError **error)
{
	g_autoptr(GPtrArray) names = site_names_in_scans(s, error);
	uint32_t found = 0;
	for (unsigned i = 0; names && i < names->len; i++) {
		struct scan_name n = site_read_scan_name(names->pdata[i]);
		g_autofree char *path = site_path_in_scans(s, names->pdata[i]);
		if (n.state != PARTIAL)
			continue;
		if (found)
			return site_refuse(error, s, G_IO_ERROR_FAILED,
				"scans %04u and %04u are both partial; there can be one", found,
				n.number);
		if (!check_scan(path, error))
			return false;
		found = n.number;
	}
	if (names)
		*ret_number = found;
	return names;
}

static bool next_number(const site *s, uint32_t *ret_number, GError **error)
{
	g_autoptr(GPtrArray) names = site_names_in_scans(s, error);
	uint32_t last = 0;
	for (unsigned i = 0; names && i < names->len; i++)
		last = MAX(last, site_read_scan_name(names->pdata[i]).number);
	if (last == SITE_SCANS_MAX)
		return site_refuse(error, s, G_IO_ERROR_NO_SPACE,
			"has a scan %u, and numbers end there", SITE_SCANS_MAX);
	*ret_number = last + 1;
	return names;
}

/* The folder of the scan as it will be, under another name. Caller frees. */
static char *build_scan(const site *s, const manifest *scan, uint32_t number, GError **error)
{
	g_autofree char *name = g_strdup_printf(".%04u.new.XXXXXX", number);
	g_autofree char *path = site_path_in_scans(s, name);
	if (!g_mkdtemp_full(path, 0777))
		return files_fail(error, path, "make the folder"), NULL;
	g_autofree char *json = g_build_filename(path, "scan.json", NULL);
	if (manifest_save_as(scan, json, error))
		return g_steal_pointer(&path);
	files_remove_tree(path, NULL);
	return NULL;
}

bool site_begin_scan(site *s, const manifest *scan, uint32_t *ret_number, GError **error)
{
	uint32_t number = 0, unfinished = 0;
	g_assert(s->lock_fd >= 0);
	if (!site_find_partial(s, &unfinished, error))
		return false;
	if (unfinished)
		return site_refuse(error, s, G_IO_ERROR_EXISTS,
			"scan %04u is not finished; resume or discard it first", unfinished);
	if (!next_number(s, &number, error))
		return false;
	g_autofree char *built = build_scan(s, scan, number, error);
	g_autofree char *partial = site_partial_path(s, number);
	if (!built)
		return false;
	if (!files_rename_new(built, partial, error)) {
		files_remove_tree(built, NULL);
		return false;
	}
	*ret_number = number;
	return true;
}

/* The files of a scan have many writers; here is the one place that all of them pass. */
static bool sync_all_in(const char *path, GError **error)
{
	int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return files_fail(error, path, "open the folder");
	bool ok = syncfs(fd) == 0 || files_fail(error, path, "sync what is in it");
	close(fd);
	return ok;
}

bool site_finish_scan(site *s, uint32_t number, GError **error)
{
	g_assert(s->lock_fd >= 0);
	g_autofree char *partial = site_partial_path(s, number), *whole = site_scan_path(s, number);
	return check_scan(partial, error) && sync_all_in(partial, error) &&
	       files_rename_new(partial, whole, error);
}

/* Renamed first: a partial is offered for resuming, and half of one must not be. */
bool site_discard_partial(site *s, uint32_t number, GError **error)
{
	g_assert(s->lock_fd >= 0);
	g_autofree char *name = g_strdup_printf(".%04u.discarded", number);
	g_autofree char *partial = site_partial_path(s, number),
			*discarded = site_path_in_scans(s, name);
	return files_remove_tree(discarded, error) && files_rename_new(partial, discarded, error) &&
	       files_remove_tree(discarded, error);
}

/* ---- scans that come whole ---- */

char *site_stage_scan(site *s, uint32_t *ret_number, GError **error)
{
	g_assert(s->lock_fd >= 0);
	uint32_t number;
	if (!next_number(s, &number, error))
		return NULL;
	g_autofree char *name = g_strdup_printf(".%04u.new.XXXXXX", number);
	g_autofree char *path = site_path_in_scans(s, name);
	if (!g_mkdtemp_full(path, 0777))
		return files_fail(error, path, "make the folder"), NULL;
	*ret_number = number;
	return g_steal_pointer(&path);
}

static char *path_of_staged(const site *s, const char *folder)
{
	g_autofree char *name = g_path_get_basename(folder);
	return site_scan_path(s, site_read_scan_name(name).number);
}

static void take_back(const site *s, const GPtrArray *folders, guint count)
{
	for (guint i = 0; i < count; i++) {
		g_autofree char *whole = path_of_staged(s, folders->pdata[i]);
		g_autoptr(GError) why = NULL;
		if (!files_rename_new(whole, folders->pdata[i], &why))
			g_message("%s", why->message);
	}
}

bool site_add_staged(site *s, const GPtrArray *folders, GError **error)
{
	g_assert(s->lock_fd >= 0);
	for (guint i = 0; i < folders->len; i++)
		if (!check_scan(folders->pdata[i], error))
			return false;
	if (folders->len && !sync_all_in(folders->pdata[0], error))
		return false;
	for (guint i = 0; i < folders->len; i++) {
		g_autofree char *whole = path_of_staged(s, folders->pdata[i]);
		if (!files_rename_new(folders->pdata[i], whole, error)) {
			/* It may have been renamed and not synced. */
			bool moved = access(folders->pdata[i], F_OK) != 0;
			return take_back(s, folders, i + moved), false;
		}
	}
	return true;
}
