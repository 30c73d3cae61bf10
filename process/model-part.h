#ifndef PROCESS_MODEL_PART_H
#define PROCESS_MODEL_PART_H
/* The points of one scan, sorted along the Morton curve: SITE/model/parts/0003.part (product.h). A scan that is larger than the
 * memory gives several sorted runs. All of its points are there, those too that another scan has better: which ones these are
 * is told by cell from the scan's overlaps (model-overlaps.h), so that the part stays when a scan is added beside it. */
#include "process/build-progress.h"
#include "process/model-inputs.h"
#include "process/morton.h"

#define MODEL_PART_KIND       "model-part"
#define MODEL_PART_VERSION    5
#define MODEL_PART_SUM_POINTS 1024u
#define PART_SORT_BYTES       32u /* for each point, while they are sorted */

struct part_point {
	uint64_t code; /* morton.h */
	uint16_t within[3];
	uint16_t leaf;
	/* as in struct model_point */
	int16_t normal[2];
	uint8_t rgba[4];
	uint16_t intensity, size, plane_error;
	uint8_t classification, feature;
	int16_t direction[2], principal[2];
	uint16_t k1, k2;
	uint8_t kind, flags;
	uint16_t spacing;
};
_Static_assert(sizeof(struct part_point) == 48, "the file's own layout");

/* CRC-32C of MODEL_PART_SUM_POINTS points and of their cells: who reads a few can check a few. */
struct part_sum {
	uint32_t points, cells;
};
_Static_assert(sizeof(struct part_sum) == 8, "the file's own layout");

/* Leaves first, then the curve; 0 only for points in the same cell of the lattice. */
static inline int part_point_compare(const struct part_point *a, const struct part_point *b)
{
	int by_leaf = (a->leaf > b->leaf) - (a->leaf < b->leaf);
	return by_leaf ? by_leaf : (a->code > b->code) - (a->code < b->code);
}

typedef struct model_part model_part;
struct model_part {
	product *file, *overlaps;
	uint32_t scan;
	bool is_cloud;
	const struct part_point *points;
	const uint32_t *cell;    /* of each point, in the scan's grid; NULL for a cloud */
	const uint64_t *dropped; /* a bit for each cell; NULL for a cloud */
	uint64_t words;          /* of dropped */
	const uint64_t *run_end; /* of each run: index behind its last point */
	const struct part_sum *sum;
	uint64_t count, runs;
	unsigned level_needed; /* of the lattice, for this scan alone */
};
static inline bool model_part_is_dropped(const model_part *p, uint64_t i)
{
	return p->dropped && p->dropped[p->cell[i] / 64] >> p->cell[i] % 64 & 1;
}

/* NULL without error when there is none of these inputs. Does not read the points. */
model_part *model_part_open(const site *s, const struct model_input *input, unsigned level);
void model_part_free(model_part *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model_part, model_part_free)

/* The points or cells of one checksum. */
bool model_part_verify_points(const model_part *p, uint64_t sum, GError **error);
bool model_part_verify_cells(const model_part *p, uint64_t sum, GError **error);
static inline size_t model_part_sum_points(const model_part *p, uint64_t sum)
{
	return MIN(MODEL_PART_SUM_POINTS, p->count - sum * MODEL_PART_SUM_POINTS);
}
/* Gives back the memory of points that were read. */
void model_part_forget(const model_part *p, const struct part_point *from, size_t count);

/* Makes the file when it is not up to date, or, with is_doubtful, when it is damaged anywhere. Points outside the lattice of this level are left out, and level_needed says so. */
bool model_part_update(const site *s, const struct model_input *input, unsigned level,
	bool is_doubtful, uint64_t memory_bytes, bool *ret_made, GError **error);

/* Their indices in the order of part_point_compare, equal ones as they stand; caller frees. Uses PART_SORT_BYTES a point. */
uint32_t *part_points_order(const struct part_point *point, size_t count);
/* Those of so many indices, one after another, on all threads. */
void part_points_gather(
	const struct part_point *from, const uint32_t *order, size_t count, struct part_point *to);
/* A copy of all, in their order; caller frees. */
struct part_point *part_points_sorted(const struct part_point *point, size_t count);

#endif
