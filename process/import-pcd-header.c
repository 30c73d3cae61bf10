#include "process/import-pcd.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define HEADER_BYTES_MAX (1u << 20)
#define FIELDS_MAX       256u
/* PCL counts points in 32 bits, and the bytes of a compressed body too. */
#define POINTS_MAX      G_MAXINT32
#define POINT_BYTES_MAX 65536u

enum key {
	KEY_VERSION,
	KEY_FIELDS,
	KEY_SIZE,
	KEY_TYPE,
	KEY_COUNT,
	KEY_WIDTH,
	KEY_HEIGHT,
	KEY_VIEWPOINT,
	KEY_POINTS,
	KEY_DATA,
	KEYS
};
static const char *const key_names[KEYS] = { "VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH",
	"HEIGHT", "VIEWPOINT", "POINTS", "DATA" };

/* The lines of the header by their first word. */
typedef struct entries entries_in;
struct entries {
	import_source *file;
	char **words[KEYS]; /* without the first; NULL: not there */
	uint64_t line[KEYS];
};

static void entries_clear(struct entries *e)
{
	for (int i = 0; i < KEYS; i++)
		g_strfreev(e->words[i]);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(entries_in, entries_clear)

static void field_clear(gpointer p)
{
	g_free(((struct pcd_field *)p)->name);
}

void pcd_header_clear(struct pcd_header *h)
{
	g_clear_pointer(&h->fields, g_array_unref);
}

static bool refuse(GError **error, import_source *file, uint64_t line, const char *format, ...)
	G_GNUC_PRINTF(4, 5);

static bool refuse(GError **error, import_source *file, uint64_t line, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	return import_refuse(
		error, file, G_IO_ERROR_INVALID_DATA, "line %" G_GUINT64_FORMAT ": %s", line, what);
}
#define refuse_key(error, e, key, ...) refuse(error, (e)->file, (e)->line[key], __VA_ARGS__)

/* ---- lines ---- */

static char **words_of(const char *line, size_t length)
{
	g_autofree char *text = g_strndup(line, length);
	g_strdelimit(text, "\t\r", ' ');
	g_auto(GStrv) parts = g_strsplit(text, " ", -1);
	g_autoptr(GPtrArray) words = g_ptr_array_new();
	for (char **part = parts; *part; part++)
		if (**part)
			g_ptr_array_add(words, g_strdup(*part));
	g_ptr_array_add(words, NULL);
	return (char **)g_ptr_array_free(g_steal_pointer(&words), FALSE);
}

static int key_of(const char *word)
{
	if (!strcmp(word, "COLUMNS")) /* of version .5 */
		return KEY_FIELDS;
	for (int i = 0; i < KEYS; i++)
		if (!strcmp(word, key_names[i]))
			return i;
	return -1;
}

static bool enter(struct entries *e, uint64_t line, char **words, GError **error)
{
	if (!*words || **words == '#')
		return true;
	int key = key_of(*words);
	if (key < 0)
		return refuse(error, e->file, line, "'%.20s' is nothing that a header has", *words);
	if (e->words[key])
		return refuse(error, e->file, line, "there is a second %s", key_names[key]);
	e->words[key] = g_strdupv(words + 1);
	e->line[key] = line;
	return true;
}

static bool read_lines(struct entries *e, const char *text, struct pcd_header *h, GError **error)
{
	const char *at = text;
	while (!e->words[KEY_DATA]) {
		const char *newline = strchr(at, '\n');
		h->lines++;
		if (!newline)
			return refuse(
				error, e->file, h->lines, "the header has no end, a line DATA");
		g_auto(GStrv) words = words_of(at, (size_t)(newline - at));
		if (!enter(e, h->lines, words, error))
			return false;
		at = newline + 1;
	}
	h->bytes = (uint64_t)(at - text);
	return true;
}

/* ---- what they say ---- */

static bool type_of(const char *letter, const char *size, enum cloud_type *ret)
{
	static const struct {
		char letter, size;
		enum cloud_type type;
	} types[] = { { 'I', '1', CLOUD_I8 }, { 'U', '1', CLOUD_U8 }, { 'I', '2', CLOUD_I16 },
		{ 'U', '2', CLOUD_U16 }, { 'I', '4', CLOUD_I32 }, { 'U', '4', CLOUD_U32 },
		{ 'I', '8', CLOUD_I64 }, { 'U', '8', CLOUD_U64 }, { 'F', '4', CLOUD_F32 },
		{ 'F', '8', CLOUD_F64 } };
	for (size_t i = 0; i < G_N_ELEMENTS(types); i++)
		if (strlen(letter) == 1 && strlen(size) == 1 && *letter == types[i].letter &&
			*size == types[i].size) {
			*ret = types[i].type;
			return true;
		}
	return false;
}

static bool check_words(const struct entries *e, enum key key, guint count, GError **error)
{
	if (!e->words[key])
		return import_refuse(error, e->file, G_IO_ERROR_INVALID_DATA,
			"its header has no %s", key_names[key]);
	guint there = g_strv_length(e->words[key]);
	return there == count || refuse_key(error, e, key, "%s has %u entries, and must have %u",
					 key_names[key], there, count);
}

static bool read_whole(
	const struct entries *e, enum key key, guint i, uint64_t max, uint64_t *ret, GError **error)
{
	if (g_ascii_string_to_unsigned(e->words[key][i], 10, 1, max, ret, NULL))
		return true;
	return refuse_key(error, e, key, "%s '%.20s' is no whole number of 1 to %" G_GUINT64_FORMAT,
		key_names[key], e->words[key][i], max);
}

static bool read_field(const struct entries *e, guint i, struct pcd_header *h, GError **error)
{
	struct pcd_field f = { .offset = h->point_bytes, .count = 1 };
	uint64_t count = 1;
	char **size = e->words[KEY_SIZE], **type = e->words[KEY_TYPE];
	if (!type_of(type ? type[i] : "F", size ? size[i] : "4", &f.type))
		return refuse_key(error, e, type ? KEY_TYPE : KEY_SIZE,
			"there are no numbers of TYPE %.10s and SIZE %.10s", type ? type[i] : "F",
			size ? size[i] : "4");
	if (e->words[KEY_COUNT] && !read_whole(e, KEY_COUNT, i, POINT_BYTES_MAX, &count, error))
		return false;
	f.count = (uint32_t)count;
	h->point_bytes += f.count * cloud_type_bytes[f.type];
	if (h->point_bytes > POINT_BYTES_MAX)
		return refuse_key(
			error, e, KEY_FIELDS, "a point has more than %u bytes", POINT_BYTES_MAX);
	f.name = g_strdup(e->words[KEY_FIELDS][i]);
	g_array_append_val(h->fields, f);
	return true;
}

static bool read_fields(const struct entries *e, struct pcd_header *h, GError **error)
{
	static const enum key beside[] = { KEY_SIZE, KEY_TYPE, KEY_COUNT };
	guint count = e->words[KEY_FIELDS] ? g_strv_length(e->words[KEY_FIELDS]) : 0;
	if (count == 0 || count > FIELDS_MAX)
		return import_refuse(error, e->file, G_IO_ERROR_INVALID_DATA,
			"its header must tell of 1 to %u FIELDS", FIELDS_MAX);
	for (size_t i = 0; i < G_N_ELEMENTS(beside); i++)
		if (e->words[beside[i]] && !check_words(e, beside[i], count, error))
			return false;
	for (guint i = 0; i < count; i++)
		if (!read_field(e, i, h, error))
			return false;
	return true;
}

static bool read_size(const struct entries *e, struct pcd_header *h, GError **error)
{
	uint64_t width, height = 1, told;
	if (!check_words(e, KEY_WIDTH, 1, error) ||
		!read_whole(e, KEY_WIDTH, 0, POINTS_MAX, &width, error))
		return false;
	if (e->words[KEY_HEIGHT] &&
		(!check_words(e, KEY_HEIGHT, 1, error) ||
			!read_whole(e, KEY_HEIGHT, 0, POINTS_MAX, &height, error)))
		return false;
	if (width * height > POINTS_MAX)
		return refuse_key(error, e, KEY_WIDTH,
			"%" G_GUINT64_FORMAT " x %" G_GUINT64_FORMAT
			" points are more than are read",
			width, height);
	told = width * height;
	if (e->words[KEY_POINTS] &&
		(!check_words(e, KEY_POINTS, 1, error) ||
			!read_whole(e, KEY_POINTS, 0, POINTS_MAX, &told, error)))
		return false;
	if (told != width * height)
		return refuse_key(error, e, KEY_POINTS,
			"POINTS is %" G_GUINT64_FORMAT
			", and WIDTH times HEIGHT %" G_GUINT64_FORMAT,
			told, width * height);
	h->width = (uint32_t)width;
	h->height = (uint32_t)height;
	return true;
}

/* tx ty tz qw qx qy qz, as doubles: PCL has them as floats, which loses the place on a map. */
static bool read_viewpoint(const struct entries *e, struct pcd_header *h, GError **error)
{
	double v[7], n = 0;
	h->viewpoint = (struct pose)POSE_IDENTITY;
	if (!e->words[KEY_VIEWPOINT])
		return true;
	if (!check_words(e, KEY_VIEWPOINT, 7, error))
		return false;
	for (int i = 0; i < 7; i++) {
		char *end;
		v[i] = g_ascii_strtod(e->words[KEY_VIEWPOINT][i], &end);
		if (*end || !(fabs(v[i]) <= 1e9))
			return refuse_key(error, e, KEY_VIEWPOINT,
				"VIEWPOINT '%.20s' is no number that can be",
				e->words[KEY_VIEWPOINT][i]);
		n += i >= 3 ? v[i] * v[i] : 0;
	}
	if (!(fabs(n - 1) < 1e-2))
		return refuse_key(error, e, KEY_VIEWPOINT,
			"the quaternion of VIEWPOINT has the length %g, and must have 1", sqrt(n));
	double w = v[3], x = v[4], y = v[5], z = v[6], s = 2 / n;
	h->viewpoint = (struct pose){
		{ { 1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y) },
			{ s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x) },
			{ s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y) } },
		{ v[0], v[1], v[2] }
	};
	return true;
}

