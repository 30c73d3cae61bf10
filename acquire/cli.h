#ifndef ACQUIRE_CLI_H
#define ACQUIRE_CLI_H
/* What all commands share: how they read options, say what is wrong, show progress and end.
 *
 * Exit status 0: done, 1: failed, 2: wrong usage. Messages go to stderr as "pleinair scan: ...";
 * results to stdout, with --json as one document. */
#include <glib.h>
#include <json-glib/json-glib.h>
#include <stdbool.h>

enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_WRONG_USAGE = 2 };

/* Brings out what was printed and returns CLI_DONE; when stdout cannot take it (a full disk, a
 * closed pipe), says so and returns CLI_FAILED. */
int cli_done(const char *command);
/* Says the error and returns CLI_FAILED. */
int cli_fail(const char *command, const GError *error);
/* Says what is wrong with the usage and where help is; returns CLI_WRONG_USAGE. */
int cli_misuse(const char *command, const char *format, ...) G_GNUC_PRINTF(2, 3);

/* Parses with GOption: parameters ("SITE"), summary and description make the help. false:
 * *ret_status is the exit status. */
bool cli_parse(const char *command, const char *parameters, const char *summary,
	const char *description, const GOptionEntry *entries, int *argc, char ***argv,
	int *ret_status);

/* Print one JSON document; they take the object, or the array. */
void cli_print_json(JsonObject *object);
void cli_print_json_array(JsonArray *array);

/* A bar on the terminal, from the second second on; silent where stderr is none. ETA by the pace so
 * far. Where $PLEINAIR_PROGRESS_FD is the number of a pipe, each step is a line on it: "0.531 what is
 * done"; who does not read it misses lines. */
struct cli_bar {
	const char *command;
	int64_t started_us, shown_us;
	double shown_fraction, pace; /* a second */
	bool terminal, visible;
	int fd; /* of PLEINAIR_PROGRESS_FD; below 0: none */
	int64_t told_us;
};
struct cli_bar cli_bar_begin(const char *command);
void cli_bar_update(struct cli_bar *bar, double fraction, const char *doing);
/* Wipes the line; call before any other output. */
void cli_bar_end(struct cli_bar *bar);
/* "12 s", "3 min 05 s", "1 h 02 min"; caller frees. */
char *cli_duration(double seconds);

/* From now on SIGINT and SIGTERM only set what cli_interrupted tells; a second one ends the
 * program. A closed pipe becomes an error of the write. */
void cli_catch_interrupts(void);
bool cli_interrupted(void);

#endif
