#ifndef ACQUIRE_ACQUISITION_SERVICE_H
#define ACQUIRE_ACQUISITION_SERVICE_H
/* org.pleinair.Acquisition1 over a recorder. Main thread. */
#include <gio/gio.h>
#include <stdbool.h>

struct acquisition_options {
	const char *device; /* URI; NULL: none yet */
	const char *folder; /* of sites; NULL: only with any_site */
	bool any_site; /* callers may name sites anywhere, and devices that read files: on a desk */
};

typedef struct acquisition_service acquisition_service;
acquisition_service *acquisition_service_new(const struct acquisition_options *options);
void acquisition_service_free(acquisition_service *s); /* NULL is fine */
bool acquisition_service_export(acquisition_service *s, GDBusConnection *c, GError **error);
/* Looks at the head, so that it is known how long a scan takes. */
void acquisition_service_begin(acquisition_service *s);
/* Stops a scan that is under way, keeping what there is of it, and then calls ended. */
void acquisition_service_end(acquisition_service *s, void (*ended)(void));

#endif
