#ifndef PROCESS_E57_VECTOR_H
#define PROCESS_E57_VECTOR_H
/* The records of a compressed vector of an E57 file (e57.h), block after block: of each field that is wanted its numbers, as doubles
 * (whole numbers beyond 2^53 are rounded). Streams of other fields, of text too, are passed over. One owner, one thread. */
#include "process/e57-tree.h"

typedef struct e57_vector e57_vector;
/* wanted: of each of the scan's fields whether it is; none of text may be. scan and pages must stay. */
e57_vector *e57_vector_open(
	e57_pages *pages, const struct e57_scan *scan, const bool *wanted, GError **error);
void e57_vector_free(e57_vector *v); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(e57_vector, e57_vector_free)

#define E57_BLOCK_RECORDS 8192u
/* The next records, at most max and E57_BLOCK_RECORDS; 0: that was all. */
bool e57_vector_read(e57_vector *v, size_t max, size_t *ret_count, GError **error);
/* Of the block that was read last; NULL: not wanted. */
const double *e57_vector_numbers(const e57_vector *v, unsigned field);
/* Of its section, logical. */
uint64_t e57_vector_bytes(const e57_vector *v);
/* Of its records that were read, 0..1. */
double e57_vector_fraction(const e57_vector *v);

#endif
