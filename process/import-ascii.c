/* Points as lines of numbers: x y z, and what the file's own header names or the number of columns suggests.
 *
 *     x y z [intensity] [red green blue]     without names; four columns have intensity, six colours, seven both
 *
 * Columns are apart by blanks, tabs, commas or semicolons, and where they are not apart by commas, decimal commas are read. Lines
 * that begin with # or // are comments; a comment before the points or the first line may name the columns. A first line of a whole
 * number alone is how many points there are. The file is read twice: what its numbers mean only all of them tell. */
#include "acquire/panorama.h"
#include "process/import-cloud.h"
#include "process/import-lines.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define COLUMNS_MAX      64u
#define COORDINATE_MAX_M 1e9
/* Coordinates beyond are of a map, and get an origin. */
#define LOCAL_MAX_M         1000.0
#define LINE_MAX_CHARACTERS 1000

/* Of all numbers of a column. */
struct column {
	double least, most;
	bool whole; /* all of them */
};

struct ascii {
	struct import_lines lines;
	char separator; /* ' ': blanks and tabs */
	bool decimal_comma, is_named;
	unsigned columns;
	enum cloud_role role[COLUMNS_MAX];
	struct column met[COLUMNS_MAX];
	uint64_t first_offset, first_line; /* of the points */
	uint64_t told;                     /* how many there are, says the first line; 0: nothing */
	uint64_t count, at;                /* lines of points */
	double intensity_low, intensity_high, colour_most;
	bool begun, has_origin;
	char *note;
	char line[LINE_MAX_CHARACTERS + 2]; /* one with its commas made points */
	struct import_scan scan;
};

/* ---- fields ---- */

static bool ends_field(const struct ascii *r, char c)
{
	return c == '\n' || c == '\r' || c == 0 || c == r->separator ||
	       (r->separator == ' ' && c == '\t');
}

/* A tab may be what holds columns apart. */
static const char *skip_blanks(const struct ascii *r, const char *at)
{
	while (*at == ' ' || (*at == '\t' && r->separator != '\t'))
		at++;
	return at;
}

static const char *skip_field(const struct ascii *r, const char *at)
{
	while (!ends_field(r, *at))
		at++;
	return at;
}

/* "nan", "inf", "null" or nothing at all, in any way: not a number. */
static bool is_none(const char *at, size_t length)
{
	static const char *const words[] = { "", "nan", "-nan", "inf", "-inf", "+inf", "null",
		"none", "-nan(ind)", "1.#qnan", "infinity", "-infinity" };
	for (size_t i = 0; i < G_N_ELEMENTS(words); i++)
		if (strlen(words[i]) == length && g_ascii_strncasecmp(at, words[i], length) == 0)
			return true;
	return false;
}

static size_t trimmed(const char *at, const char *end)
{
	while (end > at && g_ascii_isspace(end[-1]))
		end--;
	return (size_t)(end - at);
}

/* Over one field and the separator behind it. *ret is NAN where it is none; false: it is something else. */
static bool read_field(const struct ascii *r, const char **text, double *ret)
{
	const char *at = skip_blanks(r, *text), *number = at;
	bool good = import_number(&number, ret);
	const char *behind = good ? skip_blanks(r, number) : at;
	/* Of blanks as separators, those behind are what ends it. */
	good = good && (ends_field(r, *behind) || (r->separator == ' ' && behind > number));
	if (!good) {
		behind = skip_field(r, at);
		if (!is_none(at, trimmed(at, behind)))
			return false;
		*ret = NAN;
	}
	if (*behind == r->separator && r->separator != ' ')
		behind++;
	*text = behind;
	return true;
}

/* Whether nothing but the end of the line is left. */
static bool is_over(const struct ascii *r, const char *at)
{
	return import_lines_ends(&r->lines, at) ||
	       (at >= r->line && at < r->line + sizeof r->line && *import_skip_blanks(at) == 0);
}

/* The line with points for commas. */
static const char *with_points(struct ascii *r, const char *line)
{
	size_t length = strcspn(line, "\n");
	memcpy(r->line, line, length);
	r->line[length] = 0;
	for (char *c = r->line; *c; c++)
		if (*c == ',')
			*c = '.';
	return r->line;
}

