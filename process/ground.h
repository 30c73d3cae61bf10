#ifndef PROCESS_GROUND_H
#define PROCESS_GROUND_H
/* The ground of a site: surfaces that one can walk on, from where tripods stand or, where nobody knows that, from the lowest places
 * on. It may lie in several layers, as on a bridge and below it.
 *
 * Points that face up are summed in voxels; from the seeds on, a voxel beside one of the ground belongs to it when it lies where
 * the slope leads, within a step. What the walk does not reach, as behind a wall, is ground too where it is a large patch with
 * nothing below it that goes on from the ground near it.
 *
 * Filled by one thread; const after ground_find, then any number of threads may ask. */
#include "process/voxel-columns.h"

typedef struct ground ground;
/* cell_m: of its columns, two patches at least. */
ground *ground_new(double cell_m);
void ground_free(ground *g); /* NULL is fine */
void ground_add(
	ground *g, const struct voxel_point *p);  /* those that do not face up are passed over */
void ground_merge(ground *g, const ground *from); /* both before ground_find; as voxels_merge */
/* stations: where scanners stood; 0: not known. */
void ground_find(ground *g, const double (*station_m)[3], size_t stations);

/* Above the highest layer that is not clearly above the point; under all, negative. Where nothing of the ground was seen, above
 * what is nearest. NAN: there is no ground at all. */
float ground_height_m(const ground *g, const double at_m[3]);
/* Whether ground was seen in this column, and not only near it. */
bool ground_is_seen(const ground *g, const double at_m[3]);
/* The surfel that ground_height_m is told from; VOXEL_NONE: there is no ground at all. */
uint32_t ground_surfel(const ground *g, const double at_m[3]);
/* The highest surfel of the ground in a column; VOXEL_NONE: none was seen there. */
uint32_t ground_top(const ground *g, const double at_m[2]);
/* How far above the point the next layer is that one can walk to, INFINITY: none. */
float ground_above_m(const ground *g, const double at_m[3]);
/* The surfels, for whoever goes on from the ground: VOXEL_NONE where none of the ground is at that place. */
const voxels *ground_surfels(const ground *g);
const voxel_columns *ground_plan(const ground *g); /* of the surfels; after ground_find */
bool ground_is(const ground *g, uint32_t surfel);

G_DEFINE_AUTOPTR_CLEANUP_FUNC(ground, ground_free)

#endif
