#ifndef RENDER_GLES_LAYERS_H
#define RENDER_GLES_LAYERS_H
/* What a GPU holds of a frame's layers and pipelines, whatever the camera: numbers, textures of strokes, paper. */
#include "render/bands.h"
#include "render/gles-context.h"

typedef struct gles_layers gles_layers;
struct gles_layers {
	uint64_t serial; /* of the frame; 0: none */
	uint64_t relief_serial;
	GLuint numbers; /* the blocks Layer of layer.glsl, and last the block Pipelines of ground.frag.glsl */
	GLintptr layer_bytes;             /* from one to the next */
	GLuint texture[FRAME_LAYERS_MAX]; /* 0: none */
	/* Of hatching: colours and chances, and strokes wanted, by shade (frame-hatch.h). 0: none. */
	GLuint xtoon_colours[FRAME_LAYERS_MAX], xtoon_wanted[FRAME_LAYERS_MAX];
	GLuint relief; /* of the paper */
	uint32_t layers;
	bool has_points; /* any of the pipelines */
};
/* Nothing is done when they are there already. */
bool gles_layers_hold(const gles_context *c, gles_layers *g, const frame *f, GError **error);
void gles_layers_clear(const gles_context *c, gles_layers *g);
/* As block 1: of a layer; of the pipelines. */
void gles_layers_bind(const gles_context *c, const gles_layers *g, uint32_t layer);
void gles_layers_bind_pipelines(const gles_context *c, const gles_layers *g);

/* It needs no ink of its own: its strokes can multiply the canvas. */
bool gles_layer_is_direct(const struct frame_layer *l);

#endif
