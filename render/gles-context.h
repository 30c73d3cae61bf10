#ifndef RENDER_GLES_CONTEXT_H
#define RENDER_GLES_CONTEXT_H
/* An OpenGL ES 3.1 context (or a later one that ES 3.1 is part of) without a window: it draws into textures. It is current on
 * the thread that opened it, and used and freed there alone; several may be open, on several threads. What the driver has to
 * say (GL_KHR_debug) goes to g_debug; only where that is shown is the context a debugging one, which is slower.
 *
 * Broken drivers crash when a context is opened. So: gles_context_probe (gles-probe.h) first, in a child; then open what it found.
 * Errors are GLES_ERROR_NONE, one sentence. */
#include "render/gles-about.h"
#include "render/gles-display.h"
#include "render/gles-functions.h"

struct gles_buffer;
typedef struct gles_context gles_context;
struct gles_context {
	struct gles_about about;
	struct gles_functions gl;
	/* gles-buffer.c's. */
	GArray *spent, *gone, *spare; /* of struct gles_buffer */
	struct gles_buffer *landing;
	/* The rest is gles-context.c's. */
	const struct gles_display *display;
	EGLContext handle;
};

/* The context on this display; found->platform and found->display name it, the rest of found is not looked at. */
gles_context *gles_context_open(const struct gles_about *found, GError **error);
/* NULL is fine. What it made is gone with it. */
void gles_context_free(gles_context *c);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(gles_context, gles_context_free)

/* Makes it current again, where another one was opened on this thread. */
bool gles_context_use(gles_context *c, GError **error);

/* The GPU was reset: nothing that the context draws or holds is of use any more; free it, open another. False where
 * !about.has_reset_status, since the driver cannot tell. */
bool gles_context_is_lost(const gles_context *c);

/* glGetError, all of them: false with GLES_ERROR_DRIVER, "while WHAT, OpenGL said GL_INVALID_OPERATION". */
bool gles_context_check(const gles_context *c, const char *what, GError **error);

#endif
