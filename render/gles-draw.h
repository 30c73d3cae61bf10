#ifndef RENDER_GLES_DRAW_H
#define RENDER_GLES_DRAW_H
/* The gles backend: draws frames on a GPU. The picture is draw.h's, but for roundings; the same frame gives the same bytes again on
 * the same GPU and driver, for nothing depends on the order in which its threads come: depths by their least, sums of points in
 * integers, strokes numbered before they are written.
 *
 * Of a scene and a frame it keeps what it copied, known by their serials, until another one comes. On the thread of its context,
 * while that is current. */
#include "render/draw.h"
#include "render/gles-context.h"

typedef struct gles_draw gles_draw;
/* Compiles its programs. The context must live longer, and its about say what may be used: tests take something away. */
gles_draw *gles_draw_new(const gles_context *c, GError **error);
void gles_draw_free(gles_draw *d); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(gles_draw, gles_draw_free)

/* Strokes are put by compute shaders (gles-ink.h) instead of blending, or the other way round; at first it is what is faster here. */
void gles_draw_set_sums(gles_draw *d, bool sums_ink);

/* Into a picture of the camera's size, whose memory is the caller's. ret_times: NULL is faster. Errors are of gles_error, one
 * sentence: pictures too large for the GPU, no memory left, a GPU that was reset; the picture is not whole then. */
bool gles_draw_frame(gles_draw *d, const frame *f, struct picture_buffer *to,
	struct draw_times *ret_times, GError **error);

#endif
