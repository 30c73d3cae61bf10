#ifndef PROCESS_PLANE_STRAIGHT_H
#define PROCESS_PLANE_STRAIGHT_H
/* Outlines of plane regions as people would draw them: few straight edges, each fitted to all of the border along it, along the main
 * directions where they nearly are, and corners where planes meet. Internal to plane-find.c. */
#include "process/plane-find.h"

/* Rings of places close together (plane-outline.h) become those of the draft, of few vertices: what lies no farther than this from an edge
 * is of it. */
void plane_straighten(
	struct plane_draft *d, const GArray *places, const GArray *ends, float within_m);

/* Edges that lie near the line where another plane goes through theirs, and that plane's polygon is there, come to lie on it. All drafts
 * are straight, and stay as they are: returns the vertices of that number (unref), and appends to met which planes each met. */
GArray *plane_meet(const struct plane_draft *all, uint32_t count, uint32_t number, GArray *met);

/* Without vertices that lie between those beside them. After planes have met. */
void plane_prune(struct plane_draft *d);

#endif
