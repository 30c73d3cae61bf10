#include "render/kiosk/drive-files.h"
#include "process/import.h"
#include "render/kiosk/drives.h"
#include <string.h>

#define DEEPEST 5
#define LOOKED_AT                                                                                  \
	G_FILE_ATTRIBUTE_STANDARD_NAME "," G_FILE_ATTRIBUTE_STANDARD_TYPE                          \
				       "," G_FILE_ATTRIBUTE_STANDARD_SIZE                          \
				       "," G_FILE_ATTRIBUTE_STANDARD_IS_HIDDEN

void drive_file_free(drive_file *f)
{
	if (!f)
		return;
	g_free(f->path);
	g_free(f->name);
	g_free(f->place);
	g_free(f);
}

struct search {
	GPtrArray *found;
	GCancellable *cancellable;
	bool all;
};

static bool has_extension(const char *name)
{
	const char *dot = strrchr(name, '.');
	g_autofree char *extension = dot ? g_ascii_strdown(dot + 1, -1) : NULL;
	for (const struct import_format *const *f = import_formats; extension && *f; f++) {
		g_auto(GStrv) known = g_strsplit((*f)->extensions, " ", -1);
		if (g_strv_contains((const char *const *)known, extension))
			return true;
	}
	return false;
}

/* NULL: none. Texts have these endings whatever they are about, so that they must have numbers, too. */
static const struct import_format *format_of(const char *path)
{
	g_autofree uint8_t *start = g_malloc(IMPORT_PROBE_BYTES);
	size_t length;
	g_autoptr(import_source) file = import_source_open(path, NULL);
	const struct import_format *f = file ? import_format_of(file, NULL) : NULL;
	if (f != &import_ascii)
		return f;
	return import_source_read(file, 0, start, IMPORT_PROBE_BYTES, &length, NULL) &&
			       f->probe(start, length)
		       ? f
		       : NULL;
}

static void add_file(struct search *s, const char *path, const char *place, GFileInfo *info)
{
	const char *name = g_file_info_get_name(info);
	const struct import_format *format = has_extension(name) ? format_of(path) : NULL;
	if (!format)
		return;
	if (s->found->len == DRIVE_FILES_MOST) {
		s->all = false;
		return;
	}
	drive_file *f = g_new0(drive_file, 1);
	*f = (drive_file){ g_strdup(path), g_filename_display_name(name), g_strdup(place),
		format->name, format == &import_mesh, (double)g_file_info_get_size(info) };
	g_ptr_array_add(s->found, f);
}

static void look_into(struct search *s, const char *folder, const char *place, int depth)
{
	g_autoptr(GFile) dir = g_file_new_for_path(folder);
	g_autoptr(GFileEnumerator) all = g_file_enumerate_children(
		dir, LOOKED_AT, G_FILE_QUERY_INFO_NOFOLLOW_SYMLINKS, s->cancellable, NULL);
	GFileInfo *info;
	while (all && g_file_enumerator_iterate(all, &info, NULL, s->cancellable, NULL) && info) {
		const char *name = g_file_info_get_name(info);
		g_autofree char *path = g_build_filename(folder, name, NULL);
		g_autofree char *shown = g_filename_display_name(name);
		g_autofree char *within = g_build_filename(place, shown, NULL);
		GFileType type = g_file_info_get_file_type(info);
		if (g_file_info_get_is_hidden(info))
			continue;
		if (type == G_FILE_TYPE_REGULAR)
			add_file(s, path, place, info);
		else if (type == G_FILE_TYPE_DIRECTORY && depth < DEEPEST)
			look_into(s, path, within, depth + 1);
		else if (type == G_FILE_TYPE_DIRECTORY)
			s->all = false;
	}
}

static int by_place(gconstpointer a, gconstpointer b)
{
	const drive_file *one = *(const drive_file *const *)a,
			 *other = *(const drive_file *const *)b;
	g_autofree char *x = g_utf8_collate_key_for_filename(one->path, -1),
			*y = g_utf8_collate_key_for_filename(other->path, -1);
	int order = g_utf8_collate(one->place, other->place);
	return order ? order : strcmp(x, y);
}

GPtrArray *drive_files_list(char *const *folders, GCancellable *cancellable, bool *ret_all)
{
	g_autoptr(GPtrArray) drives = drives_list(folders);
	struct search s = { g_ptr_array_new_with_free_func((GDestroyNotify)drive_file_free),
		cancellable, true };
	for (guint i = 0; i < drives->len; i++) {
		const drive *d = g_ptr_array_index(drives, i);
		look_into(&s, d->path, d->name, 0);
	}
	g_ptr_array_sort(s.found, by_place);
	*ret_all = s.all;
	return s.found;
}
