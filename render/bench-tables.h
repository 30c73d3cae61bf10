#ifndef RENDER_BENCH_TABLES_H
#define RENDER_BENCH_TABLES_H
/* What a bench printed as JSON, as tables for people: an array of objects is a table of its own, with a column for each member; such arrays
 * within its objects are one more table, whose rows begin with what the object begins with; the plain
 * members of an object are a table of two columns. Names are those of the members, with spaces. */
#include <json-glib/json-glib.h>
#include <stdbool.h>

typedef struct bench_tables_table bench_tables_table;
struct bench_tables_table {
	char *title;        /* where it stands: "scenes, frames"; may be empty */
	GPtrArray *columns; /* of char *; empty: there is no heading */
	GPtrArray
		*rows; /* of GPtrArray of char *, as many as there are columns; "": nothing there */
	GArray *numbers; /* of bool, a column each: all that is there are numbers */
};
void bench_tables_table_free(bench_tables_table *t);

/* Of bench_tables_table *; caller unrefs. */
GPtrArray *bench_tables_of(JsonObject *result);
/* For a terminal. */
void bench_tables_print(JsonObject *result);

#endif
