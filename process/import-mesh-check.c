/* What can be told of a mesh's file without reading it as one. */
#include "process/import-lines.h"
#include "process/import-mesh.h"
#include "process/import-ply.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define STL_HEADER_BYTES   84u
#define STL_TRIANGLE_BYTES 50u
#define INDEX_MAX          (1 << 30)

/* ---- which it is ---- */

static bool begins_with(const char *line, const char *word)
{
	size_t length = strlen(word);
	return strncmp(line, word, length) == 0 && import_ends_field(line[length]);
}

static bool is_off(const char *text)
{
	static const char *const words[] = { "OFF", "COFF", "NOFF", "CNOFF", "STOFF" };
	for (size_t i = 0; i < G_N_ELEMENTS(words); i++)
		if (begins_with(text, words[i]))
			return true;
	return false;
}

static bool is_obj_line(const char *line)
{
	static const char *const words[] = { "v", "vn", "vt", "vp", "f", "l", "p", "g", "o", "s",
		"mg", "mtllib", "usemtl", "maplib", "usemap", "lod", "bevel", "c_interp",
		"d_interp", "shadow_obj", "trace_obj" };
	for (size_t i = 0; i < G_N_ELEMENTS(words); i++)
		if (begins_with(line, words[i]))
			return true;
	return false;
}

/* All its lines are known ones, and among them are vertices; the last one may be cut. */
static bool is_obj(const char *text)
{
	bool has_vertex = false;
	for (const char *line = text; *line;) {
		const char *end = strchr(line, '\n');
		if (!end)
			break;
		const char *at = import_skip_blanks(line);
		if (*at != '#' && *at != '\n' && !is_obj_line(at))
			return false;
		has_vertex |= begins_with(at, "v");
		line = end + 1;
	}
	return has_vertex;
}

/* How many of them a PLY's header tells; 0: none. */
static uint64_t ply_count(const char *text, const char *element)
{
	const char *at = strstr(text, element), *end = strstr(text, "\nend_header");
	return at && (!end || at < end) ? g_ascii_strtoull(at + strlen(element), NULL, 10) : 0;
}

/* A few faces among points make no mesh: that has one for each three of them or more. */
static bool is_ply_mesh(const char *text)
{
	uint64_t faces = ply_count(text, "\nelement face ");
	return strncmp(text, "ply", 3) == 0 && faces > 0 &&
	       faces >= ply_count(text, "\nelement vertex ") / 3;
}

static uint32_t u32_at(const uint8_t *at)
{
	uint32_t value;
	memcpy(&value, at, sizeof value);
	return GUINT32_FROM_LE(value);
}

static bool is_text_stl(const char *text)
{
	return begins_with(text, "solid") && strstr(text, "facet");
}

enum mesh_kind mesh_kind_of(const uint8_t *start, size_t length)
{
	g_autofree char *text = g_strndup((const char *)start, length);
	if (is_off(text))
		return MESH_OFF;
	if (is_ply_mesh(text))
		return MESH_PLY;
	if (is_text_stl(text))
		return MESH_STL;
	if (is_obj(text))
		return MESH_OBJ;
	bool is_stl =
		length > STL_HEADER_BYTES &&
		STL_HEADER_BYTES + (uint64_t)STL_TRIANGLE_BYTES * u32_at(start + 80) == length;
	return is_stl ? MESH_STL : MESH_NONE;
}

/* ---- OFF ---- */

/* The next line that is neither empty nor a comment; NULL: none. */
static bool next_line(struct import_lines *l, const char **ret, GError **error)
{
	do
		if (!import_lines_next(l, ret, error))
			return false;
	while (*ret && (import_lines_ends(l, *ret) || *import_skip_blanks(*ret) == '#'));
	return true;
}

static bool read_numbers(const char **at, int count, double *ret)
{
	for (int i = 0; i < count; i++) {
		*at = import_skip_blanks(*at);
		if (!import_number(at, &ret[i]) || !import_ends_field(**at))
			return false;
	}
	return true;
}

static bool need_line(struct import_lines *l, const char **ret, const char *what, GError **error)
{
	if (!next_line(l, ret, error))
		return false;
	if (*ret)
		return true;
	l->line++;
	return import_lines_refuse(error, l, "the file ends, and %s must stand here", what);
}

