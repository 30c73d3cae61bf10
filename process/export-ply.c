/* Binary PLY: all points in the coordinates of the site, or of its map; or one station with its grid (range_grid, as the scans of
 * Stanford have it) and where it stood (the element camera, as PCL writes it). */
#include "firmware-io/files.h"
#include "process/export-table.h"
#include "process/export-verify.h"
#include "process/export-walk.h"
#include <string.h>

/* Beyond, floats have steps of more than 0.06 mm. */
#define FLOATS_REACH_M 1000.0

struct export_ply {
	const struct export_job *job;
	FILE *file;
	struct export_table table;
	const struct export_station *station;
	uint8_t *has_point; /* of one grid, a bit a cell */
};

static struct export_table table_of(const struct export_job *j)
{
	struct table_extent e = export_table_extent(j);
	struct export_table t = { 0 };
	for (int i = 0; i < 3; i++)
		export_table_add(&t, (enum table_column)(TABLE_X + i),
			e.farthest_m > FLOATS_REACH_M ? TABLE_F64 : TABLE_F32);
	if (e.has_intensity)
		export_table_add(&t, TABLE_INTENSITY, TABLE_F32);
	for (int i = 0; i < 3 && e.has_colour; i++)
		export_table_add(&t, (enum table_column)(TABLE_RED + i), TABLE_U8);
	if (e.has_classes)
		export_table_add(&t, TABLE_CLASS, TABLE_U8);
	if (e.return_most > 1)
		export_table_add(&t, TABLE_ECHO, TABLE_U8);
	if (j->stations->len > 1)
		export_table_add(&t, TABLE_STATION, TABLE_U16);
	return t;
}

static void add_properties(GString *h, const struct export_table *t)
{
	static const char *const names[] = { [TABLE_X] = "x",
		[TABLE_Y] = "y",
		[TABLE_Z] = "z",
		[TABLE_INTENSITY] = "intensity",
		[TABLE_RED] = "red",
		[TABLE_GREEN] = "green",
		[TABLE_BLUE] = "blue",
		[TABLE_CLASS] = "classification",
		[TABLE_ECHO] = "return_number",
		[TABLE_STATION] = "scan" };
	static const char *const types[] = { [TABLE_U8] = "uchar",
		[TABLE_U16] = "ushort",
		[TABLE_U32] = "uint",
		[TABLE_F32] = "float",
		[TABLE_F64] = "double" };
	for (unsigned i = 0; i < t->count; i++)
		g_string_append_printf(h, "property %s %s\n", types[t->fields[i].type],
			names[t->fields[i].column]);
}

static void add_grid(GString *h, const struct export_station *s)
{
	static const char *const camera[] = { "view_px", "view_py", "view_pz", "x_axisx", "x_axisy",
		"x_axisz", "y_axisx", "y_axisy", "y_axisz", "z_axisx", "z_axisy", "z_axisz" };
	if (s->has_pose) {
		g_string_append(h, "element camera 1\n");
		for (size_t i = 0; i < G_N_ELEMENTS(camera); i++)
			g_string_append_printf(h, "property double %s\n", camera[i]);
	}
	g_string_append_printf(h,
		"element range_grid %" G_GUINT64_FORMAT
		"\nproperty list uchar int vertex_indices\n",
		s->cells);
}

static char *header_of(const struct export_job *j, const struct export_table *t)
{
	const struct export_station *first = export_station_at(j, 0);
	g_autoptr(GString) h = g_string_new("ply\nformat binary_little_endian 1.0\n");
	g_string_append_printf(h, "comment written by pleinair, metres\n");
	if (j->one_grid)
		g_string_append_printf(h, "obj_info num_cols %u\nobj_info num_rows %u\n",
			first->columns, first->rows);
	g_string_append_printf(
		h, "element vertex %" G_GUINT64_FORMAT "\n", export_table_extent(j).points);
	add_properties(h, t);
	if (j->one_grid)
		add_grid(h, first);
	g_string_append(h, "end_header\n");
	return g_strdup(h->str);
}

/* ---- writing ---- */

static bool begin_station(export_writer *writer, const struct export_station *s, GError **error)
{
	struct export_ply *w = (struct export_ply *)writer;
	(void)error;
	w->station = s;
	if (w->job->one_grid)
		w->has_point = g_malloc0(s->cells / 8 + 1);
	return true;
}

static void mark_points(uint8_t *has_point, const struct export_station *s,
	const struct export_point *p, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		uint64_t cell = (uint64_t)p[i].row * s->columns + p[i].column;
		has_point[cell / 8] |= (uint8_t)(p[i].is_point << cell % 8);
	}
}

