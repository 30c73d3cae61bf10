#ifndef PROCESS_IMPORT_H
#define PROCESS_IMPORT_H
/* Scans of other scanners into a site. A file is read by its format's reader, scan after scan, each as records in the order
 * of the file and never more than a block at a time; import_file turns grids so that row 0 is the highest and columns run
 * clockwise, and puts what it read into the site: all scans of a file or none.
 *
 * A file is not trusted. Readers refuse what is cut short, what lies about its counts and what overflows, with one sentence
 * of G_IO_ERROR_INVALID_DATA that begins with the path and names the place ("pump.ptx: line 371: ..."). What a format has but
 * this program does not read is G_IO_ERROR_NOT_SUPPORTED. One thread a reader. */
#include "acquire/points.h"
#include "acquire/site.h"
#include "acquire/surface.h"
#include "process/pose.h"
#include <glib.h>

typedef struct _JsonArray JsonArray;

/* ---- the bytes of a file ---- */

typedef struct import_source import_source;
import_source *import_source_open(const char *path, GError **error);
/* The bytes are not copied. name stands for the path in messages. */
import_source *import_source_from_bytes(const void *bytes, size_t length, const char *name);
void import_source_free(import_source *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(import_source, import_source_free)

const char *import_source_path(const import_source *s);
uint64_t import_source_size(const import_source *s);
/* Up to length bytes from offset; fewer only at the end of the file. false: the disk failed. */
bool import_source_read(import_source *s, uint64_t offset, void *into, size_t length,
	size_t *ret_got, GError **error);
/* A name under which a library that wants one finds these very bytes, valid until the source is freed; NULL and an error. */
const char *import_source_name_for_library(import_source *s, GError **error);
/* G_IO_ERROR_INVALID_DATA, or what code says: "PATH: WHAT". Returns false. */
bool import_refuse(GError **error, const import_source *s, int code, const char *format, ...)
	G_GNUC_PRINTF(4, 5);

/* Whether it was opened by its path, beside which others may lie. */
bool import_source_is_file(const import_source *s);

/* ---- readers ---- */

struct import_options;

/* How the records of a grid follow each other in the file. */
enum import_order {
	IMPORT_ROW_BY_ROW,
	IMPORT_COLUMN_BY_COLUMN,
	/* In any order, and not all cells: cells() of the format says of each record which one it goes to, by row * columns + column.
	 * The rest have no point. */
	IMPORT_SCATTERED,
	/* Two numbers, and nobody says which of them is columns: the points tell (import-grid.h). They stand in columns and
	 * rows as a file of the usual kind has them, column by column. */
	IMPORT_BY_CONTENT,
};

/* One scan of a file. All but count must be right only when the last record was given. A reader may then also say that what
 * looked like a grid is none (columns and rows 0): records whose cell has no point are left out of a cloud. */
struct import_scan {
	uint32_t columns, rows; /* 0, 0: not ordered */
	enum import_order order;
	uint64_t
		count; /* of records to come: columns * rows; for a cloud, and scattered, at most so many */
	uint32_t have; /* POINTS_HAVE_ */
	/* Whole metres, taken off every record: the numbers of the file are record + origin_m. 0 0 0 but for map coordinates;
	 * then near the points, so that the difference is exact. */
	double origin_m[3];
	/* Takes the numbers of the file to its common coordinates, if it says how; for a grid this is where the scanner stood. */
	bool has_pose;
	struct pose pose;
	uint64_t left_out; /* points that the file marks as not to be used (withheld, not finite) */
	/* What else the reader did, a sentence for people and scan.json, the reader's own; NULL: nothing. */
	const char *note;
	const char *no_grid; /* why what looked like a grid is none, a few words */
	/* How often the reader went back to the first record of a grid, which read then gives again: only all of them told
	 * how to give them. What was given before counts for nothing. */
	uint32_t begun;
};

enum import_result { IMPORT_SCAN, IMPORT_END, IMPORT_BAD };

/* A format: a row of import_formats. */
typedef struct import_reader import_reader; /* each format's own; it casts */
struct import_format {
	const char *name;       /* "PTX": for people and for scan.json */
	const char *extensions; /* "ptx", lower case, separated by spaces */
	/* Whether a file with this beginning (up to IMPORT_PROBE_BYTES) is of this format. */
	bool (*probe)(const uint8_t *start, size_t length);
	/* Reads what it must to know that this is going to work. The source stays valid until close. */
	/* options: NULL stands for none. */
	import_reader *(*open)(
		import_source *file, const struct import_options *options, GError **error);
	/* The next scan, whose struct is the reader's and stays until the one after. Never called before all records of the
	 * scan before were read. IMPORT_END: the file ended where it should. */
	enum import_result (*next_scan)(
		import_reader *r, const struct import_scan **ret, GError **error);
	/* Up to max records; *ret_count 0: that was all of the scan. Every record is finite; cell is CELL_MEASURED, or a cell
	 * without a point with 0 0 0. false: the file is bad. */
	bool (*read)(import_reader *r, struct point_record *into, size_t max, size_t *ret_count,
		GError **error);
	double (*fraction)(const import_reader *r); /* of the file that was read, 0..1 */
	void (*close)(import_reader *r);            /* NULL is fine */
	/* What only some formats have; NULL: this one has not. */
	/* Of a scattered grid, the cells of the records that read gave last, none of them twice in a scan. */
	const uint64_t *(*cells)(const import_reader *r);
	/* What is known of the surface at the records that read gave last. */
	const struct surface_record *(*surface)(const import_reader *r);
	/* Of the scan whose records were all read: puts the pictures that came with it into the folder, and for each an object
	 * with its name there ("file") and what is known of it into the array, as it will stand in scan.json. */
	bool (*save_pictures)(
		import_reader *r, const char *folder, JsonArray *into, GError **error);
};
#define IMPORT_PROBE_BYTES 4096
/* Ends with NULL. */
extern const struct import_format *const import_formats[];
extern const struct import_format import_e57, import_mesh, import_ptx, import_las, import_ply,
	import_pcd, import_ascii; /* their files: import-e57.c and so on */

/* By content, and only where no content is known by its extension. NULL: a sentence that lists the formats. */
const struct import_format *import_format_of(import_source *file, GError **error);

/* ---- into a site ---- */

/* How points are made of a mesh. */
struct import_mesh_options {
	uint64_t points;      /* how many, about; 0: as the spacing says, or half a million */
	double spacing_m;     /* of blue noise; 0: as the count says */
	bool uniform;         /* spread by chance, not blue noise */
	double metres_a_unit; /* of the file; 0: 1 */
	bool y_up;            /* the file's y looks up, as many modellers have it */
};

struct import_options {
	bool again; /* also what the site has already */
	struct import_mesh_options mesh;
	/* Returns false to stop: the site is then as it was. May be NULL. */
	bool (*progress)(double fraction, const char *doing, gpointer user_data);
	gpointer user_data;
};

/* A scan that is in the site now. */
struct imported {
	uint32_t number;
	uint32_t in_file; /* which scan of the file, from 1 */
	uint64_t points;  /* measured */
	uint64_t left_out;
	uint32_t columns, rows;
	uint32_t have;
	bool has_pose;
	double position_m[3]; /* of the given pose, in the file's coordinates */
	char *grid; /* a few words on how the file had its grid; NULL for a cloud that never had one */
	char *note; /* what else the reader did; NULL: nothing */
};
void imported_clear(struct imported *i);

/* All scans of the file into the site, or none: then the site is as it was. Scans that a former import of the same bytes
 * (SHA-256) has put there are not imported twice; when all of them are there it is G_IO_ERROR_EXISTS, unless again. Stopped
 * by progress: G_IO_ERROR_CANCELLED. Caller frees the array (of struct imported). */
GArray *import_file(
	site *s, const char *path, const struct import_options *options, GError **error);

#endif
