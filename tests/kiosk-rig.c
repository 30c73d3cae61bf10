#include "tests/commands.h"
#include "tests/kiosk-rig-private.h"
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

enum { width_default = 1280, height_default = 800 };
static const double start_limit_s = 120, weston_limit_s = 60;

static char *module_path(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = g_path_get_dirname(self ? self : ".");
	return g_build_filename(folder, "weston-touch.so", NULL);
}

const char *rig_missing(void)
{
	g_autofree char *weston = g_find_program_in_path("weston");
	g_autofree char *bus = g_find_program_in_path("dbus-daemon");
	g_autofree char *module = module_path();
	if (!weston)
		return "weston is not installed";
	if (!bus)
		return "dbus-daemon is not installed";
	if (!g_file_test(module, G_FILE_TEST_EXISTS))
		return "weston-touch.so was not built, since weston's headers were missing";
	return NULL;
}

bool rig_tests_begin(int *argc, char ***argv)
{
	const char *missing = rig_missing();
	g_test_init(argc, argv, NULL);
	commands_find_programs();
	if (missing)
		g_print("1..0 # SKIP %s\n", missing);
	return !missing;
}

void rig_fail(rig *r, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *why = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_autoptr(GString) shown = g_string_new(NULL);
	if (r->probe.connection && rig_line_ask(&r->probe, "list\nstate\n", 2, shown, NULL))
		g_printerr("rig: shown and known are:\n%s", shown->str);
	g_error("rig: %s (%s/weston.log)", why, r->folder);
}

/* ---- processes ---- */

/* In the child: nothing of the rig outlives the test, however that ends. */
static void die_with_test(gpointer test)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != GPOINTER_TO_INT(test))
		_exit(1);
}

static GSubprocess *launch(rig *r, char **environment, const char *const *command, bool quiet)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GSubprocessLauncher) launcher = g_subprocess_launcher_new(
		quiet ? G_SUBPROCESS_FLAGS_STDOUT_SILENCE | G_SUBPROCESS_FLAGS_STDERR_SILENCE
		      : G_SUBPROCESS_FLAGS_NONE);
	g_subprocess_launcher_set_environ(launcher, environment);
	g_subprocess_launcher_set_cwd(launcher, r->folder);
	g_subprocess_launcher_set_child_setup(
		launcher, die_with_test, GINT_TO_POINTER(getpid()), NULL);
	/* TAP goes to standard output, which is the test's alone. */
	if (!quiet)
		g_subprocess_launcher_take_fd(launcher, dup(STDERR_FILENO), STDOUT_FILENO);
	GSubprocess *process = g_subprocess_launcher_spawnv(launcher, command, &error);
	if (!process)
		rig_fail(r, "%s", error->message);
	return process;
}

static void end_process(GSubprocess **process, int signal)
{
	if (!*process)
		return;
	g_subprocess_send_signal(*process, signal);
	g_subprocess_wait(*process, NULL, NULL);
	g_clear_object(process);
}

/* Asks the kernel: a GSubprocess knows only what a main loop has told it. */
static bool has_ended(GSubprocess *process)
{
	const char *id = g_subprocess_get_identifier(process);
	if (!id)
		return true;
	g_autofree char *path = g_strdup_printf("/proc/%s/stat", id);
	g_autofree char *stat = NULL;
	if (!g_file_get_contents(path, &stat, NULL, NULL))
		return true;
	const char *after_name = strrchr(stat, ')');
	return after_name && after_name[2] == 'Z';
}

static char *in_folder(const rig *r, const char *name)
{
	return g_build_filename(r->folder, name, NULL);
}

static void open_line(
	rig *r, struct rig_line *line, const char *name, GSubprocess *server, double seconds)
{
	g_autofree char *path = in_folder(r, name);
	gint64 limit_us = g_get_monotonic_time() + seconds * G_USEC_PER_SEC;
	while (!rig_line_open(line, path)) {
		if (has_ended(server))
			rig_fail(r, "what serves '%s' has ended", name);
		if (g_get_monotonic_time() > limit_us)
			rig_fail(r, "nothing listens at '%s' within %g s", name, seconds);
		g_usleep(20000);
	}
}

static void start_weston(rig *r, int width, int height)
{
	g_autofree char *module = module_path();
	g_autofree char *modules = g_strdup_printf("--modules=%s", module);
	g_autofree char *wide = g_strdup_printf("--width=%d", width ? width : width_default);
	g_autofree char *high = g_strdup_printf("--height=%d", height ? height : height_default);
	g_autofree char *log = g_strdup_printf("--log=%s/weston.log", r->folder);
	g_autofree char *touch = in_folder(r, "touch");
	g_auto(GStrv) environment =
		g_environ_setenv(g_get_environ(), "XDG_RUNTIME_DIR", r->folder, TRUE);
	environment = g_environ_setenv(environment, "PLEINAIR_TOUCH_SOCKET", touch, TRUE);
	/* With the checks of ours loaded first weston would not start. */
	environment = g_environ_unsetenv(environment, "LD_PRELOAD");
	const char *command[] = { "weston", "--no-config", "--backend=headless-backend.so",
		"--use-pixman", "--shell=kiosk-shell.so", "--socket=screen", "--idle-time=0",
		modules, wide, high, log, NULL };
	r->weston = launch(r, environment, command, true);
	open_line(r, &r->touch, "touch", r->weston, weston_limit_s);
}

