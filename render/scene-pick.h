#ifndef RENDER_SCENE_PICK_H
#define RENDER_SCENE_PICK_H
/* Which thing a finger means: the front surface near a place of the picture. */
#include "render/camera.h"
#include "render/scene.h"

struct scene_picked {
	double place_m[3]; /* in the site's frame */
	double depth_m;
	uint32_t leaf; /* of process/segments.h */
};
/* The nearest surface of what lies within radius_px of a place of the camera's picture: of the points there those in front, and of these
 * the leaf that most belong to and the point nearest to the place. leaves NULL: all; else only those whose byte is not 0 are seen.
 * false: there is nothing. Any thread. */
bool scene_pick(const scene *s, const struct camera *c, const uint8_t *leaves, const double px[2],
	double radius_px, struct scene_picked *ret);

#endif
