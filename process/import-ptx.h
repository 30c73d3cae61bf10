#ifndef PROCESS_IMPORT_PTX_H
#define PROCESS_IMPORT_PTX_H
/* What the files of the PTX reader share: its state, the head of a scan. */
#include "process/import-lines.h"
#include "process/import.h"

#define PTX_COORDINATE_MAX_M 1e9

struct ptx {
	struct import_lines lines;
	uint32_t scans;
	uint64_t first_offset, first_line; /* of the cells of this scan; the line before them */
	uint64_t cells_left;
	bool has_points, is_map;
	/* The transform scales, mirrors or shears, so no pose says it: points are given where it takes them. */
	bool is_applied;
	struct pose applied; /* a matrix, no rotation */
	/* Intensities that become 0 and 65535: 0 and 1, or the least and the largest of the scan. */
	double intensity_low, intensity_high;
	double intensity_least, intensity_most; /* met so far */
	int fields; /* of a cell's line, all alike where there are points; 0: none seen yet */
	char *note;
	struct import_scan scan;
};
/* From its first line, which was read, to the line before its first cell. */
bool ptx_read_head(struct ptx *r, const char *first, GError **error);

#endif
