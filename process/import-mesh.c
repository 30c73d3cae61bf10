/* Meshes, as OFF, OBJ, PLY with faces and STL: sampled to points, with what the surface does at each. */
#include "process/import-mesh.h"
#include "process/mesh-sample.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define BLOCK_RECORDS 32768u

struct mesh_reader {
	import_source *file;
	mesh *m;
	mesh_sample *sample;
	bool begun;
	struct surface_record *surface; /* of the records that were given last */
	GString *notes;
	struct import_scan scan;
};

static bool mesh_probe(const uint8_t *start, size_t length)
{
	return mesh_kind_of(start, length) != MESH_NONE;
}

/* Also of a binary STL that only its name tells, and whose length then must fit. */
static bool find_kind(import_source *file, enum mesh_kind *ret, GError **error)
{
	g_autofree uint8_t *start = g_malloc0(IMPORT_PROBE_BYTES + 1);
	size_t length;
	if (!import_source_read(file, 0, start, IMPORT_PROBE_BYTES, &length, error))
		return false;
	*ret = mesh_kind_of(start, length);
	if (*ret == MESH_NONE)
		*ret = MESH_STL;
	return true;
}

/* ---- into metres, z up ---- */

static void place(mesh *m, const struct import_mesh_options *o)
{
	double scale = o->metres_a_unit > 0 ? o->metres_a_unit : 1;
	for (uint32_t i = 0; i < m->vertices; i++) {
		double *at = m->at_m[i], y = at[1], z = at[2];
		at[1] = o->y_up ? -z : y;
		at[2] = o->y_up ? y : z;
		for (int k = 0; k < 3; k++)
			at[k] *= scale;
	}
}

static bool has_area(const mesh *m)
{
	double area = 0;
	for (uint32_t t = 0; t < m->triangles; t++)
		area += mesh_triangle_area_m2(m, t);
	return area > 0 && isfinite(area);
}

static void tell_sampling(struct mesh_reader *r, const struct import_mesh_options *o)
{
	double apart_m = mesh_sample_spacing_m(r->sample);
	g_string_append_printf(r->notes, "%u triangles were sampled ", r->m->triangles);
	if (o->uniform)
		g_string_append(r->notes, "by chance");
	else if (apart_m < 1)
		g_string_append_printf(r->notes, "%.3g mm apart", apart_m * 1000);
	else
		g_string_append_printf(r->notes, "%.3g m apart", apart_m);
}

static bool make_sample(struct mesh_reader *r, const struct import_mesh_options *o, GError **error)
{
	place(r->m, o);
	mesh_weld(r->m);
	if (!has_area(r->m))
		return import_refuse(
			error, r->file, G_IO_ERROR_INVALID_DATA, "its triangles have no area");
	mesh_curve(r->m);
	struct mesh_sampling how = { o->points, o->spacing_m, o->uniform };
	r->sample = mesh_sample_new(r->m, &how);
	if (r->notes->len)
		g_string_append(r->notes, "; ");
	tell_sampling(r, o);
	return true;
}

/* ---- the reader ---- */

static void mesh_close(import_reader *reader)
{
	struct mesh_reader *r = (struct mesh_reader *)reader;
	if (!r)
		return;
	mesh_sample_free(r->sample);
	mesh_free(r->m);
	g_free(r->surface);
	g_string_free(r->notes, true);
	g_free(r);
}

static import_reader *mesh_open(
	import_source *file, const struct import_options *options, GError **error)
{
	static const struct import_mesh_options usual;
	struct mesh_reader *r = g_new0(struct mesh_reader, 1);
	enum mesh_kind kind;
	r->file = file;
	r->notes = g_string_new(NULL);
	r->surface = g_new(struct surface_record, BLOCK_RECORDS);
	if (find_kind(file, &kind, error) && mesh_check(file, kind, error))
		r->m = mesh_load(file, kind, r->notes, error);
	if (r->m && make_sample(r, options ? &options->mesh : &usual, error))
		return (import_reader *)r;
	mesh_close((import_reader *)r);
	return NULL;
}

static enum import_result mesh_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct mesh_reader *r = (struct mesh_reader *)reader;
	(void)error;
	if (r->begun)
		return IMPORT_END;
	r->begun = true;
	r->scan = (struct import_scan){
		.count = mesh_sample_most(r->sample), .pose = POSE_IDENTITY, .note = r->notes->str
	};
	*ret = &r->scan;
	return IMPORT_SCAN;
}

/* The first vertex tells where a mesh on a map lies. */
static void take_origin_off(struct mesh_reader *r, struct point_record *p, size_t count)
{
	double *o = r->scan.origin_m;
	for (size_t i = 0; i < count; i++) {
		p[i].x_m -= o[0];
		p[i].y_m -= o[1];
		p[i].z_m -= o[2];
	}
}

static bool mesh_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	struct mesh_reader *r = (struct mesh_reader *)reader;
	const double *first = r->m->at_m[0];
	(void)error;
	bool local = fabs(first[0]) <= 1000 && fabs(first[1]) <= 1000 && fabs(first[2]) <= 1000;
	for (int k = 0; k < 3; k++)
		r->scan.origin_m[k] = local ? 0 : rint(first[k]);
	*ret_count = mesh_sample_next(r->sample, into, r->surface, MIN(max, BLOCK_RECORDS));
	take_origin_off(r, into, *ret_count);
	return true;
}

static const struct surface_record *mesh_surface(const import_reader *reader)
{
	return ((const struct mesh_reader *)reader)->surface;
}

static double mesh_fraction(const import_reader *reader)
{
	return mesh_sample_fraction(((const struct mesh_reader *)reader)->sample);
}

const struct import_format import_mesh = { "mesh", "off obj stl", mesh_probe, mesh_open,
	mesh_next_scan, mesh_read, mesh_fraction, mesh_close, .surface = mesh_surface };
