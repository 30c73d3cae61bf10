#include "process/job-child.h"
#include "acquire/large-pages.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib-unix.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#define PROGRESS_FD   3
#define NICE          10
#define KILL_AFTER_S  5
#define LINE_MAX_SIZE 1024
/* linux/ioprio.h, which Debian's headers do not have for programs. */
#define IOPRIO_WHO_PROCESS 1
#define IOPRIO_IDLE        (3 << 13)

struct job_child {
	struct job_child_watcher watcher;
	GSubprocess *process;
	GPid pid;
	int fd;
	guint source, kill_timer;
	GString *line;
	bool is_stopped;
};

static void job_child_free(job_child *c)
{
	g_clear_handle_id(&c->source, g_source_remove);
	g_clear_handle_id(&c->kill_timer, g_source_remove);
	if (c->fd >= 0)
		close(c->fd);
	g_clear_object(&c->process);
	g_string_free(c->line, TRUE);
	g_free(c);
}

/* ---- progress ---- */

/* "0.5312 registering scan 3". */
static void take_line(job_child *c, const char *line)
{
	char *end;
	double fraction = g_ascii_strtod(line, &end);
	if (end == line || !(fraction >= 0 && fraction <= 1) || !g_utf8_validate(line, -1, NULL))
		return;
	c->watcher.progress(fraction, *end == ' ' ? end + 1 : end, c->watcher.user_data);
}

static void take_bytes(job_child *c, const char *bytes, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (bytes[i] == '\n') {
			take_line(c, c->line->str);
			g_string_truncate(c->line, 0);
		} else if (c->line->len < LINE_MAX_SIZE)
			g_string_append_c(c->line, bytes[i]);
}

static gboolean has_said(int fd, GIOCondition condition, gpointer user_data)
{
	job_child *c = user_data;
	char bytes[4096];
	ssize_t n = read(fd, bytes, sizeof bytes);
	(void)condition;
	if (n > 0)
		take_bytes(c, bytes, (size_t)n);
	if (n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR)))
		return G_SOURCE_CONTINUE;
	c->source = 0;
	return G_SOURCE_REMOVE;
}

/* ---- the end ---- */

/* The last line, without "pleinair render: ". Caller frees. */
static char *last_words(const char *err)
{
	g_autofree char *text = g_strdup(err ? err : "");
	g_strchomp(text);
	const char *line = strrchr(text, '\n');
	line = line ? line + 1 : text;
	const char *colon = g_str_has_prefix(line, "pleinair ") ? strstr(line, ": ") : NULL;
	return g_utf8_make_valid(colon ? colon + 2 : line, -1);
}

static char *sentence_of(const job_child *c, const char *err)
{
	g_autofree char *words = last_words(err);
	if (c->is_stopped)
		return g_strdup("it was stopped");
	if (*words)
		return g_steal_pointer(&words);
	if (g_subprocess_get_if_signaled(c->process))
		return g_strdup_printf("the program was ended by signal %d",
			g_subprocess_get_term_sig(c->process));
	return g_strdup_printf("the program failed with status %d, and did not say why",
		g_subprocess_get_exit_status(c->process));
}

static void has_ended(GObject *source, GAsyncResult *result, gpointer user_data)
{
	job_child *c = user_data;
	g_autoptr(GError) error = NULL;
	g_autofree char *out = NULL, *err = NULL, *sentence = NULL;
	bool heard = g_subprocess_communicate_utf8_finish(
		G_SUBPROCESS(source), result, &out, &err, &error);
	bool good = heard && g_subprocess_get_successful(c->process);
	if (!heard)
		sentence = g_strdup(error->message);
	else if (!good)
		sentence = sentence_of(c, err);
	struct job_child_watcher w = c->watcher;
	job_child_free(c);
	w.ended(good ? out : NULL, sentence, w.user_data);
}

static gboolean kill_it(gpointer user_data)
{
	job_child *c = user_data;
	c->kill_timer = 0;
	kill(-c->pid, SIGKILL);
	return G_SOURCE_REMOVE;
}

void job_child_stop(job_child *c)
{
	if (c->is_stopped)
		return;
	c->is_stopped = true;
	kill(-c->pid, SIGTERM);
	c->kill_timer = g_timeout_add_seconds(KILL_AFTER_S, kill_it, c);
}

/* ---- the beginning ---- */

static void prepare(gpointer user_data)
{
	(void)user_data;
	setpgid(0, 0);
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	setpriority(PRIO_PROCESS, 0, NICE);
	syscall(SYS_ioprio_set, IOPRIO_WHO_PROCESS, 0, IOPRIO_IDLE);
}

static GSubprocess *spawn(const char *const *argv, int progress_fd, GError **error)
{
	g_autoptr(GSubprocessLauncher) l = g_subprocess_launcher_new(
		G_SUBPROCESS_FLAGS_STDOUT_PIPE | G_SUBPROCESS_FLAGS_STDERR_PIPE);
	g_autofree char *number = g_strdup_printf("%d", PROGRESS_FD);
	g_subprocess_launcher_take_fd(l, progress_fd, PROGRESS_FD);
	g_subprocess_launcher_setenv(l, "PLEINAIR_PROGRESS_FD", number, TRUE);
	g_subprocess_launcher_setenv(l, LARGE_PAGES_VARIABLE, LARGE_PAGES_VALUE, FALSE);
	g_subprocess_launcher_unsetenv(l, "NOTIFY_SOCKET");
	g_subprocess_launcher_set_child_setup(l, prepare, NULL, NULL);
	return g_subprocess_launcher_spawnv(l, argv, error);
}

job_child *job_child_new(
	const char *const *argv, const struct job_child_watcher *watcher, GError **error)
{
	int pipe_fds[2];
	if (!g_unix_open_pipe(pipe_fds, FD_CLOEXEC, error))
		return NULL;
	g_unix_set_fd_nonblocking(pipe_fds[0], TRUE, NULL);
	job_child *c = g_new0(job_child, 1);
	c->watcher = *watcher;
	c->fd = pipe_fds[0];
	c->line = g_string_new(NULL);
	c->process = spawn(argv, pipe_fds[1], error);
	if (!c->process) {
		job_child_free(c);
		return NULL;
	}
	const char *id = g_subprocess_get_identifier(c->process);
	c->pid = (GPid)g_ascii_strtoll(id ? id : "0", NULL, 10);
	c->source = g_unix_fd_add(c->fd, G_IO_IN | G_IO_HUP, has_said, c);
	g_subprocess_communicate_utf8_async(c->process, NULL, NULL, has_ended, c);
	return c;
}
