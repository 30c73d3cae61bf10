#ifndef ACQUIRE_SERVICE_H
#define ACQUIRE_SERVICE_H
/* What the programs on the bus share: they own a name, say to whoever started them that they are ready and alive, and end when they
 * are told to. One main loop, one thread. */
#include <gio/gio.h>
#include <stdbool.h>

struct service {
	const char *command; /* for messages */
	const char *name;    /* on the bus */
	bool system;         /* the system bus; else the one that started it, or the session's */
	/* Puts its objects on the connection, before the name is owned. */
	bool (*export_objects)(GDBusConnection *c, gpointer user_data, GError **error);
	/* The name is ours: nobody else does the same work. May be NULL. */
	void (*begin)(gpointer user_data);
	/* SIGTERM or SIGINT, or the bus is gone: comes to its end, and then calls service_quit. */
	void (*end)(gpointer user_data);
	gpointer user_data;
};
/* Runs until service_quit; the exit status. Fails when another one owns the name. */
int service_run(const struct service *s);
/* From its main loop. */
void service_quit(void);

/* Tells systemd, or whoever set NOTIFY_SOCKET: "READY=1" (sd_notify(3)). Nothing happens where nobody listens. */
void service_notify(const char *state);

/* ---- what callers may ---- */

/* Errors of services: on the bus org.pleinair.Error.Busy and so on. */
#define SERVICE_ERROR (service_error_quark())
GQuark service_error_quark(void);
enum service_error {
	SERVICE_ERROR_BUSY,
	SERVICE_ERROR_NOT_ALLOWED,
	SERVICE_ERROR_INVALID, /* an argument that cannot be */
	SERVICE_ERROR_FAILED,
	SERVICE_ERROR_DAMAGED, /* a record, of which what is whole can be gone on with */
};
#define SERVICE_ERROR_DAMAGED_NAME "org.pleinair.Error.Damaged" /* for those who ask over the bus */
/* Whether a path is absolute, and, where only what lies in folder is allowed (NULL: all), that it lies in it, by its true path: of a
 * site that is not there yet, its parent must be the folder itself. */
bool service_allows(const char *folder, const char *path, GError **error);
/* Answers with the error as one of SERVICE_ERROR, whatever domain it is of; takes both. */
void service_refuse(GDBusMethodInvocation *call, GError *error);

#endif
