#include "process/bench-run.h"
#include <errno.h>
#include <gio/gio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

char *bench_program(const char *name)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = self ? g_path_get_dirname(self) : g_strdup(".");
	g_autofree char *file = g_strconcat("pleinair-", name, NULL);
	char *beside = g_build_filename(folder, file, NULL);
	if (g_file_test(beside, G_FILE_TEST_IS_EXECUTABLE))
		return beside;
	g_free(beside);
	return g_steal_pointer(&file);
}

double bench_peak_mib(bool set_back)
{
	g_autofree char *text = NULL;
	if (set_back)
		g_file_set_contents_full(
			"/proc/self/clear_refs", "5", 1, G_FILE_SET_CONTENTS_NONE, 0200, NULL);
	if (!g_file_get_contents("/proc/self/status", &text, NULL, NULL))
		return NAN;
	const char *line = strstr(text, "VmHWM:");
	return line ? strtod(line + 6, NULL) / 1024 : NAN;
}

/* All until the other end is closed; caller frees. */
static char *read_all(int fd)
{
	GString *text = g_string_new(NULL);
	char part[4096];
	ssize_t got;
	while ((got = TEMP_FAILURE_RETRY(read(fd, part, sizeof part))) > 0)
		g_string_append_len(text, part, got);
	close(fd);
	return g_string_free(text, false);
}

static double seconds_of(const struct timeval *t)
{
	return (double)t->tv_sec + 1e-6 * (double)t->tv_usec;
}

bool bench_run(const char *const *argv, struct bench_run *ret, GError **error)
{
	struct rusage usage;
	GPid child;
	int out, status;
	/* Until it has become the other program the child has this one's memory, and its peak. */
	bench_peak_mib(true);
	gint64 began_us = g_get_monotonic_time();
	if (!g_spawn_async_with_pipes(NULL, (char **)argv, NULL,
		    G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_SEARCH_PATH, NULL, NULL, &child, NULL, &out,
		    NULL, error))
		return false;
	g_autofree char *output = read_all(out);
	if (TEMP_FAILURE_RETRY(wait4(child, &status, 0, &usage)) < 0) {
		g_set_error(error, G_IO_ERROR, g_io_error_from_errno(errno), "%s: %s", argv[0],
			g_strerror(errno));
		return false;
	}
	if (!g_spawn_check_wait_status(status, error)) {
		g_prefix_error(error, "%s: ", argv[0]);
		return false;
	}
	*ret = (struct bench_run){ (double)(g_get_monotonic_time() - began_us) * 1e-6,
		seconds_of(&usage.ru_utime) + seconds_of(&usage.ru_stime),
		(double)usage.ru_maxrss / 1024, g_steal_pointer(&output) };
	return true;
}
