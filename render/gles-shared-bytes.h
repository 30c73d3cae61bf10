#ifndef RENDER_GLES_SHARED_BYTES_H
#define RENDER_GLES_SHARED_BYTES_H
/* How much memory the shared variables of a compute shader take: OpenGL ES tells the most there may be, never what a program
 * takes, so it is read from the text. */
#include <stddef.h>
#include <stdint.h>

struct gles_shared {
	uint64_t bytes; /* three-vectors count as four numbers, bool as one */
	size_t offset;  /* where the largest stands, or the unclear one */
	char *unclear; /* NULL; else the declaration whose size cannot be told, the caller frees it */
};

/* plain: text without comments. What stands in #if counts, whether or not it holds. */
struct gles_shared gles_shared_bytes(const char *plain);

#endif
