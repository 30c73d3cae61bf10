#ifndef RENDER_KIOSK_ALIGN_PAIR_H
#define RENDER_KIOSK_ALIGN_PAIR_H
/* Two scans of a site to be aligned: how they fit so far, and what they look like. Read at once, on any thread; const after. */
#include "process/scan-data.h"
#include "process/scan-graph.h"

typedef struct align_pair align_pair;
struct align_pair {
	uint32_t scan[2];   /* 0, 0: the site has no two scans */
	uint32_t pairs, at; /* of all pairs of the site, and which one this is, from 0 */
	scan_graph *graph;
	const struct edge *edge; /* of the graph; NULL: nobody has aligned them yet */
	scan_data *data[2];
	uint8_t *rgb[2]; /* 3 bytes a cell; NULL: a cloud without a grid */
};
/* a, b 0: the one that needs a person most. step: so many pairs on from there. */
align_pair *align_pair_new(const char *folder, uint32_t a, uint32_t b, int step, GError **error);
void align_pair_free(align_pair *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(align_pair, align_pair_free)

/* How they fit, for people: a headline, its class "good", "doubt", "bad" or NULL, and what can be done ("" nothing). */
const char *align_pair_headline(
	const align_pair *p, const char **ret_verdict, const char **ret_advice);

#endif
