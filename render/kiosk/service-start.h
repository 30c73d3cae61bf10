#ifndef RENDER_KIOSK_SERVICE_START_H
#define RENDER_KIOSK_SERVICE_START_H
/* Services and their bus on a desk, where no systemd cares for them. */
#include <gio/gio.h>
#include <stdbool.h>

struct service_start {
	GPid pid; /* 0: not started here, or ended */
	guint watch;
};
/* Runs the program that stands beside this one, in a session of its own. Does nothing while one started here runs. device: NULL, or
 * for pleinair-acquired. */
bool service_start(struct service_start *s, const char *program, const char *folder,
	const char *device, GError **error);
/* Lets go of it; idle: asks it to end. */
void service_end(struct service_start *s, bool idle);

/* The session bus; where there is none, one that is started here, or was by an earlier screen of this person. */
GDBusConnection *service_bus_of_desk(GError **error);
/* Whether one of these jobs waits or runs. */
bool service_bus_has_running_job(GDBusConnection *c, const char *const *paths);

#endif
