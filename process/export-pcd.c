/* PCD 0.7, binary: all points in the coordinates of the site; or one station with its grid and, as the viewpoint, where it stood.
 * Coordinates are floats, since the programs that read it take no doubles. */
#include "process/export-table.h"
#include <math.h>
#include <string.h>

struct export_pcd {
	const struct export_job *job;
	FILE *file;
	struct export_table table;
	const struct export_station *station;
};

static struct export_table table_of(const struct export_job *j)
{
	struct table_extent e = export_table_extent(j);
	struct export_table t = { 0 };
	for (int i = 0; i < 3; i++)
		export_table_add(&t, (enum table_column)(TABLE_X + i), TABLE_F32);
	if (e.has_intensity)
		export_table_add(&t, TABLE_INTENSITY, TABLE_F32);
	if (e.has_colour)
		export_table_add(&t, TABLE_RGB, TABLE_U32);
	if (e.has_classes)
		export_table_add(&t, TABLE_CLASS, TABLE_U32);
	if (e.return_most > 1)
		export_table_add(&t, TABLE_ECHO, TABLE_U8);
	if (j->stations->len > 1)
		export_table_add(&t, TABLE_STATION, TABLE_U16);
	return t;
}

/* Of pcl::PointXYZL and others: labels are what PCL's own programs look for. */
static const char *const names[] = { [TABLE_X] = "x",
	[TABLE_Y] = "y",
	[TABLE_Z] = "z",
	[TABLE_INTENSITY] = "intensity",
	[TABLE_RGB] = "rgb",
	[TABLE_CLASS] = "label",
	[TABLE_ECHO] = "return_number",
	[TABLE_STATION] = "scan" };

static void add_fields(GString *h, const struct export_table *t)
{
	g_string_append(h, "FIELDS");
	for (unsigned i = 0; i < t->count; i++)
		g_string_append_printf(h, " %s", names[t->fields[i].column]);
	g_string_append(h, "\nSIZE");
	for (unsigned i = 0; i < t->count; i++)
		g_string_append_printf(h, " %u", table_type_bytes[t->fields[i].type]);
	g_string_append(h, "\nTYPE");
	for (unsigned i = 0; i < t->count; i++)
		g_string_append(h, t->fields[i].type == TABLE_F32 ? " F" : " U");
	g_string_append(h, "\nCOUNT");
	for (unsigned i = 0; i < t->count; i++)
		g_string_append(h, " 1");
}

/* w x y z */
static void add_viewpoint(GString *h, const struct export_station *s, bool is_grid)
{
	struct pose none = POSE_IDENTITY, pose = is_grid && s->has_pose ? s->pose : none;
	double v[7], twist[6];
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	pose_difference(&none, &pose, twist);
	double angle = sqrt(twist[0] * twist[0] + twist[1] * twist[1] + twist[2] * twist[2]);
	v[3] = cos(angle / 2);
	for (int i = 0; i < 3; i++) {
		v[i] = pose.translation_m[i];
		v[4 + i] = angle > 0 ? twist[i] / angle * sin(angle / 2) : 0;
	}
	g_string_append(h, "\nVIEWPOINT");
	for (size_t i = 0; i < G_N_ELEMENTS(v); i++)
		g_string_append_printf(
			h, " %s", g_ascii_formatd(number, sizeof number, "%.12g", v[i]));
}

static char *header_of(const struct export_job *j, const struct export_table *t)
{
	const struct export_station *first = export_station_at(j, 0);
	uint64_t count = export_table_extent(j).points,
		 width = j->one_grid ? first->columns : count,
		 height = j->one_grid ? first->rows : 1;
	g_autoptr(GString) h =
		g_string_new("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n");
	add_fields(h, t);
	g_string_append_printf(
		h, "\nWIDTH %" G_GUINT64_FORMAT "\nHEIGHT %" G_GUINT64_FORMAT, width, height);
	add_viewpoint(h, first, j->one_grid);
	g_string_append_printf(h, "\nPOINTS %" G_GUINT64_FORMAT "\nDATA binary\n", width * height);
	return g_strdup(h->str);
}

/* ---- writing ---- */

static bool begin_station(export_writer *writer, const struct export_station *s, GError **error)
{
	(void)error;
	((struct export_pcd *)writer)->station = s;
	return true;
}

static bool write_points(
	export_writer *writer, const struct export_point *p, size_t count, GError **error)
{
	struct export_pcd *w = (struct export_pcd *)writer;
	(void)error;
	export_table_write(&w->table, w->station, p, count, w->job->one_grid, w->file);
	return true;
}

static bool nothing_more(export_writer *writer, GError **error)
{
	(void)writer;
	(void)error;
	return true;
}

static export_writer *open_writer(const struct export_job *j, FILE *file, GError **error)
{
	struct export_pcd *w = g_new0(struct export_pcd, 1);
	(void)error;
	w->job = j;
	w->file = file;
	w->table = table_of(j);
	g_autofree char *header = header_of(j, &w->table);
	fputs(header, file);
	return (export_writer *)w;
}

static void close_writer(export_writer *writer)
{
	g_free(writer);
}

static bool verify(const struct export_job *j, const char *path, GError **error)
{
	struct export_table t = table_of(j);
	g_autofree char *header = header_of(j, &t);
	return export_table_verify(j, &t, header, j->one_grid, path, error);
}

static double resolution_m(const struct export_job *j)
{
	struct table_extent e = export_table_extent(j);
	return export_table_float_step_m(&e);
}

const struct export_format export_pcd = { .name = "PCD",
	.extension = "pcd",
	.merged = true,
	.keeps_one_grid = true,
	.order = EXPORT_WALK_POINTS,
	.open = open_writer,
	.begin = begin_station,
	.write = write_points,
	.end = nothing_more,
	.finish = nothing_more,
	.close = close_writer,
	.verify = verify,
	.resolution_m = resolution_m };
