#ifndef RENDER_EDL_H
#define RENDER_EDL_H
/* Eye-dome lighting (Boucheny 2009): shades by depth alone. A pixel is darker the more its neighbours on a ring stand before it. */
#include "render/bands.h"

/* Multiplies the canvas where a pipeline has a step "edl". */
void edl_shade(
	const struct band *b, const frame *f, const visibility_mask *m, float *const canvas[3]);

#endif
