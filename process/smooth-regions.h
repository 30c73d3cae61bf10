#ifndef PROCESS_SMOOTH_REGIONS_H
#define PROCESS_SMOOTH_REGIONS_H
/* Voxels that lie on one smooth surface, by region growing (Rabbani, van den Heuvel and Vosselman 2006, which Wegen et al. 2024,
 * section 4.1, use): from the voxel with the least residual on, those beside it join whose normal is nearly the same, and where the
 * residual is small, it goes on from them. PCL has the same for points; voxels are a hundred times fewer. */
#include "process/voxels.h"
#include <glib.h>

struct smooth_options {
	float angle_deg; /* 0: 12; between neighbours */
	float residual; /* 0: 0.1; of voxels that it goes on from: 1 - how far the normals in them agree */
};

struct smooth_region {
	uint32_t voxels, points;
	double centre_m[3];
	double covariance_m2[6]; /* of the voxels' points: xx xy xz yy yz zz */
	double normal[3];        /* mean; as long as the normals agree */
	double low_m[3], high_m[3];
};

typedef struct smooth_regions smooth_regions;
struct smooth_regions {
	uint32_t count;
	struct smooth_region *region;
	uint32_t *of; /* region of each voxel; VOXEL_NONE: of none */
};
/* Voxels must be linked. skip: those to leave out, a byte each; NULL. */
smooth_regions *smooth_regions_grow(
	const voxels *v, const uint8_t *skip, const struct smooth_options *options);
void smooth_regions_free(smooth_regions *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(smooth_regions, smooth_regions_free)

#endif
