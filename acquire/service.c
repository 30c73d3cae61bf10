#include "acquire/service.h"
#include "acquire/cli.h"
#include "firmware-io/record.h"
#include <errno.h>
#include <glib-unix.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

struct running {
	const struct service *service;
	GMainLoop *loop;
	int status;
	bool ending;
};
static struct running *running;

/* ---- systemd's protocol for services ---- */

static bool notify_address(struct sockaddr_un *a, socklen_t *length)
{
	const char *path = g_getenv("NOTIFY_SOCKET");
	size_t n = path ? strlen(path) : 0;
	*a = (struct sockaddr_un){ .sun_family = AF_UNIX };
	if (n < 2 || n >= sizeof a->sun_path || !strchr("/@", *path))
		return false;
	memcpy(a->sun_path, path, n);
	/* Names in no folder begin with a zero. */
	if (*path == '@')
		a->sun_path[0] = '\0';
	*length = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + n);
	return true;
}

void service_notify(const char *state)
{
	struct sockaddr_un to;
	socklen_t length;
	if (!notify_address(&to, &length))
		return;
	int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return;
	if (sendto(fd, state, strlen(state), MSG_NOSIGNAL, (struct sockaddr *)&to, length) < 0)
		g_printerr("pleinair: NOTIFY_SOCKET: %s\n", g_strerror(errno));
	close(fd);
}

static gboolean feed_watchdog(gpointer user_data)
{
	(void)user_data;
	service_notify("WATCHDOG=1");
	return G_SOURCE_CONTINUE;
}

/* From the main loop, so that one that hangs is found out. */
static guint watch_over(void)
{
	const char *text = g_getenv("WATCHDOG_USEC"), *whose = g_getenv("WATCHDOG_PID");
	guint64 us = text ? g_ascii_strtoull(text, NULL, 10) : 0;
	if (!us || (whose && g_ascii_strtoll(whose, NULL, 10) != getpid()))
		return 0;
	return g_timeout_add((guint)MAX(us / 2000, 1), feed_watchdog, NULL);
}

/* ---- the name ---- */

/* Asked again while all is being put away, it ends already. */
static void begin_end(void)
{
	if (!running || running->ending)
		return;
	running->ending = true;
	service_notify("STOPPING=1");
	running->service->end(running->service->user_data);
}

static gboolean told_to_end(gpointer user_data)
{
	(void)user_data;
	begin_end();
	return G_SOURCE_CONTINUE;
}

static void fail(GError *error)
{
	g_autoptr(GError) e = error;
	running->status = cli_fail(running->service->command, e);
	begin_end();
}

static void got_bus(GDBusConnection *c, const char *name, gpointer user_data)
{
	const struct service *s = running->service;
	GError *error = NULL;
	(void)name;
	(void)user_data;
	if (!s->export_objects(c, s->user_data, &error))
		fail(error);
}

static void got_name(GDBusConnection *c, const char *name, gpointer user_data)
{
	const struct service *s = running->service;
	(void)c;
	(void)name;
	(void)user_data;
	service_notify("READY=1");
	if (s->begin && !running->ending)
		s->begin(s->user_data);
}

static void lost_name(GDBusConnection *c, const char *name, gpointer user_data)
{
	(void)user_data;
	if (running->ending)
		return;
	fail(c ? g_error_new(SERVICE_ERROR, SERVICE_ERROR_BUSY,
			 "%s: another program has this name on the bus already", name)
	       : g_error_new_literal(
			 SERVICE_ERROR, SERVICE_ERROR_FAILED, "there is no bus, or it is gone"));
}

static GBusType bus_of(const struct service *s)
{
	if (s->system)
		return G_BUS_TYPE_SYSTEM;
	return g_getenv("DBUS_STARTER_BUS_TYPE") ? G_BUS_TYPE_STARTER : G_BUS_TYPE_SESSION;
}

int service_run(const struct service *s)
{
	g_autoptr(GMainLoop) loop = g_main_loop_new(NULL, FALSE);
	struct running r = { s, loop, CLI_DONE, false };
	running = &r;
	g_unix_signal_add(SIGTERM, told_to_end, NULL);
	g_unix_signal_add(SIGINT, told_to_end, NULL);
	guint watchdog = watch_over();
	guint owned = g_bus_own_name(bus_of(s), s->name, G_BUS_NAME_OWNER_FLAGS_DO_NOT_QUEUE,
		got_bus, got_name, lost_name, NULL, NULL);
	g_main_loop_run(loop);
	g_bus_unown_name(owned);
	if (watchdog)
		g_source_remove(watchdog);
	running = NULL;
	return r.status;
}

void service_quit(void)
{
	if (running)
		g_main_loop_quit(running->loop);
}

/* ---- callers ---- */

static const GDBusErrorEntry errors[] = {
	{ SERVICE_ERROR_BUSY, "org.pleinair.Error.Busy" },
	{ SERVICE_ERROR_NOT_ALLOWED, "org.pleinair.Error.NotAllowed" },
	{ SERVICE_ERROR_INVALID, "org.pleinair.Error.Invalid" },
	{ SERVICE_ERROR_FAILED, "org.pleinair.Error.Failed" },
	{ SERVICE_ERROR_DAMAGED, SERVICE_ERROR_DAMAGED_NAME },
};

GQuark service_error_quark(void)
{
	static gsize quark;
	g_dbus_error_register_error_domain(
		"service-error-quark", &quark, errors, G_N_ELEMENTS(errors));
	return (GQuark)quark;
}

void service_refuse(GDBusMethodInvocation *call, GError *error)
{
	if (error->domain == SERVICE_ERROR) {
		g_dbus_method_invocation_take_error(call, error);
		return;
	}
	bool damaged = g_error_matches(error, RECORD_ERROR, RECORD_ERROR_DAMAGED);
	g_dbus_method_invocation_return_error_literal(call, SERVICE_ERROR,
		damaged ? SERVICE_ERROR_DAMAGED : SERVICE_ERROR_FAILED, error->message);
	g_error_free(error);
}

bool service_allows(const char *folder, const char *path, GError **error)
{
	if (!g_path_is_absolute(path) || !g_utf8_validate(path, -1, NULL)) {
		g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_INVALID,
			"%s: give the whole path, beginning with a slash", path);
		return false;
	}
	if (!folder)
		return true;
	g_autofree char *parent = g_path_get_dirname(path);
	char *true_folder = realpath(folder, NULL), *true_path = realpath(path, NULL);
	char *true_parent = true_path ? NULL : realpath(parent, NULL);
	size_t n = true_folder ? strlen(true_folder) : 0;
	bool good =
		n && ((true_path && !strncmp(true_path, true_folder, n) && true_path[n] == '/') ||
			     (true_parent && !strcmp(true_parent, true_folder)));
	free(true_folder);
	free(true_path);
	free(true_parent);
	if (!good)
		g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_NOT_ALLOWED,
			"%s does not lie in %s", path, folder);
	return good;
}
