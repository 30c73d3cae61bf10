#include "process/copy.h"
#include "acquire/site.h"
#include "firmware-io/files.h"
#include "process/copy-file.h"
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/statvfs.h>

#define SUMS "SHA256SUMS"
/* Left free on the drive: for its own tables. */
#define ROOM_LEFT (4u << 20)

const char *const copy_what_names[COPY_WHATS] = { "site", "scans", "exports", "pictures" };

struct file {
	char *name; /* below the site, and below the copy */
	uint64_t bytes;
};
struct copying {
	const struct copy_options *options;
	const char *from, *drive;
	char *folder;     /* on the drive */
	GPtrArray *files; /* of struct file */
	GHashTable *sums; /* what SHA256SUMS there says: hash by name */
	uint64_t bytes, done;
	uint32_t written;
};

static void file_free(gpointer data)
{
	struct file *f = data;
	g_free(f->name);
	g_free(f);
}

/* ---- what is copied ---- */

static bool is_picture(const char *name)
{
	static const char *const ends[] = { ".png", ".svg", ".pdf", ".jpg", ".mp4", ".webm" };
	for (size_t i = 0; i < G_N_ELEMENTS(ends); i++)
		if (g_str_has_suffix(name, ends[i]))
			return true;
	return false;
}

static bool is_wanted(const struct copying *c, const char *name)
{
	return c->options->what != COPY_PICTURES || is_picture(name);
}

static void add_file(struct copying *c, const char *name, uint64_t bytes)
{
	struct file *f = g_new0(struct file, 1);
	f->name = g_strdup(name);
	f->bytes = bytes;
	c->bytes += bytes;
	g_ptr_array_add(c->files, f);
}

/* Hidden ones are what programs have not finished. */
static bool add_all(struct copying *c, const char *name, GError **error)
{
	g_autofree char *path = g_build_filename(c->from, name, NULL);
	GStatBuf st;
	if (g_lstat(path, &st))
		return errno == ENOENT || files_fail(error, path, "be read");
	if (S_ISREG(st.st_mode) && is_wanted(c, name))
		add_file(c, name, (uint64_t)st.st_size);
	if (!S_ISDIR(st.st_mode))
		return true;
	g_autoptr(GPtrArray) names = files_names(path, error);
	bool good = names;
	for (guint i = 0; good && i < names->len; i++) {
		const char *one = names->pdata[i];
		g_autofree char *below = *name ? g_build_filename(name, one, NULL) : g_strdup(one);
		good = *one == '.' || add_all(c, below, error);
	}
	return good;
}

static bool list_files(struct copying *c, GError **error)
{
	switch (c->options->what) {
	case COPY_SCANS:
		return add_all(c, "site.json", error) && add_all(c, "scans", error) &&
		       add_all(c, "poses", error);
	case COPY_EXPORTS:
	case COPY_PICTURES: return add_all(c, "exports", error);
	default: return add_all(c, "", error);
	}
}

/* ---- SHA256SUMS ---- */

static void read_sums(struct copying *c)
{
	g_autofree char *path = g_build_filename(c->folder, SUMS, NULL), *text = NULL;
	if (!g_file_get_contents(path, &text, NULL, NULL))
		return;
	g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
	for (char **l = lines; *l; l++)
		if (strlen(*l) > 66 && (*l)[64] == ' ')
			g_hash_table_insert(c->sums, g_strdup(*l + 66), g_strndup(*l, 64));
}

static bool write_sums(struct copying *c, GError **error)
{
	g_autoptr(GString) text = g_string_new(NULL);
	g_autofree char *path = g_build_filename(c->folder, SUMS, NULL);
	g_autoptr(GList) names =
		g_list_sort(g_hash_table_get_keys(c->sums), (GCompareFunc)g_strcmp0);
	for (GList *n = names; n; n = n->next)
		g_string_append_printf(text, "%s  %s\n",
			(char *)g_hash_table_lookup(c->sums, n->data), (char *)n->data);
	return files_write(path, text->str, text->len, error);
}

/* ---- copying ---- */

static bool goes_on(uint64_t bytes, gpointer user_data)
{
	struct copying *c = user_data;
	const struct copy_options *o = c->options;
	c->done += bytes;
	/* All is read twice: once here, once there. */
	return !o->progress ||
	       !o->progress(c->bytes ? (double)c->done / (2.0 * (double)c->bytes) : 1,
		       "copying and comparing", o->user_data);
}

/* A drive may come from anybody: no folder on it may lead somewhere else. path: on the drive. */
static bool refuse_links(const struct copying *c, const char *path, GError **error)
{
	size_t root = strlen(c->drive);
	g_autofree char *part = g_strdup(path);
	for (char *end = part + strlen(part); (size_t)(end - part) > root;
		end = strrchr(part, '/')) {
		GStatBuf st;
		*end = '\0';
		if (g_lstat(part, &st) || !S_ISLNK(st.st_mode))
			continue;
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_EXISTS,
			"%s: is a link, which may lead out of the drive: move it away, or copy to "
			"another folder",
			part);
		return false;
	}
	return true;
}

