#include "process/jobs.h"
#include "acquire/service.h"
#include "process/job-child.h"
#include "process/job-file.h"
#include <string.h>

/* Ended ones that are remembered. */
#define ENDED_MAX 50
/* One that is cut off so often is not begun again. */
#define TRIES_MAX 3
/* Progress is told so often. */
#define TELL_EVERY_US (G_USEC_PER_SEC / 10)
/* A guess at the time left needs so much of the job. */
#define PACE_LEAST 0.02

#define CUT_OFF                                                                                    \
	"The service stopped while it worked on this: look at the result, and start it again if "  \
	"need be."

const char *const job_state_names[JOB_STATES] = { "waiting", "running", "done", "failed",
	"cancelled" };

struct jobs {
	char *state_path, *programs;
	struct jobs_watcher watcher;
	GPtrArray *all; /* of struct job *, oldest first */
	uint32_t next;
	struct job *now; /* that runs; NULL: none */
	job_child *child;
	int64_t begun_us, told_us;
	guint starter;
	bool is_cancelled, runs, stops;
};

static bool has_ended(const struct job *job)
{
	return job->state >= JOB_DONE;
}

static void remember(jobs *j)
{
	g_autoptr(GError) error = NULL;
	if (!job_file_save(j->state_path, j->all, j->next, &error))
		g_printerr("pleinair jobsd: %s\n", error->message);
}

static void tell(jobs *j, const struct job *job)
{
	j->watcher.changed(job, j->watcher.user_data);
}

static void forget_oldest(jobs *j)
{
	guint ended = 0;
	for (guint i = j->all->len; i-- > 0;) {
		struct job *job = j->all->pdata[i];
		if (!has_ended(job) || ++ended <= ENDED_MAX)
			continue;
		j->watcher.gone(job, j->watcher.user_data);
		g_ptr_array_remove_index(j->all, i);
	}
}

/* To the end of the list, so that those that ended stand in their order. Takes error. */
static void end(jobs *j, struct job *job, enum job_state state, const char *out, char *error)
{
	job->state = state;
	job->seconds_left = -1;
	g_free(job->error);
	job->error = error;
	if (state == JOB_DONE)
		job->fraction = 1;
	g_free(job->result);
	job->result = g_strdup(out);
	guint at;
	if (g_ptr_array_find(j->all, job, &at))
		g_ptr_array_add(j->all, g_ptr_array_steal_index(j->all, at));
	remember(j);
	tell(j, job);
	j->watcher.ended(job, j->watcher.user_data);
	forget_oldest(j);
}

/* ---- running ---- */

static void start_next(jobs *j);

static void goes_on(double fraction, const char *doing, gpointer user_data)
{
	jobs *j = user_data;
	struct job *job = j->now;
	int64_t now_us = g_get_monotonic_time();
	double gone_s = (double)(now_us - j->begun_us) * 1e-6;
	job->fraction = fraction;
	job->seconds_left = fraction > PACE_LEAST ? gone_s * (1 - fraction) / fraction : -1;
	if (g_strcmp0(job->doing, doing)) {
		g_free(job->doing);
		job->doing = g_strdup(doing);
	}
	if (now_us - j->told_us < TELL_EVERY_US)
		return;
	j->told_us = now_us;
	tell(j, job);
}

static void child_ended(const char *out, const char *sentence, gpointer user_data)
{
	jobs *j = user_data;
	struct job *job = j->now;
	j->now = NULL;
	j->child = NULL;
	if (j->stops && !j->is_cancelled && !out) {
		j->watcher.stopped(j->watcher.user_data);
		return;
	}
	if (out)
		end(j, job, JOB_DONE, out, NULL);
	else
		end(j, job, j->is_cancelled ? JOB_CANCELLED : JOB_FAILED, NULL, g_strdup(sentence));
	if (j->stops)
		j->watcher.stopped(j->watcher.user_data);
	else
		start_next(j);
}

static GStrv command_line(const jobs *j, const struct job *job)
{
	g_autoptr(GStrvBuilder) b = g_strv_builder_new();
	g_autofree char *name = g_strconcat("pleinair-", job->kind->name, NULL);
	g_autofree char *path = j->programs ? g_build_filename(j->programs, name, NULL) : NULL;
	bool beside = path && g_file_test(path, G_FILE_TEST_IS_EXECUTABLE);
	g_strv_builder_add(b, beside ? path : name);
	g_strv_builder_addv(b, (const char **)job->arguments);
	return g_strv_builder_end(b);
}

