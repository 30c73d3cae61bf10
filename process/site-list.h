#ifndef PROCESS_SITE_LIST_H
#define PROCESS_SITE_LIST_H
/* What can be said at once of the sites in a folder, without reading what they hold. Any thread. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct listed_site {
	char *path, *name, *created;
	int64_t changed; /* seconds since 1970 */
	uint32_t scans, placed, groups, partial;
	bool has_model;
	uint64_t bytes;
	char *error; /* one sentence; then only path and name are sure */
};

/* Of struct listed_site, the one that changed last first; folders without site.json are passed over. Caller unrefs. NULL when the
 * folder cannot be read; one that is not there has none. */
GPtrArray *site_list(const char *folder, GError **error);
/* The same as aa{sv}, floating, as org.pleinair.Jobs1 says it. */
GVariant *site_list_variant(const GPtrArray *sites);

#endif
