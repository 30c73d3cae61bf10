#ifndef PROCESS_SCAN_MOVES_H
#define PROCESS_SCAN_MOVES_H
/* What a change of the graph did to where the scans stand. */
#include "process/scan-graph.h"
#include <glib.h>

typedef struct _JsonArray JsonArray;

enum scan_move_kind {
	SCAN_MOVED,
	SCAN_PLACED,     /* it was not before */
	SCAN_NOT_PLACED, /* it was before */
	SCAN_OF_GROUP,   /* it is in another group now, whose frame is another */
};
struct scan_move {
	uint32_t number, group; /* the group that it is in now */
	enum scan_move_kind kind;
	double m, rad;
};

/* Of struct scan_move, for those that differ by more than 0.05 mm or 0.0005 degrees; before and after are arrays of struct
 * placed_scan. Caller frees. */
GArray *scan_moves(const GArray *before, const GArray *after);
char *scan_move_text(const struct scan_move *m); /* "scan 3 moved by ...", caller frees */
JsonArray *scan_moves_json(const GArray *moves); /* caller unrefs */
/* How many stand somewhere. */
guint scan_moves_count_placed(const GArray *scans);

#endif