static void run(jobs *j, struct job *job)
{
	struct job_child_watcher w = { goes_on, child_ended, j };
	g_auto(GStrv) argv = command_line(j, job);
	g_autoptr(GError) error = NULL;
	job->state = JOB_RUNNING;
	job->fraction = 0;
	job->tries++;
	j->now = job;
	j->is_cancelled = false;
	j->begun_us = g_get_monotonic_time();
	j->told_us = 0;
	remember(j);
	j->child = job_child_new((const char *const *)argv, &w, &error);
	if (j->child) {
		tell(j, job);
		return;
	}
	j->now = NULL;
	end(j, job, JOB_FAILED, NULL, g_strdup(error->message));
	start_next(j);
}

static gboolean start_now(gpointer user_data)
{
	jobs *j = user_data;
	j->starter = 0;
	for (guint i = 0; !j->now && !j->stops && i < j->all->len; i++) {
		struct job *job = j->all->pdata[i];
		if (job->state == JOB_WAITING) {
			run(j, job);
			break;
		}
	}
	return G_SOURCE_REMOVE;
}

/* Later, so that who asked for it knows of it first. */
static void start_next(jobs *j)
{
	if (!j->starter && !j->now && j->runs && !j->stops)
		j->starter = g_idle_add(start_now, j);
}

/* ---- from outside ---- */

/* What ran when the machine went off. */
static void pick_up(struct job *job)
{
	if (job->state != JOB_RUNNING)
		return;
	bool again = job->kind->repeatable && job->tries < TRIES_MAX;
	job->state = again ? JOB_WAITING : JOB_FAILED;
	if (!again)
		job->error = g_strdup(CUT_OFF);
}

jobs *jobs_new(const char *state_path, const char *programs, const struct jobs_watcher *watcher)
{
	jobs *j = g_new0(jobs, 1);
	j->state_path = g_strdup(state_path);
	j->programs = g_strdup(programs);
	j->watcher = *watcher;
	j->all = job_file_load(state_path, &j->next);
	return j;
}

void jobs_announce(jobs *j)
{
	for (guint i = 0; i < j->all->len; i++) {
		pick_up(j->all->pdata[i]);
		tell(j, j->all->pdata[i]);
	}
}

void jobs_begin(jobs *j)
{
	j->runs = true;
	start_next(j);
}

void jobs_free(jobs *j)
{
	if (!j)
		return;
	g_clear_handle_id(&j->starter, g_source_remove);
	g_ptr_array_unref(j->all);
	g_free(j->state_path);
	g_free(j->programs);
	g_free(j);
}

const struct job *jobs_add(
	jobs *j, const struct job_kind *kind, const char *site_path, GStrv arguments)
{
	struct job *job = g_new0(struct job, 1);
	*job = (struct job){ .number = j->next++,
		.kind = kind,
		.site_path = g_strdup(site_path),
		.arguments = arguments,
		.seconds_left = -1 };
	g_ptr_array_add(j->all, job);
	remember(j);
	tell(j, job);
	start_next(j);
	return job;
}

static struct job *find(jobs *j, uint32_t number)
{
	for (guint i = 0; i < j->all->len; i++)
		if (((struct job *)j->all->pdata[i])->number == number)
			return j->all->pdata[i];
	return NULL;
}

bool jobs_cancel(jobs *j, uint32_t number, GError **error)
{
	struct job *job = find(j, number);
	if (!job || has_ended(job)) {
		g_set_error_literal(
			error, SERVICE_ERROR, SERVICE_ERROR_FAILED, "this job has ended already");
		return false;
	}
	if (job == j->now) {
		j->is_cancelled = true;
		job_child_stop(j->child);
	} else
		end(j, job, JOB_CANCELLED, NULL, g_strdup("it was stopped"));
	return true;
}

GPtrArray *jobs_list(jobs *j)
{
	GPtrArray *list = g_ptr_array_new();
	for (guint i = 0; i < j->all->len; i++)
		if (!has_ended(j->all->pdata[i]))
			g_ptr_array_add(list, j->all->pdata[i]);
	for (guint i = j->all->len; i-- > 0;)
		if (has_ended(j->all->pdata[i]))
			g_ptr_array_add(list, j->all->pdata[i]);
	return list;
}

void jobs_stop(jobs *j)
{
	j->stops = true;
	if (j->child)
		job_child_stop(j->child);
	else
		j->watcher.stopped(j->watcher.user_data);
}
