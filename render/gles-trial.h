#ifndef RENDER_GLES_TRIAL_H
#define RENDER_GLES_TRIAL_H
/* A picture of 16 x 16 pixels, made the way strokes are: a compute shader fills a buffer, whose entries are drawn as quads, one a
 * pixel, into a texture, which is read back. Drivers exist that open a context and then draw nothing, or something else. */
#include "render/gles-context.h"

/* On the thread of c, while c is current; leaves nothing behind in it. false: GLES_ERROR_DRIVER with the first wrong pixel, or
 * what gles-program.h says of the shaders. */
bool gles_trial(const gles_context *c, GError **error);

#endif
