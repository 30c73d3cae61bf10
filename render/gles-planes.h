#ifndef RENDER_GLES_PLANES_H
#define RENDER_GLES_PLANES_H
/* The plane surfaces of a frame on a GPU: spans and views (plane-view.h) of each frame, textures of the scene. */
#include "render/gles-buffer.h"
#include "render/plane-view.h"

struct gles_planes {
	uint64_t serial; /* of the scene whose texels are there; 0: of none */
	uint32_t spans;  /* of this frame; 0: it has none */
	struct gles_buffer texels, planes, span;
};
/* Those of the chunks' pipelines. */
bool gles_planes_fill(const gles_context *c, struct gles_planes *p, const frame *f,
	const struct chunk_view *views, uint32_t count, GError **error);
/* By the program that is used: all spans. They and the planes are bound, others are not. */
void gles_planes_draw(const gles_context *c, const struct gles_planes *p);
void gles_planes_clear(const gles_context *c, struct gles_planes *p);

#endif
