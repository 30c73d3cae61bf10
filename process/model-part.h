#ifndef PROCESS_MODEL_PART_H
#define PROCESS_MODEL_PART_H
/* What one scan gives to the model, sorted along the Morton curve: SITE/model/parts/0003.part (product.h). A scan that is larger
 * than the memory gives several sorted runs. */
#include "process/build-progress.h"
#include "process/model-inputs.h"
#include "process/morton.h"

#define MODEL_PART_KIND    "model-part"
#define MODEL_PART_VERSION 1

struct part_point {
	uint64_t code; /* morton.h */
	uint16_t within[3];
	uint16_t leaf;
	/* as in struct model_point */
	int16_t normal[2];
	uint8_t rgba[4];
	uint16_t intensity, size, plane_error;
	uint8_t classification, feature;
};
_Static_assert(sizeof(struct part_point) == 32, "the file's own layout");

/* Leaves first, then the curve; 0 only for points in the same cell of the lattice. */
static inline int part_point_compare(const struct part_point *a, const struct part_point *b)
{
	int by_leaf = (a->leaf > b->leaf) - (a->leaf < b->leaf);
	return by_leaf ? by_leaf : (a->code > b->code) - (a->code < b->code);
}

typedef struct model_part model_part;
struct model_part {
	product *file;
	uint32_t scan;
	bool is_cloud;
	const struct part_point *points;
	const uint64_t *run_end; /* of each run: index behind its last point */
	uint64_t count, runs;
	uint64_t redundant;    /* points that were left out: another scan has them better */
	unsigned level_needed; /* of the lattice, for this scan alone */
};
/* NULL without error when there is none of these inputs. */
model_part *model_part_open(const site *s, const struct model_input *input, unsigned level);
void model_part_free(model_part *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model_part, model_part_free)

/* Makes the file when it is not up to date. Points outside the lattice of this level are left out, and level_needed says so. */
bool model_part_update(const site *s, const struct model_input *input, unsigned level,
	uint64_t memory_bytes, bool *ret_made, GError **error);

/* Sorts by part_point_compare, equal ones as they stood. Uses 32 bytes a point beside them. */
void part_points_sort(struct part_point *point, size_t count);

#endif
