#ifndef RENDER_GLES_PROGRAM_H
#define RENDER_GLES_PROGRAM_H
/* Compiles and links shaders, and refuses what small boards would refuse, whatever the GPU at hand could do: the measure is V3D,
 * the GPU of the Raspberry Pi 4 (Mesa, src/gallium/drivers/v3d/v3d_screen.c).
 *
 *   storage buffers, atomic counters, images in vertex shaders    none
 *   invocations of a compute group                                256
 *   shared variables of a compute group                           32 KiB
 *   colour outputs of a fragment shader                           4
 *   point size                                                    512 pixels
 *   GLSL                                                          310 es; of extensions GL_OES_shader_image_atomic
 *   64-bit integers and atomics, geometry and tessellation shaders  none
 *
 * The linked program is asked where OpenGL ES can tell; the rest is read from the text (gles-shader-text.h). Images, counters and
 * outputs that nothing uses do not count, as for drivers. A storage buffer counts where it is declared: its block is active, used
 * or not (OpenGL ES 3.1, 7.3.1), and which shader uses it, Mesa does not always know. So a common text for vertex shaders has
 * none, also where only the fragment shader would use it.
 *
 * Errors are one sentence: GLES_ERROR_COMPILE "strokes (vertex) line 12: 'x' undeclared", GLES_ERROR_LIMIT "strokes (vertex) line
 * 4: the storage buffer Points in a vertex shader; small boards have none there". Warnings of compilers go to g_debug. */
#include "render/gles-context.h"

struct gles_program_desc {
	const char *name;   /* for messages */
	const char *common; /* put into each shader behind its #version line; NULL is fine */
	const char *vertex, *fragment; /* both, */
	const char *compute;           /* or this alone */
};

#define GLES_GROUP_MAX   256
#define GLES_OUTPUTS_MAX 4
#define GLES_POINT_MAX   512

/* On the thread of c, while c is current. The caller deletes it (glDeleteProgram). 0: error says why. */
GLuint gles_program_new(
	const gles_context *c, const struct gles_program_desc *desc, GError **error);

#endif
