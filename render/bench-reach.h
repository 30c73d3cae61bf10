#ifndef RENDER_BENCH_REACH_H
#define RENDER_BENCH_REACH_H
/* What is to reach: the rows of "Speed and size to reach" of the design, each with where the benches say what it is, and what others need
 * for the same. The table in bench-reach.c is the only place that names them; what is wanted stands there as numbers, what is measured
 * nowhere. */
#include <json-glib/json-glib.h>
#include <stdbool.h>

#define BENCH_REACH_PEERS 4

struct bench_reach {
	const char *work; /* rows of the same one follow each other */
	const char *what, *unit;
	const char *source; /* of the number that is wanted */
	double wanted;
	bool at_least;                /* else at most */
	const char *bench, *path;     /* bench-figure.h */
	double scale;                 /* of what stands there, to the unit; 0: 1 */
	const char *count, *count_of; /* how many it is of: "trials", "pairs"; NULL: it is one */
	struct bench_reach_peer {
		const char *name, *path, *count;
	} peer[BENCH_REACH_PEERS];
};
/* Ends with one without work. */
extern const struct bench_reach bench_reaches[];

/* What the benches said, by the name of the bench, objects each: as an array of objects with
 *
 *     work, what, unit, wanted, at_least, source, bench
 *     measured and reached, or why_not; of
 *     peers: objects with name and measured or why_not; of
 *
 * where `of` tells how many it is of ("230 pairs") and may be missing. */
JsonArray *bench_reach_of(JsonObject *results);

/* "0.058", "21.1", "1,290"; caller frees. */
char *bench_reach_number(double value);
/* "at most 0.1 s" */
char *bench_reach_wish(JsonObject *row);
/* What each one is, in a line, for a terminal. */
void bench_reach_print(JsonArray *reach);
/* "17 of 24 are reached, 5 are not, 2 were not measured" */
char *bench_reach_sum(JsonArray *reach);

#endif
