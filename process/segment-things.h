#ifndef PROCESS_SEGMENT_THINGS_H
#define PROCESS_SEGMENT_THINGS_H
/* From classes to things: the leaves of the tree. Buildings are what hangs together; in each, every large smooth region is a part
 * of its own, a wall or a roof, and the rest are its details. Plants are single trees and bushes. Everything else is what hangs
 * together; what has too few points is put with others of its class, and what stands alone in the air, in a few points, is
 * stray. */
#include "process/classify.h"
#include "process/segments.h"
#include <glib.h>

struct segment_things {
	uint16_t *leaf_of_voxel, *leaf_of_surfel;
	uint16_t rest[SEGMENT_CLASSES]; /* leaf of what belongs to no thing of the class */
	uint8_t *class_of_leaf;         /* by number, SEGMENTS_MAX + 1 */
};
/* class: of each voxel. Counts boxes and areas, not points. G_IO_ERROR_NO_SPACE when there are more than 65,000 things. */
bool segment_things_find(struct segment_things *t, const struct classify_input *in,
	const uint8_t *class, uint32_t points_min, segments *into, GError **error);
void segment_things_clear(struct segment_things *t);
/* Whether a node is what is left over of its class. */
bool segment_things_is_rest(const struct segment *node);

/* The leaf of a point, that of its place, unless its own label tells another class. */
static inline uint16_t segment_things_leaf(
	const struct segment_things *t, uint16_t leaf, uint8_t label)
{
	return label >= SEGMENT_CLASSES || t->class_of_leaf[leaf] == label ? leaf : t->rest[label];
}

#endif
