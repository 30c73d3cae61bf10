#ifndef RENDER_GLES_PROGRAM_LIMITS_H
#define RENDER_GLES_PROGRAM_LIMITS_H
/* Asks a linked program whether a small board would take it; gles-program.h says what that is. */
#include "render/gles-functions.h"
#include "render/gles-shader-text.h"

/* Of one program; NULL where there is no such shader. */
struct gles_program_texts {
	const gles_shader_text *vertex, *fragment, *compute;
};

bool gles_program_check(const struct gles_functions *gl, GLuint program,
	const struct gles_program_texts *texts, GError **error);

#endif