static bool refuse_count(const struct ascii *r, unsigned count, GError **error)
{
	return import_lines_refuse(error, &r->lines,
		"has %u columns, and the points before have %u", count, r->columns);
}

/* One number a column; columns of no meaning may hold anything. */
static bool read_point(struct ascii *r, const char *line, double *value, GError **error)
{
	const char *at = r->decimal_comma ? with_points(r, line) : line;
	for (unsigned i = 0; i < r->columns; i++) {
		if (is_over(r, at) && (i == 0 || at[-1] != r->separator || r->separator == ' '))
			return refuse_count(r, i, error);
		bool may_be_text = r->is_named && r->role[i] == CLOUD_NONE;
		if (read_field(r, &at, &value[i]))
			continue;
		if (!may_be_text)
			return import_lines_refuse(
				error, &r->lines, "column %u is no number", i + 1);
		at = skip_field(r, skip_blanks(r, at));
		at += *at == r->separator && r->separator != ' ';
		value[i] = NAN;
	}
	return is_over(r, at) ||
	       import_lines_refuse(error, &r->lines,
		       "has more than the %u columns of the points before", r->columns);
}

/* ---- lines ---- */

static const char *comment_of(const char *line)
{
	const char *at = import_skip_blanks(line);
	if (*at == '#')
		return at + 1;
	return at[0] == '/' && at[1] == '/' ? at + 2 : NULL;
}

/* The next line that is neither empty nor a comment; NULL: none. */
static bool next_points(struct ascii *r, const char **ret, GError **error)
{
	do
		if (!import_lines_next(&r->lines, ret, error))
			return false;
	while (*ret && (import_lines_ends(&r->lines, *ret) || comment_of(*ret)));
	return true;
}

/* ---- what the columns are ---- */

static unsigned count_of(const char *line, char c)
{
	unsigned count = 0;
	for (; *line && *line != '\n'; line++)
		count += *line == c;
	return count;
}

static void find_separator(struct ascii *r, const char *line)
{
	unsigned commas = count_of(line, ','), dots = count_of(line, '.');
	bool semicolons = count_of(line, ';') >= 2, tabs = count_of(line, '\t') >= 2;
	bool blanks = count_of(import_skip_blanks(line), ' ') >= 2;
	/* "1,5 2,5 3,5": a comma within each of them. */
	bool within = commas >= 2 && !dots && !strstr(line, ", ") && !strstr(line, " ,");
	r->separator = semicolons                           ? ';'
		       : tabs                               ? '\t'
		       : commas >= 2 && !(blanks && within) ? ','
							    : ' ';
	r->decimal_comma = r->separator != ',' && commas > 0 && !dots;
}

static unsigned columns_of(struct ascii *r, const char *line)
{
	double value;
	unsigned count = 0;
	const char *at = r->decimal_comma ? with_points(r, line) : line;
	while (count < COLUMNS_MAX && !is_over(r, at)) {
		if (!read_field(r, &at, &value)) {
			at = skip_field(r, skip_blanks(r, at));
			at += *at == r->separator && r->separator != ' ';
		}
		at = r->separator == ' ' ? import_skip_blanks(at) : at;
		count++;
	}
	return count;
}

/* Words of a header, as "//X Y Z" or "x,y,z,intensity". false: they do not name x, y and z. */
static bool take_names(struct ascii *r, const char *line)
{
	g_autofree char *text = g_strndup(line, strcspn(line, "\r\n"));
	g_auto(GStrv) words = g_strsplit_set(text, " \t,;\"", -1);
	enum cloud_role role[COLUMNS_MAX] = { CLOUD_NONE };
	unsigned count = 0, seen = 0;
	for (char **word = words; *word && count < COLUMNS_MAX; word++) {
		if (!**word)
			continue;
		enum cloud_role is = cloud_role_of(*word);
		/* Of one meaning the first counts. */
		role[count++] = is == CLOUD_CELL || seen >> is & 1 ? CLOUD_NONE : is;
		seen |= 1u << is;
	}
	unsigned all = 1u << CLOUD_X | 1u << CLOUD_Y | 1u << CLOUD_Z;
	if ((seen & all) != all)
		return false;
	r->is_named = true;
	r->columns = count;
	memcpy(r->role, role, sizeof role);
	return true;
}

