#include "process/import-ply.h"
#include <gio/gio.h>
#include <string.h>

#define HEADER_BYTES_MAX (1u << 20)
#define ELEMENTS_MAX     64u
#define PROPERTIES_MAX   1024u

/* The lines of the header, each as words. */
struct lines {
	import_source *file;
	char *text, *at;
	uint64_t line;
};

static bool refuse(GError **error, const struct lines *l, const char *format, ...)
	G_GNUC_PRINTF(3, 4);

static bool refuse(GError **error, const struct lines *l, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	return import_refuse(error, l->file, G_IO_ERROR_INVALID_DATA,
		"line %" G_GUINT64_FORMAT ": %s", l->line, what);
}

static void property_clear(gpointer p)
{
	g_free(((struct ply_property *)p)->name);
}

static void element_clear(gpointer p)
{
	struct ply_element *e = p;
	g_free(e->name);
	g_array_unref(e->properties);
}

void ply_header_clear(struct ply_header *h)
{
	g_clear_pointer(&h->elements, g_array_unref);
}

/* NULL: the text ends before the line does. Caller frees. */
static char **next_words(struct lines *l)
{
	char *newline = strchr(l->at, '\n');
	l->line++;
	if (!newline)
		return NULL;
	g_autofree char *line = g_strndup(l->at, (gsize)(newline - l->at));
	l->at = newline + 1;
	g_strdelimit(line, "\t\r", ' ');
	g_auto(GStrv) parts = g_strsplit(line, " ", -1);
	g_autoptr(GPtrArray) words = g_ptr_array_new();
	for (char **part = parts; *part; part++)
		if (**part)
			g_ptr_array_add(words, g_strdup(*part));
	g_ptr_array_add(words, NULL);
	return (char **)g_ptr_array_free(g_steal_pointer(&words), FALSE);
}

static bool type_of(const char *name, enum cloud_type *ret)
{
	static const struct {
		const char *names[2];
		enum cloud_type type;
	} types[] = { { { "char", "int8" }, CLOUD_I8 }, { { "uchar", "uint8" }, CLOUD_U8 },
		{ { "short", "int16" }, CLOUD_I16 }, { { "ushort", "uint16" }, CLOUD_U16 },
		{ { "int", "int32" }, CLOUD_I32 }, { { "uint", "uint32" }, CLOUD_U32 },
		{ { "float", "float32" }, CLOUD_F32 }, { { "double", "float64" }, CLOUD_F64 } };
	for (size_t i = 0; i < G_N_ELEMENTS(types); i++)
		if (!strcmp(name, types[i].names[0]) || !strcmp(name, types[i].names[1])) {
			*ret = types[i].type;
			return true;
		}
	return false;
}

/* ---- the kinds of lines ---- */

static bool read_format(struct ply_header *h, const struct lines *l, char **w, GError **error)
{
	static const char *const names[] = { "ascii", "binary_little_endian", "binary_big_endian" };
	if (g_strv_length(w) != 3 || strcmp(w[0], "format") || strcmp(w[2], "1.0"))
		return refuse(
			error, l, "the format must stand here: 'format ascii 1.0', or binary");
	for (int i = 0; i < 3; i++)
		if (!strcmp(w[1], names[i])) {
			h->encoding = (enum ply_encoding)i;
			return true;
		}
	return refuse(error, l, "there is no format '%s'", w[1]);
}

static bool read_element(struct ply_header *h, const struct lines *l, char **w, GError **error)
{
	struct ply_element e = { 0 };
	if (g_strv_length(w) != 3 ||
		!g_ascii_string_to_unsigned(w[2], 10, 0, G_MAXUINT64, &e.count, NULL))
		return refuse(error, l, "an element is 'element NAME COUNT'");
	for (guint i = 0; i < h->elements->len; i++)
		if (!strcmp(g_array_index(h->elements, struct ply_element, i).name, w[1]))
			return refuse(error, l, "there is a second element '%s'", w[1]);
	if (h->elements->len == ELEMENTS_MAX)
		return refuse(error, l, "there are more than %u elements", ELEMENTS_MAX);
	e.name = g_strdup(w[1]);
	e.properties = g_array_new(false, true, sizeof(struct ply_property));
	g_array_set_clear_func(e.properties, property_clear);
	g_array_append_val(h->elements, e);
	return true;
}

static bool parse_property(const struct lines *l, char **w, struct ply_property *p, GError **error)
{
	guint words = g_strv_length(w);
	p->is_list = words > 1 && !strcmp(w[1], "list");
	if (words != (p->is_list ? 5 : 3))
		return refuse(error, l,
			"a property is 'property TYPE NAME', or 'property list TYPE TYPE NAME'");
	if (!type_of(w[words - 2], &p->type))
		return refuse(error, l, "there is no type '%s'", w[words - 2]);
	if (p->is_list && (!type_of(w[2], &p->size_type) || p->size_type >= CLOUD_F32))
		return refuse(error, l, "the length of a list cannot be of type '%s'", w[2]);
	p->name = w[words - 1];
	return true;
}

