#ifndef PROCESS_VOXEL_COLUMNS_H
#define PROCESS_VOXEL_COLUMNS_H
/* Voxels one above another: what is asked of a place of the plan at any height is looked up once, not once a height. */
#include "process/voxels.h"
#include <glib.h>

struct voxel_column {
	int32_t x, y;        /* in the voxels' lattice */
	uint32_t first, end; /* in `voxel`, from the lowest */
};

/* Const, for any number of threads. */
typedef struct voxel_columns {
	const voxels *v; /* must stay, and as it is */
	struct voxel_column *column;
	uint32_t count, *voxel;
	uint32_t *slot, slots; /* inside */
} voxel_columns;

voxel_columns *voxel_columns_new(const voxels *v);
void voxel_columns_free(voxel_columns *c); /* NULL is fine */
/* Those of the voxels at a place whose z is low..high: there are as many from *ret on. */
uint32_t voxel_columns_find(const voxel_columns *c, int32_t x, int32_t y, int32_t low, int32_t high,
	const uint32_t **ret);

G_DEFINE_AUTOPTR_CLEANUP_FUNC(voxel_columns, voxel_columns_free)

#endif
