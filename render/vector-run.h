#ifndef RENDER_VECTOR_RUN_H
#define RENDER_VECTOR_RUN_H
/* Runs of the pen along profile lines (profile-strokes.h) as one area each, which grows and shrinks as the pen presses: what a person takes
 * hold of and changes. Corners that lie within a tolerance of the line through others are left out. */
#include "render/stroke.h"

/* Off the true outline by so much at most, in pixels of the style. */
#define VECTOR_RUN_OFF_PX 0.12f
/* Where a line fades away it comes in runs, within each of which alpha is within this of the first. */
#define VECTOR_RUN_ALPHA 0.12f

/* How many of the strokes from first on, of all, make up one run. */
uint32_t vector_run_length(const struct stroke *stroke, uint32_t first, uint32_t count);
/* What goes around a run, in pixels of the picture; px: of one of the style's. ret: of float[2]; emptied first. */
void vector_run_outline(const struct stroke *run, uint32_t count, float px, GArray *ret);
/* By how long its strokes are. */
float vector_run_alpha(const struct stroke *run, uint32_t count);

#endif
