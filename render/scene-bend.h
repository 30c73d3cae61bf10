#ifndef RENDER_SCENE_BEND_H
#define RENDER_SCENE_BEND_H
/* How surfaces are bent: the principal curvatures of a scene's points, two bytes a point, read of the model when something that is drawn
 * first asks for them. A byte has a sign (128: the surface is hollow) and a step of a ninth of an octave, from 1/16 to over 1000 1/m;
 * what is bent less is 0, flat. */
#include "render/scene.h"

#define SCENE_BEND_STEPS 9.f  /* to an octave */
#define SCENE_BEND_LEAST 16.f /* m: radius of what is as good as flat */

/* Of each point k1, the one of the greater magnitude, and k2. NULL: the scene is of no model (scene_alloc). The scene's; any thread. */
const uint8_t (*scene_bend(const scene *s))[2];

/* The same of one chunk's points alone, which is not kept: in room, for so many as a chunk has, or where they are kept already. */
const uint8_t (*scene_bend_of_chunk(const scene *s, uint32_t chunk, uint8_t (*room)[2]))[2];

uint8_t scene_bend_pack(float per_m);
/* 1/m, of all bytes. */
const float *scene_bend_table(void);

/* For scene.c and scene-pager.c. */
struct scene_bend_plane {
	const model *model; /* NULL: k is there, and filled by others */
	gsize made;
	uint8_t (*k)[2];
};
/* scene_bend_pack() of all half floats. */
const uint8_t *scene_bend_halves(void);
void scene_bend_free(struct scene_bend_plane *b); /* NULL is fine */

#endif
