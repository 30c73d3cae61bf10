#ifndef PROCESS_SCRIBBLE_WINDOW_H
#define PROCESS_SCRIBBLE_WINDOW_H
/* The part of a panorama that a flood is about: the box around all cells that may still become something, with a cell more at
 * each side. Strokes are about small parts of large panoramas, so it is what makes them quick. */
#include "process/scribble-edges.h"

/* label as watershed_flood has it: in and out, of all cells. Cells that are 0 or inside are what the window is around; what lies
 * beyond it is labelled already and can reach none of them. */
void scribble_window_flood(
	const range_grid *g, const struct scribble_edges *edges, int32_t inside, int32_t *label);

#endif
