#include "process/segment-class.h"
#include <stdbool.h>
#include <string.h>

const struct segment_class_info segment_classes[SEGMENT_CLASSES] = {
	[CLASS_OTHER] = { "other", "Other things", { 150, 120, 160 } },
	[CLASS_BUILDING] = { "building", "Buildings", { 205, 92, 72 } },
	[CLASS_VEGETATION] = { "vegetation", "Vegetation", { 84, 160, 74 } },
	[CLASS_TERRAIN] = { "terrain", "Terrain", { 200, 180, 140 } },
	[CLASS_STRUCTURE] = { "structure", "Structures", { 90, 110, 130 } },
	[CLASS_WATER] = { "water", "Water", { 70, 140, 210 } },
};

int segment_class_find(const char *name)
{
	for (int i = 0; i < SEGMENT_CLASSES; i++)
		if (strcmp(segment_classes[i].name, name) == 0)
			return i;
	return -1;
}

int segment_class_from_las(uint8_t classification)
{
	switch (classification) {
	case 2: /* ground */
	case 8: /* key point of the ground, before LAS 1.4 */
	case 11: /* road */ return CLASS_TERRAIN;
	case 3: /* low, middle, high vegetation */
	case 4:
	case 5: return CLASS_VEGETATION;
	case 6: return CLASS_BUILDING;
	case 9: return CLASS_WATER;
	case 10: /* rail */
	case 13: /* wires */
	case 14:
	case 15: /* transmission tower */
	case 16:
	case 17: /* bridge deck */
	case 19: /* overhead structure */
	case 26: /* civil structure, as the Dutch elevation model numbers it */
		return CLASS_STRUCTURE;
	case 7:
	case 18: /* noise */ return CLASS_OTHER;
	default: return -1;
	}
}

uint8_t segment_class_to_las(enum segment_class class, uint8_t came)
{
	static const uint8_t number[SEGMENT_CLASSES] = { [CLASS_OTHER] = 1,
		[CLASS_BUILDING] = 6,
		[CLASS_VEGETATION] = 5,
		[CLASS_TERRAIN] = 2,
		[CLASS_STRUCTURE] = 26,
		[CLASS_WATER] = 9 };
	int said = segment_class_from_las(came);
	bool same = said == (int)class || (said < 0 && class == CLASS_OTHER && came != 0);
	return same ? came : number[class];
}
