#ifndef PROCESS_GEOMETRY_H
#define PROCESS_GEOMETRY_H
/* What the surface does at each point (Xu & Chen 2004, section 5.1): the plane that fits the points around it best, the error
 * of that fit, curvature. Planes of cells like those of the range grid that they were made from. */
#include "process/range-grid.h"

#define GEOMETRY_RADIUS_M 0.06f

typedef struct geometry geometry;
struct geometry {
	uint32_t columns, rows;
	float *normal_x, *normal_y,
		*normal_z; /* scanner frame, unit, towards the scanner; 0 0 0: none */
	float *plane_error_m; /* root mean square distance of the neighbours from the plane; NAN: none */
	float *curvature; /* smallest eigenvalue over the sum of all three, 0..1/3; NAN: none */
};

void geometry_free(geometry *g); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(geometry, geometry_free)

struct geometry_options {
	float radius_m;      /* 0: 0.06 m; of the metric window, widened where beams are sparser */
	float range_noise_m; /* 0: 0.012; 1 sigma of a range */
	bool single_thread;
};

/* From one scan alone. */
geometry *geometry_estimate(const range_grid *g, const struct geometry_options *options);

/* One of the scans of a site. */
struct posed_grid {
	const range_grid *grid;
	struct pose pose; /* scanner frame to site */
	const uint32_t *
		segment; /* leaf of each cell, 0: not known; neighbours of another known leaf are left out; NULL */
};
/* With the neighbourhoods in other scans: each point is projected into them, and where the window there lies on the same
 * surface, both are fitted together, one plane to all (Xu & Chen 2004, section 5.1). Grids are needed one other at a time;
 * they and segments must stay while they are used. Of a fine scan it takes 0.3 GB beside the grids. */
typedef struct geometry_union geometry_union;
geometry_union *geometry_union_new(
	const struct posed_grid *of, const struct geometry_options *options);
void geometry_union_add(geometry_union *u, const struct posed_grid *other);
geometry *geometry_union_finish(geometry_union *u); /* u can only be freed then */
void geometry_union_free(geometry_union *u);        /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(geometry_union, geometry_union_free)

/* Of scans[which], with the union of the neighbourhoods in all scans. progress may be NULL; it returns false to stop, and
 * NULL is returned then. */
geometry *geometry_estimate_union(const struct posed_grid *scans, size_t count, size_t which,
	const struct geometry_options *options,
	bool (*progress)(double fraction, gpointer user_data), gpointer user_data);

#endif
