#ifndef RENDER_GLES_STIPPLE_H
#define RENDER_GLES_STIPPLE_H
/* What a GPU holds for stippling (stipple.h): of each layer where its points are on the planes of eye and light, and room for the planes,
 * which layers use one after another. */
#include "render/frame.h"
#include "render/gles-views.h"
#include "render/stipple-plan.h"

/* Of a layer. The light's part is kept while frame and layer are the same. */
struct gles_stippled {
	stipple_plan *plan;            /* NULL: none yet */
	struct gles_buffer parts;      /* four words of each chunk (stipple.glsl) */
	struct gles_buffer eye, light; /* spots: three words of each slot */
};
struct gles_stipple {
	struct gles_stippled layer[FRAME_LAYERS_MAX];
	struct gles_buffer texture[2];  /* the second one is spread into */
	struct gles_buffer tree, views; /* of the light: all chunks that it sees */
	gles_views seen;                /* of windows: what the whole picture shows */
};
void gles_stipple_clear(const gles_context *c, struct gles_stipple *s);

#endif
