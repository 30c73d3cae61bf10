#ifndef RENDER_FRAME_WANT_H
#define RENDER_FRAME_WANT_H
/* How many strokes a layer wants of points, by how light these are. Internal to frame.c. */
#include "render/frame.h"
#include "render/scene-list.h"

#define FRAME_DENSEST_PER_PX 4.f

/* wanted_per_px and dithering_per_m2 */
void frame_want(struct frame_layer *l, const scene *s);
/* What is wanted at most. lit, 0..1: of a point that is lit it is what a darker one wants, down to this part less light. */
void frame_want_at_most(struct frame_layer *l, const scene *s, float lit);

#endif
