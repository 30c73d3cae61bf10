#ifndef PROCESS_BENCH_LINES_H
#define PROCESS_BENCH_LINES_H
/* pleinair bench lines: profile lines of the first four stations of simulated scenes against what really stands there (line-score.h says
 * what counts), and how long they take, after pleinair process has made the site's model. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_lines_options {
	uint64_t seed;      /* of all scenes */
	const char *preset; /* NULL: standard */
	const char *
		keep; /* folder where the scans stay, and are taken from the next time; NULL: a temporary one */
	bool json;
};
bool bench_lines(const struct bench_lines_options *options, GError **error);

#endif
