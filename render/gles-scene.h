#ifndef RENDER_GLES_SCENE_H
#define RENDER_GLES_SCENE_H
/* The points of a scene in the memory of a GPU, in slabs: ranges of whole chunks whose buffers are small enough for any board. Of a scene
 * with a pager they are ranges of its memory, and each turn brings what the last ones have not. */
#include "render/gles-context.h"
#include "render/scene.h"

/* What a storage block takes at least, wherever there are any worth the name. */
#define GLES_BLOCK_BYTES ((int64_t)128 << 20)

struct gles_slab {
	GLuint points;         /* 16 bytes each: q0 q1, q2 spacing, disc degree kind, normal */
	GLuint looks;          /* 8: rgba, direction */
	GLuint lists;          /* 4: entries (scene-list.h), of each kind in the order of ranks */
	GLuint bends;          /* 2: k1, k2 (scene-bend.h); 0 until they are asked for */
	GLuint paint;          /* 8: rgb detail, way (scene-paint.h); 0 until it is asked for */
	uint32_t first, count; /* of points */
};

typedef struct gles_scene gles_scene;
struct gles_scene {
	uint64_t serial; /* of the scene; 0: none */
	struct gles_slab *slab;
	uint32_t slabs;
	/* With a pager: what stands at each eighth point, by scene_chunk's stamp. */
	uint32_t *held, turn;
	bool is_painted; /* what is painted is held too */
};
/* Nothing is done when it is there already, as it is since the last turn. */
bool gles_scene_hold(const gles_context *c, gles_scene *g, const scene *s, GError **error);
/* Of the scene that is held; nothing is done when they are there already. */
bool gles_scene_hold_bends(const gles_context *c, gles_scene *g, const scene *s, GError **error);
bool gles_scene_hold_paint(const gles_context *c, gles_scene *g, const scene *s, GError **error);
void gles_scene_clear(const gles_context *c, gles_scene *g);
uint32_t gles_scene_slab(const gles_scene *g, const struct scene_chunk *c);

#endif
