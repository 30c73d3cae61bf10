#ifndef RENDER_BENCH_ALL_H
#define RENDER_BENCH_ALL_H
/* pleinair bench: all benches one after another, each as a process of its own with fewer repeats than alone, on one simulated site that
 * they share; then what is to reach (bench-reach.h), and two files in the folder that is told:
 *
 *     bench.json  { pleinair_bench: 1, machine: { ... } (bench-machine.h), reach: [ ... ] (bench-reach.h), benches: [ ... ], and
 *                 stopped: true when it is not whole }; each bench an object with
 *                 bench, command, seconds, and result (what it prints with --json) or error, or both
 *     bench.html  the same as a page (bench-page.h)
 *
 * Both are written anew after each bench. */
#include <json-glib/json-glib.h>
#include <stdbool.h>
#include <stdint.h>

#define BENCH_ALL_SCHEMA 1

/* A bench, and how it is run here. */
struct bench_all_part {
	const char *what;
	const char *arguments; /* beside those that all have */
	double typical_s;      /* on two cores; only for the time left */
	bool takes_site;
};
extern const struct bench_all_part bench_all_parts[]; /* ends with one without what */

struct bench_all_options {
	const char *program; /* that measures, run as PROGRAM WHAT --json ...: this one */
	const struct bench_all_part *parts; /* NULL: all */
	const char *output;                 /* folder of both files; made when it is not there */
	const char *site;                   /* for those that draw; NULL: simulated */
	const char *keep; /* where simulated scans stay; NULL: a temporary folder */
	uint64_t seed;
	uint32_t repeats; /* 0: as many as each part has */
	bool json;        /* prints the document instead of tables */
	bool (*stop)(void);
	void (*progress)(
		double fraction, const char *doing); /* doing NULL: before anything is printed */
};
/* A figure that is not reached is no failure. Fails when it is stopped, or when a bench fails, which the rest does not mind. */
bool bench_all(const struct bench_all_options *options, GError **error);

/* The document of what was measured so far: takes machine and benches. */
JsonObject *bench_all_document(JsonObject *machine, JsonArray *benches, bool whole);
/* Both files. */
bool bench_all_write(JsonObject *document, const char *folder, GError **error);

#endif
