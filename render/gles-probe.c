#include "render/gles-probe.h"
#include "render/gles-trial.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

/* Tells the child its platform and its parent. */
#define CHILD "PLEINAIR_PROBE"
/* Where it writes to. */
#define ANSWERS 3

/* What the child writes, at once; it has no padding that matters and no pointers. */
struct answer {
	bool is_found;
	int32_t code;
	struct gles_about about;
	char why[512];
};
G_STATIC_ASSERT(sizeof(struct answer) <= 4096); /* PIPE_BUF: all of it or nothing */

/* ---- the child: looks ---- */

static bool try_display(struct gles_about *about, GError **error)
{
	g_autoptr(gles_context) c = gles_context_open(about, error);
	if (!c || !gles_trial(c, error))
		return false;
	*about = c->about;
	return true;
}

/* false: go on, there may be better. */
static bool take(const struct gles_about *about, bool *is_found, struct gles_about *ret)
{
	if (!*is_found || !about->is_software)
		*ret = *about;
	*is_found = true;
	return !about->is_software;
}

/* The first GPU, else the first software renderer; else why the first display is of no use. */
static bool try_platform(enum gles_platform platform, struct gles_about *ret, GError **error)
{
	uint32_t number[GLES_DISPLAYS_MAX];
	g_autoptr(GError) first = NULL;
	unsigned n = gles_display_list(platform, number, error);
	bool is_found = false, is_gpu = false;
	for (unsigned i = 0; i < n && !is_gpu; i++) {
		struct gles_about about = { .platform = platform, .display = number[i] };
		g_autoptr(GError) why = NULL;
		if (try_display(&about, &why))
			is_gpu = take(&about, &is_found, ret);
		else
			g_debug("EGL %s %u: %s", gles_platform_names[platform], number[i],
				why->message);
		if (why && !first)
			first = g_steal_pointer(&why);
	}
	if (n && !is_found)
		g_propagate_error(error, g_steal_pointer(&first));
	return is_found;
}

/* Runs before the parent's own handlers, if a driver calls exit. */
static void leave(int status, void *unused)
{
	(void)unused;
	_exit(status);
}

static void keep_to_itself(pid_t parent)
{
	/* A crash is one, also where a sanitizer would have its say first. */
	static const int crashes[] = { SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT };
	for (size_t i = 0; i < G_N_ELEMENTS(crashes); i++)
		signal(crashes[i], SIG_DFL);
	/* 1, not 0: only that keeps handlers of core files away too (Linux, fs/coredump.c). */
	setrlimit(RLIMIT_CORE, &(struct rlimit){ 1, 1 });
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(EXIT_FAILURE);
	on_exit(leave, NULL);
	int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
	dup2(nowhere, STDOUT_FILENO);
	if (g_log_writer_default_would_drop(G_LOG_LEVEL_DEBUG, G_LOG_DOMAIN))
		dup2(nowhere, STDERR_FILENO);
}

static G_NORETURN void look(enum gles_platform platform, pid_t parent)
{
	struct answer a = { 0 };
	g_autoptr(GError) error = NULL;
	fcntl(ANSWERS, F_SETFD, FD_CLOEXEC);
	g_unsetenv(CHILD);
	keep_to_itself(parent);
	a.is_found = try_platform(platform, &a.about, &error);
	if (error) {
		a.code = error->code;
		g_strlcpy(a.why, error->message, sizeof a.why);
	}
	_exit(write(ANSWERS, &a, sizeof a) == (ssize_t)sizeof a ? EXIT_SUCCESS : EXIT_FAILURE);
}

/* The program again, to look only: it never comes to main(). */
__attribute__((constructor)) static void look_if_child(void)
{
	const char *told = g_getenv(CHILD);
	unsigned platform;
	int parent;
	if (told && sscanf(told, "%u %d", &platform, &parent) == 2 && platform < GLES_PLATFORMS)
		look((enum gles_platform)platform, parent);
}

/* ---- the parent: waits ---- */

/* How many bytes came before the end or the deadline; ret_is_late: it was the deadline. */
static size_t hear(int from, void *into, size_t size, gint64 deadline_us, bool *ret_is_late)
{
	size_t have = 0;
	*ret_is_late = false;
	while (have < size) {
		gint64 left_us = deadline_us - g_get_monotonic_time();
		struct pollfd p = { .fd = from, .events = POLLIN };
		*ret_is_late = left_us <= 0;
		if (*ret_is_late)
			break;
		if (poll(&p, 1, (int)(left_us / 1000) + 1) <= 0)
			continue;
		ssize_t n = read(from, (char *)into + have, size - have);
		if (n == 0 || (n < 0 && errno != EINTR))
			break;
		have += (size_t)MAX(n, 0);
	}
	return have;
}

/* Its status; -1: it cannot be had. A child stuck in the kernel survives even SIGKILL, and is not waited for. */
static int end(pid_t child, bool is_killed)
{
	if (is_killed)
		kill(child, SIGKILL);
	for (int i = 0; i < 200; i++) {
		int status = 0;
		pid_t is = waitpid(child, &status, WNOHANG);
		if (is == child)
			return status;
		if (is < 0 && errno != EINTR)
			return -1;
		g_usleep(10 * 1000);
	}
	/* It has answered, or will never; what is left of it is of no interest. */
	kill(child, SIGKILL);
	return -1;
}

static bool driver_failed(GError **error, const char *format, ...) G_GNUC_PRINTF(2, 3);
static bool driver_failed(GError **error, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *sentence = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error_literal(error, GLES_ERROR, GLES_ERROR_DRIVER, sentence);
	return false;
}

