#ifndef PROCESS_COMPONENTS_H
#define PROCESS_COMPONENTS_H
/* Connected components of voxels (Wegen et al. 2024, section 4.1, as CloudCompare has them): what a gap separates, with two
 * parameters: the level of an octree around all points, whose cells are the smallest gap, and the least number of points; smaller
 * components are dropped. */
#include "process/voxels.h"
#include <glib.h>

struct component {
	uint32_t voxels, points;
	double centre_m[3], low_m[3], high_m[3];
	double covariance_m2[6]; /* of the voxels' points: xx xy xz yy yz zz */
};

typedef struct components components;
struct components {
	uint32_t count;
	struct component *component;
	uint32_t *of; /* component of each voxel; VOXEL_NONE: of none */
};
/* Over the voxels' links. kind: only voxels of the same kind belong together, a byte each, 0: left out; NULL: all. */
components *components_find(const voxels *v, const uint8_t *kind, uint32_t points_min);
void components_free(components *c); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(components, components_free)

/* Edge of an octree's cells at a level, the whole being a cube of this size; and the level whose cells are nearest to a gap. */
double octree_cell_m(double whole_m, unsigned level);
unsigned octree_level(double whole_m, double gap_m);

#endif
