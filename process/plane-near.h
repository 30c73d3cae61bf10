#ifndef PROCESS_PLANE_NEAR_H
#define PROCESS_PLANE_NEAR_H
/* Which planes points may belong to, chunk by chunk: of the hundreds of planes that a leaf may have, a chunk reaches few. Internal to
 * plane-find.c and plane-grow.c. */
#include "process/plane-find.h"

/* Whether some of the chunk may lie so near the plane, anywhere on it. */
bool plane_is_near(const struct plane_draft *d, const struct model_chunk *c, double within_m);
/* The same within its box. */
bool plane_may_reach(const struct plane_draft *d, const struct model_chunk *c, double within_m);

/* Lists of planes, for chunks first..end of a leaf; const, for any number of threads, as long as places, boxes and thicknesses stay. */
typedef struct plane_near plane_near;
plane_near *plane_near_new(struct plane_draft *from, uint32_t count,
	const struct model_chunk *chunk, uint64_t first, uint64_t end);
void plane_near_free(plane_near *n); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(plane_near, plane_near_free)

/* The plane that a point of the chunk belongs to, and how far it is; NULL: to none. normal 0 0 0: it has none. */
struct plane_draft *plane_nearest(const plane_near *n, uint64_t chunk, const double at_m[3],
	const float normal[3], float within_m, double *ret_m);

#endif
