#include "render/kiosk/services.h"
#include "render/kiosk/service-start.h"
#include <glib/gi18n.h>

#define ACQUISITION_NAME "org.pleinair.Acquisition1"
#define ACQUISITION_PATH "/org/pleinair/Acquisition1"
#define JOBS_NAME        "org.pleinair.Jobs1"
#define JOBS_PATH        "/org/pleinair/Jobs1"
/* A service that is gone is started again after this, if nobody else has. */
#define AGAIN_MS 500

struct one {
	services *all;
	const char *name, *program;
	GDBusProxy *proxy;
	struct service_start start;
	guint again;
	bool is_there, was_there;
};
struct services {
	struct services_options options;
	char *folder, *device;
	GDBusConnection *connection;
	BusAcquisition1 *acquisition;
	BusJobs1 *jobs;
	struct one each[2];
	struct services_watcher watcher;
};

static const char *words_of(const struct one *o, bool came)
{
	bool scanner = !g_strcmp0(o->name, ACQUISITION_NAME);
	if (came)
		return scanner ? _("The scanner service is back.")
			       : _("The service that computes is back.");
	return scanner ? _("The scanner service stopped unexpectedly. It is being started again; "
			   "what was "
			   "scanned is kept.")
		       : _("The service that computes stopped unexpectedly. It is being started "
			   "again; its jobs go on.");
}

static void start(struct one *o)
{
	services *s = o->all;
	g_autoptr(GError) error = NULL;
	if (s->options.system)
		return;
	if (!service_start(&o->start, o->program, s->folder, s->device, &error))
		g_printerr("pleinair kiosk: %s\n", error->message);
}

static gboolean start_again(gpointer user_data)
{
	struct one *o = user_data;
	o->again = 0;
	if (!o->is_there)
		start(o);
	return G_SOURCE_REMOVE;
}

static void owner_changed(GObject *proxy, GParamSpec *what, gpointer user_data)
{
	struct one *o = user_data;
	const struct services_watcher *w = &o->all->watcher;
	g_autofree char *owner = g_dbus_proxy_get_name_owner(G_DBUS_PROXY(proxy));
	bool was = o->is_there;
	(void)what;
	o->is_there = owner;
	if (o->is_there == was)
		return;
	if (!o->is_there) {
		if (!o->again)
			o->again = g_timeout_add(AGAIN_MS, start_again, o);
		if (w->went)
			w->went(words_of(o, false), w->user_data);
	} else if (o->was_there && w->came)
		w->came(words_of(o, true), w->user_data);
	o->was_there = true;
}

static void look_after(
	services *s, struct one *o, gpointer proxy, const char *name, const char *program)
{
	o->all = s;
	o->name = name;
	o->program = program;
	o->proxy = proxy;
	g_autofree char *owner = g_dbus_proxy_get_name_owner(proxy);
	o->is_there = o->was_there = owner;
	g_signal_connect(proxy, "notify::g-name-owner", G_CALLBACK(owner_changed), o);
	if (!o->is_there)
		start(o);
}

static GDBusConnection *connect(bool system, GError **error)
{
	if (system)
		return g_bus_get_sync(G_BUS_TYPE_SYSTEM, NULL, error);
	return service_bus_of_desk(error);
}

services *services_new(const struct services_options *options, GError **error)
{
	services *s = g_new0(services, 1);
	/* Those of systemd are started by a call, those of a desk by us. */
	GDBusProxyFlags flags =
		options->system ? G_DBUS_PROXY_FLAGS_NONE : G_DBUS_PROXY_FLAGS_DO_NOT_AUTO_START;
	s->options = *options;
	s->folder = g_strdup(options->folder);
	s->device = g_strdup(options->device);
	s->connection = connect(options->system, error);
	if (s->connection)
		s->acquisition = bus_acquisition1_proxy_new_sync(
			s->connection, flags, ACQUISITION_NAME, ACQUISITION_PATH, NULL, error);
	if (s->acquisition)
		s->jobs = bus_jobs1_proxy_new_sync(
			s->connection, flags, JOBS_NAME, JOBS_PATH, NULL, error);
	if (!s->jobs) {
		services_free(s);
		return NULL;
	}
	/* To make a photo turn, or list many sites, takes its time. */
	g_dbus_proxy_set_default_timeout(G_DBUS_PROXY(s->acquisition), 120000);
	look_after(s, &s->each[0], s->acquisition, ACQUISITION_NAME, "pleinair-acquired");
	look_after(s, &s->each[1], s->jobs, JOBS_NAME, "pleinair-jobsd");
	return s;
}

static bool is_scanning(services *s)
{
	const char *state = s->acquisition ? bus_acquisition1_get_state(s->acquisition) : NULL;
	return state && g_strcmp0(state, "idle") && g_strcmp0(state, "paused");
}

static bool is_working(services *s)
{
	const char *const *jobs = s->jobs ? bus_jobs1_get_jobs(s->jobs) : NULL;
	return jobs && *jobs && service_bus_has_running_job(s->connection, jobs);
}

void services_free(services *s)
{
	if (!s)
		return;
	for (int i = 0; i < 2; i++) {
		struct one *o = &s->each[i];
		if (o->proxy)
			g_signal_handlers_disconnect_by_data(o->proxy, o);
		g_clear_handle_id(&o->again, g_source_remove);
	}
	service_end(&s->each[0].start, !is_scanning(s));
	service_end(&s->each[1].start, !is_working(s));
	g_clear_object(&s->acquisition);
	g_clear_object(&s->jobs);
	g_clear_object(&s->connection);
	g_free(s->folder);
	g_free(s->device);
	g_free(s);
}

void services_watch(services *s, const struct services_watcher *watcher)
{
	s->watcher = *watcher;
}

BusAcquisition1 *services_acquisition(services *s)
{
	return s->acquisition;
}

BusJobs1 *services_jobs(services *s)
{
	return s->jobs;
}

bool services_has_acquisition(services *s)
{
	return s->each[0].is_there;
}

bool services_has_jobs(services *s)
{
	return s->each[1].is_there;
}