/* All fractions, or all whole. */
static bool is_colour(const struct column *c)
{
	bool fractions = true, whole = true;
	for (int i = 0; i < 3; i++) {
		fractions &= c[i].least >= 0 && c[i].most <= 1;
		whole &= c[i].least >= 0 && c[i].most <= 65535 && c[i].whole;
	}
	return fractions || whole;
}

static void set_colours(struct ascii *r, unsigned from)
{
	for (unsigned i = 0; i < 3; i++)
		r->role[from + i] = (enum cloud_role)(CLOUD_RED + i);
}

/* As most programs write them. */
static void guess_roles(struct ascii *r)
{
	unsigned n = r->columns, known = 3;
	for (unsigned i = 0; i < 3; i++)
		r->role[i] = (enum cloud_role)(CLOUD_X + i);
	if (n == 4 || (n == 7 && is_colour(r->met + 4)))
		r->role[known++] = CLOUD_INTENSITY;
	if ((n == 6 || n == 7) && is_colour(r->met + known)) {
		set_colours(r, known);
		known += 3;
		if (n == 7 && known == 6)
			r->role[known++] = CLOUD_INTENSITY;
	}
	if (known == n - 1)
		r->note = g_strdup_printf("column %u has no name and was passed over", n);
	else if (known < n)
		r->note = g_strdup_printf(
			"columns %u to %u have no names and were passed over", known + 1, n);
}

static void settle_ranges(struct ascii *r)
{
	for (unsigned i = 0; i < r->columns; i++) {
		const struct column *c = &r->met[i];
		if (r->role[i] >= CLOUD_RED && r->role[i] <= CLOUD_BLUE && c->most > r->colour_most)
			r->colour_most = c->most;
		if (r->role[i] != CLOUD_INTENSITY || c->least > c->most)
			continue;
		bool odd = c->least < 0 || c->most > 65535;
		r->intensity_low = odd ? c->least : 0;
		r->intensity_high = odd ? c->most : c->most <= 1 ? 1 : c->most <= 255 ? 255 : 65535;
	}
	r->colour_most = r->colour_most <= 1 ? 1 : r->colour_most <= 255 ? 255 : 65535;
}

/* ---- the first time through ---- */

static void meet(struct ascii *r, const double *value)
{
	for (unsigned i = 0; i < r->columns; i++) {
		struct column *c = &r->met[i];
		if (!isfinite(value[i]))
			continue;
		c->least = fmin(c->least, value[i]);
		c->most = fmax(c->most, value[i]);
		c->whole &= value[i] == rint(value[i]);
	}
}

static bool is_count(struct ascii *r, const char *line, uint64_t *ret)
{
	const char *at = import_skip_blanks(line);
	uint64_t value;
	if (!import_integer(&at, &value) || !import_lines_ends(&r->lines, at))
		return false;
	*ret = value;
	return true;
}

static void skip_mark(struct ascii *r, const char **line)
{
	if (r->lines.line == 1 && !strncmp(*line, "\xef\xbb\xbf", 3))
		*line += 3;
}

/* Everything before the points; *ret is their first line. */
static bool read_head(struct ascii *r, const char **ret, GError **error)
{
	for (;;) {
		r->first_offset = import_lines_tell(&r->lines);
		r->first_line = r->lines.line;
		if (!import_lines_next(&r->lines, ret, error))
			return false;
		if (!*ret)
			return import_refuse(
				error, r->lines.file, G_IO_ERROR_INVALID_DATA, "has no points");
		skip_mark(r, ret);
		const char *comment = comment_of(*ret);
		if (comment)
			take_names(r, comment);
		else if (!import_lines_ends(&r->lines, *ret) && !take_names(r, *ret) &&
			 (r->told || !is_count(r, *ret, &r->told)))
			return true;
	}
}

