#ifndef PROCESS_ALIGN_STORE_H
#define PROCESS_ALIGN_STORE_H
/* The scans of a site ready for aligning, each made when it is first asked for and kept as long as memory allows, for any
 * number of threads; two scans at a time are in memory with all their points. */
#include "acquire/site.h"
#include "process/align-scans.h"
#include "process/alikes.h"

typedef struct align_store align_store;
/* The site must live as long, and not change. bytes_max: what scans that nobody uses may take together; known: what is known of them,
 * and takes what becomes known. */
align_store *align_store_new(const site *s, uint64_t bytes_max, alikes *known);
void align_store_free(align_store *store); /* NULL is fine; all scans must have been given back */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(align_store, align_store_free)

/* Waits while another thread makes it. NULL and an error: it cannot be read. */
const align_scan *align_store_get(align_store *store, uint32_t number, GError **error);
void align_store_give_back(align_store *store, const align_scan *scan); /* NULL is fine */

#endif
