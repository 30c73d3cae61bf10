#include "process/pick-file.h"
#include "firmware-io/files.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define BYTES_MAX  (4u << 20)
#define METRES_MAX 1e7
#define WORD_SHOWN 40
#define WORDS_MAX  8

/* What is read just now. */
struct place {
	const char *path;
	uint32_t line;
	GError **error;
};

static bool refuse(const struct place *at, const char *format, ...) G_GNUC_PRINTF(2, 3);
static bool refuse(const struct place *at, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *text = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error(at->error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA, "%s: line %u: %s", at->path,
		at->line, text);
	return false;
}

/* A word of the file for a message: without what a terminal must not get. */
static char *shown(const char *word)
{
	char *text = g_strndup(word, WORD_SHOWN);
	for (char *c = text; *c; c++)
		if (!g_ascii_isprint(*c))
			*c = '?';
	return text;
}

static bool refuse_word(const struct place *at, const char *word, const char *what)
{
	g_autofree char *text = shown(word);
	return refuse(at, "'%s' %s", text, what);
}

static bool read_metres(const struct place *at, const char *word, double *ret)
{
	char *end;
	*ret = g_ascii_strtod(word, &end);
	if (end == word || *end)
		return refuse_word(at, word, "is no number");
	if (!isfinite(*ret) || fabs(*ret) > METRES_MAX)
		return refuse_word(at, word, "is no place on earth");
	return true;
}

static bool read_index(const char **at, char after, uint32_t *ret)
{
	char *end;
	if (!g_ascii_isdigit(**at))
		return false;
	guint64 value = g_ascii_strtoull(*at, &end, 10);
	if (value > G_MAXUINT32 || *end != after)
		return false;
	*ret = (uint32_t)value;
	*at = end + (after != '\0');
	return true;
}

static bool read_cell(const struct place *at, const char *word, struct picked_point *ret)
{
	const char *rest = word + 2;
	ret->is_cell = true;
	if (read_index(&rest, ',', &ret->column) && read_index(&rest, '\0', &ret->row))
		return true;
	return refuse_word(at, word, "is no cell like c:1204,188");
}

/* Takes one or three of the words from *next on. */
static bool read_point(const struct place *at, char **words, guint *next, const char *scan,
	struct picked_point *ret)
{
	if (words[*next] && g_str_has_prefix(words[*next], "c:"))
		return read_cell(at, words[(*next)++], ret);
	for (int k = 0; k < 3; k++) {
		if (!words[*next])
			return refuse(at,
				"the point in scan %s is not whole: a pair is x y z x y z "
				"or c:COLUMN,ROW c:COLUMN,ROW",
				scan);
		if (!read_metres(at, words[(*next)++], &ret->point_m[k]))
			return false;
	}
	return true;
}

/* Splits in place; at most WORDS_MAX, which is more than a pair has. */
static guint split(char *line, char **ret_words)
{
	guint count = 0;
	char *save = NULL;
	line[strcspn(line, "#")] = '\0';
	for (char *word = strtok_r(line, " \t\r\v\f", &save); word && count < WORDS_MAX;
		word = strtok_r(NULL, " \t\r\v\f", &save))
		ret_words[count++] = word;
	ret_words[count] = NULL;
	return count;
}

static bool read_line(const struct place *at, char *line, GArray *pairs)
{
	char *words[WORDS_MAX + 1];
	struct picked_pair pair = { .line = at->line };
	guint next = 0;
	if (!split(line, words))
		return true;
	if (!read_point(at, words, &next, "A", &pair.a) ||
		!read_point(at, words, &next, "B", &pair.b))
		return false;
	if (words[next])
		return refuse_word(at, words[next], "is one word too many for a pair");
	if (pairs->len == PICK_FILE_PAIRS_MAX)
		return refuse(at, "more than %u pairs", PICK_FILE_PAIRS_MAX);
	g_array_append_val(pairs, pair);
	return true;
}

GArray *pick_file_read(const char *path, GError **error)
{
	size_t length;
	struct place at = { path, 0, error };
	g_autofree char *text = files_read(path, BYTES_MAX, &length, error);
	g_autoptr(GArray) pairs = g_array_new(FALSE, FALSE, sizeof(struct picked_pair));
	if (!text)
		return NULL;
	if (memchr(text, 0, length)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA, "%s: is no text", path);
		return NULL;
	}
	g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
	for (char **line = lines; *line; line++) {
		at.line++;
		if (!read_line(&at, *line, pairs))
			return NULL;
	}
	return g_steal_pointer(&pairs);
}

/* ---- cells ---- */

static bool resolve(
	const struct place *at, const scan_data *d, const struct picked_point *p, double ret_m[3])
{
	const range_grid *g = d->grid;
	memcpy(ret_m, p->point_m, sizeof p->point_m);
	if (!p->is_cell)
		return true;
	if (!g)
		return refuse(at, "scan %u is a cloud and has no cells; give metres", d->number);
	if (p->column >= g->columns || p->row >= g->rows)
		return refuse(at, "cell %u,%u is outside the %u x %u cells of scan %u", p->column,
			p->row, g->columns, g->rows, d->number);
	size_t i = (size_t)p->row * g->columns + p->column;
	if (!(g->range_m[i] > 0))
		return refuse(
			at, "cell %u,%u of scan %u has no point", p->column, p->row, d->number);
	ret_m[0] = g->x_m[i];
	ret_m[1] = g->y_m[i];
	ret_m[2] = g->z_m[i];
	return true;
}

bool pick_file_resolve(const char *path, const GArray *pairs, const scan_data *a,
	const scan_data *b, struct pick *ret, GError **error)
{
	for (guint i = 0; i < pairs->len; i++) {
		const struct picked_pair *p = &g_array_index(pairs, struct picked_pair, i);
		struct place at = { path, p->line, error };
		if (!resolve(&at, a, &p->a, ret[i].a_m) || !resolve(&at, b, &p->b, ret[i].b_m))
			return false;
	}
	return true;
}