static bool check_off_counts(
	struct import_lines *l, uint64_t *ret_vertices, uint64_t *ret_faces, GError **error)
{
	const char *at;
	if (!need_line(l, &at, "OFF", error))
		return false;
	at = import_skip_blanks(at);
	if (!is_off(at))
		return import_lines_refuse(error, l, "OFF must stand here");
	at += strcspn(at, " \t\r\n");
	if (import_lines_ends(l, at) && !need_line(l, &at, "how many vertices and faces", error))
		return false;
	at = import_skip_blanks(at);
	if (!import_integer(&at, ret_vertices) ||
		(at = import_skip_blanks(at), !import_integer(&at, ret_faces)))
		return import_lines_refuse(error, l, "how many vertices and faces must stand here");
	uint64_t left = import_source_size(l->file) - import_lines_tell(l);
	if (*ret_vertices <= left / 5 && *ret_faces <= left / 5)
		return true;
	return import_lines_refuse(error, l,
		"%" G_GUINT64_FORMAT " vertices and %" G_GUINT64_FORMAT
		" faces cannot stand in the %" G_GUINT64_FORMAT " bytes that are left",
		*ret_vertices, *ret_faces, left);
}

static bool check_off_face(
	struct import_lines *l, const char *at, uint64_t vertices, GError **error)
{
	uint64_t corners, index;
	at = import_skip_blanks(at);
	if (!import_integer(&at, &corners) || corners < 1 || corners > 1000)
		return import_lines_refuse(
			error, l, "a face is the number of its corners, and them");
	for (uint64_t i = 0; i < corners; i++) {
		at = import_skip_blanks(at);
		if (!import_integer(&at, &index) || !import_ends_field(*at))
			return import_lines_refuse(error, l,
				"a face of %" G_GUINT64_FORMAT " corners has fewer of them",
				corners);
		if (index >= vertices)
			return import_lines_refuse(error, l,
				"there is no vertex %" G_GUINT64_FORMAT
				": there are %" G_GUINT64_FORMAT,
				index, vertices);
	}
	return true;
}

static bool check_off(struct import_lines *l, GError **error)
{
	uint64_t vertices, faces;
	const char *at;
	double xyz[3];
	if (!check_off_counts(l, &vertices, &faces, error))
		return false;
	for (uint64_t i = 0; i < vertices; i++) {
		if (!need_line(l, &at, "a vertex", error))
			return false;
		if (!read_numbers(&at, 3, xyz))
			return import_lines_refuse(error, l, "a vertex is x y z");
	}
	for (uint64_t i = 0; i < faces; i++)
		if (!need_line(l, &at, "a face", error) || !check_off_face(l, at, vertices, error))
			return false;
	return true;
}

/* ---- OBJ ---- */

struct obj {
	int64_t count[3]; /* of v, vt, vn */
	int64_t most[3];  /* index that a face names */
	uint64_t most_line[3];
};

/* One corner of a face: v, v/vt, v//vn or v/vt/vn. */
static bool check_corner(struct import_lines *l, struct obj *o, const char **at, GError **error)
{
	for (int i = 0; i < 3; i++) {
		bool negative = **at == '-';
		uint64_t index;
		*at += negative;
		if (i == 1 && !negative && **at == '/') { /* v//vn */
			(*at)++;
			continue;
		}
		if (!import_integer(at, &index) || index < 1 || index > INDEX_MAX)
			return import_lines_refuse(
				error, l, "a face is the numbers of its corners");
		if (negative && (int64_t)index > o->count[i])
			return import_lines_refuse(error, l,
				"there are not %" G_GUINT64_FORMAT " of them before this line",
				index);
		if (!negative && (int64_t)index > o->most[i]) {
			o->most[i] = (int64_t)index;
			o->most_line[i] = l->line;
		}
		if (**at != '/')
			break;
		(*at)++;
	}
	return import_ends_field(**at) ||
	       import_lines_refuse(error, l, "a face is the numbers of its corners");
}

static bool check_obj_face(struct import_lines *l, struct obj *o, const char *at, GError **error)
{
	unsigned corners = 0;
	for (at = import_skip_blanks(at); !import_lines_ends(l, at);
		at = import_skip_blanks(at), corners++)
		if (!check_corner(l, o, &at, error))
			return false;
	return corners >= 3 ||
	       import_lines_refuse(error, l, "a face has three corners or more, not %u", corners);
}

static bool check_obj_line(struct import_lines *l, struct obj *o, const char *line, GError **error)
{
	static const struct {
		const char *word;
		int which, numbers;
	} rows[] = { { "v", 0, 3 }, { "vt", 1, 1 }, { "vn", 2, 3 } };
	const char *at = import_skip_blanks(line);
	double numbers[3];
	for (size_t i = 0; i < G_N_ELEMENTS(rows); i++) {
		if (!begins_with(at, rows[i].word))
			continue;
		at += strlen(rows[i].word);
		o->count[rows[i].which]++;
		return read_numbers(&at, rows[i].numbers, numbers) ||
		       import_lines_refuse(error, l, "%d numbers must stand behind %s",
			       rows[i].numbers, rows[i].word);
	}
	return !begins_with(at, "f") || check_obj_face(l, o, at + 1, error);
}

