#ifndef PROCESS_E57_WRITE_H
#define PROCESS_E57_WRITE_H
/* The bytes of an E57 file (e57.h) as it is written: pages with their CRCs, compressed vectors, blobs. What the file itself refuses
 * shows in ferror, for whoever opened it. One owner, one thread. */
#include "process/e57.h"
#include <glib.h>
#include <stdbool.h>
#include <stdio.h>

typedef struct e57_write e57_write;
e57_write *e57_write_new(FILE *file); /* empty, open for reading too; with room for the header */
void e57_write_free(e57_write *w);    /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(e57_write, e57_write_free)
uint64_t e57_write_at(const e57_write *w); /* logical offset of what comes next */
void e57_write_bytes(e57_write *w, const void *bytes, size_t length);
/* A whole blob; returns its physical offset. */
uint64_t e57_write_blob(e57_write *w, const void *bytes, size_t length);
/* The XML, the last page, the header. */
void e57_write_end(e57_write *w, const char *xml, size_t length);

/* Records of whole numbers, each less its field's minimum. */
typedef struct e57_vector_write e57_vector_write;
/* bits: of each field; not all of them 0. */
e57_vector_write *e57_vector_write_new(e57_write *w, const unsigned *bits, unsigned fields);
void e57_vector_write_free(e57_vector_write *v); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(e57_vector_write, e57_vector_write_free)
/* Room for the numbers of one record, one a field, which the next call takes. */
uint64_t *e57_vector_write_next(e57_vector_write *v);
/* The physical offset of the section. */
uint64_t e57_vector_write_end(e57_vector_write *v);

#endif
