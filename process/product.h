#ifndef PROCESS_PRODUCT_H
#define PROCESS_PRODUCT_H
/* Files of what was computed (geometry, model): sections of plain arrays, mapped into memory to read, each with a checksum.
 * They can be deleted and made again.
 *
 *     "PLPRODUC", u32 version of the container, u32 sections, u64 offset of the table, u64 length of the file,
 *     u32 CRC-32C of the table, u32 CRC-32C of this header up to here; padded to 64 bytes
 *     sections, each from a multiple of 64 bytes on
 *     the table: per section char name[24], u32 element_bytes, u32 CRC-32C of the section, u64 offset, u64 elements
 *
 * The section "manifest" is JSON text: kind, version of the kind, and what it was made from. A file is written under another
 * name, synced and renamed, so it is whole or not there; a file must not be changed in place while it is mapped.
 * Little-endian. Names are unique; sections do not overlap. Errors are of G_IO_ERROR and PRODUCT_ERROR, one
 * sentence that begins with the path. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct _JsonObject JsonObject;

#define PRODUCT_ERROR (product_error_quark())
GQuark product_error_quark(void);
enum product_error { PRODUCT_ERROR_DAMAGED, PRODUCT_ERROR_KIND, PRODUCT_ERROR_VERSION };

typedef struct product product;
/* Maps the file and checks header, table and manifest. Refuses another kind and a later version. */
product *product_open(const char *path, const char *kind, int version, GError **error);
int product_version(const product *p); /* of its kind: that it was written with */
void product_free(product *p);         /* NULL is fine; what sections gave goes with it */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(product, product_free)
const char *product_path(const product *p);
JsonObject *product_manifest(const product *p); /* owned by p */
/* Over the checksums of all sections: another one when any of the contents is another. */
uint32_t product_checksum(const product *p);
/* The array itself, in the mapping; NULL when it is missing or of another element size. */
const void *product_section(const product *p, const char *name, uint32_t element_bytes,
	uint64_t *ret_elements, GError **error);
/* CRC-32C that the file has of a section; 0 when it is missing. */
uint32_t product_section_checksum(const product *p, const char *name);
/* Reads all of the file and compares the checksums. The mapping holds no more memory after it than before. */
bool product_verify(const product *p, GError **error);
/* Gives back the memory of a part of a section that was read, which stays readable: whoever walks through a file that is
 * larger than memory calls it behind itself. */
void product_forget(const product *p, const void *from, size_t bytes);

/* The file that is mapped once more, to be read without the mapping: what the disk fails to give is an error then, and ends nobody. An error
 * when there is another file by its name now. Close it. */
int product_reopen(const product *p, GError **error);
/* Reads a part of a section so. Any thread. */
bool product_read(
	const product *p, int fd, const void *from, size_t bytes, void *to, GError **error);

typedef struct product_writer product_writer;
product_writer *product_writer_new(const char *path, GError **error);
/* Sections are written one after another; append may be called any number of times. */
bool product_writer_begin(
	product_writer *w, const char *name, uint32_t element_bytes, GError **error);
bool product_writer_append(product_writer *w, const void *elements, uint64_t count, GError **error);
/* Writes manifest (taken; kind and version are added) and table, syncs, renames. The writer can only be freed then. */
bool product_writer_finish(
	product_writer *w, const char *kind, int version, JsonObject *manifest, GError **error);
void product_writer_free(product_writer *w); /* NULL is fine; removes what was not finished */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(product_writer, product_writer_free)

#endif
