#include "render/kiosk/service-start.h"
#include <signal.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

/* ---- programs ---- */

static char *beside(const char *program)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : ".");
	g_autofree char *path = g_build_filename(folder, program, NULL);
	if (g_file_test(path, G_FILE_TEST_IS_EXECUTABLE))
		return g_steal_pointer(&path);
	return g_find_program_in_path(program);
}

static void own_session(gpointer user_data)
{
	(void)user_data;
	setsid();
}

static void has_ended(GPid pid, int status, gpointer user_data)
{
	struct service_start *s = user_data;
	(void)status;
	g_spawn_close_pid(pid);
	s->pid = 0;
	s->watch = 0;
}

static char *state_file(void)
{
	g_autofree char *folder = g_build_filename(g_get_user_state_dir(), "pleinair", NULL);
	g_mkdir_with_parents(folder, 0700);
	return g_build_filename(folder, "jobs", NULL);
}

bool service_start(struct service_start *s, const char *program, const char *folder,
	const char *device, GError **error)
{
	bool scans = !strcmp(program, "pleinair-acquired");
	g_autofree char *path = beside(program), *state = scans ? NULL : state_file();
	char *argv[8] = { path, "--sites", (char *)folder };
	int n = 3;
	if (s->pid)
		return true;
	if (!path) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"%s is neither beside this program nor on the PATH", program);
		return false;
	}
	if (scans && device) {
		argv[n++] = "--device";
		argv[n++] = (char *)device;
	}
	if (state) {
		argv[n++] = "--state";
		argv[n++] = state;
	}
	if (!g_spawn_async(NULL, argv, NULL, G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_STDOUT_TO_DEV_NULL,
		    own_session, NULL, &s->pid, error))
		return false;
	s->watch = g_child_watch_add(s->pid, has_ended, s);
	return true;
}

void service_end(struct service_start *s, bool idle)
{
	g_clear_handle_id(&s->watch, g_source_remove);
	if (s->pid && idle)
		kill(s->pid, SIGTERM);
	s->pid = 0;
}

/* ---- the bus ---- */

static GDBusConnection *connect_to(const char *address, GError **error)
{
	return g_dbus_connection_new_for_address_sync(address,
		G_DBUS_CONNECTION_FLAGS_AUTHENTICATION_CLIENT |
			G_DBUS_CONNECTION_FLAGS_MESSAGE_BUS_CONNECTION,
		NULL, NULL, error);
}

static char *address_file(void)
{
	return g_build_filename(g_get_user_runtime_dir(), "pleinair-bus", NULL);
}

static char *start_bus(const char *file, GError **error)
{
	g_autofree char *out = NULL;
	char *argv[] = { "dbus-daemon", "--session", "--fork", "--print-address", NULL };
	int status;
	if (!g_spawn_sync(NULL, argv, NULL, G_SPAWN_SEARCH_PATH, own_session, NULL, &out, NULL,
		    &status, error) ||
		!g_spawn_check_wait_status(status, error))
		return NULL;
	g_strchomp(out);
	if (!g_file_set_contents_full(file, out, -1, G_FILE_SET_CONTENTS_CONSISTENT, 0600, error))
		return NULL;
	return g_steal_pointer(&out);
}

GDBusConnection *service_bus_of_desk(GError **error)
{
	g_autoptr(GError) none = NULL;
	GDBusConnection *c = g_bus_get_sync(G_BUS_TYPE_SESSION, NULL, &none);
	if (c) {
		g_dbus_connection_set_exit_on_close(c, FALSE);
		return c;
	}
	g_autofree char *file = address_file(), *address = NULL;
	if (g_file_get_contents(file, &address, NULL, NULL) &&
		(c = connect_to(g_strchomp(address), NULL))) {
		g_setenv("DBUS_SESSION_BUS_ADDRESS", address, TRUE);
		return c;
	}
	g_free(address);
	address = start_bus(file, error);
	if (!address)
		return NULL;
	/* For the services that are started here. */
	g_setenv("DBUS_SESSION_BUS_ADDRESS", address, TRUE);
	return connect_to(address, error);
}

bool service_bus_has_running_job(GDBusConnection *c, const char *const *paths)
{
	for (; *paths; paths++) {
		g_autoptr(GVariant) got = g_dbus_connection_call_sync(c, "org.pleinair.Jobs1",
			*paths, "org.freedesktop.DBus.Properties", "Get",
			g_variant_new("(ss)", "org.pleinair.Jobs1.Job", "State"),
			G_VARIANT_TYPE("(v)"), G_DBUS_CALL_FLAGS_NO_AUTO_START, 1000, NULL, NULL);
		g_autoptr(GVariant) state = NULL;
		if (got)
			g_variant_get(got, "(v)", &state);
		if (state && g_variant_is_of_type(state, G_VARIANT_TYPE_STRING) &&
			(!strcmp(g_variant_get_string(state, NULL), "running") ||
				!strcmp(g_variant_get_string(state, NULL), "waiting")))
			return true;
	}
	return false;
}
