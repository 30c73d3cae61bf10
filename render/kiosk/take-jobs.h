#ifndef RENDER_KIOSK_TAKE_JOBS_H
#define RENDER_KIOSK_TAKE_JOBS_H
/* What is being made and copied of a site just now, and brought into it: a row each, with progress, the time left and a way to stop
 * it; also what was started before the screen was opened. What is to be known of the result stays there until it is put away. Main
 * thread. */
#include "render/kiosk/kiosk.h"

typedef struct take_jobs take_jobs;
/* ended: comes after any of them ended. The box owns it. */
take_jobs *take_jobs_new(
	kiosk *k, const char *site, void (*ended)(gpointer user_data), gpointer user_data);
GtkWidget *take_jobs_box(take_jobs *j);
/* title: in words. output: the path that it writes, NULL: none. done (may be NULL) is told what became of it, after people were. */
void take_jobs_start(take_jobs *j, const char *kind, const char *title, const char *output,
	GVariant *options, job_ended done, gpointer user_data);
/* Paths that will be written; of char *, theirs. */
GPtrArray *take_jobs_outputs(take_jobs *j);

#endif
