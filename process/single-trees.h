#ifndef PROCESS_SINGLE_TREES_H
#define PROCESS_SINGLE_TREES_H
/* Single trees in voxels of vegetation, by marker-controlled watershed on the canopy's height (Wegen et al. 2024, section 4.1): over
 * a plan of cells, the height of the vegetation, smoothed; its local maxima, those that rise enough above the saddles to others,
 * are the markers; what drains to one of them is one
 * tree, with all that stands below. Bushes, lower than TREE_LEAST_M and tied to no tree, are what hangs together. */
#include "process/voxels.h"

#define TREE_LEAST_M 2.2f
#define TREE_NONE    UINT32_MAX

struct single_trees {
	uint32_t count, trees; /* trees first, then bushes */
	uint32_t *of; /* tree or bush of each voxel; TREE_NONE: not vegetation, or too little */
};
/* is_plant: a byte each; height_m: above the ground. Voxels must be linked. Free `of` with g_free. */
struct single_trees single_trees_find(
	const voxels *v, const uint8_t *is_plant, const float *height_m, uint32_t points_min);

#endif
