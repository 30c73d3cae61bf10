#ifndef PROCESS_BENCH_MODEL_H
#define PROCESS_BENCH_MODEL_H
/* pleinair bench model: what building the model of a site costs. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_model_options {
	double million_points; /* that the scanners measured, about; in scans of 2.4 million cells */
	uint64_t memory_bytes; /* as build_options */
	const char *
		folder; /* for the site, which is removed again; NULL: the folder of temporary files */
	bool json;
};

/* Makes a site of ordered scans along a street of relief, 8 m from each other. Builds the model of all scans but the last, then
 * adds that one; prints points a second and the peak of memory of either. */
bool bench_model(const struct bench_model_options *options, GError **error);

#endif
