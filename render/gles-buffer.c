#include "render/gles-buffer.h"
#include <string.h>

static bool fits(const gles_context *c, int64_t bytes, const char *what, GError **error)
{
	if (bytes <= c->about.limits.storage_block_bytes)
		return true;
	g_set_error(error, GLES_ERROR, GLES_ERROR_LIMIT,
		"%s need %.0f MB at once, and the GPU has %.0f", what, (double)bytes / 1e6,
		(double)c->about.limits.storage_block_bytes / 1e6);
	return false;
}

/* from NULL: of any content. */
static bool make_store(const gles_context *c, struct gles_buffer *b, const void *from,
	int64_t bytes, const char *what, GError **error)
{
	if (!b->name)
		c->gl.GenBuffers(1, &b->name);
	c->gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, b->name);
	c->gl.BufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)bytes, from,
		from ? GL_STREAM_DRAW : GL_DYNAMIC_COPY);
	b->bytes = bytes;
	g_autofree char *making = g_strdup_printf("making room for %s", what);
	if (gles_context_check(c, making, error))
		return true;
	gles_buffer_clear(c, b);
	return false;
}

bool gles_buffer_reserve(const gles_context *c, struct gles_buffer *b, int64_t bytes,
	const char *what, GError **error)
{
	if (b->name && b->bytes >= bytes)
		return true;
	if (!fits(c, bytes, what, error))
		return false;
	gles_buffer_clear(c, b);
	return make_store(c, b, NULL, bytes, what, error);
}

bool gles_buffer_put(const gles_context *c, struct gles_buffer *b, const void *from, int64_t bytes,
	const char *what, GError **error)
{
	return fits(c, bytes, what, error) &&
	       make_store(c, b, bytes ? from : NULL, bytes ? bytes : 16, what, error);
}

bool gles_buffer_read(
	const gles_context *c, const struct gles_buffer *b, size_t bytes, void *to, GError **error)
{
	c->gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	c->gl.BindBuffer(GL_COPY_READ_BUFFER, b->name);
	const void *from =
		c->gl.MapBufferRange(GL_COPY_READ_BUFFER, 0, (GLsizeiptr)bytes, GL_MAP_READ_BIT);
	if (from) {
		memcpy(to, from, bytes);
		c->gl.UnmapBuffer(GL_COPY_READ_BUFFER);
		return true;
	}
	if (gles_context_check(c, "reading from the GPU", error))
		g_set_error(error, GLES_ERROR, GLES_ERROR_DRIVER,
			"the GPU does not give back what it made");
	return false;
}

void gles_buffer_clear(const gles_context *c, struct gles_buffer *b)
{
	c->gl.DeleteBuffers(1, &b->name);
	b->name = 0;
	b->bytes = 0;
}
