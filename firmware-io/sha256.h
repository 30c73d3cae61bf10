#ifndef FIRMWARE_IO_SHA256_H
#define FIRMWARE_IO_SHA256_H
/* SHA-256 (FIPS 180-4), with the processor's own instructions where it has them; GChecksum elsewhere, with the same result. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct sha256 sha256;
sha256 *sha256_new(void);
void sha256_update(sha256 *s, const void *bytes, size_t length);
char *sha256_end(sha256 *s); /* 64 hex digits, caller frees; the sum can only be freed then */
void sha256_free(sha256 *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(sha256, sha256_free)

/* All at once; caller frees. */
char *sha256_of(const void *bytes, size_t length);

#endif
