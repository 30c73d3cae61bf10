#ifndef PROCESS_BENCH_RUN_H
#define PROCESS_BENCH_RUN_H
/* Other programs of pleinair as benches run them, and what they and this one cost. */
#include <glib.h>
#include <stdbool.h>

/* pleinair-NAME beside this program, else that of PATH; caller frees. */
char *bench_program(const char *name);

struct bench_run {
	double seconds;     /* on the clock */
	double cpu_seconds; /* of all its threads, and the system's for them */
	double peak_mib; /* of its memory; never less than what this process holds when it starts it */
	char *output;    /* what it wrote to stdout; caller frees */
};
/* Runs argv, which ends with NULL, to its end. Fails when it fails; what it writes to stderr is seen. */
bool bench_run(const char *const *argv, struct bench_run *ret, GError **error);

/* The most memory that this process held since it was last set back; NAN where Linux does not tell. */
double bench_peak_mib(bool set_back);

#endif
