#ifndef PROCESS_CLASSIFY_THING_H
#define PROCESS_CLASSIFY_THING_H
/* What a thing that stands alone is, by its size, where it stands, and what it touches: for classify.h. */
#include "process/components.h"
#include "process/segment-class.h"
#include <stdbool.h>

/* Shares and heights that surfaces are told by too. */
#define CLASSIFY_FOLIAGE     0.5f
#define CLASSIFY_TOP_LEAST_M 2.2 /* above the ground: walls and roofs reach */
#define CLASSIFY_BENCH_M     1.3f /* up to here things may stand against a wall that are none of it */

struct thing {
	float foliage, green;
	float low_m, high_m;                /* above the ground */
	double length_m, width_m;           /* upright box along its longer side */
	uint32_t contacts[SEGMENT_CLASSES]; /* links to voxels of a class */
	bool near_building, in_line;        /* in_line: with a wall further along */
};
/* c: the voxels of the thing. */
uint8_t classify_thing(const struct thing *t, const struct component *c);

/* What is little larger than the voxels that roughness is told from is rough, whatever it is: its colour tells, if it has one. */
bool classify_may_be_plant(const struct component *c, float green);

#endif
