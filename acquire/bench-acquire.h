#ifndef ACQUIRE_BENCH_ACQUIRE_H
#define ACQUIRE_BENCH_ACQUIRE_H
/* pleinair bench acquire: what recording costs. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_acquire_options {
	double seconds; /* of streaming, in real time */
	uint32_t beams; /* of the simulated lidar, with intensity */
	bool json;
};

/* Streams a simulated SCIP lidar at 40 Hz in real time through the pump into a record, as a scan
 * does, and prints the share of a core, the peak of memory and the losses; then how fast each
 * lidar's bytes are decoded. */
bool bench_acquire(const struct bench_acquire_options *options, GError **error);

#endif