static bool read_property(struct ply_header *h, const struct lines *l, char **w, GError **error)
{
	struct ply_property p = { 0 };
	if (!h->elements->len)
		return refuse(error, l, "a property stands before any element");
	struct ply_element *e =
		&g_array_index(h->elements, struct ply_element, h->elements->len - 1);
	if (!parse_property(l, w, &p, error))
		return false;
	for (guint i = 0; i < e->properties->len; i++)
		if (!strcmp(g_array_index(e->properties, struct ply_property, i).name, p.name))
			return refuse(error, l, "%s has a second property '%s'", e->name, p.name);
	if (e->properties->len == PROPERTIES_MAX)
		return refuse(error, l, "%s has more than %u properties", e->name, PROPERTIES_MAX);
	p.name = g_strdup(p.name);
	g_array_append_val(e->properties, p);
	e->has_list |= p.is_list;
	e->least_bytes += h->encoding == PLY_TEXT ? 2
			  : p.is_list             ? cloud_type_bytes[p.size_type]
						  : cloud_type_bytes[p.type];
	return true;
}

static void read_info(struct ply_header *h, char **w)
{
	guint64 value;
	if (g_strv_length(w) != 3 ||
		!g_ascii_string_to_unsigned(w[2], 10, 1, G_MAXINT32, &value, NULL))
		return;
	if (!strcmp(w[1], "num_cols"))
		h->columns = (uint32_t)value;
	if (!strcmp(w[1], "num_rows"))
		h->rows = (uint32_t)value;
}

static bool read_line(struct ply_header *h, const struct lines *l, char **w, GError **error)
{
	if (!*w || !strcmp(*w, "comment"))
		return true;
	if (!strcmp(*w, "obj_info"))
		return read_info(h, w), true;
	if (!strcmp(*w, "element"))
		return read_element(h, l, w, error);
	if (!strcmp(*w, "property"))
		return read_property(h, l, w, error);
	return refuse(error, l, "'%.20s' is nothing that a header has", *w);
}

/* ---- the whole ---- */

static bool read_lines(struct ply_header *h, struct lines *l, GError **error)
{
	bool has_format = false;
	for (l->line = 0;;) {
		g_auto(GStrv) w = next_words(l);
		if (!w)
			return refuse(error, l, "the header has no end");
		if (l->line == 1) {
			if (g_strv_length(w) != 1 || strcmp(*w, "ply"))
				return refuse(error, l, "a PLY file begins with 'ply'");
		} else if (*w && !strcmp(*w, "end_header") && has_format) {
			return true;
		} else if (!has_format && *w && strcmp(*w, "comment") && strcmp(*w, "obj_info")) {
			if (!read_format(h, l, w, error))
				return false;
			has_format = true;
		} else if (!read_line(h, l, w, error)) {
			return false;
		}
	}
}

/* Lists make an element longer than it must be, and then only the least is known. */
static bool check_room(const struct ply_header *h, import_source *file, GError **error)
{
	uint64_t left = import_source_size(file) - h->bytes;
	bool exact = h->encoding != PLY_TEXT;
	left += h->encoding == PLY_TEXT; /* the last number needs no blank */
	for (guint i = 0; i < h->elements->len; i++) {
		const struct ply_element *e = &g_array_index(h->elements, struct ply_element, i);
		if (e->count && !e->properties->len)
			return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
				"its header tells of %" G_GUINT64_FORMAT
				" elements '%s' that have no properties",
				e->count, e->name);
		if (e->count && e->count > left / e->least_bytes)
			return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
				"its header tells of %" G_GUINT64_FORMAT
				" elements '%s', and there is room for %" G_GUINT64_FORMAT,
				e->count, e->name, left / e->least_bytes);
		left -= e->count * e->least_bytes;
		exact = exact && !(e->has_list && e->count);
	}
	if (exact && left)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
			"has %" G_GUINT64_FORMAT " bytes more than its header tells of", left);
	return true;
}

bool ply_header_read(import_source *file, struct ply_header *ret, GError **error)
{
	size_t most = (size_t)MIN(import_source_size(file), HEADER_BYTES_MAX);
	g_autofree char *text = g_malloc(most + 1);
	struct lines l = { file, text, text, 0 };
	size_t got;
	*ret = (struct ply_header){ 0 };
	ret->elements = g_array_new(false, true, sizeof(struct ply_element));
	g_array_set_clear_func(ret->elements, element_clear);
	if (!import_source_read(file, 0, text, most, &got, error))
		return false;
	text[got] = 0;
	if (!read_lines(ret, &l, error))
		return false;
	ret->bytes = (uint64_t)(l.at - text);
	ret->lines = l.line;
	return check_room(ret, file, error);
}
