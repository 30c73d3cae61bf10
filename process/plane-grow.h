#ifndef PROCESS_PLANE_GROW_H
#define PROCESS_PLANE_GROW_H
/* Planes in the points of one leaf: region growing over cubes of space (Rabbani, van den Heuvel and Vosselman 2006, with a plane in
 * place of smoothness), then all points near, each of the plane that is nearest to it, fit it anew. Internal to plane-find.c. */
#include "process/plane-find.h"

/* Appends a struct plane_draft with place, box and thickness for each; the largest first. */
void plane_grow(const model *m, const struct plane_leaf *leaf, float area_least_m2, GArray *ret);

#endif
