#ifndef PROCESS_PICK_FILE_H
#define PROCESS_PICK_FILE_H
/* Picked pairs as a text file. A line is a pair: the point in scan A, then the same point in scan B, each either three
 * numbers (metres in the scan's own frame) or a cell of the scan's grid, c:COLUMN,ROW, both from 0, row 0 the highest. What
 * comes after # is a comment.
 *
 *     # the door's upper corner, the step
 *     1.204 3.881 0.45   -2.07 1.99 0.44
 *     c:1204,188         c:77,201
 *
 * Errors are of G_IO_ERROR, one sentence with file and line. */
#include "process/picks.h"
#include "process/scan-data.h"
#include <stdint.h>

#define PICK_FILE_PAIRS_MAX 10000u

struct picked_point {
	bool is_cell;
	uint32_t column, row;
	double point_m[3];
};
struct picked_pair {
	uint32_t line; /* from 1 */
	struct picked_point a, b;
};

/* Of struct picked_pair; caller frees. */
GArray *pick_file_read(const char *path, GError **error);
/* Puts the cells' points in; ret has pairs->len entries. path is for messages. Refused: a cell outside the grid or without a
 * point, a cell of a scan that has no grid. */
bool pick_file_resolve(const char *path, const GArray *pairs, const scan_data *a,
	const scan_data *b, struct pick *ret, GError **error);

#endif
