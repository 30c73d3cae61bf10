#ifndef PROCESS_JOBS_H
#define PROCESS_JOBS_H
/* Jobs, one after another, each in a process of its own with low priority, that a file remembers: what waits or runs when the
 * machine goes off is there again, under the same numbers. One main loop, one thread. */
#include "process/job-kinds.h"
#include <stdint.h>

enum job_state { JOB_WAITING, JOB_RUNNING, JOB_DONE, JOB_FAILED, JOB_CANCELLED, JOB_STATES };
extern const char *const job_state_names[JOB_STATES];

struct job {
	uint32_t number;
	const struct job_kind *kind;
	char *site_path;
	GStrv arguments;
	enum job_state state;
	double fraction, seconds_left; /* below 0: not known */
	char *doing;
	char *result; /* what the command printed */
	char *error;  /* one sentence */
	uint32_t tries;
};

struct jobs_watcher {
	void (*changed)(const struct job *job, gpointer user_data); /* also when it is new */
	void (*ended)(const struct job *job, gpointer user_data);
	/* It is forgotten after this. */
	void (*gone)(const struct job *job, gpointer user_data);
	/* None runs any more, after jobs_stop. */
	void (*stopped)(gpointer user_data);
	gpointer user_data;
};

typedef struct jobs jobs;
/* state_path: the file; NULL: nothing is remembered. One that cannot be read is moved aside with a warning. Jobs that it has are told
 * of by jobs_announce. programs: the folder of the commands; NULL: the PATH. */
jobs *jobs_new(const char *state_path, const char *programs, const struct jobs_watcher *watcher);
void jobs_free(jobs *j); /* NULL is fine; only when none runs */
void jobs_announce(jobs *j);
/* Runs what waits, from now on. */
void jobs_begin(jobs *j);

/* Takes arguments (job_kind_arguments). */
const struct job *jobs_add(
	jobs *j, const struct job_kind *kind, const char *site_path, GStrv arguments);
/* false: there is no such job, or it has ended. */
bool jobs_cancel(jobs *j, uint32_t number, GError **error);
/* Those that wait or run, in their order, then those that ended, the last one first. Of const struct job *; caller unrefs. */
GPtrArray *jobs_list(jobs *j);
/* Stops the one that runs, which is begun again the next time, and begins no other. */
void jobs_stop(jobs *j);

#endif