static void set(rig *r, const char *name, const char *value)
{
	r->environment = g_environ_setenv(r->environment, name, value, TRUE);
}

static void start_bus(rig *r, const char *services)
{
	if (g_environ_getenv(r->environment, "DBUS_SESSION_BUS_ADDRESS"))
		return;
	r->bus = g_test_dbus_new(G_TEST_DBUS_NONE);
	if (services)
		g_test_dbus_add_service_dir(r->bus, services);
	g_test_dbus_up(r->bus);
	set(r, "DBUS_SESSION_BUS_ADDRESS", g_test_dbus_get_bus_address(r->bus));
}

/* Settings and buses of the desk must not leak in. */
static void make_environment(rig *r, const char *const *added)
{
	static const char *const removed[] = { "DISPLAY", "DBUS_SESSION_BUS_ADDRESS", "GTK_THEME",
		"GTK_IM_MODULE", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME" };
	g_autofree char *probe = in_folder(r, "probe");
	r->environment = g_get_environ();
	for (size_t i = 0; i < G_N_ELEMENTS(removed); i++)
		r->environment = g_environ_unsetenv(r->environment, removed[i]);
	set(r, "HOME", r->folder);
	set(r, "XDG_RUNTIME_DIR", r->folder);
	set(r, "WAYLAND_DISPLAY", "screen");
	set(r, "GDK_BACKEND", "wayland");
	set(r, "GSK_RENDERER", "cairo");
	set(r, "GSETTINGS_BACKEND", "memory");
	/* What screen readers are told is kept in the program, where the probe finds it. */
	set(r, "GTK_A11Y", "test");
	set(r, "PLEINAIR_KIOSK_PROBE", probe);
	for (; added && *added; added++) {
		g_auto(GStrv) parts = g_strsplit(*added, "=", 2);
		set(r, parts[0], parts[1]);
	}
}

rig *rig_new(const struct rig_desc *desc)
{
	g_autoptr(GError) error = NULL;
	rig *r = g_new0(rig, 1);
	/* Paths of sockets are short. */
	r->folder = g_dir_make_tmp("rig-XXXXXX", &error);
	g_assert_no_error(error);
	r->program = g_canonicalize_filename(desc->program, NULL);
	r->arguments = g_strdupv((char **)desc->arguments);
	make_environment(r, desc->environment);
	start_bus(r, desc->services);
	start_weston(r, desc->width, desc->height);
	rig_start(r);
	return r;
}

static void remove_folder(const char *path)
{
	g_autoptr(GDir) folder = g_dir_open(path, 0, NULL);
	for (const char *name; folder && (name = g_dir_read_name(folder));) {
		g_autofree char *inner = g_build_filename(path, name, NULL);
		if (g_file_test(inner, G_FILE_TEST_IS_DIR) &&
			!g_file_test(inner, G_FILE_TEST_IS_SYMLINK))
			remove_folder(inner);
		else
			remove(inner);
	}
	rmdir(path);
}

void rig_free(rig *r)
{
	if (!r)
		return;
	rig_line_close(&r->probe);
	end_process(&r->running, SIGKILL);
	rig_line_close(&r->touch);
	end_process(&r->weston, SIGTERM);
	if (r->bus)
		g_test_dbus_down(r->bus);
	g_clear_object(&r->bus);
	remove_folder(r->folder);
	g_strfreev(r->environment);
	g_strfreev(r->arguments);
	g_free(r->program);
	g_free(r->folder);
	g_free(r);
}

const char *rig_folder(const rig *r)
{
	return r->folder;
}

static void wait_shown(rig *r)
{
	gint64 limit_us = g_get_monotonic_time() + start_limit_s * G_USEC_PER_SEC;
	for (;;) {
		g_autofree char *list = rig_list(r);
		if (*list)
			return;
		if (g_get_monotonic_time() > limit_us)
			rig_fail(r, "the program shows nothing that has a name");
		g_usleep(20000);
	}
}

void rig_start(rig *r)
{
	g_assert_null(r->running);
	g_autofree char *probe = in_folder(r, "probe");
	remove(probe);
	g_autoptr(GStrvBuilder) words = g_strv_builder_new();
	g_strv_builder_add(words, r->program);
	if (r->arguments)
		g_strv_builder_addv(words, (const char **)r->arguments);
	g_auto(GStrv) command = g_strv_builder_end(words);
	r->running = launch(r, r->environment, (const char *const *)command, false);
	open_line(r, &r->probe, "probe", r->running, start_limit_s);
	wait_shown(r);
}

void rig_kill(rig *r)
{
	rig_line_close(&r->probe);
	end_process(&r->running, SIGKILL);
}

bool rig_runs(rig *r)
{
	return r->running && !has_ended(r->running);
}
