#ifndef PROCESS_SCRIBBLE_FLOOR_H
#define PROCESS_SCRIBBLE_FLOOR_H
/* Floors: what things stand on. Cells that look up and hang together are one floor if they are larger than any table or car
 * roof, be it the ground, a terrace or the deck of a bridge, and with it what else lies as high beside it, such as the ground
 * that is seen between the legs of a bench and the lowest hand's breadth of what stands there. */
#include "process/scribble-edges.h"

#define SCRIBBLE_FLOOR_M2 6.0f

/* A number for each cell: of its floor, 1 and more, or 0. Caller frees. *ret_floors: how many; may be NULL. */
uint16_t *scribble_floors_find(const range_grid *g, const geometry *normals,
	const struct scribble_edges *edges, uint32_t *ret_floors);

#endif
