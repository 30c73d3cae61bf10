#ifndef PROCESS_BENCH_TABLE_H
#define PROCESS_BENCH_TABLE_H
/* The outcome of trials, summed up. */
#include "process/bench-trials.h"

struct bench_table;
struct bench_table *bench_table_new(void);
void bench_table_free(struct bench_table *t);                      /* NULL is fine */
void bench_table_add(struct bench_table *t, const GArray *trials); /* copies; their sites may go */
uint32_t bench_table_count(const struct bench_table *t);
uint32_t bench_table_wrong(const struct bench_table *t); /* accepted, and not true */
/* others: NULL, as lines; else one JSON document, with what other programs made of some pairs (bench-coarse.h) in it. */
void bench_table_print(const struct bench_table *t, JsonArray *others);
/* A line a trial. */
bool bench_table_save(const struct bench_table *t, const char *path, GError **error);

#endif
