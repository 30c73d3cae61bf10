#ifndef PROCESS_PRODUCT_FORMAT_H
#define PROCESS_PRODUCT_FORMAT_H
/* The bytes of a product file (product.h), for its reader, its writer and their tests. */
#include <glib.h>
#include <stdint.h>

#define PRODUCT_MAGIC        "PLPRODUC"
#define PRODUCT_CONTAINER    1u
#define PRODUCT_ALIGNMENT    64u
#define PRODUCT_SECTIONS_MAX 1000u
#define PRODUCT_MANIFEST     "manifest"
#define PRODUCT_MANIFEST_MAX (64u << 20) /* bytes */

struct product_header {
	char magic[8];
	uint32_t container, sections;
	uint64_t table_offset, file_bytes;
	uint32_t table_crc32c;
	uint32_t header_crc32c; /* of the 36 bytes before it */
	uint8_t reserved[24];
};
_Static_assert(sizeof(struct product_header) == 64, "the file's own layout");

struct product_entry {
	char name[24]; /* ends in a zero */
	uint32_t element_bytes, crc32c;
	uint64_t offset, elements;
};
_Static_assert(sizeof(struct product_entry) == 48, "the file's own layout");
_Static_assert(G_BYTE_ORDER == G_LITTLE_ENDIAN, "products are mapped as they are");

#endif
