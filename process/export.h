#ifndef PROCESS_EXPORT_H
#define PROCESS_EXPORT_H
/* The points of a site in files that other programs open. A file is written beside its place, read back and compared, synced and
 * renamed: it is whole, or as it was before.
 *
 * E57 and PTX have each station by itself, in its own frame with its pose; LAS, PLY and PCD have all points in one frame, but for a
 * single station with a grid, which PLY and PCD keep with its pose. Coordinates are the site's, and where the site has an origin on
 * a map (site.json, "origin_m") those of the map; PCD, whose programs want floats, leaves it off.
 *
 * One station is in memory at a time, an imported one only as a mapping. Errors are of G_IO_ERROR and those of the products that
 * are read; G_IO_ERROR_CANCELLED when progress stopped it. */
#include "acquire/site.h"
#include "process/pose.h"
#include <glib.h>

struct export_options {
	const uint32_t *scans; /* numbers; NULL: all */
	guint scan_count;
	/* Each station as its scanner saw it, not where it was found to stand: recorded ones without a pose, imported ones with that
	 * of their file. */
	bool raw;
	double spacing_m; /* no two points of the file nearer than this; 0: all points */
	/* Returns false to stop; may be NULL. */
	bool (*progress)(double fraction, const char *doing, gpointer user_data);
	gpointer user_data;
};

struct export_result {
	const char *format;
	uint32_t stations;
	uint64_t points;     /* written, and found again when the file was read back */
	uint64_t left_out;   /* for the spacing */
	uint64_t bytes;      /* of the file */
	double resolution_m; /* of its coordinates */
	GPtrArray *notes;    /* of char: what a person should know of the file, a sentence each */
};
void export_result_clear(struct export_result *r);

/* The format is told by the end of the name. */
bool export_site(const site *s, const char *path, const struct export_options *options,
	struct export_result *ret, GError **error);
/* "E57, PTX, LAS, PLY and PCD"; caller frees. */
char *export_format_names(void);
/* Whether a file of this name can be written. */
bool export_knows(const char *path);

#endif
