#ifndef PROCESS_REGISTER_CHOOSE_H
#define PROCESS_REGISTER_CHOOSE_H
/* Which pairs of a site's scans are worth a try, by what is known so far. */
#include "process/scan-graph.h"

struct scan_pair {
	uint32_t a, b; /* numbers, a < b */
};

/* Pairs without an edge in g, to be tried together, of struct scan_pair; empty: there is nothing left to try. Caller frees.
 *
 * First the scans that follow each other; then, some at a time, pairs that would tie groups together, those first that were
 * scanned soonest after each other; last, when g was solved, neighbours in space: the loops that tell whether all of it is
 * right. Depends on the graph alone, so that it repeats. */
GArray *register_choose(const scan_graph *g, const struct scan_given *given, size_t count);

#endif
