#ifndef RENDER_PROFILE_STROKES_H
#define RENDER_PROFILE_STROKES_H
/* Profile lines as strokes of the cpu backend: those of profile-links.h as far as the mask shows them. struct stroke of them: point is the
 * line's number (scene-lines.h), copy 1 where the stroke goes on where the one before it ended, which makes runs of the pen of them.
 * Whether it is hidden was told for all of a link: at its pixels nobody asks the mask again. */
#include "render/stroke-brush.h"

#define PROFILE_ALPHA_LEAST (1 / 255.f)

/* m NULL: nothing is hidden. In the order of lines, the same on any number of threads. */
void profile_strokes(const frame *f, const struct frame_layer *l, const visibility_mask *m,
	struct stroke_chain *to);

#endif
