#ifndef PROCESS_BENCH_SEGMENTS_H
#define PROCESS_BENCH_SEGMENTS_H
/* pleinair bench segments: how well things are told apart, and what that costs. On simulated sites against the truth: what the middle
 * of each measured cell meets first. Cells whose range is another one by more than 0.15 m saw two things at once and are left
 * out, but what stands behind a pane of a building counts as the building. On a site of a person's own, against the classes
 * that its points came with. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_segments_options {
	const char *site;   /* NULL: court, street and bridge are simulated, four stations each */
	const char *preset; /* NULL: standard */
	uint64_t seed;
	bool json;
};
bool bench_segments(const struct bench_segments_options *options, GError **error);

#endif
