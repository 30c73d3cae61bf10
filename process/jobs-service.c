#include "process/jobs-service.h"
#include "acquire/service.h"
#include "process/jobs-bus.h"
#include "process/jobs.h"
#include "process/site-list.h"
#include <math.h>

#define OBJECT_PATH "/org/pleinair/Jobs1"

struct jobs_service {
	char *folder;
	struct job_limits limits;
	jobs *jobs;
	BusJobs1 *bus;
	GDBusConnection *connection; /* NULL before it is exported */
	GHashTable *objects;         /* BusJobs1Job by number */
	void (*ended)(void);
};

static char *path_of(const struct job *job)
{
	return g_strdup_printf(OBJECT_PATH "/job/%u", job->number);
}

static void show_list(jobs_service *s)
{
	g_autoptr(GPtrArray) list = jobs_list(s->jobs);
	g_auto(GStrv) paths = g_new0(char *, list->len + 1);
	for (guint i = 0; i < list->len; i++)
		paths[i] = path_of(list->pdata[i]);
	bus_jobs1_set_jobs(s->bus, (const char *const *)paths);
	g_dbus_interface_skeleton_flush(G_DBUS_INTERFACE_SKELETON(s->bus));
}

/* ---- jobs as objects ---- */

static gboolean cancel(BusJobs1Job *object, GDBusMethodInvocation *call, gpointer user_data)
{
	jobs_service *s = user_data;
	GError *error = NULL;
	uint32_t number = GPOINTER_TO_UINT(g_object_get_data(G_OBJECT(object), "number"));
	if (jobs_cancel(s->jobs, number, &error))
		bus_jobs1_job_complete_cancel(object, call);
	else
		service_refuse(call, error);
	return TRUE;
}

static BusJobs1Job *make_object(jobs_service *s, const struct job *job)
{
	g_autofree char *path = path_of(job);
	g_autoptr(GError) error = NULL;
	BusJobs1Job *o = bus_jobs1_job_skeleton_new();
	g_object_set_data(G_OBJECT(o), "number", GUINT_TO_POINTER(job->number));
	bus_jobs1_job_set_kind(o, job->kind->name);
	bus_jobs1_job_set_site(o, job->site_path);
	g_signal_connect(o, "handle-cancel", G_CALLBACK(cancel), s);
	if (!g_dbus_interface_skeleton_export(
		    G_DBUS_INTERFACE_SKELETON(o), s->connection, path, &error))
		g_printerr("pleinair jobsd: %s\n", error->message);
	g_hash_table_insert(s->objects, GUINT_TO_POINTER(job->number), o);
	return o;
}

static void changed(const struct job *job, gpointer user_data)
{
	jobs_service *s = user_data;
	BusJobs1Job *o = g_hash_table_lookup(s->objects, GUINT_TO_POINTER(job->number));
	bool moves = !o || g_strcmp0(bus_jobs1_job_get_state(o), job_state_names[job->state]);
	if (!o)
		o = make_object(s, job);
	g_autofree char *doing = g_utf8_make_valid(job->doing ? job->doing : "", -1);
	bus_jobs1_job_set_fraction(o, round(job->fraction * 1000) / 1000);
	bus_jobs1_job_set_doing(o, doing);
	bus_jobs1_job_set_seconds_left(o, round(job->seconds_left));
	bus_jobs1_job_set_result(o, job->result ? job->result : "");
	bus_jobs1_job_set_error(o, job->error ? job->error : "");
	/* Last: who sees the end finds the rest there. */
	bus_jobs1_job_set_state(o, job_state_names[job->state]);
	g_dbus_interface_skeleton_flush(G_DBUS_INTERFACE_SKELETON(o));
	if (moves)
		show_list(s);
}

static void job_ended(const struct job *job, gpointer user_data)
{
	jobs_service *s = user_data;
	g_autofree char *path = path_of(job);
	bus_jobs1_emit_ended(
		s->bus, path, job->kind->name, job->site_path, job_state_names[job->state]);
}

static void gone(const struct job *job, gpointer user_data)
{
	jobs_service *s = user_data;
	g_hash_table_remove(s->objects, GUINT_TO_POINTER(job->number));
}

