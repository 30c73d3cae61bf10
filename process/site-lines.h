#ifndef PROCESS_SITE_LINES_H
#define PROCESS_SITE_LINES_H
/* The profile lines of a site's model (profile-lines.h) as a product of the site: SITE/model/profile.lines (product.h, pleinair-lines(5)):
 *
 *     lines     struct profile_line, the longest first
 *     vertices  struct profile_vertex, from the origin
 *     origin    3 * double, metres in the site
 *
 * The manifest's "key" tells what went in: the checksum of the model, the classes of the leaves, versions. */
#include "acquire/site.h"
#include "process/product.h"
#include "process/profile-lines.h"

#define SITE_LINES_KIND    "lines"
#define SITE_LINES_VERSION 4

char *site_lines_path(const char *site_path); /* caller frees */
/* A copy in memory. Refused is what no writer writes: lines that share vertices, of fewer than two, places that are not
 * finite, kinds that there are none of. G_IO_ERROR_NOT_FOUND: there are none yet. */
profile_lines *site_lines_load(const char *site_path, GError **error);
profile_lines *site_lines_load_file(const char *path, GError **error);

struct site_lines_options {
	/* 0..1; returns false to stop. */
	bool (*progress)(double fraction, const char *doing, gpointer user_data);
	gpointer user_data;
};
/* Finds and writes them. Takes as much memory as feature points ask for, 0.1 GB a million. ret: what was written; caller frees.
 * G_IO_ERROR_CANCELLED when progress stopped it: what was there stays. */
profile_lines *site_lines_make(site *s, const struct site_lines_options *options, GError **error);
/* A site without a model has none. *ret_why: a few words, NULL when they are not due; caller frees. */
bool site_lines_is_due(const site *s, bool *ret_due, char **ret_why, GError **error);

#endif
