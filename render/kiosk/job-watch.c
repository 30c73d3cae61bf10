#include "render/kiosk/services.h"
#include <glib/gi18n.h>

struct job_watch {
	services *services;
	BusJobs1Job *job; /* NULL: not there yet */
	void (*progress)(double, const char *, double, gpointer);
	job_ended ended;
	gpointer user_data;
	guint lost;
	bool is_let_go, wants_cancel;
};

static void watch_free(job_watch *w)
{
	if (w->job)
		g_signal_handlers_disconnect_by_data(w->job, w);
	g_signal_handlers_disconnect_by_data(services_jobs(w->services), w);
	g_clear_handle_id(&w->lost, g_source_remove);
	g_clear_object(&w->job);
	g_free(w);
}

static void end(job_watch *w, const char *state, const char *result, const char *sentence)
{
	if (!w->is_let_go && w->ended)
		w->ended(state, result, sentence, w->user_data);
	watch_free(w);
}

static void look(job_watch *w)
{
	const char *state = bus_jobs1_job_get_state(w->job);
	if (!state)
		return;
	if (!g_strcmp0(state, "waiting") || !g_strcmp0(state, "running")) {
		if (w->progress && !w->is_let_go)
			w->progress(bus_jobs1_job_get_fraction(w->job),
				bus_jobs1_job_get_doing(w->job),
				bus_jobs1_job_get_seconds_left(w->job), w->user_data);
		return;
	}
	g_autofree char *kept = g_strdup(state);
	g_autofree char *result = g_strdup(bus_jobs1_job_get_result(w->job));
	g_autofree char *error = g_strdup(bus_jobs1_job_get_error(w->job));
	end(w, kept, result, error);
}

static void changed(
	GObject *proxy, GVariant *properties, const char *const *gone, gpointer user_data)
{
	(void)proxy;
	(void)properties;
	(void)gone;
	look(user_data);
}

static void got_job(GObject *source, GAsyncResult *result, gpointer user_data)
{
	job_watch *w = user_data;
	g_autoptr(GError) error = NULL;
	BusJobs1Job *job = bus_jobs1_job_proxy_new_finish(result, &error);
	(void)source;
	if (!job) {
		end(w, "failed", NULL, error->message);
		return;
	}
	w->job = job;
	g_signal_connect(job, "g-properties-changed", G_CALLBACK(changed), w);
	if (w->wants_cancel)
		job_watch_cancel(w);
	look(w);
}

static void find_job(job_watch *w, const char *path)
{
	bus_jobs1_job_proxy_new(
		g_dbus_proxy_get_connection(G_DBUS_PROXY(services_jobs(w->services))),
		G_DBUS_PROXY_FLAGS_DO_NOT_AUTO_START, "org.pleinair.Jobs1", path, NULL, got_job, w);
}

static void started(GObject *source, GAsyncResult *result, gpointer user_data)
{
	job_watch *w = user_data;
	g_autoptr(GError) error = NULL;
	g_autofree char *path = NULL;
	if (!bus_jobs1_call_start_finish(BUS_JOBS1(source), &path, result, &error)) {
		g_dbus_error_strip_remote_error(error);
		end(w, "failed", NULL,
			services_has_jobs(w->services)
				? error->message
				: _("The service that does this is not there just now."));
		return;
	}
	find_job(w, path);
}

/* The service was killed: it comes back with its jobs, under their old names, or this one is lost. */
static gboolean is_lost(gpointer user_data)
{
	job_watch *w = user_data;
	w->lost = 0;
	g_autofree char *owner = w->job ? g_dbus_proxy_get_name_owner(G_DBUS_PROXY(w->job)) : NULL;
	const char *state = owner ? bus_jobs1_job_get_state(w->job) : NULL;
	if (state)
		return G_SOURCE_REMOVE;
	end(w, "failed", NULL, _("The service that computes stopped while it worked on this."));
	return G_SOURCE_REMOVE;
}

static void owner_changed(GObject *proxy, GParamSpec *what, gpointer user_data)
{
	job_watch *w = user_data;
	(void)what;
	g_autofree char *owner = g_dbus_proxy_get_name_owner(G_DBUS_PROXY(proxy));
	if (w->job && !w->lost && !owner)
		w->lost = g_timeout_add_seconds(10, is_lost, w);
	else if (w->job && owner && !w->lost)
		look(w);
}

static job_watch *watch_new(services *s,
	void (*progress)(
		double fraction, const char *doing, double seconds_left, gpointer user_data),
	job_ended ended, gpointer user_data)
{
	job_watch *w = g_new0(job_watch, 1);
	w->services = s;
	w->progress = progress;
	w->ended = ended;
	w->user_data = user_data;
	g_signal_connect(services_jobs(s), "notify::g-name-owner", G_CALLBACK(owner_changed), w);
	return w;
}

job_watch *services_start_job(services *s, const char *kind, const char *site, GVariant *options,
	void (*progress)(
		double fraction, const char *doing, double seconds_left, gpointer user_data),
	job_ended ended, gpointer user_data)
{
	job_watch *w = watch_new(s, progress, ended, user_data);
	if (!options)
		options = g_variant_new("a{sv}", NULL);
	bus_jobs1_call_start(services_jobs(s), kind, site, options, NULL, started, w);
	return w;
}

job_watch *services_follow_job(services *s, const char *path,
	void (*progress)(
		double fraction, const char *doing, double seconds_left, gpointer user_data),
	job_ended ended, gpointer user_data)
{
	job_watch *w = watch_new(s, progress, ended, user_data);
	find_job(w, path);
	return w;
}

void job_watch_cancel(job_watch *w)
{
	w->wants_cancel = true;
	if (w->job)
		bus_jobs1_job_call_cancel(w->job, NULL, NULL, NULL);
}

void job_watch_let_go(job_watch *w)
{
	if (!w)
		return;
	w->is_let_go = true;
	/* Calls that are under way still come back here. */
	if (w->job)
		watch_free(w);
}
