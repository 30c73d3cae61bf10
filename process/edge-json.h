#ifndef PROCESS_EDGE_JSON_H
#define PROCESS_EDGE_JSON_H
/* An edge of the graph as people and programs are told of it. */
#include "process/scan-graph.h"
#include <glib.h>

typedef struct _JsonObject JsonObject;

/* "accepted", "accepted by hand", "refused by hand", "contradicts its loops" or "refused". */
const char *edge_standing(const struct edge *e);
/* All that is known of it; a number that is not finite is null. Caller unrefs. */
JsonObject *edge_json(const struct edge *e);

#endif
