#ifndef ACQUIRE_POINTS_H
#define ACQUIRE_POINTS_H
/* The points of an imported scan on disk: points.ply, a binary PLY that any point program opens, mapped into memory to read.
 * Coordinates are doubles, exactly those of the file that was imported less an origin of whole metres, which stands in
 * scan.json. An ordered scan keeps its grid: all cells are there, row by row (row 0 the highest, columns clockwise, turned so
 * when it was imported), and obj_info num_cols and num_rows tell its size. It has colour, say, when any of its points has one
 * that is not black. Nothing is synced: whoever puts the file into a site does that.
 *
 * Errors are of G_IO_ERROR, one sentence that begins with the path. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One vertex of points.ply, as it lies in the file. */
struct point_record {
	double x_m, y_m, z_m; /* 0 0 0 in a cell without a point */
	uint16_t intensity;   /* 0..65535 */
	uint8_t rgb[3];
	uint8_t classification; /* as LAS 1.4 numbers them; 0: never classified */
	uint8_t cell;           /* enum panorama_cell: measured, empty, no return */
	uint8_t return_number;  /* 1: the first, or the only one */
} __attribute__((packed));

#define POINTS_HAVE_INTENSITY      1u
#define POINTS_HAVE_COLOUR         2u
#define POINTS_HAVE_CLASSIFICATION 4u

typedef struct points points;
struct points {
	const struct point_record *record;
	uint64_t count;         /* of records, cells without a point too */
	uint32_t columns, rows; /* 0: not ordered */
	uint32_t have;          /* POINTS_HAVE_ */
};
/* Checks the header against the file's length. */
points *points_open(const char *path, GError **error);
void points_free(points *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(points, points_free)
/* Gives back the memory of records that were read, which stay readable: for whoever walks through a file larger than memory. */
void points_forget(const points *p, uint64_t first, uint64_t count);

typedef struct points_writer points_writer;
/* columns, rows 0: not ordered. The file appears when it is finished. */
points_writer *points_writer_new(const char *path, uint32_t columns, uint32_t rows, GError **error);
bool points_writer_append(
	points_writer *w, const struct point_record *records, size_t count, GError **error);
/* Fails when an ordered scan has not all its cells. */
bool points_writer_finish(points_writer *w, GError **error);
void points_writer_free(points_writer *w); /* NULL is fine; removes what was not finished */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(points_writer, points_writer_free)

#endif
