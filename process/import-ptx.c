/* PTX, a text of scans one after another. Each is
 *
 *     columns                 usually; some write the rows first (import-grid.h)
 *     rows
 *     x y z                   where the scanner stood, and its three axes: what the matrix below says again
 *     x y z (3 times)
 *     a b c 0 (3 times)       the motion to the file's coordinates for row vectors: p' = p M
 *     x y z 1
 *     x y z i [r g b]         columns * rows lines; 0 0 0 where there is no point; i 0..1, r g b 0..255 */
#include "acquire/panorama.h"
#include "process/import-number.h"
#include "process/import.h"
#include <math.h>
#include <string.h>

#define BLOCK_BYTES         (1u << 20)
#define LINE_CHARACTERS_MAX 1000 /* of characters */
/* The shortest line of a cell, "0 0 0 0" and its end. */
#define CELL_BYTES_MIN 8
/* No scanner reaches so far: these are coordinates of a map. */
#define SCANNER_REACH_M  10000.0
#define COORDINATE_MAX_M 1e9
#define RIGID_TOLERANCE  1e-4

struct ptx {
	import_source *file;
	char *block; /* BLOCK_BYTES and a zero */
	size_t at, filled;
	uint64_t offset; /* of the file, behind what is in the block */
	uint64_t line;   /* number of the line read last */
	uint32_t scans;
	uint64_t cells_left;
	bool has_points, is_map;
	int fields; /* of a cell's line, all alike where there are points; 0: none seen yet */
	struct import_scan scan;
};

static bool refuse(GError **error, const struct ptx *r, const char *format, ...)
	G_GNUC_PRINTF(3, 4);

static bool refuse(GError **error, const struct ptx *r, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	return import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA,
		"line %" G_GUINT64_FORMAT ": %s", r->line, what);
}

/* ---- lines ---- */

static bool refill(struct ptx *r, GError **error)
{
	size_t kept = r->filled - r->at, got;
	memmove(r->block, r->block + r->at, kept);
	if (!import_source_read(
		    r->file, r->offset, r->block + kept, BLOCK_BYTES - kept, &got, error))
		return false;
	r->at = 0;
	r->filled = kept + got;
	r->offset += got;
	r->block[r->filled] = 0;
	return true;
}

/* The next line, which ends in a newline, in a carriage return before it, or in 0 at the end of the file. *ret is NULL when
 * there is none. */
static inline bool next_line(struct ptx *r, const char **ret, GError **error)
{
	char *newline = memchr(r->block + r->at, '\n', r->filled - r->at);
	if (!newline) {
		if (!refill(r, error))
			return false;
		newline = memchr(r->block, '\n', r->filled);
	}
	*ret = r->at < r->filled ? r->block + r->at : NULL;
	char *end = newline ? newline : r->block + r->filled;
	r->line += *ret != NULL;
	if (end - (r->block + r->at) > LINE_CHARACTERS_MAX)
		return refuse(error, r, "has more than %d characters", LINE_CHARACTERS_MAX);
	r->at = (size_t)(end - r->block) + (newline != NULL);
	return true;
}

static inline const char *skip_blanks(const char *at)
{
	while (*at == ' ' || *at == '\t' || *at == '\r')
		at++;
	return at;
}

/* Behind a number: nothing that belongs to it. */
static inline bool ends_field(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == 0;
}

/* Behind the last field. A zero byte ends a line only where the file ends. */
static bool ends_line(const struct ptx *r, const char *at)
{
	at = skip_blanks(at);
	return *at == '\n' || (*at == 0 && at == r->block + r->filled);
}

/* A line with just these numbers. */
static bool read_numbers(struct ptx *r, int count, double *ret, const char *what, GError **error)
{
	const char *at;
	if (!next_line(r, &at, error))
		return false;
	if (!at)
		return r->line++, refuse(error, r, "the file ends, and %s must stand here", what);
	for (int i = 0; i < count; i++) {
		at = skip_blanks(at);
		if (!import_number(&at, &ret[i]) || !ends_field(*at))
			return refuse(error, r, "%s must stand here", what);
	}
	return ends_line(r, at) || refuse(error, r, "%s must stand here, and nothing else", what);
}

/* ---- the head of a scan ---- */

static bool read_size(struct ptx *r, const char *at, uint32_t *ret, GError **error)
{
	uint64_t value;
	at = skip_blanks(at);
	if (!import_integer(&at, &value) || !ends_line(r, at))
		return refuse(error, r,
			r->scans ? "the size of the next grid must stand here, a whole number alone"
				 : "the size of the grid must stand here, a whole number alone");
	if (value == 0 || value > G_MAXINT32)
		return refuse(error, r, "a grid cannot have %" G_GUINT64_FORMAT " columns or rows",
			value);
	*ret = (uint32_t)value;
	return true;
}

