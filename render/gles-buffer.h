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
void gles_buffer_clear(const gles_context *c, struct gles_buffer *b);

#endif