static bool read_data(const struct entries *e, struct pcd_header *h, GError **error)
{
	static const char *const names[] = { "ascii", "binary", "binary_compressed" };
	if (!check_words(e, KEY_DATA, 1, error))
		return false;
	for (int i = 0; i < 3; i++)
		if (!strcmp(*e->words[KEY_DATA], names[i])) {
			h->data = (enum pcd_data)i;
			return true;
		}
	return refuse_key(error, e, KEY_DATA,
		"DATA '%.20s' is none of ascii, binary and "
		"binary_compressed",
		*e->words[KEY_DATA]);
}

/* ---- against the length of the file ---- */

static bool check_binary(const struct pcd_header *h, import_source *file, GError **error)
{
	uint64_t there = import_source_size(file) - h->bytes,
		 need = (uint64_t)h->width * h->height * h->point_bytes;
	if (there >= need && there < need + h->point_bytes)
		return true;
	return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
		"its header tells of %" G_GUINT64_FORMAT " bytes of points, and %" G_GUINT64_FORMAT
		" stand behind it",
		need, there);
}

/* Two lengths of 32 bits, then the compressed bytes. LZF makes at most 264 bytes of three. */
static bool check_compressed(const struct pcd_header *h, import_source *file, GError **error)
{
	uint64_t there = import_source_size(file) - h->bytes,
		 need = (uint64_t)h->width * h->height * h->point_bytes;
	uint32_t length[2];
	size_t got;
	if (!import_source_read(file, h->bytes, length, sizeof length, &got, error))
		return false;
	if (got < sizeof length)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
			"is cut short at byte %" G_GUINT64_FORMAT, h->bytes + got);
	uint64_t packed = GUINT32_FROM_LE(length[0]), unpacked = GUINT32_FROM_LE(length[1]);
	if (packed > there - sizeof length)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
			"byte %" G_GUINT64_FORMAT ": tells of %" G_GUINT64_FORMAT
			" compressed bytes, and the file has %" G_GUINT64_FORMAT " more",
			h->bytes, packed, there - sizeof length);
	if (unpacked != need || need > packed * 88 || need > G_MAXINT32)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
			"byte %" G_GUINT64_FORMAT ": %" G_GUINT64_FORMAT
			" compressed bytes cannot be the %" G_GUINT64_FORMAT
			" bytes of points that the header tells of",
			h->bytes + 4, packed, need);
	return true;
}

