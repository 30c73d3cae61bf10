#ifndef PROCESS_IMPORT_PLY_H
#define PROCESS_IMPORT_PLY_H
/* PLY, text or binary of either byte order. The header is read and checked here, against the length of the file too. Binary
 * bodies are then read by PCL's ply_parser, the part of PCL that keeps every number as it is: its PLYReader takes colours for
 * granted in one order and loses what stands between them. Bodies of text are read here: where a number is none PCL says
 * "not a number" and goes on.
 *
 * Of its elements vertex has the points; camera (with viewportx, viewporty) and obj_info (num_cols, num_rows) tell of a grid,
 * and range_grid tells which point stands in which of its cells. The rest, faces too, is passed over. */
#include "process/import-cloud.h"

enum ply_encoding { PLY_TEXT, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN };

struct ply_property {
	char *name;
	enum cloud_type type;
	bool is_list;
	enum cloud_type size_type; /* of a list: of its length */
};
struct ply_element {
	char *name;
	uint64_t count;
	GArray *properties; /* of struct ply_property */
	bool has_list;
	uint64_t least_bytes; /* of one; in text a digit and a blank a number */
};
struct ply_header {
	enum ply_encoding encoding;
	GArray *elements;       /* of struct ply_element */
	uint32_t columns, rows; /* by obj_info; 0: not told */
	uint64_t bytes, lines;
};
void ply_header_clear(struct ply_header *h);
bool ply_header_read(import_source *file, struct ply_header *ret, GError **error);

/* One instance of an element: a number a property; of a list its first item, NAN where it is empty. Returns false to stop. */
typedef bool (*ply_row_func)(gpointer user_data, uint32_t element, const double *values);
/* All elements in order, by PCL from the file of that name. */
bool ply_read_binary(const char *name, const struct ply_header *h, ply_row_func row,
	gpointer user_data, GError **error);

#endif
