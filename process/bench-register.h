#ifndef PROCESS_BENCH_REGISTER_H
#define PROCESS_BENCH_REGISTER_H
/* pleinair bench register: how often pairs of scans are found, refused and, worst of all, accepted although wrong. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

struct bench_register_options {
	uint32_t trials;
	uint64_t seed; /* of the first sites; trials with other seeds have other sites */
	const char *preset;
	const char *
		keep; /* a folder for the scans, taken from there if they are; NULL: a temporary one */
	/* Of the first pairs that overlap so many are given to other programs, too (bench-coarse.h). */
	uint32_t pairs_of_others;
	bool json;
	bool (*stop)(void); /* asked now and then; may be NULL */
	/* From any thread, one at a time; doing is NULL when all is over, before anything is printed. May be NULL. */
	void (*progress)(double fraction, const char *doing);
};

/* Scans simulated sites, aligns pairs of their scans on all processors and prints a table. With keep, each trial is a line of
 * KEEP/trials.tsv. A wrong pose that was accepted is an error, given after the table is printed. */
bool bench_register(const struct bench_register_options *options, GError **error);

#endif
