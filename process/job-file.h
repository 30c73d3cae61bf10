#ifndef PROCESS_JOB_FILE_H
#define PROCESS_JOB_FILE_H
/* The file that remembers jobs: a key file with a group a job. */
#include "process/jobs.h"

/* Of struct job *, in their order; what is wrong is said as a warning, the file moved to FILE.broken. *ret_next: the number of the next
 * job. Caller unrefs. */
GPtrArray *job_file_load(const char *path, uint32_t *ret_next);
bool job_file_save(const char *path, const GPtrArray *all, uint32_t next, GError **error);
void job_free(gpointer job);

#endif
