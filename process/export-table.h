#ifndef PROCESS_EXPORT_TABLE_H
#define PROCESS_EXPORT_TABLE_H
/* What PLY and PCD have in common: a header, then records of equal length, one a point (or, of PCD's grid, one a cell). Intensity is a
 * float from 0 to 1, for in both formats nothing else says what its largest is. */
#include "process/export-format.h"

enum table_column {
	TABLE_X,
	TABLE_Y,
	TABLE_Z,
	TABLE_INTENSITY,
	TABLE_RED,
	TABLE_GREEN,
	TABLE_BLUE,
	TABLE_RGB, /* the three in one number, 0x00RRGGBB */
	TABLE_CLASS,
	TABLE_ECHO,
	TABLE_STATION,
	TABLE_COLUMNS
};
enum table_type { TABLE_U8, TABLE_U16, TABLE_U32, TABLE_F32, TABLE_F64 };
extern const uint8_t table_type_bytes[];

struct export_table {
	unsigned count;
	struct table_field {
		enum table_column column;
		enum table_type type;
	} fields[TABLE_COLUMNS];
	size_t record_bytes;
};
void export_table_add(struct export_table *t, enum table_column column, enum table_type type);

struct table_extent {
	double low_m[3], high_m[3], farthest_m; /* of any coordinate from 0 */
	uint64_t points;
	bool has_intensity, has_colour, has_classes;
	uint8_t return_most;
};
struct table_extent export_table_extent(const struct export_job *j);
/* Of coordinates as floats. */
double export_table_float_step_m(const struct table_extent *e);

/* The record of a point; without one its coordinates are not a number. */
void export_table_record(const struct export_table *t, const struct export_station *s,
	const struct export_point *p, uint8_t *into);
void export_table_write(const struct export_table *t, const struct export_station *s,
	const struct export_point *p, size_t count, bool cells_too, FILE *file);
/* Reads the file back: the header, then each record. */
bool export_table_verify(const struct export_job *j, const struct export_table *t,
	const char *header, bool cells_too, const char *path, GError **error);

#endif
