#ifndef PROCESS_JOBS_SERVICE_H
#define PROCESS_JOBS_SERVICE_H
/* org.pleinair.Jobs1 and its jobs, over a queue of them. Main thread. */
#include "process/job-kinds.h"
#include <gio/gio.h>

struct jobs_service_options {
	const char *folder;     /* of sites */
	const char *state_path; /* where jobs are remembered; NULL: nowhere */
	const char *programs;   /* the folder of the commands; NULL: the PATH */
	struct job_limits limits;
};

typedef struct jobs_service jobs_service;
jobs_service *jobs_service_new(const struct jobs_service_options *options);
void jobs_service_free(jobs_service *s); /* NULL is fine; only when none runs */
bool jobs_service_export(jobs_service *s, GDBusConnection *c, GError **error);
/* Begins with what waits. */
void jobs_service_begin(jobs_service *s);
/* Stops the job that runs, and then calls ended. */
void jobs_service_end(jobs_service *s, void (*ended)(void));

#endif
