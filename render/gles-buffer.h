#ifndef RENDER_GLES_BUFFER_H
#define RENDER_GLES_BUFFER_H
/* A buffer that grows as it is needed, and is kept from frame to frame.
 *
 * What the processor puts into it goes into a store that no command reads which was given before and may not be done: drivers should see to
 * that, and NVIDIA's (580, OpenGL ES 3.2, an H200) does not where compute shaders read. With BufferSubData it wrote the chunks of a second
 * sheet before the points of the first one had been drawn by theirs; with BufferData too, once several programs shared the GPU and it lay
 * far behind. So stores are given up, not written again or freed, until the GPU has come to rest.
 *
 * What the processor reads is copied into a store that is there for nothing else. One that is mapped moves into the processor's memory, on
 * NVIDIA for good, and shaders reach it over the bus from then on: filters took 1.6 times as long. */
#include "render/gles-context.h"

struct gles_buffer {
	GLuint name;
	int64_t bytes;
};
/* At least so large; what was in it is lost when it grows. Refuses more than a storage block may have, "WHAT need ... MB at once". */
bool gles_buffer_reserve(const gles_context *c, struct gles_buffer *b, int64_t bytes,
	const char *what, GError **error);
/* These bytes, instead of what was in it, in another store. */
bool gles_buffer_put(const gles_context *c, struct gles_buffer *b, const void *from, int64_t bytes,
	const char *what, GError **error);
/* Its first bytes, once what writes them is done. */
bool gles_buffer_read(
	const gles_context *c, const struct gles_buffer *b, size_t bytes, void *to, GError **error);
/* The bound framebuffer, row by row, rgba. */
bool gles_pixels_read(
	const gles_context *c, uint32_t width, uint32_t height, uint8_t (*to)[4], GError **error);
void gles_buffer_clear(const gles_context *c, struct gles_buffer *b);

/* Between frames: waits until all commands are done; stores that were given up are free again. */
void gles_buffers_rest(const gles_context *c);

#endif
