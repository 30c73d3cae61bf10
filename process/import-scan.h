#ifndef PROCESS_IMPORT_SCAN_H
#define PROCESS_IMPORT_SCAN_H
/* One scan of a file, from its reader into a staged folder: points.ply, then scan.json. */
#include "process/import-grid.h"
#include "process/import-hash.h"
#include "process/import.h"

struct staged_scan {
	char *folder;
	struct import_scan scan;   /* as the reader left it */
	struct grid_layout layout; /* of a grid */
	bool was_grid;             /* the file had it in columns and rows, whatever came of them */
	const char *no_grid;       /* why they were given up; NULL: they were not */
	uint32_t columns_in_file, rows_in_file;
	uint64_t bytes, records; /* of points.ply */
	import_hash *hash;       /* of points.ply, under way */
	uint64_t surface_bytes;  /* of surface.ply; 0: there is none */
	JsonArray *pictures;     /* that came with it, as scan.json will have them */
	struct imported result;
};
void staged_scan_free(struct staged_scan *s);

/* Where a file came from. */
struct import_origin {
	const import_source *file;
	const struct import_format *format;
	const char *sha256;
	uint32_t scans; /* in the file */
};

/* Reads all records of the scan that the reader stands at. progress as import_options. */
bool import_scan_points(struct staged_scan *s, import_source *file,
	const struct import_format *format, import_reader *reader, const struct import_scan *scan,
	const struct import_options *options, GError **error);
/* The pose from the records' frame to the coordinates of the file. */
struct pose import_given_pose(const struct import_scan *scan);
bool import_scan_describe(
	struct staged_scan *s, const struct import_origin *origin, GError **error);

#endif
