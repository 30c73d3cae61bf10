#include "render/bench-child.h"
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#define LOOK_MS     200
#define PATIENCE_MS 5000 /* between asking it to end and ending it */

struct running {
	const struct bench_child_desc *desc;
	struct bench_child *ret;
	GMainLoop *loop;
	GSubprocess *process;
	gint64 began_us, asked_us; /* 0: it was not asked to end */
	pid_t pid;                 /* of it and its group; 0: not known */
};

/* A group of its own: what it started ends with it, and Ctrl-C reaches this program alone. */
static void before_exec(gpointer user_data)
{
	(void)user_data;
	setpgid(0, 0);
	prctl(PR_SET_PDEATHSIG, SIGTERM);
}

static void end(const struct running *r, int signal_number)
{
	if (r->pid > 0)
		kill(-r->pid, signal_number);
}

static gboolean look(gpointer user_data)
{
	struct running *r = user_data;
	gint64 now_us = g_get_monotonic_time();
	if (r->desc->waits)
		r->desc->waits((double)(now_us - r->began_us) * 1e-6, r->desc->user_data);
	if (!r->asked_us && r->desc->stop && r->desc->stop()) {
		r->asked_us = now_us;
		end(r, SIGTERM);
	} else if (r->asked_us && now_us - r->asked_us > PATIENCE_MS * 1000) {
		end(r, SIGKILL);
	}
	return G_SOURCE_CONTINUE;
}

/* The last thing that it complained of; caller frees. */
static char *complaint(const char *said)
{
	g_auto(GStrv) lines = g_strsplit(said ? said : "", "\n", -1);
	for (guint n = g_strv_length(lines); n > 0; n--) {
		char *line = g_strstrip(lines[n - 1]);
		if (g_str_has_prefix(line, "pleinair bench: "))
			return g_strdup(line + strlen("pleinair bench: "));
	}
	return NULL;
}

static char *how_it_ended(GSubprocess *p)
{
	if (g_subprocess_get_if_signaled(p))
		return g_strdup_printf("it was ended by the signal %d (%s)",
			g_subprocess_get_term_sig(p), g_strsignal(g_subprocess_get_term_sig(p)));
	return g_strdup_printf(
		"it ended with the status %d and said nothing", g_subprocess_get_exit_status(p));
}

static JsonObject *result_of(const char *text)
{
	g_autoptr(JsonNode) root = text ? json_from_string(text, NULL) : NULL;
	return root && JSON_NODE_HOLDS_OBJECT(root) ? json_node_dup_object(root) : NULL;
}

static void ended(GObject *source, GAsyncResult *result, gpointer user_data)
{
	struct running *r = user_data;
	g_autofree char *out = NULL, *err = NULL;
	g_autoptr(GError) error = NULL;
	if (!g_subprocess_communicate_utf8_finish(G_SUBPROCESS(source), result, &out, &err, &error))
		r->ret->error = g_strdup(error->message);
	else if (r->asked_us)
		r->ret->error = g_strdup("stopped");
	else if (!g_subprocess_get_successful(r->process) && !(r->ret->error = complaint(err)))
		r->ret->error = how_it_ended(r->process);
	r->ret->result = r->asked_us ? NULL : result_of(out);
	if (!r->ret->error && !r->ret->result)
		r->ret->error = g_strdup("it printed no JSON object");
	g_main_loop_quit(r->loop);
}

void bench_child_run(const struct bench_child_desc *desc, struct bench_child *ret)
{
	g_autoptr(GSubprocessLauncher) launcher = g_subprocess_launcher_new(
		G_SUBPROCESS_FLAGS_STDOUT_PIPE | G_SUBPROCESS_FLAGS_STDERR_PIPE);
	g_autoptr(GError) error = NULL;
	struct running r = { .desc = desc, .ret = ret, .began_us = g_get_monotonic_time() };
	*ret = (struct bench_child){ 0 };
	g_subprocess_launcher_setenv(launcher, "TMPDIR", desc->temporary, TRUE);
	/* It is this program whose progress somebody may read. */
	g_subprocess_launcher_unsetenv(launcher, "PLEINAIR_PROGRESS_FD");
	g_subprocess_launcher_set_child_setup(launcher, before_exec, NULL, NULL);
	g_autoptr(GSubprocess) process =
		g_subprocess_launcher_spawnv(launcher, (const char *const *)desc->argv, &error);
	if (!process) {
		ret->error = g_strdup(error->message);
		return;
	}
	g_autoptr(GMainLoop) loop = g_main_loop_new(NULL, FALSE);
	r.process = process;
	r.loop = loop;
	/* It may have ended already. */
	const char *pid = g_subprocess_get_identifier(process);
	r.pid = pid ? (pid_t)atoi(pid) : 0;
	guint timer = g_timeout_add(LOOK_MS, look, &r);
	g_subprocess_communicate_utf8_async(process, NULL, NULL, ended, &r);
	g_main_loop_run(loop);
	g_source_remove(timer);
	ret->seconds = (double)(g_get_monotonic_time() - r.began_us) * 1e-6;
}

void bench_child_clear(struct bench_child *c)
{
	g_clear_pointer(&c->result, json_object_unref);
	g_clear_pointer(&c->error, g_free);
}
