#ifndef PROCESS_BENCH_FEATURES_H
#define PROCESS_BENCH_FEATURES_H
/* pleinair bench features: features of the first four stations of simulated scenes against what really stands there
 * (feature-score.h says what counts), and what they cost: seconds in this process, and what pleinair process takes from the
 * geometry of the scans to their features, as a program of its own, on a copy of the site. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_features_options {
	uint64_t seed;      /* of all scenes */
	const char *preset; /* NULL: standard */
	const char *
		keep; /* folder where the scans stay, and are taken from the next time; NULL: a temporary one */
	bool json;
};
bool bench_features(const struct bench_features_options *options, GError **error);

#endif
