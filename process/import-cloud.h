#ifndef PROCESS_IMPORT_CLOUD_H
#define PROCESS_IMPORT_CLOUD_H
/* What PLY and PCD have in common: points as a table of named columns of numbers, all of which is held in memory. A reader
 * says what its columns are, adds the points, and then gives them out as records.
 *
 *     x y z                                             doubles stay what they are; not finite, or 0 0 0: no point
 *     intensity scalar_intensity reflectance ...        to 0..65535, see below
 *     red green blue, diffuse_red ..., r g b            of 8 bit, or told by the largest: to 1, to 255, to 65535
 *     rgb rgba                                          packed: 0xAARRGGBB in 32 bits, whole numbers or as a float
 *     classification scalar_classification class label  whole, 0..255; others are 0, never classified
 *     return_number; cell (as points.h has it, in a grid)
 *
 * Names are taken without regard to case. Intensity of 8 bit becomes 257 times as much. Of other types the largest of all
 * tells: up to 1 it counts to 1, up to 255 to 255, up to 65535 it stays; else, or where any is negative, smallest and largest
 * become 0 and 65535. So what is dark in one file need not be in another: nothing in these formats says more. */
#include "process/import.h"

enum cloud_role {
	CLOUD_NONE,
	CLOUD_X,
	CLOUD_Y,
	CLOUD_Z,
	CLOUD_INTENSITY,
	CLOUD_RED,
	CLOUD_GREEN,
	CLOUD_BLUE,
	CLOUD_RGB, /* the value is that of the 32 bits as a whole number */
	CLOUD_CLASS,
	CLOUD_RETURN,
	CLOUD_CELL,
	CLOUD_ROLES
};
enum cloud_role cloud_role_of(const char *name);

enum cloud_type {
	CLOUD_I8,
	CLOUD_U8,
	CLOUD_I16,
	CLOUD_U16,
	CLOUD_I32,
	CLOUD_U32,
	CLOUD_I64,
	CLOUD_U64,
	CLOUD_F32,
	CLOUD_F64,
	CLOUD_TYPES
};
extern const uint8_t cloud_type_bytes[CLOUD_TYPES];
/* A number at any address, in this machine's byte order. */
double cloud_type_get(enum cloud_type type, const void *at);
/* What a column is; for CLOUD_RGB also of a float, whose bits are meant. */
double cloud_role_get(enum cloud_role role, enum cloud_type type, const void *at);

typedef struct import_cloud import_cloud;
import_cloud *import_cloud_new(import_source *file);
void import_cloud_free(import_cloud *c); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(import_cloud, import_cloud_free)

/* Before any point. Refuses a second column of one meaning. */
bool import_cloud_column(import_cloud *c, enum cloud_role role, enum cloud_type type,
	const char *name, GError **error);
/* Refuses columns that make no points, and what this machine's memory does not hold: count points and other_bytes beside
 * them may take three quarters of it. */
bool import_cloud_reserve(import_cloud *c, uint64_t count, uint64_t other_bytes, GError **error);
/* By role; those that have no column are not looked at. At most as many as were reserved. */
void import_cloud_add(import_cloud *c, const double value[CLOUD_ROLES]);

/* Columns and rows, row by row, of what was added; or which of its cells each point goes to (the rest has none; indices at or
 * beyond the points are cells without). index is copied; count is columns * rows. */
void import_cloud_set_grid(import_cloud *c, uint32_t columns, uint32_t rows);
bool import_cloud_spread(
	import_cloud *c, const int64_t *index, uint32_t columns, uint32_t rows, GError **error);
/* Where the file says the sensor stood and looked. At 0 0 0 it says nothing, however it looked: so writers fill in what they
 * do not know. */
void import_cloud_set_pose(import_cloud *c, const struct pose *pose);

/* After the last point. A grid that was seen by a camera (z forward, x right, y down) is turned into a scanner's frame by
 * exchange of axes; one that was not seen from the origin becomes a cloud. Then the scan is known. */
bool import_cloud_finish(import_cloud *c, GError **error);
const struct import_scan *import_cloud_scan(const import_cloud *c);
size_t import_cloud_read(import_cloud *c, struct point_record *into, size_t max);
double import_cloud_fraction(const import_cloud *c);

/* ---- tables in text ---- */

/* Bytes of the file from offset on with 64 zero bytes behind them; caller frees. */
uint8_t *import_load(import_source *file, uint64_t offset, size_t *ret_length, GError **error);

struct import_text {
	import_source *file;
	const char *at, *end; /* *end is 0 */
	uint64_t line;        /* number of the line at `at` */
};
/* The next number of this line, with "nan" and "inf" in all their ways; whole and in range for the types that are. */
bool import_text_number(struct import_text *t, enum cloud_type type, double *ret, GError **error);
/* Over the end of the line, which must have nothing more; and over lines with nothing in them. */
bool import_text_end_line(struct import_text *t, GError **error);
bool import_text_refuse(const struct import_text *t, GError **error, const char *format, ...)
	G_GNUC_PRINTF(3, 4);

#endif
