#ifndef RENDER_GLES_ABOUT_GL_H
#define RENDER_GLES_ABOUT_GL_H
/* Asks the context that is current what gles-about.h says. */
#include "render/gles-about.h"
#include "render/gles-functions.h"

/* All but platform and display. Refuses, with GLES_ERROR_NONE, what is less than OpenGL ES 3.1. */
bool gles_about_fill(struct gles_about *a, const struct gles_functions *gl, GError **error);

#endif
