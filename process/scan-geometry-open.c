#include "process/scan-geometry.h"
#include <json-glib/json-glib.h>

static char *path_of(const site *s, uint32_t number)
{
	return g_strdup_printf("%s/geometry/%04u.geometry", site_path(s), number);
}

static bool differs(const scan_geometry *g, GError **error)
{
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: its sections differ in length", product_path(g->file));
	return false;
}

static bool take_sections(scan_geometry *g, GError **error)
{
	uint64_t errors, curvatures, sizes;
	if (!(g->normal = product_section(g->file, "normal", 4, &g->count, error)) ||
		!(g->plane_error_m = product_section(g->file, "plane_error", 4, &errors, error)) ||
		!(g->curvature = product_section(g->file, "curvature", 4, &curvatures, error)) ||
		!(g->point_size_m = product_section(g->file, "point_size", 4, &sizes, error)))
		return false;
	return (errors == g->count && curvatures == g->count && sizes == g->count) ||
	       differs(g, error);
}

static uint32_t rings_of(const product *file)
{
	JsonNode *rings = json_object_get_member(product_manifest(file), "rings");
	return rings && JSON_NODE_HOLDS_VALUE(rings) ? (uint32_t)json_node_get_int(rings) : 0;
}

scan_geometry *scan_geometry_open(const site *s, uint32_t number, GError **error)
{
	g_autoptr(scan_geometry) g = g_new0(scan_geometry, 1);
	g_autofree char *path = path_of(s, number);
	g->file = product_open(path, SCAN_GEOMETRY_KIND, SCAN_GEOMETRY_VERSION, error);
	if (!g->file || !take_sections(g, error))
		return NULL;
	g->rings = rings_of(g->file);
	return g_steal_pointer(&g);
}

void scan_geometry_free(scan_geometry *g)
{
	if (!g)
		return;
	product_free(g->file);
	g_free(g);
}