static void object_free(gpointer data)
{
	g_dbus_interface_skeleton_unexport(data);
	g_object_unref(data);
}

static void stopped(gpointer user_data)
{
	jobs_service *s = user_data;
	s->ended();
}

/* ---- methods ---- */

static gboolean start(BusJobs1 *b, GDBusMethodInvocation *call, const char *kind_name,
	const char *site_path, GVariant *options, gpointer user_data)
{
	jobs_service *s = user_data;
	GError *error = NULL;
	const struct job_kind *kind = job_kind_find(kind_name, &error);
	GStrv arguments =
		kind ? job_kind_arguments(kind, site_path, options, &s->limits, &error) : NULL;
	if (!arguments) {
		service_refuse(call, error);
		return TRUE;
	}
	const struct job *job = jobs_add(s->jobs, kind, site_path, arguments);
	g_autofree char *path = path_of(job);
	bus_jobs1_complete_start(b, call, path);
	return TRUE;
}

static void list_there(GTask *task, gpointer source, gpointer folder, GCancellable *cancellable)
{
	GError *error = NULL;
	GPtrArray *sites = site_list(folder, &error);
	(void)source;
	(void)cancellable;
	if (sites)
		g_task_return_pointer(task, sites, (GDestroyNotify)g_ptr_array_unref);
	else
		g_task_return_error(task, error);
}

static void is_listed(GObject *source, GAsyncResult *result, gpointer user_data)
{
	GDBusMethodInvocation *call = user_data;
	GError *error = NULL;
	g_autoptr(GPtrArray) sites = g_task_propagate_pointer(G_TASK(result), &error);
	if (sites)
		bus_jobs1_complete_list_sites(BUS_JOBS1(source), call, site_list_variant(sites));
	else
		service_refuse(call, error);
}

/* On a thread: a slow disk must not hold up the rest. */
static gboolean list_sites(
	BusJobs1 *b, GDBusMethodInvocation *call, const char *folder, gpointer user_data)
{
	jobs_service *s = user_data;
	GError *error = NULL;
	bool own = !*folder || !g_strcmp0(folder, s->folder);
	if (!own && !service_allows(s->limits.folder, folder, &error)) {
		service_refuse(call, error);
		return TRUE;
	}
	g_autoptr(GTask) task = g_task_new(b, NULL, is_listed, call);
	g_task_set_task_data(task, g_strdup(own ? s->folder : folder), g_free);
	g_task_run_in_thread(task, list_there);
	return TRUE;
}

/* ---- the object ---- */

jobs_service *jobs_service_new(const struct jobs_service_options *options)
{
	jobs_service *s = g_new0(jobs_service, 1);
	struct jobs_watcher w = { changed, job_ended, gone, stopped, s };
	s->folder = g_strdup(options->folder);
	s->limits = options->limits;
	s->objects = g_hash_table_new_full(NULL, NULL, NULL, object_free);
	s->bus = bus_jobs1_skeleton_new();
	s->jobs = jobs_new(options->state_path, options->programs, &w);
	bus_jobs1_set_sites_folder(s->bus, s->folder);
	g_signal_connect(s->bus, "handle-start", G_CALLBACK(start), s);
	g_signal_connect(s->bus, "handle-list-sites", G_CALLBACK(list_sites), s);
	return s;
}

void jobs_service_free(jobs_service *s)
{
	if (!s)
		return;
	jobs_free(s->jobs);
	g_hash_table_unref(s->objects);
	if (s->connection)
		g_dbus_interface_skeleton_unexport(G_DBUS_INTERFACE_SKELETON(s->bus));
	g_clear_object(&s->connection);
	g_object_unref(s->bus);
	g_free(s->folder);
	g_free(s);
}

bool jobs_service_export(jobs_service *s, GDBusConnection *c, GError **error)
{
	s->connection = g_object_ref(c);
	jobs_announce(s->jobs);
	show_list(s);
	return g_dbus_interface_skeleton_export(
		G_DBUS_INTERFACE_SKELETON(s->bus), c, OBJECT_PATH, error);
}

void jobs_service_begin(jobs_service *s)
{
	jobs_begin(s->jobs);
}

void jobs_service_end(jobs_service *s, void (*ended)(void))
{
	s->ended = ended;
	jobs_stop(s->jobs);
}
