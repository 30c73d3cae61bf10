#ifndef RENDER_BENCH_FRAMES_H
#define RENDER_BENCH_FRAMES_H
/* Cameras whose frames cost about what those of a paper cost: so many points in view. */
#include "render/bench-place.h"
#include "render/chunk-view.h"

struct bench_camera {
	char name[48]; /* "station-2 +30" */
	struct camera camera;
	uint64_t in_view; /* points in chunks that are in view: Nc of Xu & Chen 2004, table 1 */
	uint64_t discs;   /* of these the mask is drawn of: N1 */
};

/* Of the site's views, these turned, and its overview from nearer, those with about so many points in view; what people would look at
 * goes before what is a little closer. f is moved about. */
bool bench_cameras_find(const bench_place *p, frame *f, const uint64_t *wanted_in_view,
	uint32_t count, struct bench_camera *ret, GError **error);

#endif
