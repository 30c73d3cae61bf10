#ifndef PROCESS_SCAN_SEGMENTS_H
#define PROCESS_SCAN_SEGMENTS_H
/* The segment of each point of a scan, a product of the site: SITE/segments/0003.segments (product.h), with one element per cell
 * of the scan's grid, or per point of a cloud:
 *
 *     automatic   uint16, number of a leaf as the computer found it, 0: no point
 *     leaf        uint16, the same after what a person changed (segment-edits.h)
 *
 * The numbers are those of the site's trees (segments.h): automatic.json and segments.json, which have the checksums of the
 * labels that belong to them. Files depend on nothing but their labels: where these stay, the file does, and so does all that was
 * made from it. */
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
/* Does not look at the labels themselves. */
scan_segments *scan_segments_open(const site *s, uint32_t number, GError **error);
void scan_segments_free(scan_segments *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_segments, scan_segments_free)
/* Of "automatic" and of "leaf", as the file says that they are, and of labels in memory. */
uint32_t scan_segments_automatic_checksum(const scan_segments *s);
uint32_t scan_segments_leaf_checksum(const scan_segments *s);
uint32_t scan_segments_checksum(const uint16_t *labels, uint64_t count);
/* Leaves a file alone that has these labels already. leaf NULL: what people changed is yet to be done to them, and what the file
 * has of it does not matter. */
bool scan_segments_write(const site *s, uint32_t number, const uint16_t *automatic,
	const uint16_t *leaf, uint64_t count, GError **error);

#endif
