#ifndef RENDER_SCENE_GREY_H
#define RENDER_SCENE_GREY_H
/* Points that nobody photographed are as light as their intensities say, which scanners give in units of their own: spread so that
 * those of most points lie between a dark and a light grey. */
#include "process/model.h"
#include <math.h>

#define SCENE_GREY_DARK  48.f
#define SCENE_GREY_LIGHT 224.f
#define SCENE_GREY_NONE  168 /* of points that have neither */

struct scene_grey {
	float least, by; /* by 0: there are no intensities */
};
/* By some points of each chunk. */
struct scene_grey scene_grey_of(const model *m);

/* Of a point without a colour: opaque, where it has an intensity. */
static inline void scene_grey_colour(
	const struct scene_grey *g, uint16_t intensity, uint8_t ret_rgba[4])
{
	float grey = SCENE_GREY_DARK + ((float)intensity - g->least) * g->by;
	bool known = g->by > 0;
	uint8_t value = known ? (uint8_t)fminf(fmaxf(grey, SCENE_GREY_DARK), SCENE_GREY_LIGHT)
			      : SCENE_GREY_NONE;
	ret_rgba[0] = ret_rgba[1] = ret_rgba[2] = value;
	ret_rgba[3] = known ? 255 : 0;
}

#endif