static bool silent(int status, GError **error)
{
	if (status >= 0 && WIFSIGNALED(status))
		return driver_failed(
			error, "its driver crashes (%s)", g_strsignal(WTERMSIG(status)));
	if (status >= 0 && WIFEXITED(status))
		return driver_failed(
			error, "its driver ends the program (exit status %d)", WEXITSTATUS(status));
	return driver_failed(error, "its driver ends the program");
}

static bool judge(const struct answer *a, struct gles_about *ret, GError **error)
{
	if (a->is_found) {
		*ret = a->about;
		return true;
	}
	g_set_error(error, GLES_ERROR, a->code, "%.*s", (int)sizeof a->why, a->why);
	return false;
}

static bool wait_for(
	pid_t child, int from, unsigned patience_s, struct gles_about *ret, GError **error)
{
	struct answer a;
	bool is_late;
	gint64 deadline_us = g_get_monotonic_time() + (gint64)patience_s * G_USEC_PER_SEC;
	size_t have = hear(from, &a, sizeof a, deadline_us, &is_late);
	int status = end(child, is_late);
	if (is_late)
		return driver_failed(error, "its driver hangs (%u s)", patience_s);
	return have == sizeof a ? judge(&a, ret, error) : silent(status, error);
}

/* With the signals that programs begin with. 0: there is none, and errno says why. */
static pid_t start(enum gles_platform platform, int to)
{
	posix_spawnattr_t how;
	posix_spawn_file_actions_t files;
	sigset_t none, all;
	pid_t child = 0;
	g_autofree char *told = g_strdup_printf("%d %d", (int)platform, (int)getpid());
	g_auto(GStrv) environment = g_environ_setenv(g_get_environ(), CHILD, told, TRUE);
	char *arguments[] = { (char *)"pleinair: looks for OpenGL ES", NULL };
	sigemptyset(&none);
	sigfillset(&all);
	posix_spawnattr_init(&how);
	posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
	posix_spawnattr_setsigmask(&how, &none);
	posix_spawnattr_setsigdefault(&how, &all);
	posix_spawn_file_actions_init(&files);
	posix_spawn_file_actions_adddup2(&files, to, ANSWERS);
	int why = posix_spawn(&child, "/proc/self/exe", &files, &how, arguments, environment);
	posix_spawn_file_actions_destroy(&files);
	posix_spawnattr_destroy(&how);
	errno = why;
	return why ? 0 : child;
}

static bool probe_platform(
	enum gles_platform platform, unsigned patience_s, struct gles_about *ret, GError **error)
{
	int ends[2];
	if (pipe2(ends, O_CLOEXEC))
		return driver_failed(error, "no pipe: %s", g_strerror(errno));
	pid_t child = start(platform, ends[1]);
	int why = errno;
	close(ends[1]);
	bool is_found = child ? wait_for(child, ends[0], patience_s, ret, error)
			      : driver_failed(error, "no child process: %s", g_strerror(why));
	close(ends[0]);
	return is_found;
}

/* ---- all platforms ---- */

static bool is_wanted(const char *only, enum gles_platform platform)
{
	return !only || !*only || !strcmp(only, gles_platform_names[platform]);
}

static bool check_wish(const char *only, GError **error)
{
	bool is_known = !only || !*only;
	for (int i = 0; i < GLES_PLATFORMS; i++)
		is_known = is_known || !strcmp(only, gles_platform_names[i]);
	if (is_known)
		return true;
	if (!strcmp(only, "none"))
		g_set_error_literal(
			error, GLES_ERROR, GLES_ERROR_NONE, "PLEINAIR_EGL=none forbids OpenGL");
	else
		g_set_error(error, GLES_ERROR, GLES_ERROR_NONE,
			"PLEINAIR_EGL is \"%s\", not surfaceless, device, gbm or none", only);
	return false;
}

/* What did not work, and why; said once where it is the same for all. */
struct attempts {
	GString *each;
	char *first;
	bool differ;
	int code; /* GLES_ERROR_DRIVER if it is that of any */
};

static void note(struct attempts *a, enum gles_platform platform, const GError *why)
{
	if (!a->first)
		a->first = g_strdup(why->message);
	a->differ = a->differ || strcmp(a->first, why->message);
	a->code = MAX(a->code, MIN(why->code, GLES_ERROR_DRIVER));
	g_string_append_printf(a->each, "%sby %s, %s", a->each->len ? "; " : "",
		gles_platform_names[platform], why->message);
}

static void report(struct attempts *a, bool is_found, GError **error)
{
	if (!is_found)
		g_set_error(error, GLES_ERROR, a->code, "EGL has no OpenGL ES 3.1: %s",
			a->differ ? a->each->str : a->first);
	g_string_free(a->each, TRUE);
	g_free(a->first);
}

bool gles_context_probe(
	const struct gles_probe_options *options, struct gles_about *ret, GError **error)
{
	const char *only = g_getenv("PLEINAIR_EGL");
	unsigned patience_s = options && options->patience_s ? options->patience_s : 20;
	/* Only loads the library: the dispatcher as a rule, which looks for drivers when it is asked something. */
	if (!check_wish(only, error) || !egl_functions_load(error))
		return false;
	struct attempts attempts = { .each = g_string_new(NULL) };
	bool is_found = false, is_gpu = false;
	for (enum gles_platform p = 0; p < GLES_PLATFORMS && !is_gpu; p++) {
		g_autoptr(GError) why = NULL;
		struct gles_about about;
		if (!is_wanted(only, p))
			continue;
		if (probe_platform(p, patience_s, &about, &why))
			is_gpu = take(&about, &is_found, ret);
		else
			note(&attempts, p, why);
	}
	report(&attempts, is_found, error);
	return is_found;
}
