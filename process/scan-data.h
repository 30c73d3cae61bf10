#ifndef PROCESS_SCAN_DATA_H
#define PROCESS_SCAN_DATA_H
/* A scan of a site in memory, whatever scanner it came from.
 *
 * Its own frame is the scanner's for scans with a grid; for a cloud it is what its file had, less an origin. An imported
 * scan's scan.json has, beside number, created and files as any scan:
 *
 *     "kind": "imported"
 *     "source": { "file": "pump.ptx", "format": "PTX", "scan": 1, "sha256": "..." }    scan: which one in the file, from 1
 *     "points": { "count": 155201, "columns": 345, "rows": 1074 }                      0, 0: not ordered
 *     "given_pose": { "rotation": [[...],...], "translation_m": [...] }                when the file says where it stands, in
 *                                                                                      the file's own coordinates
 * A given pose becomes one in the site by taking site.json's "origin_m" (whole metres, set by the first scan that came with
 * coordinates) off its translation. */
#include "acquire/points.h"
#include "acquire/site.h"
#include "process/range-grid.h"

enum scan_kind {
	SCAN_RECORDED, /* by a head of ours: a panorama */
	SCAN_ORDERED,  /* imported with its grid; the scanner stood at the origin of its frame */
	SCAN_CLOUD,    /* imported points without order */
};

typedef struct scan_data scan_data;
struct scan_data {
	uint32_t number;
	enum scan_kind kind;
	range_grid *grid; /* NULL for a cloud */
	points *points; /* NULL for a recorded scan. They have no colours where more than a quarter is black: those tell nothing */
	bool is_las;    /* it came from a LAS file, so its classes are numbered as LAS does it */
	bool has_given_pose;
	struct pose given_pose; /* scan to site */
	char *fingerprint; /* SHA-256 over the hashes of its data files: changes when the points do */
	/* Of scan_data_keep alone: */
	char *kept_of; /* path of its site; NULL: it is not kept */
	uint64_t kept_bytes;
	uint32_t users;
};
/* Loads and checks the files by size and, for recorded scans, by SHA-256. */
scan_data *scan_data_load(const site *s, uint32_t number, GError **error);
/* From then on what was loaded is kept, the last used up to so many bytes, and who asks for it again has the same one without a look at
 * its files: for programs that go through a site several times, and then end. Const for all. Before there are threads. */
void scan_data_keep(uint64_t bytes);
/* Without the points: kind, pose and fingerprint alone. */
scan_data *scan_data_peek(const site *s, uint32_t number, GError **error);
void scan_data_free(scan_data *d); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_data, scan_data_free)

#endif
