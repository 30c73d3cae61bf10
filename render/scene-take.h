#ifndef RENDER_SCENE_TAKE_H
#define RENDER_SCENE_TAKE_H
/* Points of a model become those of a scene, a chunk at a time. Internal to scene.c and scene-pager.c. */
#include "render/scene-grey.h"
#include "render/scene.h"

/* What a thread needs for it. */
typedef struct scene_taker scene_taker;
scene_taker *scene_taker_new(void);
void scene_taker_free(scene_taker *t); /* NULL is fine */

/* Where the chunk is, and how many points it has: all that there are. */
void scene_place_chunk(const scene *s, struct scene_chunk *c, const struct model_chunk *from);
/* The points of a chunk that is placed, from c->first on. When c->part is less than 1, they are that part of all where they are, and
 * stand for as much more surface. */
void scene_take(scene_taker *t, scene *s, struct scene_chunk *c, const struct model_point *p,
	const struct scene_grey *grey);
/* The scene's unit and median spacing, by the points of some chunks; origin, levels and densities of dithering points, of all of the
 * model. */
void scene_find_spacing(scene *s, const model *m);
void scene_find_origin(scene *s, const struct model_chunk *chunk, uint64_t chunks);
void scene_find_densities(scene *s, const model *m);
/* count: of the points of each lightness. */
void scene_set_levels(scene *s, const uint32_t count[256]);
/* Memory for so many points, of any content; lists are not yet 0. */
void scene_alloc_points(scene *s, size_t count);

#endif