static bool find_columns(struct ascii *r, const char *line, GError **error)
{
	find_separator(r, line);
	unsigned count = columns_of(r, line);
	if (r->is_named && count != r->columns)
		return import_lines_refuse(error, &r->lines,
			"has %u columns, and the names before are of %u", count, r->columns);
	r->columns = count;
	if (count < 3)
		return import_lines_refuse(error, &r->lines,
			"a point is x y z and more, and here are %u columns", count);
	if (count >= COLUMNS_MAX)
		return import_lines_refuse(
			error, &r->lines, "has more than %u columns", COLUMNS_MAX - 1);
	return true;
}

static bool meet_all(struct ascii *r, const char *line, GError **error)
{
	double value[COLUMNS_MAX];
	for (unsigned i = 0; i < r->columns; i++)
		r->met[i] = (struct column){ INFINITY, -INFINITY, true };
	for (; line; r->count++) {
		skip_mark(r, &line);
		if (!read_point(r, line, value, error))
			return false;
		meet(r, value);
		if (!next_points(r, &line, error))
			return false;
	}
	if (!r->told || r->told == r->count)
		return true;
	return import_refuse(error, r->lines.file, G_IO_ERROR_INVALID_DATA,
		"its first line tells of %" G_GUINT64_FORMAT
		" points, and there are %" G_GUINT64_FORMAT,
		r->told, r->count);
}

static bool look_through(struct ascii *r, GError **error)
{
	const char *line;
	if (!read_head(r, &line, error) || !find_columns(r, line, error) ||
		!meet_all(r, line, error))
		return false;
	if (!r->is_named)
		guess_roles(r);
	settle_ranges(r);
	import_lines_seek(&r->lines, r->first_offset, r->first_line);
	return true;
}

/* ---- points ---- */

static uint16_t intensity_of(const struct ascii *r, double value)
{
	double share = (value - r->intensity_low) / (r->intensity_high - r->intensity_low);
	return isfinite(share) ? (uint16_t)(CLAMP(share, 0, 1) * 65535 + 0.5) : 0;
}

static uint8_t byte_of(double value)
{
	return value >= 0 && value <= 255 ? (uint8_t)value : 0;
}

static void take(const struct ascii *r, const double *value, struct point_record *p, double at_m[3])
{
	*p = (struct point_record){ .cell = CELL_MEASURED, .return_number = 1 };
	for (unsigned i = 0; i < r->columns; i++) {
		double v = value[i];
		switch (r->role[i]) {
		case CLOUD_X:
		case CLOUD_Y:
		case CLOUD_Z: at_m[r->role[i] - CLOUD_X] = v; break;
		case CLOUD_INTENSITY: p->intensity = intensity_of(r, v); break;
		case CLOUD_RED:
		case CLOUD_GREEN:
		case CLOUD_BLUE:
			p->rgb[r->role[i] - CLOUD_RED] =
				(uint8_t)(CLAMP(isfinite(v) ? v / r->colour_most : 0, 0, 1) * 255 +
					  0.5);
			break;
		case CLOUD_CLASS: p->classification = byte_of(v); break;
		case CLOUD_RETURN: p->return_number = MAX(byte_of(v), 1); break;
		default: break;
		}
	}
}

/* false: it is no point, or an error. */
static bool place(struct ascii *r, const double at_m[3], struct point_record *p, GError **error)
{
	if (!isfinite(at_m[0]) || !isfinite(at_m[1]) || !isfinite(at_m[2]) ||
		(at_m[0] == 0 && at_m[1] == 0 && at_m[2] == 0))
		return r->scan.left_out++, false;
	for (int k = 0; k < 3; k++)
		if (!(fabs(at_m[k]) <= COORDINATE_MAX_M))
			return import_lines_refuse(
				error, &r->lines, "%g m is too far to be a point", at_m[k]);
	bool local = fabs(at_m[0]) <= LOCAL_MAX_M && fabs(at_m[1]) <= LOCAL_MAX_M &&
		     fabs(at_m[2]) <= LOCAL_MAX_M;
	for (int k = 0; k < 3 && !r->has_origin && !local; k++)
		r->scan.origin_m[k] = rint(at_m[k]);
	r->has_origin = true;
	p->x_m = at_m[0] - r->scan.origin_m[0];
	p->y_m = at_m[1] - r->scan.origin_m[1];
	p->z_m = at_m[2] - r->scan.origin_m[2];
	return true;
}

