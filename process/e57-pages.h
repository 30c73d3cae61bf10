#ifndef PROCESS_E57_PAGES_H
#define PROCESS_E57_PAGES_H
/* The bytes of an E57 file (e57.h) without the CRCs, each page checked against its own before any byte of it is given. One owner,
 * one thread. Errors as import.h says; what is cut short or damaged names the byte of the file. */
#include "process/e57.h"
#include "process/import.h"

typedef struct e57_pages e57_pages;
e57_pages *e57_pages_new(import_source *file); /* which must stay */
void e57_pages_free(e57_pages *p);             /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(e57_pages, e57_pages_free)

/* Logical bytes of the file as it is. */
uint64_t e57_pages_size(const e57_pages *p);
/* All length bytes from there, or an error. */
bool e57_pages_read(e57_pages *p, uint64_t logical, void *into, size_t length, GError **error);
/* "PATH: byte 1024: WHAT" of the logical offset; false. */
bool e57_pages_refuse(GError **error, const e57_pages *p, uint64_t logical, const char *format, ...)
	G_GNUC_PRINTF(4, 5);

#endif
