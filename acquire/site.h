#ifndef ACQUIRE_SITE_H
#define ACQUIRE_SITE_H
/* A site is a folder (DESIGN, "Acquire"): site.json, scans/0001/ ... and what later stages add. A
 * scan is written in scans/.0003.partial/ and renamed to scans/0003/ when it is whole, so a folder
 * with a plain number is always complete.
 *
 * Writers hold the site's lock from site_open_for_writing to site_free, so that there is one at a
 * time; readers need none. The lock is the kernel's (flock on the folder): it goes with the process
 * that held it, and leaves nothing behind. A writer that is killed leaves at most folders
 * scans/.0003.new.* and scans/.0003.discarded, which the next one removes.
 *
 * Errors are of G_IO_ERROR, those of site.json as manifest.h says. A site holds only for the thread
 * that opened it. */
#include "acquire/manifest.h"
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define SITE_SCHEMA    1
#define SITE_SCANS_MAX 9999u

typedef struct site site;

/* Refuses a folder without site.json, or with one that lacks name, id, created or units
 * ("metres"). */
site *site_open(const char *path, GError **error);
/* Makes the site when the folder is missing or empty (name = the folder's); its parent must be
 * there. Refuses a folder that holds other things than a site ("photos: is not a site: it has files
 * but no site.json"), a lock held by another process, and a folder that cannot be written; nothing
 * is changed then. What a killed maker of this site left counts as empty, and so does the
 * lost+found of a fresh disk. */
site *site_open_for_writing(const char *path, GError **error);
/* The same for a site that must be there: nothing is made. */
site *site_open_existing(const char *path, GError **error);
/* Removes a site that site_open_for_writing has just made, when it is still empty: for the first
 * scan that came to nothing. Else it stays. The site can only be freed then. */
void site_discard_new(site *s);
void site_free(site *s); /* NULL is fine; lets the lock go */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(site, site_free)

const char *site_path(const site *s); /* as it was given */
const manifest *site_manifest(const site *s);

/* Numbers of the finished scans in rising order; caller frees. A scan's folder without scan.json is
 * refused, names that are no four-digit number are passed over. */
GArray *site_scans(const site *s, GError **error);    /* of uint32_t */
char *site_scan_path(const site *s, uint32_t number); /* SITE/scans/0003; caller frees */

/* The partial scan, if any: its number, or 0. There is at most one; a site with more is refused. */
bool site_find_partial(const site *s, uint32_t *ret_number, GError **error);
/* SITE/scans/.0003.partial; caller frees. */
char *site_partial_path(const site *s, uint32_t number);

/* The functions below need a site that was opened for writing. */

/* Prepares the next scan's folder with its scan.json already in it (the folder appears whole).
 * *ret_number is one above every scan. Refused while there is a partial scan, and beyond
 * SITE_SCANS_MAX. */
bool site_begin_scan(site *s, const manifest *scan, uint32_t *ret_number, GError **error);
/* Syncs all that is in the partial, renames it to its number and syncs that. Refused when that
 * number exists or scan.json is missing. */
bool site_finish_scan(site *s, uint32_t number, GError **error);
/* Removes a partial scan with all that is in it. */
bool site_discard_partial(site *s, uint32_t number, GError **error);

/* For scans that are worth nothing before they are whole, as imported ones: an empty folder
 * scans/.0003.new.XXXXXX, which no reader sees and the next writer removes. A partial scan is not
 * in its way. *ret_number is the number that it will have; caller frees the path. */
char *site_stage_scan(site *s, uint32_t *ret_number, GError **error);
/* Syncs what is in the staged folders (paths) and gives them their numbers: all of them, or, when
 * that cannot be done, none. */
bool site_add_staged(site *s, const GPtrArray *folders, GError **error);
/* Sets a key of site.json and replaces the file; NULL removes the key. Takes value. When it fails,
 * both are as they were. */
bool site_set(site *s, const char *key, JsonNode *value, GError **error);

#endif
