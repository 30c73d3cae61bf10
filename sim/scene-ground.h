#ifndef SIM_SCENE_GROUND_H
#define SIM_SCENE_GROUND_H
/* Ground that follows the site's relief, and what lies on it. */
#include "sim/scene-palette.h"

/* A sheet over the rectangle, `above` metres over the relief; the material comes from choose(),
 * whose edges it follows to a centimetre, or is the pen's where that is NULL. The pen must be in
 * the world's frame. */
void draw_ground(const struct site *s, const struct pen *p, vec low, vec high, float cell_m,
	float above, uint16_t (*choose)(float x, float y, const void *data), const void *data);
/* A bed of grass in a kerb, its tufts included. */
void draw_bed(struct site *s, const struct palette *m, float x0, float y0, float x1, float y1,
	uint32_t tuft);
/* A kerb of stone along a straight line, following the relief. */
void draw_kerb(const struct site *s, const struct pen *p, vec a, vec b, float width, float height);

#endif
