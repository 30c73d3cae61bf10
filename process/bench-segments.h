#ifndef PROCESS_BENCH_SEGMENTS_H
#define PROCESS_BENCH_SEGMENTS_H
/* pleinair bench segments: how well things are told apart, and what that costs (segment-score.h). On simulated sites against the
 * truth; on a site of a person's own, against the classes that its points came with. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_segments_options {
	const char *site;   /* NULL: court, street and bridge are simulated, four stations each */
	const char *preset; /* NULL: standard */
	uint64_t seed;
	const char *
		keep; /* folder where the scans stay, and are taken from the next time; NULL: a temporary one */
	bool json;
};
bool bench_segments(const struct bench_segments_options *options, GError **error);

#endif
