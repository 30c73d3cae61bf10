#ifndef PROCESS_SCAN_GEOMETRY_H
#define PROCESS_SCAN_GEOMETRY_H
/* The geometry of each placed scan as a product of the site: SITE/geometry/0003.geometry (product.h), with one element per
 * cell of the scan's grid, or per point of a cloud:
 *
 *     normal       2 * int16, octahedral, in the scan's own frame (model_pack_normal)
 *     plane_error  float, m        curvature  float        point_size  float, m
 *
 * A cloud that a turning lidar made, and nobody moved since, is known by its rings (cloud.h): it was all seen from its origin. Grids by geometry_union with the scans of their group that stand near, at most GEOMETRY_NEIGHBOURS; scans that are not placed
 * alone; clouds by cloud.h. The manifest's "key" is a hash of all that went in: fingerprints of the scans, their poses relative
 * to this one (to half a millimetre and 2e-5), versions. It needs no points, so asking what is due is quick. */
#include "process/product.h"
#include "process/scan-graph.h"

#define SCAN_GEOMETRY_KIND    "geometry"
#define SCAN_GEOMETRY_VERSION 3
/* Further away scanners see little of the same, and not as well. */
#define GEOMETRY_NEIGHBOURS 6
#define GEOMETRY_REACH_M    40.0

typedef struct scan_geometry scan_geometry;
struct scan_geometry {
	product *file;
	uint64_t count;                                        /* cells, or points */
	const int16_t (*normal)[2];                            /* -32768 in both: none */
	const float *plane_error_m, *curvature, *point_size_m; /* NAN: none */
	uint32_t rings; /* of a cloud that was all seen from its origin; else 0 */
};
scan_geometry *scan_geometry_open(const site *s, uint32_t number, GError **error);
void scan_geometry_free(scan_geometry *g); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_geometry, scan_geometry_free)

struct geometry_site_options {
	bool (*progress)(
		double fraction, const char *doing, gpointer user_data); /* returns false to stop */
	gpointer user_data;
};
/* Makes what is missing or out of date, scan by scan, with a few grids in memory at a time (a fine one has 50 MB); each is whole on disk when the next begins. G_IO_ERROR_CANCELLED when
 * progress stopped it. */
bool geometry_site(site *s, const scan_graph *g, const struct geometry_site_options *options,
	uint32_t *ret_made, GError **error);
bool geometry_site_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error);

#endif
