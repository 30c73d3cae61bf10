#ifndef RENDER_KIOSK_SERVICES_H
#define RENDER_KIOSK_SERVICES_H
/* The two services that do the work: pleinair-acquired and pleinair-jobsd, as proxies. On the appliance they are of the system bus
 * and systemd's; on a desk they are of the session bus, and started here when nobody else has: in sessions of their own, so that
 * they outlive a screen that crashes, and once more when they are gone. Where there is no session bus, a bus of our own is started,
 * which later screens find again. Main thread. */
#include "acquire/acquisition-bus.h"
#include "process/jobs-bus.h"
#include <stdbool.h>

struct services_options {
	bool system;        /* the appliance */
	const char *folder; /* of sites */
	const char *device; /* head's URI; NULL: the service's own choice */
};
struct services_watcher {
	/* A service came or went; in words, for people. */
	void (*came)(const char *sentence, gpointer user_data);
	void (*went)(const char *sentence, gpointer user_data);
	gpointer user_data;
};

typedef struct services services;
services *services_new(const struct services_options *options, GError **error);
void services_free(services
		*s); /* NULL is fine; ends services that were started here and have nothing to do */
void services_watch(services *s, const struct services_watcher *watcher);
/* Properties are NULL, false or 0 while the service is not there. */
BusAcquisition1 *services_acquisition(services *s);
BusJobs1 *services_jobs(services *s);
bool services_has_acquisition(services *s);
bool services_has_jobs(services *s);

/* ---- jobs ---- */

/* What became of a job that was started here. result: the command's JSON document, when it is done. */
typedef void (*job_ended)(
	const char *state, const char *result, const char *sentence, gpointer user_data);
typedef struct job_watch job_watch;
/* Starts a job, and tells of it until it ends or is let go: progress may be NULL. options: floating, of type a{sv}, or NULL. Both
 * callbacks come from the main loop; ended exactly once, also when the job could not be started. Freed by itself after ended. */
job_watch *services_start_job(services *s, const char *kind, const char *site, GVariant *options,
	void (*progress)(
		double fraction, const char *doing, double seconds_left, gpointer user_data),
	job_ended ended, gpointer user_data);
/* The same for a job that was started before; path: its object's. */
job_watch *services_follow_job(services *s, const char *path,
	void (*progress)(
		double fraction, const char *doing, double seconds_left, gpointer user_data),
	job_ended ended, gpointer user_data);
void job_watch_cancel(job_watch *w); /* asks for it; ended comes */
/* No callback comes any more; the job goes on. NULL is fine. */
void job_watch_let_go(job_watch *w);

#endif