static bool ascii_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	struct ascii *r = (struct ascii *)reader;
	double value[COLUMNS_MAX], at_m[3] = { NAN, NAN, NAN };
	*ret_count = 0;
	for (; r->at < r->count && *ret_count < max; r->at++) {
		g_autoptr(GError) why = NULL;
		const char *line;
		if (!next_points(r, &line, error))
			return false;
		if (!line)
			return import_refuse(error, r->lines.file, G_IO_ERROR_INVALID_DATA,
				"became shorter while it was read");
		skip_mark(r, &line);
		if (!read_point(r, line, value, error))
			return false;
		take(r, value, &into[*ret_count], at_m);
		*ret_count += place(r, at_m, &into[*ret_count], &why);
		if (why)
			return g_propagate_error(error, g_steal_pointer(&why)), false;
	}
	if (r->at == r->count && r->scan.left_out == r->count)
		return import_refuse(error, r->lines.file, G_IO_ERROR_INVALID_DATA,
			"has no points but such as are not numbers, or zero");
	return true;
}

/* ---- the format ---- */

static enum import_result ascii_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct ascii *r = (struct ascii *)reader;
	(void)error;
	if (r->begun)
		return IMPORT_END;
	r->begun = true;
	r->scan = (struct import_scan){ .count = r->count, .pose = POSE_IDENTITY, .note = r->note };
	*ret = &r->scan;
	return IMPORT_SCAN;
}

static bool names_columns(const char *line)
{
	struct ascii r = { 0 };
	return take_names(&r, line);
}

/* Whether the line has three numbers or more, and nothing but what may stand beside them. */
static bool has_numbers(const char *at)
{
	unsigned count = 0;
	double value;
	for (; *at && *at != '\n'; at++) {
		if (strchr(" \t,;\r", *at))
			continue;
		if (!import_number(&at, &value) || !strchr(" \t,;\r\n", *at))
			return count >= 3;
		count++;
		if (*at == '\n')
			break;
		at--;
	}
	return count >= 3;
}

/* Text of which the first line that is no comment has numbers, or names them; or is their count, with the first of them behind. */
static bool ascii_probe(const uint8_t *start, size_t length)
{
	if (memchr(start, 0, length))
		return false;
	g_autofree char *text = g_strndup((const char *)start, length);
	uint64_t count;
	bool counted = false;
	const char *line = g_str_has_prefix(text, "\xef\xbb\xbf") ? text + 3 : text;
	while (line && *line) {
		const char *at = import_skip_blanks(line), *number = at;
		bool passed_over = *at == '\n' || comment_of(line);
		bool alone = !counted && import_integer(&number, &count) &&
			     *import_skip_blanks(number) == '\n';
		if (!passed_over && !alone && !names_columns(line))
			return has_numbers(at);
		counted |= alone;
		line = strchr(line, '\n');
		line = line ? line + 1 : NULL;
	}
	return false;
}

static void ascii_close(import_reader *reader)
{
	struct ascii *r = (struct ascii *)reader;
	if (!r)
		return;
	import_lines_clear(&r->lines);
	g_free(r->note);
	g_free(r);
}

static import_reader *ascii_open(
	import_source *file, const struct import_options *options, GError **error)
{
	(void)options;
	struct ascii *r = g_new0(struct ascii, 1);
	import_lines_begin(&r->lines, file);
	if (look_through(r, error))
		return (import_reader *)r;
	ascii_close((import_reader *)r);
	return NULL;
}

static double ascii_fraction(const import_reader *reader)
{
	const struct ascii *r = (const struct ascii *)reader;
	return (double)r->at / (double)MAX(r->count, 1);
}

const struct import_format import_ascii = { "ASCII", "xyz txt asc pts csv xyzi xyzrgb", ascii_probe,
	ascii_open, ascii_next_scan, ascii_read, ascii_fraction, ascii_close };