static bool check_obj(struct import_lines *l, GError **error)
{
	static const char *const names[] = { "vertex", "texture coordinate", "normal" };
	struct obj o = { 0 };
	const char *line;
	for (;;) {
		if (!next_line(l, &line, error))
			return false;
		if (!line)
			break;
		if (!check_obj_line(l, &o, line, error))
			return false;
	}
	for (int i = 0; i < 3; i++)
		if (o.most[i] > o.count[i])
			return l->line = o.most_line[i], import_lines_refuse(error, l,
								 "there is no %s %" G_GINT64_FORMAT
								 ": the file has %" G_GINT64_FORMAT,
								 names[i], o.most[i], o.count[i]);
	return true;
}

/* ---- STL ---- */

static bool check_binary_stl(import_source *file, const uint8_t *start, GError **error)
{
	uint64_t size = import_source_size(file), told = u32_at(start + 80),
		 room = (size - STL_HEADER_BYTES) / STL_TRIANGLE_BYTES;
	if (told && told <= room)
		return true;
	return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
		"byte 80: it tells of %" G_GUINT64_FORMAT
		" triangles, and has room for %" G_GUINT64_FORMAT,
		told, room);
}

/* The lines of a triangle, each with the numbers behind it. */
static const struct {
	const char *words;
	int numbers;
} stl_lines[] = { { "facet normal", 3 }, { "outer loop", 0 }, { "vertex", 3 }, { "vertex", 3 },
	{ "vertex", 3 }, { "endloop", 0 }, { "endfacet", 0 } };

static bool check_stl_line(struct import_lines *l, const char *at, size_t which, GError **error)
{
	double numbers[3];
	g_auto(GStrv) words = g_strsplit(stl_lines[which].words, " ", -1);
	bool good = true;
	for (char **word = words; *word && good; word++) {
		at = import_skip_blanks(at);
		good = begins_with(at, *word);
		at += good ? strlen(*word) : 0;
	}
	return (good && read_numbers(&at, stl_lines[which].numbers, numbers) &&
		       import_lines_ends(l, at)) ||
	       import_lines_refuse(error, l, "'%s%s' must stand here", stl_lines[which].words,
		       stl_lines[which].numbers ? " x y z" : "");
}

static bool check_text_stl(struct import_lines *l, GError **error)
{
	const char *line;
	uint64_t lines = 0;
	bool inside = false;
	for (;;) {
		if (!next_line(l, &line, error))
			return false;
		if (!line)
			break;
		const char *at = import_skip_blanks(line);
		bool between = lines % G_N_ELEMENTS(stl_lines) == 0,
		     turns = between && begins_with(at, inside ? "endsolid" : "solid");
		if (!turns && !inside)
			return import_lines_refuse(error, l, "'solid' must stand here");
		if (!turns && !check_stl_line(l, at, lines++ % G_N_ELEMENTS(stl_lines), error))
			return false;
		inside ^= turns;
	}
	l->line++;
	if (inside)
		return import_lines_refuse(
			error, l, "the file ends here, and endsolid should stand before");
	return lines || import_lines_refuse(error, l, "the file ends here, and has no triangle");
}

static bool check_stl(import_source *file, struct import_lines *l, GError **error)
{
	uint8_t start[512] = { 0 };
	size_t got;
	if (!import_source_read(file, 0, start, sizeof start - 1, &got, error))
		return false;
	if (is_text_stl((const char *)start))
		return check_text_stl(l, error);
	if (got < STL_HEADER_BYTES)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
			"is cut short in its header, at byte %zu", got);
	return check_binary_stl(file, start, error);
}

/* ---- all ---- */

static bool check_ply(import_source *file, GError **error)
{
	struct ply_header h = { 0 };
	bool good = ply_header_read(file, &h, error);
	ply_header_clear(&h);
	return good;
}

bool mesh_check(import_source *file, enum mesh_kind kind, GError **error)
{
	struct import_lines l;
	import_lines_begin(&l, file);
	bool good = kind == MESH_OFF   ? check_off(&l, error)
		    : kind == MESH_OBJ ? check_obj(&l, error)
		    : kind == MESH_STL ? check_stl(file, &l, error)
				       : check_ply(file, error);
	import_lines_clear(&l);
	return good;
}
