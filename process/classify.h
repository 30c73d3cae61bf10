#ifndef PROCESS_CLASSIFY_H
#define PROCESS_CLASSIFY_H
/* Rules that tell what things are, from the shape of surfaces and where they stand above the ground (after Richter et al. 2015; as
 * Wegen et al. 2024, section 4.1, use it). Voxels are those of all points that are not ground.
 *
 * Large smooth regions that rise above the ground are walls and roofs; those with ground on top of them, behind them, hold that
 * ground up: bridges, retaining walls. What is rough all through is foliage, and what is thin and stands under it, its trunks; but
 * in voxels small things are rough whatever they are, and are foliage only where they are green, or nothing has a colour. What
 * lies against a wall is part of it, but ivy is not, where colour tells it. What remains stands alone, and its size tells. */
#include "process/ground.h"
#include "process/segment-class.h"
#include "process/smooth-regions.h"
#include "process/voxel-shape.h"

struct classify_input {
	const voxels *voxels; /* linked */
	const struct voxel_shape *shape;
	const smooth_regions *regions;
	const ground *ground;
	const float *height_m;       /* above the ground, of each voxel */
	const uint8_t *ground_class; /* enum segment_class of each surfel of the ground (water.h) */
	float ground_m; /* what faces up and is so near the ground is part of it, and in no voxel */
};
/* enum segment_class of each voxel; caller frees. */
uint8_t *classify(const struct classify_input *in);

#endif
