#ifndef RENDER_SCENE_GREY_H
#define RENDER_SCENE_GREY_H
/* Points that nobody photographed. They are as light as their intensities say, which scanners give in units of their own: spread so
 * that those of most points lie between a dark and a light grey; without intensities, as a plaster cast is lit, by the way that they
 * face. Of the site's class they have a hue, of the same lightness: leaves a green one, water a blue one. So whatever looks at tones
 * finds the scanner's, and what paints has more than greys to paint with. */
#include "process/model.h"

#define SCENE_GREY_DARK  48.f
#define SCENE_GREY_LIGHT 224.f
#define SCENE_GREY_NONE  168.f /* of points that have no intensity, and face the light */

struct scene_grey {
	float least, by;           /* by 0: there are no intensities */
	const uint8_t *leaf_class; /* as segments_classes() has them; NULL: greys. Must stay */
};
/* By some points of each chunk. */
struct scene_grey scene_grey_of(const model *m, const uint8_t *leaf_class);

/* Of a point without a colour; opaque where it has an intensity. normal NULL: nobody knows. */
void scene_grey_colour(const struct scene_grey *g, uint16_t intensity, uint32_t leaf,
	const int16_t normal[2], uint8_t ret_rgba[4]);

#endif