static bool write_points(
	export_writer *writer, const struct export_point *p, size_t count, GError **error)
{
	struct export_ply *w = (struct export_ply *)writer;
	(void)error;
	export_table_write(&w->table, w->station, p, count, false, w->file);
	if (w->has_point)
		mark_points(w->has_point, w->station, p, count);
	return true;
}

/* Axes are the columns of the rotation. */
struct camera {
	double v[12];
};

static struct camera camera_of(const struct pose *p)
{
	struct camera c;
	for (int i = 0; i < 3; i++) {
		c.v[i] = p->translation_m[i];
		for (int k = 0; k < 3; k++)
			c.v[3 + 3 * k + i] = p->rotation[i][k];
	}
	return c;
}

static bool end_station(export_writer *writer, GError **error)
{
	struct export_ply *w = (struct export_ply *)writer;
	struct camera camera = camera_of(&w->station->pose);
	int32_t vertex = 0;
	(void)error;
	if (w->has_point && w->station->has_pose)
		fwrite(&camera, sizeof camera, 1, w->file);
	for (uint64_t i = 0; w->has_point && i < w->station->cells; i++) {
		bool has = w->has_point[i / 8] >> i % 8 & 1;
		fputc(has, w->file);
		if (has)
			fwrite(&vertex, sizeof vertex, 1, w->file);
		vertex += has;
	}
	return true;
}

static bool finish(export_writer *writer, GError **error)
{
	(void)writer;
	(void)error;
	return true;
}

static export_writer *open_writer(const struct export_job *j, FILE *file, GError **error)
{
	struct export_ply *w = g_new0(struct export_ply, 1);
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
	if (writer)
		g_free(((struct export_ply *)writer)->has_point);
	g_free(writer);
}

/* ---- reading back ---- */

static bool look_again(const struct export_job *j, uint8_t *has_point, GError **error)
{
	const struct export_station *s = export_station_at(j, 0);
	g_autoptr(export_walk) walk = export_walk_open(j, s, export_order_of(j, s), error);
	const struct export_point *p;
	size_t count = 1;
	while (walk && count) {
		if (!export_walk_next(walk, &p, &count, error))
			return false;
		mark_points(has_point, s, p, count);
	}
	return walk != NULL;
}

/* What stands behind the points: the camera, and of each cell its point. */
static bool grid_is_back(FILE *file, const struct export_station *s, const uint8_t *has_point)
{
	struct camera written = camera_of(&s->pose), camera;
	int32_t vertex = 0, back;
	if (s->has_pose && (fread(&camera, sizeof camera, 1, file) != 1 ||
				   memcmp(&camera, &written, sizeof camera) != 0))
		return false;
	for (uint64_t i = 0; i < s->cells; i++) {
		int has = has_point[i / 8] >> i % 8 & 1;
		if (getc(file) != has ||
			(has && (fread(&back, sizeof back, 1, file) != 1 || back != vertex++)))
			return false;
	}
	return getc(file) == EOF && !ferror(file);
}

static bool verify_grid(
	const struct export_job *j, uint64_t points_end, const char *path, GError **error)
{
	const struct export_station *s = export_station_at(j, 0);
	g_autofree uint8_t *has_point = g_malloc0(s->cells / 8 + 1);
	if (!look_again(j, has_point, error))
		return false;
	FILE *file = fopen(path, "rbe");
	if (!file)
		return files_fail(error, path, "open"), false;
	bool good =
		fseeko(file, (off_t)points_end, SEEK_SET) == 0 && grid_is_back(file, s, has_point);
	fclose(file);
	return good || export_refuse_back(error, path, "its grid is not as it was written");
}

static bool verify(const struct export_job *j, const char *path, GError **error)
{
	struct export_table t = table_of(j);
	g_autofree char *header = header_of(j, &t);
	uint64_t points_end = strlen(header) + export_table_extent(j).points * t.record_bytes;
	return export_table_verify(j, &t, header, false, path, error) &&
	       (!j->one_grid || verify_grid(j, points_end, path, error));
}

static double resolution_m(const struct export_job *j)
{
	struct table_extent e = export_table_extent(j);
	return e.farthest_m > FLOATS_REACH_M ? 1e-8 : export_table_float_step_m(&e);
}

const struct export_format export_ply = { .name = "PLY",
	.extension = "ply",
	.merged = true,
	.keeps_one_grid = true,
	.has_map = true,
	.order = EXPORT_WALK_POINTS,
	.open = open_writer,
	.begin = begin_station,
	.write = write_points,
	.end = end_station,
	.finish = finish,
	.close = close_writer,
	.verify = verify,
	.resolution_m = resolution_m };
