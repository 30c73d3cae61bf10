#ifndef ACQUIRE_SITE_H
#define ACQUIRE_SITE_H
/* A site is a folder (DESIGN, "Acquire"): site.json, scans/0001/ ... and what later stages add. A scan is written in
 * scans/.0003.partial/ and renamed to scans/0003/ when it is whole, so a folder with a plain number is always complete.
 *
 * Writers hold the site's lock from site_open_for_writing to site_free, so that there is one at a time; readers need none. */
#include "acquire/manifest.h"
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define SITE_SCHEMA 1
#define SITE_SCANS_MAX 9999u

typedef struct site site;

site *site_open(const char *path, GError **error);
/* Makes the site when the folder is missing or empty (name = the folder's). Refuses a folder that holds other things
 * than a site ("photos: is not a site: it has files but no site.json"), a lock held by another process, and a folder that
 * cannot be written; nothing is changed then. */
site *site_open_for_writing(const char *path, GError **error);
void site_free(site *s); /* NULL is fine; lets the lock go */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(site, site_free)

const char *site_path(const site *s);
const manifest *site_manifest(const site *s);

/* Numbers of the finished scans in rising order; caller frees. */
GArray *site_scans(const site *s, GError **error); /* of uint32_t */
char *site_scan_path(const site *s, uint32_t number); /* scans/0003; caller frees */

/* The partial scan, if any: its number, or 0. There is at most one; a site with more is refused. */
bool site_find_partial(const site *s, uint32_t *ret_number, GError **error);
char *site_partial_path(const site *s, uint32_t number); /* scans/.0003.partial; caller frees */

/* Prepares the next scan's folder with its scan.json already in it (the folder appears whole). *ret_number is free to use:
 * one above every scan and partial. */
bool site_begin_scan(site *s, const manifest *scan, uint32_t *ret_number, GError **error);
/* Renames the partial to its number and syncs. Refused when that number exists. */
bool site_finish_scan(site *s, uint32_t number, GError **error);
/* Removes a partial scan with all that is in it. */
bool site_discard_partial(site *s, uint32_t number, GError **error);

#endif
