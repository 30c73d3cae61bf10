#ifndef RENDER_BENCH_STATION_H
#define RENDER_BENCH_STATION_H
/* pleinair bench station: how long one waits on a site. A courtyard that was scanned from all but one of its places and processed is
 * scanned from the last one by pleinair-scan; then pleinair-process registers it and makes a first look, and pleinair-render draws that, as
 * large as the touch screen shows it; then pleinair-process brings all up to the model up to date. What counts is from the last beam (when
 * the record was last written) to that picture on the disk, on the clock, with all programs as they are. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_station_options {
	const char *preset; /* NULL: fine */
	uint64_t seed;
	/* Folder where the simulated scans stay, and are taken from the next time; NULL: a temporary one. */
	const char *keep;
	bool json;
};
/* Fails also when the last scan was not placed. */
bool bench_station(const struct bench_station_options *options, GError **error);

#endif
