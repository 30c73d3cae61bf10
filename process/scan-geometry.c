#include "process/scan-geometry.h"
#include "acquire/surface.h"
#include "firmware-io/files.h"
#include "process/cloud.h"
#include "process/geometry.h"
#include "process/model.h"
#include "process/scan-cache.h"
#include "process/scan-sources.h"
#include <json-glib/json-glib.h>
#include <string.h>

/* Grids that stay in memory: the scan itself and the neighbours of the scans next to it are mostly the same. */
#define CACHED         4
#define PACKED_AT_ONCE 65536u

static char *path_of(const site *s, uint32_t number)
{
	return g_strdup_printf("%s/geometry/%04u.geometry", site_path(s), number);
}

/* ---- what goes into each ---- */

static GArray *find_sources(const site *s, const scan_graph *graph, GError **error)
{
	_Static_assert(GEOMETRY_NEIGHBOURS <= SCAN_SOURCE_NEIGHBOURS, "a source has room for them");
	g_autofree char *method =
		g_strdup_printf("%s %d", SCAN_GEOMETRY_KIND, SCAN_GEOMETRY_VERSION);
	struct scan_sources_desc desc = { GEOMETRY_NEIGHBOURS, GEOMETRY_REACH_M, method, NULL };
	return scan_sources_find(s, graph, &desc, error);
}

/* Why it must be made; NULL: it need not. What cannot be read is made again. */
static const char *why_due(const site *s, const struct scan_source *source)
{
	g_autofree char *path = path_of(s, source->number);
	if (!g_file_test(path, G_FILE_TEST_EXISTS))
		return "has no normals";
	g_autoptr(scan_geometry) g = scan_geometry_open(s, source->number, NULL);
	if (!g)
		return "has normals that cannot be read";
	JsonNode *key = json_object_get_member(product_manifest(g->file), "key");
	bool same = key && JSON_NODE_HOLDS_VALUE(key) &&
		    g_strcmp0(json_node_get_string(key), source->key) == 0;
	return same ? NULL : "or where it stands has changed";
}

bool geometry_site_is_due(
	const site *s, const scan_graph *graph, bool *ret_due, char **ret_why, GError **error)
{
	return scan_sources_is_due(s, find_sources(s, graph, error), why_due, ret_due, ret_why);
}

/* ---- making them ---- */

struct box {
	double low_m[3], high_m[3];
};

struct maker {
	site *site;
	GArray *sources;
	const struct geometry_site_options *options;
	scan_cache *cache;
	uint32_t due, made;
	uint32_t number;
};