static bool read_sizes(struct ptx *r, const char *first, GError **error)
{
	struct import_scan *s = &r->scan;
	const char *second;
	if (!read_size(r, first, &s->columns, error) || !next_line(r, &second, error))
		return false;
	if (!second)
		return r->line++,
		       refuse(error, r,
			       "the file ends, and the other size of the grid must stand here");
	if (!read_size(r, second, &s->rows, error))
		return false;
	uint64_t left = import_source_size(r->file) - (r->offset - (r->filled - r->at));
	s->count = (uint64_t)s->columns * s->rows;
	if (s->count <= left / CELL_BYTES_MIN + 1)
		return true;
	return refuse(error, r,
		"a grid of %u x %u has %" G_GUINT64_FORMAT
		" cells, and there are only %" G_GUINT64_FORMAT " bytes left in the file",
		s->columns, s->rows, s->count, left);
}

static double length3(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double determinant(const double m[3][3])
{
	return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
	       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
	       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* The matrix ends in the line read last. */
static bool check_rigid(struct ptx *r, GError **error)
{
	const struct pose *p = &r->scan.pose;
	uint64_t last = r->line;
	for (int i = 0; i < 3; i++) {
		double axis[3] = { p->rotation[0][i], p->rotation[1][i], p->rotation[2][i] };
		r->line = last - 3 + (uint64_t)i;
		if (fabs(length3(axis) - 1) > RIGID_TOLERANCE)
			return refuse(error, r,
				"the transform scales by %g: it must be a rotation and a "
				"translation",
				length3(axis));
	}
	r->line = last - 3;
	if (determinant(p->rotation) < 0)
		return refuse(
			error, r, "the transform mirrors: it must be a rotation and a translation");
	if (!pose_is_rigid(p, RIGID_TOLERANCE))
		return refuse(
			error, r, "the transform shears: it must be a rotation and a translation");
	r->line = last;
	return true;
}

static bool check_last_column(struct ptx *r, double value, int row, GError **error)
{
	if (fabs(value - (row == 3)) <= 1e-6)
		return true;
	return refuse(error, r,
		"the last number of this line of the transform is %g, and must be %d (a "
		"translation stands in the fourth line)",
		value, row == 3);
}

static bool read_transform(struct ptx *r, GError **error)
{
	struct pose *p = &r->scan.pose;
	for (int row = 0; row < 4; row++) {
		double m[4];
		if (!read_numbers(r, 4, m, "a line of the transform, four numbers,", error) ||
			!check_last_column(r, m[3], row, error))
			return false;
		for (int i = 0; i < 3; i++) {
			if (!(fabs(m[i]) <= COORDINATE_MAX_M))
				return refuse(error, r, "%g is too large for a transform", m[i]);
			*(row == 3 ? &p->translation_m[i] : &p->rotation[i][row]) = m[i];
		}
	}
	if (!check_rigid(r, error))
		return false;
	static const struct pose identity = POSE_IDENTITY;
	r->scan.has_pose = memcmp(p, &identity, sizeof identity) != 0;
	pose_orthonormalise(p);
	return true;
}

static bool read_head(struct ptx *r, const char *first, GError **error)
{
	double unused[3];
	r->scan = (struct import_scan){ .order = IMPORT_BY_CONTENT };
	r->has_points = r->is_map = false;
	r->fields = 0;
	if (!read_sizes(r, first, error))
		return false;
	for (int i = 0; i < 4; i++)
		if (!read_numbers(r, 3, unused,
			    i ? "an axis of the scanner, three numbers,"
			      : "where the scanner stood, three numbers,",
			    error))
			return false;
	if (!read_transform(r, error))
		return false;
	r->cells_left = r->scan.count;
	r->scans++;
	return true;
}

static enum import_result ptx_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct ptx *r = (struct ptx *)reader;
	const char *line;
	do {
		if (!next_line(r, &line, error))
			return IMPORT_BAD;
		if (!line && r->scans)
			return IMPORT_END;
		if (!line)
			return refuse(error, r, "there is no scan in it"), IMPORT_BAD;
	} while (ends_line(r, line));
	if (!read_head(r, line, error))
		return IMPORT_BAD;
	*ret = &r->scan;
	return IMPORT_SCAN;
}

/* ---- cells ---- */

static bool read_colour(struct ptx *r, const char **at, struct point_record *p, GError **error)
{
	for (int i = 0; i < 3; i++) {
		uint64_t value;
		*at = skip_blanks(*at);
		if (!import_integer(at, &value) || !ends_field(**at))
			return refuse(error, r,
				"a cell is x y z intensity, or x y z intensity red green blue");
		if (value > 255)
			return refuse(error, r, "a colour of %" G_GUINT64_FORMAT " is not 0 to 255",
				value);
		p->rgb[i] = (uint8_t)value;
	}
	return true;
}

/* The first point tells whether these are the scanner's own coordinates. */
static void look_at_first(struct ptx *r, const double xyz[3])
{
	r->has_points = true;
	r->is_map = !(length3(xyz) <= SCANNER_REACH_M);
	for (int i = 0; i < 3 && r->is_map; i++)
		r->scan.origin_m[i] = rint(xyz[i]);
}

/* One line shorter than the others was cut. */
static bool check_fields(struct ptx *r, int fields, GError **error)
{
	if (!r->fields)
		r->fields = fields;
	return r->fields == fields ||
	       refuse(error, r, "has %d numbers, and the points before have %d", fields, r->fields);
}

static bool place(
	struct ptx *r, const double v[4], int fields, struct point_record *p, GError **error)
{
	p->return_number = 1;
	p->cell = v[0] != 0 || v[1] != 0 || v[2] != 0 ? CELL_MEASURED : CELL_EMPTY;
	if (p->cell == CELL_EMPTY) {
		memset(p->rgb, 0, sizeof p->rgb);
		return true;
	}
	for (int i = 0; i < 3; i++)
		if (!(fabs(v[i]) <= COORDINATE_MAX_M))
			return refuse(error, r, "%g m is too far to be a point", v[i]);
	if (!(v[3] >= 0 && v[3] <= 1))
		return refuse(error, r, "an intensity of %g is not 0 to 1", v[3]);
	if (!check_fields(r, fields, error))
		return false;
	if (!r->has_points)
		look_at_first(r, v);
	p->x_m = v[0] - r->scan.origin_m[0];
	p->y_m = v[1] - r->scan.origin_m[1];
	p->z_m = v[2] - r->scan.origin_m[2];
	p->intensity = (uint16_t)(v[3] * 65535 + 0.5);
	return true;
}

static bool read_cell(struct ptx *r, struct point_record *p, GError **error)
{
	const char *at;
	double v[4];
	if (!next_line(r, &at, error))
		return false;
	if (!at)
		return r->line++,
		       refuse(error, r,
			       "the file ends here, and %" G_GUINT64_FORMAT
			       " of the %" G_GUINT64_FORMAT " cells of scan %u are missing",
			       r->cells_left, r->scan.count, r->scans);
	for (int i = 0; i < 4; i++) {
		at = skip_blanks(at);
		if (!import_number(&at, &v[i]) || !ends_field(*at))
			return refuse(error, r,
				"a cell is x y z intensity, or x y z intensity red green blue");
	}
	*p = (struct point_record){ 0 };
	int fields = ends_line(r, at) ? 4 : 7;
	if (fields == 7 && !read_colour(r, &at, p, error))
		return false;
	if (!ends_line(r, at))
		return refuse(error, r, "a cell has no more than seven numbers");
	return place(r, v, fields, p, error);
}

static bool ptx_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	struct ptx *r = (struct ptx *)reader;
	size_t count = (size_t)MIN(max, r->cells_left);
	for (size_t i = 0; i < count; i++, r->cells_left--)
		if (!read_cell(r, &into[i], error))
			return false;
	*ret_count = count;
	if (r->cells_left == 0 && !r->has_points)
		return refuse(error, r, "scan %u has no point in any of its cells", r->scans);
	if (r->cells_left == 0 && r->is_map)
		r->scan.columns = r->scan.rows = 0;
	return true;
}

