#ifndef RENDER_GLES_TARGETS_H
#define RENDER_GLES_TARGETS_H
/* What a picture of one size is drawn into. Light is kept in half floats where a GPU draws into them, else in sRGB bytes, whose
 * blending every GPU does in linear light; paint, whose sums exceed 1, needs half floats. Below filters it is kept in floats where
 * they can be blended: half floats change every tenth byte by 1, and filters that choose make more of that. */
#include "render/bands.h"
#include "render/gles-context.h"

struct gles_target {
	GLuint frame, plane[2]; /* framebuffer; textures, the second one 0 but for paint */
};

typedef struct gles_targets gles_targets;
struct gles_targets {
	uint32_t width, height;
	bool is_filtered;
	GLuint keys; /* a texture: the mask, of integers */
	struct gles_target canvas, picture;
	struct gles_target
		ink[BAND_BLENDS]; /* of enum band_blend; made when a layer first wants it */
};
/* Nothing is done when they are there already. Refuses sizes that the GPU cannot. */
bool gles_targets_hold(const gles_context *c, gles_targets *t, uint32_t width, uint32_t height,
	bool is_filtered, GError **error);
bool gles_targets_hold_ink(
	const gles_context *c, gles_targets *t, enum band_blend blend, GError **error);
void gles_targets_clear(const gles_context *c, gles_targets *t);

#endif
