#include "process/import.h"
#include <gio/gio.h>
#include <string.h>

const struct import_format *const import_formats[] = { &import_e57, &import_ptx, &import_las,
	&import_mesh, &import_ply, &import_pcd, &import_ascii, NULL };

static bool has_extension(const struct import_format *f, const char *path)
{
	const char *dot = strrchr(path, '.');
	g_auto(GStrv) extensions = g_strsplit(f->extensions, " ", -1);
	g_autofree char *extension = dot ? g_ascii_strdown(dot + 1, -1) : NULL;
	return extension && !strchr(extension, '/') &&
	       g_strv_contains((const char *const *)extensions, extension);
}

static char *list_names(void)
{
	g_autoptr(GString) text = g_string_new(NULL);
	for (const struct import_format *const *f = import_formats; *f; f++)
		g_string_append_printf(text, "%s%s",
			f == import_formats ? ""
			: f[1]              ? ", "
					    : " and ",
			(*f)->name);
	return g_strdup(text->str);
}

const struct import_format *import_format_of(import_source *file, GError **error)
{
	g_autofree uint8_t *start = g_malloc0(IMPORT_PROBE_BYTES);
	size_t length;
	if (!import_source_read(file, 0, start, IMPORT_PROBE_BYTES, &length, error))
		return NULL;
	if (length == 0)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA, "is empty"), NULL;
	for (const struct import_format *const *f = import_formats; *f; f++)
		if ((*f)->probe(start, length))
			return *f;
	/* Its reader then says what is wrong with it. */
	for (const struct import_format *const *f = import_formats; *f; f++)
		if (has_extension(*f, import_source_path(file)))
			return *f;
	g_autofree char *names = list_names();
	import_refuse(error, file, G_IO_ERROR_NOT_SUPPORTED,
		"is in no format that is read here: %s", names);
	return NULL;
}
