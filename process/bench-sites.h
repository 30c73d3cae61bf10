#ifndef PROCESS_BENCH_SITES_H
#define PROCESS_BENCH_SITES_H
/* Simulated sites for trials: scanned as pleinair scan does, with the simulator's own word on where each scan stands. */
#include "acquire/preset.h"
#include "process/pair.h"
#include <gio/gio.h>

/* One tripod position in one state of a site. */
struct bench_scan {
	uint32_t station;
	bool moved; /* people, cars and furniture stand elsewhere */
	pair_scan *scan;
	struct pose truth; /* scanner to site */
};

struct bench_site {
	const char *scene;
	const char *variant; /* "symmetric", "repeated" or NULL */
	uint64_t seed;
	uint32_t stations;       /* that are scanned, from 1 */
	uint32_t moved_stations; /* of these, with things moved: 1, 3, 5 ... */
	struct bench_scan *scans;
	uint32_t count;
};

/* Scans what the folder does not have yet, then loads all. The records are removed. stop is asked now and then. The error of
 * a stop is G_IO_ERROR_CANCELLED. Any thread, one a site. */
bool bench_site_make(struct bench_site *s, const char *folder, const struct preset *preset,
	bool (*stop)(void), GError **error);
void bench_site_clear(struct bench_site *s);

#endif
