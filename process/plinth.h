#ifndef PROCESS_PLINTH_H
#define PROCESS_PLINTH_H
/* What structures stand on: a step around a fountain, the foot of a lamp. It is flat and low, and one could walk on it, so that
 * it is ground (ground.h); but at the foot of a structure, what lies higher than the floor around is of the structure. Where
 * surfels are wider than 0.35 m, as in scans from the air, nothing has a foot. */
#include "process/ground.h"

/* By surfel of the ground (ground_surfels); caller frees both. */
struct plinths {
	uint32_t *voxel; /* of the structure whose foot is there; VOXEL_NONE: none is */
	float *floor_m;  /* where there is one: z of the floor around, at the surfel's mean point */
};
/* class: enum segment_class of each voxel; ground_class: of each surfel; height_m: above the ground, of each voxel. */
struct plinths plinths_find(const ground *g, const voxels *v, const uint8_t *class,
	const uint8_t *ground_class, const float *height_m);
void plinths_clear(struct plinths *p);
/* The voxel of the structure that a point of the ground, of this surfel, is the foot of; VOXEL_NONE: it is the floor. */
static inline uint32_t plinths_at(const struct plinths *p, uint32_t surfel, double z_m)
{
	const float step_m = 0.06f;
	return p->voxel[surfel] != VOXEL_NONE && z_m > p->floor_m[surfel] + step_m
		       ? p->voxel[surfel]
		       : VOXEL_NONE;
}

#endif
