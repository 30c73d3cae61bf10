#include "process/import-ptx.h"
#include <math.h>
#include <string.h>

/* The shortest line of a cell, "0 0 0 0" and its end. */
#define CELL_BYTES_MIN  8
#define RIGID_TOLERANCE 1e-4
/* Of the volume that its axes would have at right angles. */
#define FLAT 1e-9

/* ---- the head of a scan ---- */

/* A line with just these numbers; what it is, for the message. */
static bool read_numbers(struct ptx *r, int count, double *ret, const char *what, GError **error)
{
	const char *at;
	if (!import_lines_next(&r->lines, &at, error))
		return false;
	if (!at)
		return r->lines.line++, import_lines_refuse(error, &r->lines,
						"the file ends, and %s must stand here", what);
	for (int i = 0; i < count; i++) {
		at = import_skip_blanks(at);
		if (!import_number(&at, &ret[i]) || !import_ends_field(*at))
			return import_lines_refuse(error, &r->lines, "%s must stand here", what);
	}
	return import_lines_ends(&r->lines, at) ||
	       import_lines_refuse(error, &r->lines, "%s must stand here, and nothing else", what);
}

static bool read_size(struct ptx *r, const char *at, uint32_t *ret, GError **error)
{
	uint64_t value;
	at = import_skip_blanks(at);
	if (!import_integer(&at, &value) || !import_lines_ends(&r->lines, at))
		return import_lines_refuse(error, &r->lines,
			r->scans ? "the size of the next grid must stand here, a whole number alone"
				 : "the size of the grid must stand here, a whole number alone");
	if (value == 0 || value > G_MAXINT32)
		return import_lines_refuse(error, &r->lines,
			"a grid cannot have %" G_GUINT64_FORMAT " columns or rows", value);
	*ret = (uint32_t)value;
	return true;
}

static bool read_sizes(struct ptx *r, const char *first, GError **error)
{
	struct import_scan *s = &r->scan;
	const char *second;
	if (!read_size(r, first, &s->columns, error) ||
		!import_lines_next(&r->lines, &second, error))
		return false;
	if (!second)
		return r->lines.line++,
		       import_lines_refuse(error, &r->lines,
			       "the file ends, and the other size of the grid must stand here");
	if (!read_size(r, second, &s->rows, error))
		return false;
	uint64_t left = import_source_size(r->lines.file) - import_lines_tell(&r->lines);
	s->count = (uint64_t)s->columns * s->rows;
	if (s->count <= left / CELL_BYTES_MIN + 1)
		return true;
	return import_lines_refuse(error, &r->lines,
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

static const char *what_it_does(const double lengths[3], double volume)
{
	if (volume < 0)
		return "mirrors";
	for (int i = 0; i < 3; i++)
		if (fabs(lengths[i] - 1) > RIGID_TOLERANCE)
			return "scales";
	return "shears";
}

/* One of a map's projection or units, say, that is no motion of a scanner. It ends in the line read last. */
static bool apply_to_points(struct ptx *r, GError **error)
{
	const struct pose *p = &r->scan.pose;
	double lengths[3], volume = determinant(p->rotation);
	for (int i = 0; i < 3; i++) {
		double axis[3] = { p->rotation[0][i], p->rotation[1][i], p->rotation[2][i] };
		lengths[i] = length3(axis);
	}
	if (!(fabs(volume) > FLAT * lengths[0] * lengths[1] * lengths[2]))
		return r->lines.line -= 3, import_lines_refuse(error, &r->lines,
						   "the transform takes all points to one plane");
	r->is_applied = true;
	r->applied = *p;
	r->scan.pose = POSE_IDENTITY;
	r->scan.has_pose = true;
	r->note = g_strdup_printf(
		"the transform %s, so it was applied to the points", what_it_does(lengths, volume));
	return true;
}

static bool check_last_column(struct ptx *r, double value, int row, GError **error)
{
	if (fabs(value - (row == 3)) <= 1e-6)
		return true;
	return import_lines_refuse(error, &r->lines,
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
			if (!(fabs(m[i]) <= PTX_COORDINATE_MAX_M))
				return import_lines_refuse(
					error, &r->lines, "%g is too large for a transform", m[i]);
			*(row == 3 ? &p->translation_m[i] : &p->rotation[i][row]) = m[i];
		}
	}
	if (determinant(p->rotation) < 0 || !pose_is_rigid(p, RIGID_TOLERANCE))
		return apply_to_points(r, error);
	static const struct pose identity = POSE_IDENTITY;
	r->scan.has_pose = memcmp(p, &identity, sizeof identity) != 0;
	pose_orthonormalise(p);
	return true;
}

bool ptx_read_head(struct ptx *r, const char *first, GError **error)
{
	double unused[3];
	r->scan = (struct import_scan){ .order = IMPORT_BY_CONTENT };
	r->has_points = r->is_map = r->is_applied = false;
	r->fields = 0;
	r->intensity_low = 0;
	r->intensity_high = 1;
	r->intensity_least = INFINITY;
	r->intensity_most = -INFINITY;
	g_clear_pointer(&r->note, g_free);
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
	r->first_offset = import_lines_tell(&r->lines);
	r->first_line = r->lines.line;
	r->scan.note = r->note;
	r->scans++;
	return true;
}
