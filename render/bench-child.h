#ifndef RENDER_BENCH_CHILD_H
#define RENDER_BENCH_CHILD_H
/* A bench as a process of its own, so that its memory is its own and its crash nobody else's. */
#include <json-glib/json-glib.h>
#include <stdbool.h>

struct bench_child_desc {
	char **argv;           /* ends with NULL */
	const char *temporary; /* folder where it has its temporary files */
	bool (*stop)(void);    /* asked a few times a second; may be NULL */
	void (*waits)(double seconds, gpointer user_data); /* called as often; may be NULL */
	gpointer user_data;
};
struct bench_child {
	JsonObject *result; /* what it printed; NULL: no object */
	char *error;        /* a sentence; NULL: it did what it should */
	double seconds;
};
/* Waits for its end. When it is to stop, all that it started is ended with it, and the error says so. Clear it in any case. */
void bench_child_run(const struct bench_child_desc *desc, struct bench_child *ret);
void bench_child_clear(struct bench_child *c);

#endif