static bool check_text(const struct pcd_header *h, import_source *file, GError **error)
{
	uint64_t numbers = 0, there = import_source_size(file) - h->bytes,
		 count = (uint64_t)h->width * h->height;
	for (guint i = 0; i < h->fields->len; i++)
		numbers += g_array_index(h->fields, struct pcd_field, i).count;
	if (count <= (there + 1) / (2 * numbers))
		return true;
	return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
		"its header tells of %" G_GUINT64_FORMAT " points with %" G_GUINT64_FORMAT
		" numbers each, and only %" G_GUINT64_FORMAT " bytes stand behind it",
		count, numbers, there);
}

bool pcd_header_read(import_source *file, struct pcd_header *ret, GError **error)
{
	static bool (*const check[])(const struct pcd_header *, import_source *,
		GError **) = { check_text, check_binary, check_compressed };
	size_t most = (size_t)MIN(import_source_size(file), HEADER_BYTES_MAX);
	g_autofree char *text = g_malloc(most + 1);
	g_auto(entries_in) e = { .file = file };
	size_t got;
	*ret = (struct pcd_header){ 0 };
	ret->fields = g_array_new(false, true, sizeof(struct pcd_field));
	g_array_set_clear_func(ret->fields, field_clear);
	if (!import_source_read(file, 0, text, most, &got, error))
		return false;
	text[got] = 0;
	return read_lines(&e, text, ret, error) && read_fields(&e, ret, error) &&
	       read_size(&e, ret, error) && read_viewpoint(&e, ret, error) &&
	       read_data(&e, ret, error) && check[ret->data](ret, file, error);
}
