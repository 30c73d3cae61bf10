#ifndef PROCESS_BENCH_SITES_H
#define PROCESS_BENCH_SITES_H
/* Simulated sites: scanned as pleinair scan does. For trials, without a camera, with the simulator's own word on where each scan
 * stands; and a few scenes as they are, one after the other. Records are removed: the scans do. */
#include "acquire/preset.h"
#include "process/pair.h"
#include <json-glib/json-glib.h>

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

/* Scans what the folder does not have yet, then loads all. stop is asked now and then. The error of
 * a stop is G_IO_ERROR_CANCELLED. Any thread, one a site. */
bool bench_site_make(struct bench_site *s, const char *folder, const struct preset *preset,
	bool (*stop)(void), GError **error);
void bench_site_clear(struct bench_site *s);
/* One of its scans as a grid again, from that folder; caller frees. */
range_grid *bench_site_grid(const struct bench_site *s, const char *folder,
	const struct preset *preset, const struct bench_scan *scan, GError **error);

/* One of court, street and bridge, as its first stations see it. */
#define BENCH_STATIONS 4
struct bench_scene {
	const char *name;
	uint64_t seed;
	const char
		*path; /* a site of scans 1 to BENCH_STATIONS, and of nothing else; removed again */
	const char *work; /* a folder for files that are needed on the way */
};
/* "court?seed=7&station=2"; caller frees. */
char *bench_scene_station(const struct bench_scene *s, uint32_t station);
/* Scans what the site at this path does not have yet; of the scene, name and seed count. */
bool bench_scene_scan(
	const struct bench_scene *s, const char *path, const struct preset *preset, GError **error);

struct bench_scenes {
	uint64_t seed;      /* of all */
	const char *preset; /* NULL: standard */
	const char *
		keep; /* folder where the scans stay, and are taken from the next time; NULL: a temporary one */
	bool (*measure)(const struct bench_scene *scene, gpointer user_data, GError **error);
	gpointer user_data;
};
/* Scans what the folder does not have yet, and measures; scene by scene. */
bool bench_scenes_measure(const struct bench_scenes *all, GError **error);
/* The same, and says it: lines of a heading (NULL ends them) before, or as JSON, which measure has filled; takes json, NULL: as lines. */
bool bench_scenes_say(const struct bench_scenes *all, const char *const *heading, JsonObject *json,
	GError **error);

#endif
