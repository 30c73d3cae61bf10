#ifndef PROCESS_NORMALS_TILE_H
#define PROCESS_NORMALS_TILE_H
/* The plane fits of one tile of a grid. Internal to normals*.c. One thread a tile. */
#include "process/normals.h"

#define TILE_COLUMNS 96 /* at most, of the tile itself */
#define TILE_ROWS    132
#define TILE_REACH   16 /* cells around it that windows may reach into */

struct tile_job {
	const range_grid *grid;
	const struct normals_options *options;
	const struct normals_planes *planes;
	uint32_t column, row, columns, rows; /* the tile itself */
	uint32_t reach_columns;              /* at most TILE_REACH */
};

typedef struct tile tile;
tile *tile_new(void);
void tile_free(tile *t);
void tile_fit(tile *t, const struct tile_job *job);

#endif
