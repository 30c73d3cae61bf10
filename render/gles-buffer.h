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
/* Its first bytes, once what writes them is done; and others into it. */
bool gles_buffer_read(
	const gles_context *c, const struct gles_buffer *b, size_t bytes, void *to, GError **error);
bool gles_buffer_write(const gles_context *c, const struct gles_buffer *b, const void *from,
	size_t bytes, GError **error);
void gles_buffer_clear(const gles_context *c, struct gles_buffer *b);

#endif
