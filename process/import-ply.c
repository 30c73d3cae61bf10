#include "process/import-ply.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

/* Of the element camera, as PCL writes it. */
static const char *const camera_names[] = { "view_px", "view_py", "view_pz", "x_axisx", "x_axisy",
	"x_axisz", "y_axisx", "y_axisy", "y_axisz", "z_axisx", "z_axisy", "z_axisz", "viewportx",
	"viewporty" };
enum { CAMERA_POSITION = 0, CAMERA_AXES = 3, CAMERA_COLUMNS = 12, CAMERA_ROWS, CAMERA_NUMBERS };

struct ply {
	import_source *file;
	struct ply_header header;
	import_cloud *cloud;
	int vertex, range_grid, camera; /* elements; -1: none */
	enum cloud_role *role;          /* a property of vertex */
	double camera_value[CAMERA_NUMBERS];
	GArray *cells; /* of int64_t: the point of each cell of the grid, -1 none */
	bool begun;
};

static const struct ply_element *element(const struct ply *r, int i)
{
	return &g_array_index(r->header.elements, struct ply_element, i);
}

static const struct ply_property *property(const struct ply_element *e, guint i)
{
	return &g_array_index(e->properties, struct ply_property, i);
}

static int find_element(const struct ply *r, const char *name)
{
	for (guint i = 0; i < r->header.elements->len; i++)
		if (!strcmp(element(r, (int)i)->name, name))
			return (int)i;
	return -1;
}

/* ---- elements ---- */

static bool take_vertex(struct ply *r, const double *values)
{
	double value[CLOUD_ROLES];
	for (guint i = 0; i < element(r, r->vertex)->properties->len; i++)
		value[r->role[i]] = values[i];
	import_cloud_add(r->cloud, value);
	return true;
}

static void take_camera(struct ply *r, const double *values)
{
	const struct ply_element *e = element(r, r->camera);
	for (guint i = 0; i < e->properties->len; i++)
		for (int k = 0; k < CAMERA_NUMBERS; k++)
			if (!strcmp(property(e, i)->name, camera_names[k]))
				r->camera_value[k] = values[i];
}

static bool take_row(gpointer user_data, uint32_t i, const double *values)
{
	struct ply *r = user_data;
	if ((int)i == r->vertex)
		return take_vertex(r, values);
	if ((int)i == r->camera)
		take_camera(r, values);
	if ((int)i == r->range_grid) {
		double first = values[0];
		int64_t cell = first >= 0 && first < 9e15 ? (int64_t)first : -1;
		g_array_append_val(r->cells, cell);
	}
	/* What follows the last of these need not be read. */
	return (int)i <= MAX(MAX(r->vertex, r->camera), r->range_grid);
}

/* ---- text ---- */

static bool read_list(
	struct import_text *t, const struct ply_property *p, double *ret, GError **error)
{
	double length, unused;
	*ret = NAN;
	if (!import_text_number(t, p->size_type, &length, error))
		return false;
	for (double i = 0; i < length; i++)
		if (!import_text_number(t, p->type, i == 0 ? ret : &unused, error))
			return false;
	return true;
}

static bool read_line(
	struct import_text *t, const struct ply_element *e, double *values, GError **error)
{
	for (guint i = 0; i < e->properties->len; i++) {
		const struct ply_property *p = property(e, i);
		bool whole = cloud_role_of(p->name) == CLOUD_RGB && p->type == CLOUD_F32;
		if (!(p->is_list ? read_list(t, p, &values[i], error)
				 : import_text_number(t, p->type, &values[i], error)))
			return false;
		float bits = (float)values[i];
		if (whole)
			values[i] = cloud_role_get(CLOUD_RGB, CLOUD_F32, &bits);
	}
	return import_text_end_line(t, error);
}

static bool read_elements(struct ply *r, struct import_text *t, GError **error)
{
	for (guint i = 0; i < r->header.elements->len; i++) {
		const struct ply_element *e = element(r, (int)i);
		g_autofree double *values = g_new(double, e->properties->len + 1);
		for (uint64_t k = 0; k < e->count; k++) {
			if (t->at >= t->end)
				return import_text_refuse(t, error,
					"the file ends here, after %" G_GUINT64_FORMAT
					" of %" G_GUINT64_FORMAT " elements '%s'",
					k, e->count, e->name);
			if (!read_line(t, e, values, error))
				return false;
			take_row(r, i, values);
		}
	}
	return t->at >= t->end || import_text_refuse(t, error, "here the file should end");
}

static bool read_text(struct ply *r, GError **error)
{
	size_t length;
	g_autofree uint8_t *bytes = import_load(r->file, r->header.bytes, &length, error);
	if (!bytes)
		return false;
	const char *start = (const char *)bytes;
	struct import_text t = { r->file, start, start + length, r->header.lines + 1 };
	while (*t.at == '\n' || *t.at == '\r')
		t.line += *t.at++ == '\n';
	return read_elements(r, &t, error);
}

