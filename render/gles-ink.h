#ifndef RENDER_GLES_INK_H
#define RENDER_GLES_INK_H
/* Strokes without blending: compute shaders add what each leaves in its pixels to words of a buffer (shaders/ink-sums.glsl), in whole
 * numbers, so that their order is of no matter. GPUs that are made for reckoning have few processors that can blend (an H200 four of
 * 132), and these have all of them; small boards blend in their tiles, which is faster there. So it is tried out which it is. Beside
 * gles-draw-ink.c, whose pictures are the same but for roundings. */
#include "render/gles-draw-private.h"

/* Whether adding is clearly faster than blending on the GPU of c, which is current; software blends. PLEINAIR_INK=added|blended says it
 * without a trial. */
bool gles_ink_trial(const gles_context *c, bool *ret_sums, GError **error);

/* It is wanted, and the buffer is not larger than the GPU allows. */
bool gles_ink_is_summed(const gles_draw *d, const struct frame_layer *l);
/* A layer's strokes, onto the canvas; its block is bound. */
bool gles_ink_put(gles_draw *d, const struct frame_layer *l, uint32_t layer, GError **error);

#endif
