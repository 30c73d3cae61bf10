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

static bool make_store(const gles_context *c, struct gles_buffer *b, int64_t bytes, GLenum usage,
	const char *what, GError **error)
{
	c->gl.GenBuffers(1, &b->name);
	c->gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, b->name);
	c->gl.BufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)bytes, NULL, usage);
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
	return make_store(c, b, bytes, GL_DYNAMIC_COPY, what, error);
}

/* The one of the spare stores that is large enough, and not much larger. */
static bool take_spare(const gles_context *c, struct gles_buffer *b, int64_t bytes)
{
	for (guint n = 0; n < c->spare->len; n++) {
		struct gles_buffer one = g_array_index(c->spare, struct gles_buffer, n);
		if (one.bytes < bytes || one.bytes > 2 * bytes)
			continue;
		g_array_remove_index_fast(c->spare, n);
		*b = one;
		c->gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, b->name);
		return true;
	}
	return false;
}

bool gles_buffer_put(const gles_context *c, struct gles_buffer *b, const void *from, int64_t bytes,
	const char *what, GError **error)
{
	if (!fits(c, bytes, what, error))
		return false;
	if (b->name)
		g_array_append_val(c->spent, *b);
	*b = (struct gles_buffer){ 0 };
	int64_t room = MAX(bytes, 16), roomy = (room + room / 4 + 15) / 16 * 16;
	roomy = MIN(roomy, c->about.limits.storage_block_bytes);
	if (!take_spare(c, b, room) &&
		!make_store(c, b, MAX(room, roomy), GL_STREAM_DRAW, what, error))
		return false;
	c->gl.BufferSubData(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)bytes, from);
	return true;
}

/* ---- to the processor ---- */

/* What one thread takes at a time. */
#define PIECE_BYTES ((size_t)512 << 10)

static bool hold_landing(const gles_context *c, size_t bytes, GError **error)
{
	struct gles_buffer *l = c->landing;
	if (l->name && l->bytes >= (int64_t)bytes)
		return true;
	gles_buffer_clear(c, l);
	return make_store(c, l, (int64_t)bytes, GL_STREAM_READ, "what is read", error);
}

/* Bound as COPY_READ_BUFFER. */
static bool fetch_landing(const gles_context *c, size_t bytes, void *to, GError **error)
{
	const uint8_t *from =
		c->gl.MapBufferRange(GL_COPY_READ_BUFFER, 0, (GLsizeiptr)bytes, GL_MAP_READ_BIT);
	if (from) {
#pragma omp parallel for schedule(static) if (bytes > PIECE_BYTES)
		for (size_t n = 0; n < bytes; n += PIECE_BYTES)
			memcpy((uint8_t *)to + n, from + n, MIN(PIECE_BYTES, bytes - n));
		c->gl.UnmapBuffer(GL_COPY_READ_BUFFER);
		return true;
	}
	if (gles_context_check(c, "reading from the GPU", error))
		g_set_error(error, GLES_ERROR, GLES_ERROR_DRIVER,
			"the GPU does not give back what it made");
	return false;
}

bool gles_buffer_read(
	const gles_context *c, const struct gles_buffer *b, size_t bytes, void *to, GError **error)
{
	if (!hold_landing(c, bytes, error))
		return false;
	c->gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	c->gl.BindBuffer(GL_COPY_READ_BUFFER, b->name);
	c->gl.BindBuffer(GL_COPY_WRITE_BUFFER, c->landing->name);
	c->gl.CopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, (GLsizeiptr)bytes);
	c->gl.BindBuffer(GL_COPY_READ_BUFFER, c->landing->name);
	return fetch_landing(c, bytes, to, error);
}

bool gles_pixels_read(
	const gles_context *c, uint32_t width, uint32_t height, uint8_t (*to)[4], GError **error)
{
	size_t bytes = (size_t)width * height * 4;
	if (!hold_landing(c, bytes, error))
		return false;
	c->gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
	c->gl.BindBuffer(GL_PIXEL_PACK_BUFFER, c->landing->name);
	c->gl.ReadPixels(0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
	c->gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	c->gl.BindBuffer(GL_COPY_READ_BUFFER, c->landing->name);
	return fetch_landing(c, bytes, to, error);
}

/* ---- rest ---- */

void gles_buffer_clear(const gles_context *c, struct gles_buffer *b)
{
	if (b->name)
		g_array_append_val(c->gone, *b);
	*b = (struct gles_buffer){ 0 };
}

static void free_stores(const gles_context *c, GArray *stores)
{
	for (guint n = 0; n < stores->len; n++)
		c->gl.DeleteBuffers(1, &g_array_index(stores, struct gles_buffer, n).name);
	g_array_set_size(stores, 0);
}

void gles_buffers_rest(const gles_context *c)
{
	c->gl.Finish();
	free_stores(c, c->gone);
	/* What the last frame did not want the next one will not want. */
	free_stores(c, c->spare);
	g_array_append_vals(c->spare, c->spent->data, c->spent->len);
	g_array_set_size(c->spent, 0);
}
