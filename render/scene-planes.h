#ifndef RENDER_SCENE_PLANES_H
#define RENDER_SCENE_PLANES_H
/* The plane surfaces of a scene (process/plane-regions.h), drawn in place of their points where a style says so (struct mask_step). All
 * of them are there, however few of the points are: they are small. Points that they explain are marked in the scene's discs. */
#include "process/plane-regions.h"
#include "render/scene-grey.h"
#include "render/scene.h"

/* Of a point's disc: the rest is its diameter. */
#define SCENE_DISC_PLANE 0x8000u
#define SCENE_DISC_MOST  0x7fffu

#define SCENE_PLANE_LEVELS 14

/* Textures become smaller by halves, until they are a texel. */
struct scene_plane_level {
	uint32_t first, width, height; /* of texel */
};
struct scene_plane {
	const struct plane_region *region;
	struct scene_plane_level level[SCENE_PLANE_LEVELS];
	uint32_t levels;
};

struct scene_planes {
	plane_regions *regions;
	uint32_t count, texels;
	struct scene_plane *plane;
	uint8_t (*texel)[4]; /* sRGB, 255; of all levels of all planes */
};
/* Those of the model, beside its file. *ret NULL, which is no error: there are none, or they are those of another model. */
bool scene_planes_load(
	const model *m, const struct scene_grey *grey, struct scene_planes **ret, GError **error);
void scene_planes_free(struct scene_planes *p); /* NULL is fine */

/* Marks those points of a chunk that planes explain, by their numbers in the model. */
void scene_planes_mark(scene *s, struct scene_chunk *c);

/* Diameter of a point's disc, in units of the scene. */
static inline uint16_t scene_disc(const scene *s, uint32_t point)
{
	return s->disc[point] & SCENE_DISC_MOST;
}

#endif
