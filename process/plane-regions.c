#include "process/plane-regions.h"
#include "process/plane-find.h"
#include <json-glib/json-glib.h>
#include <math.h>

void plane_regions_free(plane_regions *r)
{
	if (!r)
		return;
	if (!r->file) {
		g_free((void *)r->region);
		g_free((void *)r->ring);
		g_free((void *)r->vertex);
		g_free((void *)r->texel);
		g_free((void *)r->explained);
	}
	product_free(r->file);
	g_free(r);
}

char *plane_regions_path(const char *site_path)
{
	return g_build_filename(site_path, "model", "planes.regions", NULL);
}

static bool write_all(product_writer *w, const char *name, uint32_t bytes, const void *from,
	uint64_t count, GError **error)
{
	return product_writer_begin(w, name, bytes, error) &&
	       product_writer_append(w, from, count, error);
}

bool plane_regions_save(const plane_regions *r, const model *of, const char *path, GError **error)
{
	g_autoptr(product_writer) w = product_writer_new(path, error);
	if (!w || !write_all(w, "regions", sizeof *r->region, r->region, r->count, error) ||
		!write_all(w, "rings", sizeof *r->ring, r->ring, r->rings, error) ||
		!write_all(w, "vertices", sizeof *r->vertex, r->vertex, r->vertices, error) ||
		!write_all(w, "texels", sizeof *r->texel, r->texel, r->texels, error) ||
		!write_all(w, "explained", 1, r->explained, (r->points + 7) / 8, error))
		return false;
	JsonObject *made = json_object_new();
	json_object_set_int_member(made, "points", (gint64)r->points);
	json_object_set_int_member(made, "model_checksum", product_checksum(model_file(of)));
	json_object_set_int_member(made, "classes", r->classes);
	return product_writer_finish(w, PLANE_REGIONS_KIND, PLANE_REGIONS_VERSION, made, error);
}

/* ---- reading ---- */

static bool damaged(const plane_regions *r, uint32_t region, const char *what, GError **error)
{
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED, "%s: plane %u: %s",
		product_path(r->file), region, what);
	return false;
}

static bool is_unit(const float v[3])
{
	return fabsf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - 1) < 1e-3f;
}

static bool check_place(const plane_regions *r, uint32_t n, GError **error)
{
	const struct plane_region *p = &r->region[n];
	bool good = is_unit(p->u) && is_unit(p->v) && is_unit(p->normal) && p->texel_m > 0 &&
		    isfinite(p->texel_m) && p->thickness_m >= 0 && isfinite(p->thickness_m) &&
		    isfinite(p->low_m[0]) && isfinite(p->low_m[1]);
	for (int k = 0; k < 3; k++)
		good &= isfinite(p->origin_m[k]) != 0;
	return good || damaged(r, n, "it lies nowhere", error);
}

static bool check_region(
	const plane_regions *r, uint32_t n, uint32_t ring, uint64_t texel, GError **error)
{
	const struct plane_region *p = &r->region[n];
	if (p->first_ring != ring || p->rings < 1 || p->rings > r->rings - ring)
		return damaged(r, n, "its rings are not those after the plane before", error);
	if (p->first_texel != texel || !p->width || !p->height ||
		(uint64_t)p->width * p->height > r->texels - texel)
		return damaged(r, n, "its texels are not those after the plane before", error);
	if (p->leaf > UINT16_MAX)
		return damaged(r, n, "no tree of segments has its leaf", error);
	return check_place(r, n, error);
}

static bool check_rings(const plane_regions *r, GError **error)
{
	uint32_t vertex = 0;
	for (uint32_t n = 0; n < r->rings; n++) {
		if (r->ring[n].first != vertex || r->ring[n].count < 3 ||
			r->ring[n].count > r->vertices - vertex)
			return damaged(
				r, n, "a ring has not the vertices after that before", error);
		vertex += r->ring[n].count;
	}
	for (uint32_t n = 0; n < r->vertices; n++)
		if (!isfinite(r->vertex[n][0]) || !isfinite(r->vertex[n][1]))
			return damaged(r, 0, "a vertex lies nowhere", error);
	return vertex == r->vertices || damaged(r, r->count, "vertices are left over", error);
}

static bool check(const plane_regions *r, GError **error)
{
	uint32_t ring = 0;
	uint64_t texel = 0;
	for (uint32_t n = 0; n < r->count; n++) {
		if (!check_region(r, n, ring, texel, error))
			return false;
		ring += r->region[n].rings;
		texel += (uint64_t)r->region[n].width * r->region[n].height;
	}
	if (ring != r->rings || texel != r->texels)
		return damaged(r, r->count, "rings or texels are left over", error);
	return check_rings(r, error);
}

static bool find_sections(plane_regions *r, GError **error)
{
	uint64_t count, rings, vertices, bytes;
	gint64 points =
		json_object_get_int_member_with_default(product_manifest(r->file), "points", -1);
	if (!(r->region = product_section(r->file, "regions", sizeof *r->region, &count, error)) ||
		!(r->ring = product_section(r->file, "rings", sizeof *r->ring, &rings, error)) ||
		!(r->vertex = product_section(
			  r->file, "vertices", sizeof *r->vertex, &vertices, error)) ||
		!(r->texel = product_section(
			  r->file, "texels", sizeof *r->texel, &r->texels, error)) ||
		!(r->explained = product_section(r->file, "explained", 1, &bytes, error)))
		return false;
	if (points < 0 || bytes != ((uint64_t)points + 7) / 8 || count > INT32_MAX ||
		rings > INT32_MAX || vertices > INT32_MAX)
		return damaged(r, 0, "it is of another number of points than it says", error);
	r->count = (uint32_t)count;
	r->rings = (uint32_t)rings;
	r->vertices = (uint32_t)vertices;
	r->points = (uint64_t)points;
	r->classes = (uint32_t)json_object_get_int_member_with_default(
		product_manifest(r->file), "classes", 0);
	return true;
}

plane_regions *plane_regions_open(const char *path, GError **error)
{
	g_autoptr(plane_regions) r = g_new0(plane_regions, 1);
	r->file = product_open(path, PLANE_REGIONS_KIND, PLANE_REGIONS_VERSION, error);
	if (!r->file || !find_sections(r, error) || !check(r, error))
		return NULL;
	return g_steal_pointer(&r);
}

bool plane_regions_are_of(const plane_regions *r, const model *m)
{
	return r->file && r->points == model_count(m) &&
	       json_object_get_int_member_with_default(product_manifest(r->file), "model_checksum",
		       -1) == product_checksum(model_file(m));
}
