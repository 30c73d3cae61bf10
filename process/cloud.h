#ifndef PROCESS_CLOUD_H
#define PROCESS_CLOUD_H
/* Points without a grid: what the surface does at each (Xu & Chen 2004, section 5.1), from its nearest neighbours by PCL's
 * kd-tree. Clouds are taken in blocks of a few hundred thousand points, each with what stands around it, so that beside the
 * points and the result little memory is needed, however large the cloud is. */
#include "acquire/points.h"
#include "process/range-grid.h"
#include <glib.h>

/* Points as they lie in someone's memory: x, y, z as doubles in m, at every stride bytes from first. Must stay. */
struct cloud_view {
	const void *first;
	size_t count, stride; /* stride 0: 24 bytes */
	bool has_viewpoint;   /* all points were seen from one place */
	double viewpoint_m[3];
};
struct cloud_view cloud_view_of(
	const points *p); /* all records; a cloud has no cells without a point */
static inline const void *cloud_view_at(const struct cloud_view *v, size_t i)
{
	return (const char *)v->first + i * (v->stride ? v->stride : 3 * sizeof(double));
}

typedef struct cloud_geometry cloud_geometry;
struct cloud_geometry {
	uint64_t count;
	/* Unit; 0 0 0 where all neighbours are at one place. Towards the viewpoint where there is one. Else up; where the
	 * surface is upright, to the side where things are lower: out of a house, from above a bank. Next to a crease it is of the
	 * point's own face, where a plane beside it tells which. */
	float (*normal)[3];
	float *plane_error_m; /* root mean square distance of the neighbours from the plane; NAN: no normal */
	float *curvature; /* smallest eigenvalue over the sum of all three, 0..1/3; NAN: no normal */
	float *point_size_m; /* diameter of the patch that it stands for, by the distance of its 8th neighbour; NAN: none */
};
void cloud_geometry_free(cloud_geometry *g); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(cloud_geometry, cloud_geometry_free)

struct cloud_geometry_options {
	float radius_m; /* 0: 0.06. Where points are dense, neighbours up to here are taken, and no nearer ones alone */
	uint32_t block_points; /* 0: 400,000 */
	bool single_thread;
	bool (*progress)(
		double fraction, gpointer user_data); /* returns false to stop; may be NULL */
	gpointer user_data;
};
/* G_IO_ERROR_INVALID_DATA for points that are not finite, G_IO_ERROR_CANCELLED when stopped. */
cloud_geometry *cloud_geometry_estimate(
	const struct cloud_view *v, const struct cloud_geometry_options *options, GError **error);

/* Whether the points are those of a lidar whose mirror or head turns, at the origin: they stand on rings of equal elevation,
 * which only a place from where all of them were seen gives. Never says yes to anything else; may say no to such a sweep, as
 * when it was moved on the way. Sets *ret_elevation_rad to the rings from the highest on; caller frees. */
bool cloud_find_rings(const struct cloud_view *v, double **ret_elevation_rad, uint32_t *ret_rings);
/* Half the angle between the rings beside the one that is nearest to an elevation: so high is what a point of it stands for. */
double cloud_ring_height_rad(const double *elevation_rad, uint32_t rings, double at_rad);
/* A cloud with such rings as a grid of one row a ring, so that free space can be told from it. *ret_index: per cell the point,
 * RANGE_GRID_NONE where there is none; NULL or caller frees. NULL: it has no rings. */
range_grid *cloud_range_grid(const struct cloud_view *v, uint32_t **ret_index);

#endif
