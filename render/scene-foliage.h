#ifndef RENDER_SCENE_FOLIAGE_H
#define RENDER_SCENE_FOLIAGE_H
/* How much of what is seen of foliage its points stand for. On a wall what points stand for lies side by side, and of two scans one was
 * left out (process/overlap.h). No two scans met the same leaves: all are kept, and hang before each other; which way they stand nobody
 * knows; and discs cover gaps between them. So strokes would be too many where leaves were met by many beams, and too few where these
 * are far apart. Of a cloud nobody knows the beams, only the room around each point: twice too many there. Close to a scanner leaves are
 * large enough to look like surface, and hang before each other all the same. */
#include "render/scene.h"

/* Changes the spacings of the chunk's points without a direction, which are of vegetation, and of what is surface among them. p: the model's,
 * in the same order. Positions, spacings and kinds must be there, and c->part. */
void scene_foliage_chunk(scene *s, const struct scene_chunk *c, const struct model_point *p);

#endif
