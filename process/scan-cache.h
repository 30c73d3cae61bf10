#ifndef PROCESS_SCAN_CACHE_H
#define PROCESS_SCAN_CACHE_H
/* The scans of a site that were last asked for, in memory: who goes over scans and their neighbours mostly asks for the same. A fine
 * grid has 50 MB. Not thread-safe. */
#include "process/scan-data.h"

typedef struct scan_cache scan_cache;
scan_cache *scan_cache_new(const site *s, guint scans); /* s must stay */
void scan_cache_free(scan_cache *c);                    /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_cache, scan_cache_free)
/* Owned by the cache, until as many others as it holds were asked for. */
const scan_data *scan_cache_load(scan_cache *c, uint32_t number, GError **error);

#endif
