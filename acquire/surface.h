#ifndef ACQUIRE_SURFACE_H
#define ACQUIRE_SURFACE_H
/* What is known of the surface at the points of an imported scan, where its file told more than points, as a mesh does: surface.ply, a
 * binary PLY beside points.ply with as many vertices, mapped into memory to read. Directions are in the frame of points.ply.
 *
 * Errors are of G_IO_ERROR, one sentence that begins with the path. */
#include "acquire/site.h"
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* One vertex, as it lies in the file. */
struct surface_record {
	float normal[3]; /* unit; 0 0 0: not known */
	float k1,
		k2; /* principal curvatures, 1/m, k1 the one of the greater magnitude; positive where the surface bulges the
			    way the normal looks; NAN: not known */
	float direction[3]; /* unit, of k1, sign free; 0 0 0: not known */
};

typedef struct scan_surface scan_surface;
struct scan_surface {
	const struct surface_record *record;
	uint64_t count;
};
/* Checks the header against the file's length, and that there are count vertices. */
scan_surface *surface_open(const char *path, uint64_t count, GError **error);
/* Of a scan of a site; *ret is NULL where there is none. */
bool surface_open_of_scan(
	const site *s, uint32_t number, uint64_t count, scan_surface **ret, GError **error);
void surface_free(scan_surface *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_surface, surface_free)

typedef struct surface_writer surface_writer;
/* Nothing is synced: whoever puts the file into a site does that. */
surface_writer *surface_writer_new(const char *path, GError **error);
bool surface_writer_append(
	surface_writer *w, const struct surface_record *records, size_t count, GError **error);
bool surface_writer_finish(surface_writer *w, GError **error);
void surface_writer_free(surface_writer *w); /* NULL is fine; removes what was not finished */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(surface_writer, surface_writer_free)

#endif
