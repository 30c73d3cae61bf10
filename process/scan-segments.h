#ifndef PROCESS_SCAN_SEGMENTS_H
#define PROCESS_SCAN_SEGMENTS_H
/* The segment of each point of a scan, a product of the site: SITE/segments/0003.segments (product.h), with one element per cell
 * of the scan's grid, or per point of a cloud:
 *
 *     automatic   uint16, number of a leaf as the computer found it, 0: no point
 *     leaf        uint16, the same after what a person changed (segment-edits.h)
 *
 * The numbers are those of the site's tree (segments.h), whose key stands in the manifest. */
#include "process/product.h"
#include "process/scan-graph.h"
#include "process/segments.h"

#define SCAN_SEGMENTS_KIND    "segments"
#define SCAN_SEGMENTS_VERSION 1

typedef struct scan_segments scan_segments;
struct scan_segments {
	product *file;
	uint64_t count; /* cells, or points */
	const uint16_t *automatic, *leaf;
};
scan_segments *scan_segments_open(const site *s, uint32_t number, GError **error);
void scan_segments_free(scan_segments *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_segments, scan_segments_free)
bool scan_segments_write(const site *s, uint32_t number, const char *key, const uint16_t *automatic,
	const uint16_t *leaf, uint64_t count, GError **error);
/* The key of a scan's file; NULL: there is none that can be read. Caller frees. */
char *scan_segments_key(const site *s, uint32_t number);

#endif
