/* PTX (import-ptx.c): each station with a grid, all its cells, column by column. */
#include "process/export-verify.h"
#include <math.h>
#include <string.h>

/* Six digits behind the point. */
#define STEP_M 1e-6

struct export_ptx {
	FILE *file;
	bool has_colour;
};

/* Faster than printf by far, and the same digits. value is below 9e12. Returns behind it. */
static char *put_millionths(char *at, double value)
{
	int64_t millionths = (int64_t)rint(value * 1e6);
	char digits[24];
	int count = 0;
	if (millionths < 0)
		*at++ = '-';
	uint64_t rest = (uint64_t)(millionths < 0 ? -millionths : millionths);
	for (; count < 7 || rest; count++, rest /= 10) {
		if (count == 6)
			digits[count++] = '.';
		digits[count] = (char)('0' + rest % 10);
	}
	while (count)
		*at++ = digits[--count];
	return at;
}

static char *put_colour(char *at, const uint8_t rgb[3])
{
	for (int i = 0; i < 3; i++) {
		unsigned value = rgb[i];
		*at++ = ' ';
		if (value >= 100)
			*at++ = (char)('0' + value / 100);
		if (value >= 10)
			*at++ = (char)('0' + value / 10 % 10);
		*at++ = (char)('0' + value % 10);
	}
	return at;
}

static void put_point(struct export_ptx *w, const struct export_point *p)
{
	char line[160], *at = line;
	for (int i = 0; i < 3; i++) {
		at = put_millionths(at, p->at_m[i]);
		*at++ = ' ';
	}
	at = put_millionths(at, p->intensity / 65535.0);
	if (w->has_colour)
		at = put_colour(at, p->rgb);
	*at++ = '\n';
	fwrite(line, 1, (size_t)(at - line), w->file);
}

static bool write_points(
	export_writer *writer, const struct export_point *p, size_t count, GError **error)
{
	struct export_ptx *w = (struct export_ptx *)writer;
	(void)error;
	for (size_t i = 0; i < count; i++)
		if (p[i].is_point)
			put_point(w, &p[i]);
		else
			fputs(w->has_colour ? "0 0 0 0.5 0 0 0\n" : "0 0 0 0.5\n", w->file);
	return true;
}

static void put_numbers(FILE *file, const double *v, int count, const char *behind)
{
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	for (int i = 0; i < count; i++)
		fprintf(file, "%s%s", i ? " " : "",
			g_ascii_formatd(number, sizeof number, "%.12g", v[i]));
	fprintf(file, "%s\n", behind);
}

/* Axes are the columns of the rotation: where the scanner's x, y and z point to; so they are the rows of a matrix for row vectors. */
static bool begin_station(export_writer *writer, const struct export_station *s, GError **error)
{
	struct export_ptx *w = (struct export_ptx *)writer;
	struct pose none = POSE_IDENTITY, pose = s->has_pose ? s->pose : none;
	(void)error;
	w->has_colour = s->survey.has_colour;
	fprintf(w->file, "%u\n%u\n", s->columns, s->rows);
	for (int pass = 0; pass < 2; pass++) {
		if (pass == 0)
			put_numbers(w->file, pose.translation_m, 3, "");
		for (int i = 0; i < 3; i++) {
			double axis[3] = { pose.rotation[0][i], pose.rotation[1][i],
				pose.rotation[2][i] };
			put_numbers(w->file, axis, 3, pass ? " 0" : "");
		}
		if (pass == 1)
			put_numbers(w->file, pose.translation_m, 3, " 1");
	}
	return true;
}

static bool end_station(export_writer *writer, GError **error)
{
	(void)writer;
	(void)error;
	return true;
}

static export_writer *open_writer(const struct export_job *j, FILE *file, GError **error)
{
	struct export_ptx *w = g_new0(struct export_ptx, 1);
	(void)j;
	(void)error;
	w->file = file;
	return (export_writer *)w;
}

static void close_writer(export_writer *writer)
{
	g_free(writer);
}

static double resolution_m(const struct export_job *j)
{
	(void)j;
	return STEP_M;
}

static bool verify(const struct export_job *j, const char *path, GError **error)
{
	return export_verify_by_import(j, &import_ptx, path, false, error);
}

const struct export_format export_ptx = { .name = "PTX",
	.extension = "ptx",
	.grids_only = true,
	.has_map = true,
	.order = EXPORT_WALK_COLUMNS,
	.open = open_writer,
	.begin = begin_station,
	.write = write_points,
	.end = end_station,
	.finish = end_station,
	.close = close_writer,
	.verify = verify,
	.resolution_m = resolution_m };
