#ifndef RENDER_SCENE_PAINT_H
#define RENDER_SCENE_PAINT_H
/* What a painter sees of points besides themselves: the colour of what is around each, how much there is to see there, and along what
 * a brush would go. Made of the scene alone, chunk by chunk, when something that is drawn first asks for it. */
#include "render/scene-pager.h"

/* Around: in the cells of a chunk that touch a point's own; this part of the chunk's longest side is a cell's. */
#define SCENE_PAINT_CELLS 16

struct scene_paint_point {
	uint8_t rgb[3]; /* sRGB: the mean of what is around */
	uint8_t detail; /* 255: edges, features, colours that differ from those around; 0: all is even */
	int16_t way
		[2]; /* packed (model.h), in the site's frame: along edges, and near them, else as the surface is bent; none: MODEL_NORMAL_NONE */
};

struct scene_paint_chunk {
	uint8_t rgba[4]; /* its mean */
	float cell_m;    /* of the cells in it */
	uint32_t
		is_leafy; /* 1: so many of its points are features without a line that these are leaves; else they are of surface */
	float middle_m[3]; /* of its leaf's box, from the scene's origin */
};

typedef struct scene_paint scene_paint;
struct scene_paint {
	struct scene_paint_point
		*point; /* as many as the scene has, and some that vectors read beyond */
	struct scene_paint_chunk *chunk; /* scene_paint_chunk_of() */
	uint32_t *stamp;                 /* with a pager, of each chunk that this is of */
	float (*middle_m)[3];            /* with a pager, of every number of a leaf */
};

/* The scene's; any thread. With a pager it is of the chunks that the last turn left. */
const scene_paint *scene_paint_of(const scene *s);
static inline const struct scene_paint_chunk *scene_paint_chunk_of(
	const scene_paint *p, const scene *s, const struct scene_chunk *c)
{
	return &p->chunk[s->pager ? c->first / SCENE_PAGER_ALIGNED : (uint32_t)(c - s->chunk)];
}
/* For the pager, within a turn: what is new is looked at, if anything is painted. */
void scene_paint_follow(const scene *s);

/* For scene.c. */
struct scene_paint_plane {
	gsize made;
	scene_paint paint;
};
void scene_paint_free(struct scene_paint_plane *p); /* NULL is fine */

#endif
