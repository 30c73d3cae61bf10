#ifndef RENDER_SCENE_COVER_H
#define RENDER_SCENE_COVER_H
/* How much surface the points of a chunk stand for, by what their discs cover. A point's spacing says what its own beam met; but beside
 * gaps, at the ends of what was seen and where beams hardly met anything, discs cover more than that, and strokes would be too few
 * for the surface that is shown there. */
#include "render/scene.h"

typedef struct scene_cover scene_cover;
scene_cover *scene_cover_new(void);    /* for one thread */
void scene_cover_free(scene_cover *w); /* NULL is fine */

/* Changes the spacings of the chunk's points on surface to what their discs cover, at least 1 and at most those of the discs. Positions,
 * normals, discs and kinds must be there. */
void scene_cover_chunk(scene_cover *w, scene *s, const struct scene_chunk *c);

#endif
