#ifndef RENDER_CHUNK_VIEW_H
#define RENDER_CHUNK_VIEW_H
/* A chunk as a camera sees it: camera coordinates (x right, y down, z ahead) of a point are base + q0 axis0 + q1 axis1 + q2 axis2. */
#include "render/frame.h"

struct chunk_view {
	const struct scene_chunk *chunk;
	uint8_t pipeline;
	float base[3], axis[3][3]; /* [of q][x y z] */
	float near_m, far_m;       /* depths of its box, at least the camera's near */
	float margin_px;           /* how far discs of its points reach beyond that */
	float nearest_m;           /* that any part of such a disc, and any stroke, can be */
	float low_px[2],
		high_px[2]; /* around its box on the screen; all of it when the box reaches behind a pinhole camera */
};

/* false: no part of its box is in view. */
bool chunk_view_find(const frame *f, const struct scene_chunk *c, struct chunk_view *ret);

/* Those in view, from near to far. Free with g_free. */
struct chunk_view *chunk_views_new(const frame *f, uint32_t *ret_count);

#endif