static bool read_binary(struct ply *r, GError **error)
{
	g_autoptr(GError) pcl = NULL;
	const char *name = import_source_name_for_library(r->file, error);
	if (!name)
		return false;
	if (ply_read_binary(name, &r->header, take_row, r, &pcl))
		return true;
	return import_refuse(error, r->file, pcl->code, "%s", pcl->message);
}

/* ---- what it is ---- */

static bool set_columns(struct ply *r, GError **error)
{
	const struct ply_element *e = element(r, r->vertex);
	r->role = g_new0(enum cloud_role, e->properties->len + 1);
	for (guint i = 0; i < e->properties->len; i++) {
		const struct ply_property *p = property(e, i);
		r->role[i] = p->is_list ? CLOUD_NONE : cloud_role_of(p->name);
		if (r->role[i] == CLOUD_CELL && !(r->header.columns && r->header.rows))
			r->role[i] = CLOUD_NONE;
		if (!import_cloud_column(r->cloud, r->role[i], p->type, p->name, error))
			return false;
	}
	uint64_t text = r->header.encoding == PLY_TEXT ? import_source_size(r->file) : 0,
		 cells = r->range_grid < 0 ? 0 : element(r, r->range_grid)->count;
	return import_cloud_reserve(r->cloud, e->count, text + cells * 64, error);
}

static bool camera_pose(const struct ply *r, struct pose *ret)
{
	const double *v = r->camera_value;
	for (int i = 0; i < 3; i++) {
		ret->translation_m[i] = v[CAMERA_POSITION + i];
		for (int k = 0; k < 3; k++)
			ret->rotation[i][k] = v[CAMERA_AXES + 3 * k + i];
	}
	if (!pose_is_rigid(ret, 1e-4))
		return false;
	pose_orthonormalise(ret);
	return true;
}

/* obj_info is the older way, the camera PCL's; range_grid says which cells have a point. */
static bool set_grid(struct ply *r, GError **error)
{
	double columns = r->header.columns, rows = r->header.rows;
	uint64_t vertices = element(r, r->vertex)->count;
	struct pose pose;
	if (r->camera >= 0 && camera_pose(r, &pose))
		import_cloud_set_pose(r->cloud, &pose);
	if (!(columns && rows) && r->camera >= 0) {
		columns = r->camera_value[CAMERA_COLUMNS];
		rows = r->camera_value[CAMERA_ROWS];
	}
	if (!(columns > 1 && rows > 1 && columns <= G_MAXINT32 && rows <= G_MAXINT32))
		return true;
	if (r->cells->len && columns * rows == r->cells->len)
		return import_cloud_spread(r->cloud, (const int64_t *)(gpointer)r->cells->data,
			(uint32_t)columns, (uint32_t)rows, error);
	if (columns * rows == (double)vertices)
		import_cloud_set_grid(r->cloud, (uint32_t)columns, (uint32_t)rows);
	return true;
}

static enum import_result ply_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct ply *r = (struct ply *)reader;
	if (r->begun)
		return IMPORT_END;
	r->begun = true;
	if (!(r->header.encoding == PLY_TEXT ? read_text : read_binary)(r, error) ||
		!set_grid(r, error) || !import_cloud_finish(r->cloud, error))
		return IMPORT_BAD;
	*ret = import_cloud_scan(r->cloud);
	return IMPORT_SCAN;
}

/* ---- the format ---- */

static bool ply_probe(const uint8_t *start, size_t length)
{
	return length >= 4 && memcmp(start, "ply", 3) == 0 &&
	       (start[3] == '\n' || start[3] == '\r');
}

static void ply_close(import_reader *reader)
{
	struct ply *r = (struct ply *)reader;
	if (!r)
		return;
	ply_header_clear(&r->header);
	import_cloud_free(r->cloud);
	g_free(r->role);
	g_array_unref(r->cells);
	g_free(r);
}

static bool open_elements(struct ply *r, GError **error)
{
	if (!ply_header_read(r->file, &r->header, error))
		return false;
	r->vertex = find_element(r, "vertex");
	r->camera = find_element(r, "camera");
	r->range_grid = find_element(r, "range_grid");
	if (r->range_grid >= 0 && !element(r, r->range_grid)->properties->len)
		r->range_grid = -1;
	if (r->vertex < 0)
		return import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA,
			"its header tells of no element 'vertex'");
	return set_columns(r, error);
}

static import_reader *ply_open(
	import_source *file, const struct import_options *options, GError **error)
{
	(void)options;
	struct ply *r = g_new0(struct ply, 1);
	r->file = file;
	r->cloud = import_cloud_new(file);
	r->cells = g_array_new(false, false, sizeof(int64_t));
	if (open_elements(r, error))
		return (import_reader *)r;
	ply_close((import_reader *)r);
	return NULL;
}

static bool ply_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	(void)error;
	*ret_count = import_cloud_read(((struct ply *)reader)->cloud, into, max);
	return true;
}

static double ply_fraction(const import_reader *reader)
{
	return import_cloud_fraction(((const struct ply *)reader)->cloud);
}

const struct import_format import_ply = { "PLY", "ply", ply_probe, ply_open, ply_next_scan,
	ply_read, ply_fraction, ply_close };
