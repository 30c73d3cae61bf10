#ifndef PROCESS_BENCH_EXPORT_H
#define PROCESS_BENCH_EXPORT_H
/* pleinair bench export: what files for other programs cost. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_export_options {
	double million_points; /* about; in scans of 2.4 million cells */
	const char *
		folder; /* for the site and the files, which are removed again; NULL: the folder of temporary files */
	bool json;
};

/* Makes a site of ordered scans along a street and exports it in each format, which includes reading the file back. Prints points a
 * minute of one core, bytes a point, and the peak of memory. */
bool bench_export(const struct bench_export_options *options, GError **error);

#endif