/* ---- the format ---- */

static bool is_alone(const char **at)
{
	uint64_t value;
	*at = skip_blanks(*at);
	if (!import_integer(at, &value))
		return false;
	*at = skip_blanks(*at);
	return *(*at)++ == '\n';
}

/* Two whole numbers, each on a line of its own. */
static bool ptx_probe(const uint8_t *start, size_t length)
{
	g_autofree char *text = g_strndup((const char *)start, length);
	const char *at = text;
	double x;
	return is_alone(&at) && is_alone(&at) && (at = skip_blanks(at), import_number(&at, &x));
}

static void ptx_close(import_reader *reader)
{
	struct ptx *r = (struct ptx *)reader;
	if (!r)
		return;
	g_free(r->block);
	g_free(r);
}

static import_reader *ptx_open(import_source *file, GError **error)
{
	struct ptx *r = g_new0(struct ptx, 1);
	(void)error;
	r->file = file;
	r->block = g_malloc(BLOCK_BYTES + 1);
	r->block[0] = 0;
	return (import_reader *)r;
}

static double ptx_fraction(const import_reader *reader)
{
	const struct ptx *r = (const struct ptx *)reader;
	return (double)(r->offset - (r->filled - r->at)) /
	       (double)MAX(import_source_size(r->file), 1);
}

const struct import_format import_ptx = { "PTX", "ptx", ptx_probe, ptx_open, ptx_next_scan,
	ptx_read, ptx_fraction, ptx_close };
