/* PTX, a text of scans one after another. Each is
 *
 *     columns                 usually; some write the rows first (import-grid.h)
 *     rows
 *     x y z                   where the scanner stood, and its three axes: what the matrix below says again
 *     x y z (3 times)
 *     a b c 0 (3 times)       the motion to the file's coordinates for row vectors: p' = p M
 *     x y z 1
 *     x y z i [r g b]         columns * rows lines; 0 0 0 where there is no point; i 0..1, r g b 0..255
 *
 * Some exporters write a matrix that is no motion, or intensities as their scanner had them (0..255, -2048..2047). */
#include "process/import-ptx.h"
#include "acquire/panorama.h"
#include <math.h>
#include <string.h>

/* No scanner reaches so far: these are coordinates of a map. */
#define SCANNER_REACH_M 10000.0
#define INTENSITY_MAX   1e9

/* ---- cells ---- */

static bool read_colour(struct ptx *r, const char **at, struct point_record *p, GError **error)
{
	for (int i = 0; i < 3; i++) {
		uint64_t value;
		*at = import_skip_blanks(*at);
		if (!import_integer(at, &value) || !import_ends_field(**at))
			return import_lines_refuse(error, &r->lines,
				"a cell is x y z intensity, or x y z intensity red green blue");
		if (value > 255)
			return import_lines_refuse(error, &r->lines,
				"a colour of %" G_GUINT64_FORMAT " is not 0 to 255", value);
		p->rgb[i] = (uint8_t)value;
	}
	return true;
}

/* The first point tells whether these are the scanner's own coordinates. */
static void look_at_first(struct ptx *r, const double xyz[3])
{
	r->has_points = true;
	double range_m = sqrt(xyz[0] * xyz[0] + xyz[1] * xyz[1] + xyz[2] * xyz[2]);
	r->is_map = !(range_m <= SCANNER_REACH_M);
	for (int i = 0; i < 3 && (r->is_map || r->is_applied); i++)
		r->scan.origin_m[i] = rint(xyz[i]);
}

/* One line shorter than the others was cut. */
static bool check_fields(struct ptx *r, int fields, GError **error)
{
	if (!r->fields)
		r->fields = fields;
	return r->fields == fields ||
	       import_lines_refuse(error, &r->lines,
		       "has %d numbers, and the points before have %d", fields, r->fields);
}

/* Beyond 0..1 only the whole scan tells what they mean: then it is read again. */
static uint16_t intensity_of(struct ptx *r, double value)
{
	r->intensity_least = fmin(r->intensity_least, value);
	r->intensity_most = fmax(r->intensity_most, value);
	double span = r->intensity_high - r->intensity_low;
	double share = span > 0 ? (value - r->intensity_low) / span : 0;
	return (uint16_t)(CLAMP(share, 0, 1) * 65535 + 0.5);
}

/* v: x y z as the file has them, then where they belong. */
static bool place(struct ptx *r, double v[4], int fields, struct point_record *p, GError **error)
{
	p->return_number = 1;
	p->cell = v[0] != 0 || v[1] != 0 || v[2] != 0 ? CELL_MEASURED : CELL_EMPTY;
	if (p->cell == CELL_EMPTY) {
		memset(p->rgb, 0, sizeof p->rgb);
		return true;
	}
	if (r->is_applied)
		pose_apply(&r->applied, v, v);
	for (int i = 0; i < 3; i++)
		if (!(fabs(v[i]) <= PTX_COORDINATE_MAX_M))
			return import_lines_refuse(
				error, &r->lines, "%g m is too far to be a point", v[i]);
	if (!(fabs(v[3]) <= INTENSITY_MAX))
		return import_lines_refuse(
			error, &r->lines, "%g is too large for an intensity", v[3]);
	if (!check_fields(r, fields, error))
		return false;
	if (!r->has_points)
		look_at_first(r, v);
	p->x_m = v[0] - r->scan.origin_m[0];
	p->y_m = v[1] - r->scan.origin_m[1];
	p->z_m = v[2] - r->scan.origin_m[2];
	p->intensity = intensity_of(r, v[3]);
	return true;
}

