#ifndef PROCESS_SEGMENT_CLASS_H
#define PROCESS_SEGMENT_CLASS_H
/* The classes that everything in a site is one of (Wegen et al. 2024, section 4.1, after Richter et al. 2015). */
#include <stdint.h>

enum segment_class {
	CLASS_OTHER, /* people, cars, what nobody can tell */
	CLASS_BUILDING,
	CLASS_VEGETATION,
	CLASS_TERRAIN,
	CLASS_STRUCTURE, /* bridges, walls, lamp posts, railings, benches: infrastructure */
	CLASS_WATER,
	SEGMENT_CLASSES
};

struct segment_class_info {
	const char *name;  /* "building": in files and commands */
	const char *title; /* "Buildings": for people */
	uint8_t rgb[3];    /* to tell them apart in pictures */
};
extern const struct segment_class_info segment_classes[SEGMENT_CLASSES];
/* -1: there is none of this name. */
int segment_class_find(const char *name);
/* Of the classes of LAS 1.4 (ASPRS, table 17); -1: never classified, or one that says nothing of what it is, as 1 and 12. Noise,
 * 7 and 18, is other. */
int segment_class_from_las(uint8_t classification);
/* The other way: came is the number that a point came with, which stays where it says the same. Vegetation becomes high vegetation,
 * structure 26, civil structure, as the Dutch elevation model numbers it: LAS itself has no number for it. */
uint8_t segment_class_to_las(enum segment_class class, uint8_t came);

#endif
