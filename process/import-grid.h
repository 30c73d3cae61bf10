#ifndef PROCESS_IMPORT_GRID_H
#define PROCESS_IMPORT_GRID_H
/* How a file has laid out the grid of a scan, told from its points, and the same grid as pleinair has it: row by row, row 0
 * the highest, columns clockwise seen from above.
 *
 * In a file of two sizes and a list of cells four things are open: which size is how long a run of cells is, and whether a
 * run is a column (its points differ in elevation and have about one azimuth) or a row. Each answer says which cells are
 * neighbours; in the right one neighbours of a column have about the same azimuth and neighbours of a row the same elevation.
 * Medians over cells spread through the whole scan do not mind missing cells. */
#include "process/import.h"

struct grid_layout {
	uint32_t columns, rows;
	bool column_by_column; /* runs are columns */
	bool rows_first;       /* the first size was that of rows */
	bool anticlockwise;    /* columns of the file */
	bool upwards;          /* rows of the file */
	bool told;             /* by the points */
	bool assumed;          /* nothing tells: as files usually have it */
	bool is_grid; /* has neighbours along rows and along columns; else it is a list of points */
};

/* Records in the order of the file. */
struct grid_records {
	bool (*read)(gpointer user_data, uint64_t first, size_t count, struct point_record *into,
		GError **error);
	gpointer user_data;
};
/* first, second: sizes as the file has them when order is IMPORT_BY_CONTENT; else columns and rows. */
bool grid_layout_find(const struct grid_records *records, enum import_order order, uint32_t first,
	uint32_t second, struct grid_layout *ret, GError **error);
/* Appends all cells to w; bands of rows, so memory is bounded. step may be NULL; false from it stops (G_IO_ERROR_CANCELLED). */
bool grid_turn(const struct grid_records *records, const struct grid_layout *layout,
	points_writer *w, bool (*step)(double fraction, gpointer user_data), gpointer user_data,
	GError **error);
/* "columns first, column by column, upwards, anticlockwise"; caller frees. */
char *grid_layout_text(const struct grid_layout *layout);

#endif
