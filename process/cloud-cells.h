#ifndef PROCESS_CLOUD_CELLS_H
#define PROCESS_CLOUD_CELLS_H
/* The points of a cloud by the cube of space they are in, so that those around a place are found at once: a list in the order of the
 * cubes, and a hash table of where each begins. Const after it was made; any number of threads may read. The view must stay. */
#include "process/cloud.h"

/* A point under the key that it is put in order by. */
struct cloud_keyed {
	uint64_t key;
	uint32_t point;
};
void cloud_keyed_sort(struct cloud_keyed *k, size_t count); /* by key, then by point */

struct cloud_cells {
	const struct cloud_view *view;
	float side_m;
	uint32_t *order,
		*first; /* points, cell by cell; those of cell c from first[c] to first[c + 1] */
	uint64_t *key;  /* of each cell */
	uint32_t *slot; /* of a hash table: a cell, plus one; 0: none */
	uint32_t slots, count; /* count: of cells */
};
/* use: which points; NULL: all. */
void cloud_cells_init(
	struct cloud_cells *c, const struct cloud_view *v, float side_m, const uint8_t *use);
void cloud_cells_clear(struct cloud_cells *c);

/* Calls visit for the points within radius_m, at most side_m, with what each is off; of a cell with more than most points, for every
 * second, third ... of them alone. */
void cloud_cells_visit(const struct cloud_cells *c, const double at[3], float radius_m,
	uint32_t most, void (*visit)(uint32_t point, const float off[3], void *data), void *data);

#endif