/* Where its points are, in the site; every 16th is enough for that. */
static struct box box_of(const range_grid *g, const struct pose *pose)
{
	struct box b = { { G_MAXDOUBLE, G_MAXDOUBLE, G_MAXDOUBLE },
		{ -G_MAXDOUBLE, -G_MAXDOUBLE, -G_MAXDOUBLE } };
	for (size_t i = 0; i < range_grid_cells(g); i += 16) {
		double point[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		if (!(g->range_m[i] > 0))
			continue;
		pose_apply(pose, point, point);
		for (int k = 0; k < 3; k++) {
			b.low_m[k] = fmin(b.low_m[k], point[k]);
			b.high_m[k] = fmax(b.high_m[k], point[k]);
		}
	}
	return b;
}

static bool boxes_meet(const struct box *a, const struct box *b)
{
	for (int k = 0; k < 3; k++)
		if (a->low_m[k] > b->high_m[k] || b->low_m[k] > a->high_m[k])
			return false;
	return true;
}

static bool go_on(struct maker *m, double fraction, GError **error)
{
	g_autofree char *doing = g_strdup_printf("normals of scan %u", m->number);
	double done = m->due ? (m->made + fraction) / m->due : 1;
	if (!m->options || !m->options->progress ||
		m->options->progress(done, doing, m->options->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped at the normals of scan %u",
		m->number);
	return false;
}

static geometry *fit_grid(
	struct maker *m, const struct scan_source *s, const range_grid *grid, GError **error)
{
	struct posed_grid of = { .grid = grid, .pose = s->pose };
	if (!s->neighbour_count)
		return geometry_estimate(grid, NULL);
	struct box box = box_of(grid, &s->pose);
	g_autoptr(geometry_union) all = geometry_union_new(&of, NULL);
	for (uint32_t i = 0; i < s->neighbour_count; i++) {
		const struct scan_source *other = scan_sources_at(m->sources, s->neighbours[i]);
		if (!go_on(m, (i + 1.0) / (s->neighbour_count + 2.0), error))
			return NULL;
		const scan_data *d = scan_cache_load(m->cache, other->number, error);
		if (!d || !scan_cache_load(m->cache, s->number,
				  error)) /* which keeps the scan itself in the cache */
			return NULL;
		struct box there = box_of(d->grid, &other->pose);
		struct posed_grid scan = { .grid = d->grid, .pose = other->pose };
		if (boxes_meet(&box, &there))
			geometry_union_add(all, &scan);
	}
	return geometry_union_finish(all);
}

struct planes {
	uint64_t count;
	const float *normal[3]; /* planes, or stride apart */
	size_t stride;
	const float *plane_error_m, *curvature, *point_size_m;
	uint32_t rings;
};

static bool write_normals(product_writer *w, const struct planes *p, GError **error)
{
	g_autofree int16_t(*packed)[2] = g_malloc(PACKED_AT_ONCE * sizeof *packed);
	if (!product_writer_begin(w, "normal", sizeof *packed, error))
		return false;
	for (uint64_t from = 0; from < p->count; from += PACKED_AT_ONCE) {
		uint64_t n = MIN(p->count - from, PACKED_AT_ONCE);
		for (uint64_t i = 0; i < n; i++) {
			size_t at = (from + i) * p->stride;
			float normal[3] = { p->normal[0][at], p->normal[1][at], p->normal[2][at] };
			bool none = normal[0] == 0 && normal[1] == 0 && normal[2] == 0;
			packed[i][0] = packed[i][1] = -32768;
			if (!none)
				model_pack_normal(normal, packed[i]);
		}
		if (!product_writer_append(w, packed, n, error))
			return false;
	}
	return true;
}

static bool write_floats(
	product_writer *w, const char *name, const float *values, uint64_t count, GError **error)
{
	return product_writer_begin(w, name, sizeof *values, error) &&
	       product_writer_append(w, values, count, error);
}

static bool write_file(
	struct maker *m, const struct scan_source *s, const struct planes *p, GError **error)
{
	g_autofree char *path = path_of(m->site, s->number);
	g_autoptr(product_writer) w = product_writer_new(path, error);
	if (!w || !write_normals(w, p, error) ||
		!write_floats(w, "plane_error", p->plane_error_m, p->count, error) ||
		!write_floats(w, "curvature", p->curvature, p->count, error) ||
		!write_floats(w, "point_size", p->point_size_m, p->count, error))
		return false;
	JsonObject *made_from = json_object_new();
	JsonArray *with = json_array_new();
	for (uint32_t i = 0; i < s->neighbour_count; i++)
		json_array_add_int_element(
			with, scan_sources_at(m->sources, s->neighbours[i])->number);
	json_object_set_int_member(made_from, "scan", s->number);
	json_object_set_array_member(made_from, "with", with);
	json_object_set_string_member(made_from, "key", s->key);
	if (p->rings)
		json_object_set_int_member(made_from, "rings", p->rings);
	return product_writer_finish(
		w, SCAN_GEOMETRY_KIND, SCAN_GEOMETRY_VERSION, made_from, error);
}

static bool make_grid(
	struct maker *m, const struct scan_source *s, const range_grid *grid, GError **error)
{
	g_autoptr(geometry) g = fit_grid(m, s, grid, error);
	if (!g)
		return false;
	size_t cells = range_grid_cells(grid);
	g_autofree float *size_m = g_new(float, cells);
	for (size_t i = 0; i < cells; i++)
		size_m[i] = grid->range_m[i] > 0 ? range_grid_point_size_m(grid, i) : NAN;
	struct planes p = { cells, { g->normal_x, g->normal_y, g->normal_z }, 1, g->plane_error_m,
		g->curvature, size_m, 0 };
	return write_file(m, s, &p, error);
}

static bool cloud_progress(double fraction, gpointer user_data)
{
	return go_on(user_data, fraction, NULL);
}

/* Those of the file, where it told more than points. */
static bool take_normals(
	const site *of, uint32_t number, const points *cloud, cloud_geometry *g, GError **error)
{
	g_autoptr(scan_surface) known = NULL;
	if (!surface_open_of_scan(of, number, cloud->count, &known, error))
		return false;
	for (uint64_t i = 0; known && i < known->count; i++)
		if (known->record[i].normal[0] != 0 || known->record[i].normal[1] != 0 ||
			known->record[i].normal[2] != 0)
			memcpy(g->normal[i], known->record[i].normal, sizeof g->normal[i]);
	return true;
}

/* Rings are farther apart than the points on them, which the nearest neighbours alone are of: patches reach to the next ring, but no
 * farther than so many times. */
#define RING_REACH 3.f

static void reach_rings(
	cloud_geometry *g, const points *cloud, const double *elevation_rad, uint32_t rings)
{
	for (uint64_t i = 0; i < g->count; i++) {
		const struct point_record *r = &cloud->record[i];
		double level_m = hypot(r->x_m, r->y_m),
		       height_m = hypot(level_m, r->z_m) * cloud_ring_height_rad(elevation_rad,
								   rings, atan2(r->z_m, level_m));
		float *size_m = &g->point_size_m[i];
		*size_m = fmaxf(*size_m, fminf((float)height_m, RING_REACH * *size_m));
	}
}

static bool make_cloud(
	struct maker *m, const struct scan_source *s, const points *cloud, GError **error)
{
	struct cloud_view v = cloud_view_of(cloud);
	g_autofree double *elevation_rad = NULL;
	uint32_t rings = 0;
	v.has_viewpoint = cloud_find_rings(&v, &elevation_rad, &rings);
	struct cloud_geometry_options options = { .progress = cloud_progress, .user_data = m };
	g_autoptr(cloud_geometry) g = cloud_geometry_estimate(&v, &options, error);
	if (!g)
		return false;
	if (!take_normals(m->site, s->number, cloud, g, error))
		return false;
	if (rings)
		reach_rings(g, cloud, elevation_rad, rings);
	const float *first = (const float *)g->normal;
	struct planes p = { g->count, { first, first + 1, first + 2 }, 3, g->plane_error_m,
		g->curvature, g->point_size_m, rings };
	return write_file(m, s, &p, error);
}

static bool make(struct maker *m, const struct scan_source *s, GError **error)
{
	m->number = s->number;
	if (!go_on(m, 0, error))
		return false;
	const scan_data *d = scan_cache_load(m->cache, s->number, error);
	return d && (d->kind == SCAN_CLOUD ? make_cloud(m, s, d->points, error)
					   : make_grid(m, s, d->grid, error));
}

bool geometry_site(site *s, const scan_graph *graph, const struct geometry_site_options *options,
	uint32_t *ret_made, GError **error)
{
	g_autoptr(GArray) sources = find_sources(s, graph, error);
	g_autoptr(scan_cache) cache = scan_cache_new(s, CACHED);
	g_autofree char *folder = g_build_filename(site_path(s), "geometry", NULL);
	if (ret_made)
		*ret_made = 0;
	if (!sources || !files_make_folder(folder, error))
		return false;
	struct maker m = { .site = s, .sources = sources, .options = options, .cache = cache };
	g_autofree bool *due = g_new0(bool, sources->len + 1);
	for (guint i = 0; i < sources->len; i++)
		m.due += due[i] = why_due(s, scan_sources_at(sources, i));
	for (guint i = 0; i < sources->len; i++) {
		if (!due[i])
			continue;
		if (!make(&m, scan_sources_at(sources, i), error))
			return false;
		m.made++;
		if (ret_made)
			*ret_made = m.made;
	}
	return true;
}
