#ifndef RENDER_GLES_SHADERS_H
#define RENDER_GLES_SHADERS_H
/* The shaders that gles draws with: files of render/shaders/, which the build puts into the library. "mask" is mask.glsl. A file with
 * #version is a shader; the others are parts that several have in common (gles-program.h). */
#include <stddef.h>

struct gles_shader {
	const char *name, *text;
};
extern const struct gles_shader gles_shaders[]; /* by name; ends with a row without a name */

/* NULL: there is none. */
const char *gles_shader_find(const char *name);
/* The texts of these, one after the other; names ends with NULL. The caller frees it. */
char *gles_shaders_join(const char *const *names);

#endif
