#include "acquire/imported.h"
#include "acquire/points.h"
#include "acquire/scan-manifest.h"
#include "acquire/scan.h"
#include <math.h>
#include <string.h>

static manifest *load(const site *s, uint32_t number, char **ret_folder, GError **error)
{
	*ret_folder = site_scan_path(s, number);
	g_autofree char *path = g_build_filename(*ret_folder, "scan.json", NULL);
	return manifest_load(path, SCAN_SCHEMA, error);
}

bool imported_is(const site *s, uint32_t number, bool *ret, GError **error)
{
	g_autofree char *folder = NULL;
	g_autoptr(manifest) m = load(s, number, &folder, error);
	*ret = m && manifest_has(m, "kind") &&
	       g_strcmp0(manifest_get_string(m, "kind", NULL), "imported") == 0;
	return m;
}

static void fill(panorama *p, const points *from)
{
	if (from->have & POINTS_HAVE_COLOUR)
		p->rgb = g_malloc0(3 * from->count);
	for (uint64_t i = 0; i < from->count; i++) {
		const struct point_record *r = &from->record[i];
		p->cell[i] = r->cell;
		if (r->cell != CELL_MEASURED)
			continue;
		p->range_m[i] = (float)sqrt(r->x_m * r->x_m + r->y_m * r->y_m + r->z_m * r->z_m);
		p->intensity[i] = r->intensity;
		if (p->rgb)
			memcpy(p->rgb + 3 * i, r->rgb, 3);
	}
}

bool imported_panorama(const site *s, uint32_t number, panorama **ret, GError **error)
{
	g_autofree char *folder = NULL;
	g_autoptr(manifest) m = load(s, number, &folder, error);
	*ret = NULL;
	if (!m || !scan_manifest_verify_file(m, folder, "points.ply", error))
		return false;
	g_autofree char *path = g_build_filename(folder, "points.ply", NULL);
	g_autoptr(points) p = points_open(path, error);
	if (!p)
		return false;
	struct panorama_desc desc = { p->columns, p->rows, -G_PI_2, G_PI_2 };
	*ret = p->columns ? panorama_new(&desc, NULL) : NULL;
	if (*ret)
		fill(*ret, p);
	return true;
}
