#ifndef ACQUIRE_SITE_PRIVATE_H
#define ACQUIRE_SITE_PRIVATE_H
/* What site.c (the folder, its lock, site.json) and site-scans.c (what is in scans/) have in
 * common. */
#include "acquire/site.h"

/* scans/ holds, beside finished scans: .0003.partial, the scan under way; .0003.new.AbCdEf, one
 * that is not yet begun; .0003.discarded, one that is being removed. The last two are remains when
 * they are found. */
enum scan_state { FOREIGN, FINISHED, PARTIAL, REMAINS };
struct scan_name {
	uint32_t number;
	enum scan_state state;
};

struct site {
	char *path, *scans_path;
	manifest *m;
	/* Of the folder itself; -1 for readers. The kernel lets the lock go with the process. */
	int lock_fd;
	bool made, made_folder; /* by this opening */
};

/* G_IO_ERROR "site oak: WHAT"; returns false. */
bool site_refuse(GError **error, const site *s, int code, const char *format, ...)
	G_GNUC_PRINTF(4, 5);

struct scan_name site_read_scan_name(const char *name);
char *site_path_in_scans(const site *s, const char *name);     /* caller frees */
GPtrArray *site_names_in_scans(const site *s, GError **error); /* none when there is no scans/ */

#endif
