#ifndef RENDER_SCENE_PAINT_H
#define RENDER_SCENE_PAINT_H
/* What a painter sees of points besides themselves: the colour of what is around each, how much there is to see there, and along what
 * a brush would go. Made of the scene alone, chunk by chunk, when something that is drawn first asks for it. */
#include "render/scene-pager.h"

/* Around: in the cells of a chunk that touch a point's own; this part of the chunk's longest side is a cell's. */
#define SCENE_PAINT_CELLS 16

/* What is seen of a point, in a word: the sRGB mean of what is around it, 5 6 5 bits; and a way, packed (model.h) in bytes instead of
 * halves, in the site's frame: along edges, and near them, else as the surface is bent; none: SCENE_PAINT_NO_WAY. */
#define SCENE_PAINT_NO_WAY     (-128)
#define SCENE_PAINT_WAY_FACTOR 258 /* from a byte to a half */
/* 0..255 of five bits or of six. */
#define SCENE_PAINT_OF_FIVE(v) (((v)*527 + 23) >> 6)
#define SCENE_PAINT_OF_SIX(v)  (((v)*259 + 33) >> 6)
static inline void scene_paint_rgb(uint32_t look, uint8_t ret[3])
{
	ret[0] = (uint8_t)SCENE_PAINT_OF_FIVE(look & 31);
	ret[1] = (uint8_t)SCENE_PAINT_OF_SIX(look >> 5 & 63);
	ret[2] = (uint8_t)SCENE_PAINT_OF_FIVE(look >> 11 & 31);
}
static inline void scene_paint_way(uint32_t look, int16_t ret[2])
{
	int8_t first = (int8_t)(look >> 16), second = (int8_t)(look >> 24);
	bool some = first != SCENE_PAINT_NO_WAY;
	ret[0] = (int16_t)(some ? first * SCENE_PAINT_WAY_FACTOR : MODEL_NORMAL_NONE);
	ret[1] = (int16_t)(some ? second * SCENE_PAINT_WAY_FACTOR : 0);
}

struct scene_paint_chunk {
	uint8_t rgba[4]; /* its mean */
	float cell_m;    /* of the cells in it */
	uint32_t
		is_leafy; /* 1: so many of its points are features without a line that these are leaves; else they are of surface */
	float middle_m[3]; /* of its leaf's box, from the scene's origin */
};

typedef struct scene_paint scene_paint;
struct scene_paint {
	/* As many as the scene has, and some that vectors read beyond: words as above; 255: edges, features, colours that differ from those
	 * around, 0: all is even. */
	uint32_t *look;
	uint8_t *detail;
	struct scene_paint_chunk *chunk; /* scene_paint_chunk_of() */
	uint32_t *stamp;                 /* with a pager, of each chunk that this is of */
	float (*middle_m)[3];            /* with a pager, of every number of a leaf */
};

/* The scene's, which whoever asks holds until it is released. With a pager it is of the chunks that the last turn left. Any thread, this
 * and all that follows. */
const scene_paint *scene_paint_hold(const scene *s);
void scene_paint_release(const scene *s);
/* Where it is not held: 5 bytes a point are given back. */
void scene_paint_forget(const scene *s);
bool scene_paint_is_there(const scene *s);
/* Where somebody holds it. */
static inline const scene_paint *scene_paint_of(const scene *s);
static inline const struct scene_paint_chunk *scene_paint_chunk_of(
	const scene_paint *p, const scene *s, const struct scene_chunk *c)
{
	return &p->chunk[s->pager ? c->first / SCENE_PAGER_ALIGNED : (uint32_t)(c - s->chunk)];
}
/* For the pager, within a turn: what is new is looked at, if anything is painted. */
void scene_paint_follow(const scene *s);

/* For scene.c and scene-pager.c. */
struct scene_paint_plane {
	GMutex lock;
	uint32_t holders;
	scene_paint paint; /* look NULL: it is not there */
};
static inline const scene_paint *scene_paint_of(const scene *s)
{
	return &s->paint->paint;
}
struct scene_paint_plane *scene_paint_new(void);
void scene_paint_free(struct scene_paint_plane *p); /* NULL is fine */

#endif
