#ifndef PROCESS_JOB_CHILD_H
#define PROCESS_JOB_CHILD_H
/* The process of a job: low in priority, dies with its parent, says on a pipe how far it is (cli.h, PLEINAIR_PROGRESS_FD). Main
 * loop. */
#include <glib.h>
#include <stdbool.h>

struct job_child_watcher {
	void (*progress)(double fraction, const char *doing, gpointer user_data);
	/* out: what it printed, NULL when it failed; sentence: its last words on stderr, or what ended it. Frees the child. */
	void (*ended)(const char *out, const char *sentence, gpointer user_data);
	gpointer user_data;
};

typedef struct job_child job_child;
/* argv[0]: a path, or a name on the PATH. */
job_child *job_child_new(
	const char *const *argv, const struct job_child_watcher *watcher, GError **error);
/* Asks it to end; what does not is killed after some seconds. */
void job_child_stop(job_child *c);

#endif