static bool read_cell(struct ptx *r, struct point_record *p, GError **error)
{
	const char *at;
	double v[4];
	if (!import_lines_next(&r->lines, &at, error))
		return false;
	if (!at)
		return r->lines.line++,
		       import_lines_refuse(error, &r->lines,
			       "the file ends here, and %" G_GUINT64_FORMAT
			       " of the %" G_GUINT64_FORMAT " cells of scan %u are missing",
			       r->cells_left, r->scan.count, r->scans);
	for (int i = 0; i < 4; i++) {
		at = import_skip_blanks(at);
		if (!import_number(&at, &v[i]) || !import_ends_field(*at))
			return import_lines_refuse(error, &r->lines,
				"a cell is x y z intensity, or x y z intensity red green blue");
	}
	*p = (struct point_record){ 0 };
	int fields = import_lines_ends(&r->lines, at) ? 4 : 7;
	if (fields == 7 && !read_colour(r, &at, p, error))
		return false;
	if (!import_lines_ends(&r->lines, at))
		return import_lines_refuse(
			error, &r->lines, "a cell has no more than seven numbers");
	return place(r, v, fields, p, error);
}

static void begin_again(struct ptx *r)
{
	import_lines_seek(&r->lines, r->first_offset, r->first_line);
	r->cells_left = r->scan.count;
	r->scan.begun++;
	/* Nothing stays nothing. */
	r->intensity_low = fmin(r->intensity_least, 0);
	r->intensity_high = r->intensity_most;
	char *note = g_strdup_printf("%s%sintensities of %g to %g were scaled from %g to %g",
		r->note ? r->note : "", r->note ? "; " : "", r->intensity_least, r->intensity_most,
		r->intensity_low, r->intensity_high);
	g_free(r->note);
	r->scan.note = r->note = note;
}

static bool ptx_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	struct ptx *r = (struct ptx *)reader;
	bool beyond = r->intensity_least < 0 || r->intensity_most > 1;
	if (r->cells_left == 0 && beyond && !r->scan.begun)
		begin_again(r);
	size_t count = (size_t)MIN(max, r->cells_left);
	for (size_t i = 0; i < count; i++, r->cells_left--)
		if (!read_cell(r, &into[i], error))
			return false;
	*ret_count = count;
	if (r->cells_left == 0 && !r->has_points)
		return import_lines_refuse(
			error, &r->lines, "scan %u has no point in any of its cells", r->scans);
	if (r->cells_left == 0 && (r->is_map || r->is_applied)) {
		r->scan.columns = r->scan.rows = 0;
		r->scan.no_grid =
			r->is_applied ? "a transform that is no motion" : "map coordinates";
	}
	return true;
}

/* ---- the format ---- */

static enum import_result ptx_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct ptx *r = (struct ptx *)reader;
	const char *line;
	do {
		if (!import_lines_next(&r->lines, &line, error))
			return IMPORT_BAD;
		if (!line && r->scans)
			return IMPORT_END;
		if (!line)
			return import_lines_refuse(error, &r->lines, "there is no scan in it"),
			       IMPORT_BAD;
	} while (import_lines_ends(&r->lines, line));
	if (!ptx_read_head(r, line, error))
		return IMPORT_BAD;
	*ret = &r->scan;
	return IMPORT_SCAN;
}

static bool is_alone(const char **at)
{
	uint64_t value;
	*at = import_skip_blanks(*at);
	if (!import_integer(at, &value))
		return false;
	*at = import_skip_blanks(*at);
	return *(*at)++ == '\n';
}

/* Two whole numbers, each on a line of its own. */
static bool ptx_probe(const uint8_t *start, size_t length)
{
	g_autofree char *text = g_strndup((const char *)start, length);
	const char *at = text;
	double x;
	return is_alone(&at) && is_alone(&at) &&
	       (at = import_skip_blanks(at), import_number(&at, &x));
}

static void ptx_close(import_reader *reader)
{
	struct ptx *r = (struct ptx *)reader;
	if (!r)
		return;
	import_lines_clear(&r->lines);
	g_free(r->note);
	g_free(r);
}

static import_reader *ptx_open(
	import_source *file, const struct import_options *options, GError **error)
{
	(void)options;
	struct ptx *r = g_new0(struct ptx, 1);
	(void)error;
	import_lines_begin(&r->lines, file);
	return (import_reader *)r;
}

static double ptx_fraction(const import_reader *reader)
{
	const struct ptx *r = (const struct ptx *)reader;
	return (double)import_lines_tell(&r->lines) /
	       (double)MAX(import_source_size(r->lines.file), 1);
}

const struct import_format import_ptx = { "PTX", "ptx", ptx_probe, ptx_open, ptx_next_scan,
	ptx_read, ptx_fraction, ptx_close };