static bool make_folders(const char *path, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(path);
	if (g_mkdir_with_parents(folder, 0777) == 0)
		return true;
	return files_fail(error, folder, "be made");
}

/* There already: as it is here, or as we left it, when it can be replaced. */
static bool look_there(struct copying *c, const struct file *f, const char *to, bool *ret_same,
	char **ret_hash, GError **error)
{
	struct copy_watcher w = { goes_on, c };
	g_autofree char *from = g_build_filename(c->from, f->name, NULL);
	const char *ours = g_hash_table_lookup(c->sums, f->name);
	uint64_t done = c->done;
	*ret_same = false;
	g_autofree char *there = copy_file_hash(to, &w, error);
	g_autofree char *here = there ? copy_file_hash(from, &w, error) : NULL;
	if (!here)
		return false;
	*ret_same = !strcmp(here, there);
	if (*ret_same || !g_strcmp0(ours, there)) {
		*ret_hash = *ret_same ? g_steal_pointer(&here) : NULL;
		if (!*ret_same)
			c->done = done;
		return true;
	}
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_EXISTS,
		"%s: is there already with other content: move it away, or copy to another folder",
		to);
	return false;
}

static bool copy_one(struct copying *c, const struct file *f, GError **error)
{
	struct copy_watcher w = { goes_on, c };
	g_autofree char *from = g_build_filename(c->from, f->name, NULL);
	g_autofree char *to = g_build_filename(c->folder, f->name, NULL), *hash = NULL;
	g_autofree char *in = g_path_get_dirname(to);
	bool same = false;
	if (!refuse_links(c, in, error))
		return false;
	if (g_file_test(to, G_FILE_TEST_EXISTS) && !look_there(c, f, to, &same, &hash, error))
		return false;
	if (!same) {
		if (!make_folders(to, error) || !(hash = copy_file(from, to, &w, error)))
			return false;
		c->written++;
	}
	g_hash_table_insert(c->sums, g_strdup(f->name), g_steal_pointer(&hash));
	return true;
}

static bool has_room(const struct copying *c, const char *to, GError **error)
{
	struct statvfs fs;
	uint64_t need = ROOM_LEFT;
	for (guint i = 0; i < c->files->len; i++) {
		const struct file *f = c->files->pdata[i];
		g_autofree char *there = g_build_filename(c->folder, f->name, NULL);
		if (!g_file_test(there, G_FILE_TEST_EXISTS))
			need += f->bytes;
	}
	if (statvfs(to, &fs))
		return files_fail(error, to, "be read");
	uint64_t free_bytes = (uint64_t)fs.f_bavail * fs.f_frsize;
	if (free_bytes >= need)
		return true;
	g_autofree char *needed = g_format_size(need), *has = g_format_size(free_bytes);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE,
		"%s: has %s free, and the copy needs %s", to, has, needed);
	return false;
}

static bool is_inside(const char *site_path, const char *to)
{
	g_autofree char *a = g_canonicalize_filename(site_path, NULL);
	g_autofree char *b = g_canonicalize_filename(to, NULL);
	size_t n = strlen(a);
	return !strncmp(a, b, n) && (!b[n] || b[n] == '/');
}

static bool prepare(struct copying *c, const char *site_path, const char *to, GError **error)
{
	g_autoptr(site) s = site_open(site_path, error);
	g_autofree char *whole = g_canonicalize_filename(site_path, NULL);
	g_autofree char *base = g_path_get_basename(whole);
	if (!s)
		return false;
	if (!g_file_test(to, G_FILE_TEST_IS_DIR)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"%s: is no folder; is the drive plugged in?", to);
		return false;
	}
	if (is_inside(site_path, to)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"%s: lies in the site itself", to);
		return false;
	}
	c->drive = to;
	c->folder = g_build_filename(to, base, NULL);
	if (!refuse_links(c, c->folder, error))
		return false;
	read_sums(c);
	return list_files(c, error) && has_room(c, to, error);
}

static bool copy_all(struct copying *c, GError **error)
{
	bool good = true;
	for (guint i = 0; good && i < c->files->len; i++)
		good = copy_one(c, c->files->pdata[i], error);
	/* Also of what came to an end half way: that much is ours. */
	if (!good && g_hash_table_size(c->sums))
		write_sums(c, NULL);
	return good && (!c->files->len || (make_folders(c->folder, error) && write_sums(c, error) &&
						  files_sync_folder(c->folder, error)));
}

bool copy_site(const char *site_path, const char *to, const struct copy_options *options,
	struct copy_result *ret, GError **error)
{
	struct copying c = { .options = options,
		.from = site_path,
		.files = g_ptr_array_new_with_free_func(file_free),
		.sums = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free) };
	bool good = prepare(&c, site_path, to, error) && copy_all(&c, error);
	if (good)
		*ret = (struct copy_result){ g_strdup(c.folder), c.files->len, c.written, c.bytes };
	g_ptr_array_unref(c.files);
	g_hash_table_unref(c.sums);
	g_free(c.folder);
	return good;
}
