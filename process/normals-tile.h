#ifndef PROCESS_NORMALS_TILE_H
#define PROCESS_NORMALS_TILE_H
/* The plane fits of one tile of a grid, and what is done to the planes of rows of it. Internal to normals*.c. One thread a tile. */
#include "process/normals.h"

#define TILE_COLUMNS 128 /* at most, of the tile itself */
#define TILE_ROWS    132
#define TILE_REACH   16 /* cells around it that windows may reach into */

struct tile_job {
	const range_grid *grid;
	const struct normals_options *options;
	const struct normals_planes *planes;
	uint32_t column, row, columns, rows; /* the tile itself */
	uint32_t reach_columns;              /* at most TILE_REACH */
	size_t first, pitch; /* in the planes: its first cell, and from row to row */
};

#define TILE_STEP 24 /* rows */

typedef struct tile tile;
tile *tile_new(void);
void tile_free(tile *t);
void tile_start(tile *t, const struct tile_job *job);
/* The next rows of it: TILE_STEP of them, or what is left. */
void tile_fit(tile *t, const struct tile_job *job, uint32_t first, uint32_t end);

/* Part of a grid. */
struct area {
	uint32_t row, rows_end, column, columns_end;
};

/* Cells at creases take the plane of a neighbour's window that holds them and does not reach over the crease. Looks this many
 * rows and columns away, at planes of fits alone. */
#define SHARPEN_REACH 16
void sharpen_area(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes, struct area area);
/* Cells that the fit left out, for they have no neighbours beside them: from what is near in space. */
void fill_area(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes, struct area area);

#endif
