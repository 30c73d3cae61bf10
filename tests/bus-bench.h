#ifndef TESTS_BUS_BENCH_H
#define TESTS_BUS_BENCH_H
/* A bus of the test's own, which is also what a daemon takes for the system's, and a daemon on it that can be killed. */
#include "tests/commands.h"

#define BUS_PATIENCE_S 300

struct bus_bench {
	GTestDBus *bus;
	GDBusConnection *connection;
	GPid pid; /* of the daemon; 0: none runs */
};

static inline void bus_bench_begin(struct bus_bench *b)
{
	g_autoptr(GError) error = NULL;
	b->bus = g_test_dbus_new(G_TEST_DBUS_NONE);
	g_test_dbus_up(b->bus);
	const char *address = g_test_dbus_get_bus_address(b->bus);
	g_setenv("DBUS_SYSTEM_BUS_ADDRESS", address, TRUE);
	b->connection = g_dbus_connection_new_for_address_sync(address,
		G_DBUS_CONNECTION_FLAGS_AUTHENTICATION_CLIENT |
			G_DBUS_CONNECTION_FLAGS_MESSAGE_BUS_CONNECTION,
		NULL, NULL, &error);
	g_assert_no_error(error);
}

/* argv[0] is set to the program's path. */
static inline void bus_bench_start(struct bus_bench *b, const char *program, char **argv)
{
	g_autofree char *path = commands_program(program);
	g_autoptr(GError) error = NULL;
	argv[0] = path;
	g_spawn_async(NULL, argv, NULL, G_SPAWN_DO_NOT_REAP_CHILD, commands_follow, NULL, &b->pid,
		&error);
	g_assert_no_error(error);
}

/* Its wait status. */
static inline int bus_bench_kill(struct bus_bench *b, int signal_number)
{
	int status = 0;
	if (!b->pid)
		return 0;
	kill(b->pid, signal_number);
	g_assert_cmpint(waitpid(b->pid, &status, 0), ==, b->pid);
	b->pid = 0;
	return status;
}

static inline void bus_bench_end(struct bus_bench *b)
{
	bus_bench_kill(b, SIGTERM);
	g_dbus_connection_close_sync(b->connection, NULL, NULL);
	g_object_unref(b->connection);
	g_test_dbus_down(b->bus);
	g_object_unref(b->bus);
}

static inline gboolean bus_bench_late(gpointer user_data)
{
	*(bool *)user_data = true;
	return G_SOURCE_CONTINUE;
}

/* Runs the main loop until it holds. */
#define WAIT_FOR(condition)                                                                        \
	do {                                                                                       \
		bool late = false;                                                                 \
		guint timer = g_timeout_add_seconds(BUS_PATIENCE_S, bus_bench_late, &late);        \
		while (!(condition) && !late)                                                      \
			g_main_context_iteration(NULL, TRUE);                                      \
		g_source_remove(timer);                                                            \
		g_assert_true(condition);                                                          \
	} while (0)

static inline void bus_bench_live_for(guint ms)
{
	bool over = false;
	guint timer = g_timeout_add(ms, bus_bench_late, &over);
	while (!over)
		g_main_context_iteration(NULL, TRUE);
	g_source_remove(timer);
}

/* org.pleinair.Error.CODE with these words in it; takes error. */
static inline void bus_bench_assert_refused(GError *error, const char *code, const char *names)
{
	g_autoptr(GError) e = error;
	g_autofree char *remote = e ? g_dbus_error_get_remote_error(e) : NULL;
	g_autofree char *name = g_strconcat("org.pleinair.Error.", code, NULL);
	g_assert_cmpstr(remote, ==, name);
	if (!strstr(e->message, names))
		g_test_message("%s", e->message);
	g_assert_nonnull(strstr(e->message, names));
}

/* How often a test of kills kills. */
static inline guint bus_bench_kills(void)
{
	const char *text = g_getenv("PLEINAIR_KILLS");
	return text ? (guint)g_ascii_strtoull(text, NULL, 10) : 4;
}

#endif
