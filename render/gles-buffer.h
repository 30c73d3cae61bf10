#ifndef RENDER_GLES_BUFFER_H
#define RENDER_GLES_BUFFER_H
/* A buffer that grows as it is needed, and is kept from frame to frame. */
#include "render/gles-context.h"

struct gles_buffer {
	GLuint name;
	int64_t bytes;
};
/* At least so large; what was in it is lost when it grows. Refuses more than a storage block may have, "WHAT need ... MB at once". */
bool gles_buffer_reserve(const gles_context *c, struct gles_buffer *b, int64_t bytes,
	const char *what, GError **error);
/* These bytes, instead of what was in it, in a store that is new each time: into one that earlier commands still read NVIDIA's driver
 * (580, OpenGL ES 3.2) writes before they have. */
bool gles_buffer_put(const gles_context *c, struct gles_buffer *b, const void *from, int64_t bytes,
	const char *what, GError **error);
/* Its first bytes, once what writes them is done. */
bool gles_buffer_read(
	const gles_context *c, const struct gles_buffer *b, size_t bytes, void *to, GError **error);
void gles_buffer_clear(const gles_context *c, struct gles_buffer *b);

#endif
