#ifndef RENDER_PLANE_VIEW_H
#define RENDER_PLANE_VIEW_H
/* The plane surfaces of a frame as its camera sees them: which pixels have their middles in each polygon, as spans of rows, cut at the
 * near plane and, of parallel cameras, the far one; and all that tells how deep a pixel is and where in the texture. Both backends draw
 * the same spans.
 *
 * The plane is n . P = along, P a place as the camera sees it; so where the ray of a pixel goes through right and down at depth 1 (lens.h),
 * with slant = n.x right + n.y down,
 *
 *     depth = (along - parallel_m slant) / (fan slant + n.z) */
#include "render/chunk-view.h"
#include "render/scene-planes.h"

struct plane_span {
	int32_t row, from, end; /* columns: the first one, and the first that is not */
	uint32_t view;
};

struct plane_view {
	const struct scene_plane *plane;
	uint32_t leaf;
	uint8_t pipeline;
	float normal[3], along;
	float back_m; /* farther behind itself than any of its points: the mask hides none of them */
	float u[4], v[4];    /* texels of level 0 at a place: three of it, and what is added */
	float lit;           /* what is left of its light */
	int32_t top, bottom; /* its rows; the latter is beyond */
	uint32_t first_span; /* of row top */
	uint32_t *row;       /* of each row, and the end: spans from first_span on */
};

typedef struct plane_views plane_views;
struct plane_views {
	struct lens lens;
	uint32_t count, spans;
	struct plane_view *view;
	struct plane_span *span; /* view by view, row by row, left to right */
};
/* Of pipelines that some of the chunks have and whose style draws planes; NULL: there are none. */
plane_views *plane_views_new(const frame *f, const struct chunk_view *views, uint32_t count);
void plane_views_free(plane_views *v); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(plane_views, plane_views_free)

/* So much more than a point's own does a plane's colour count where both are. */
#define PLANE_WEIGHT 4.f
/* Of the depth: the most that the mask pushes planes back that are met aslant. */
#define PLANE_BACK_MOST 0.1f

#endif
