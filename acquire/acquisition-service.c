#include "acquire/acquisition-service.h"
#include "acquire/acquisition-bus.h"
#include "acquire/acquisition-lists.h"
#include "acquire/advice.h"
#include "acquire/pump.h"
#include "acquire/service.h"
#include "firmware-io/button.h"
#include "firmware-io/hotplug.h"
#include <gio/gunixfdlist.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#define OBJECT_PATH "/org/pleinair/Acquisition1"
/* Properties change so often during a scan. */
#define PROPERTIES_MS 100
/* A head that did not answer is looked for again after this. */
#define LOOK_AGAIN_S 20

/* A scan that somebody wants: it waits while the head is being looked at, and while another one stops. */
struct wish {
	GDBusMethodInvocation *call; /* NULL: answered, or none */
	bool is_tried;               /* the recorder works on it */
	bool resume, salvage;
	char *site;
	const struct preset *preset;
	bool hdr;
};

struct acquisition_service {
	char *device, *folder;
	bool any_site;
	BusAcquisition1 *bus;
	recorder *recorder;
	GError *error;                /* of the last look or scan; NULL: it was good */
	struct wish wish;             /* the scan that has not begun yet */
	GPtrArray *lookers;           /* calls of Check that wait */
	GDBusMethodInvocation *reset; /* a call of Reset that waits; NULL: none */
	bool is_resetting;            /* the recorder works on it */
	guint timer, look_again;
	hotplug *plugs;
	button *button;  /* while the head is closed; NULL: has none */
	char *last_site; /* of the last scan that began */
	const struct preset *last_preset;
	bool last_hdr;
	void (*ended)(void); /* once it shall end */
};

/* ---- properties ---- */

static void show_devices(acquisition_service *s)
{
	struct identity h = recorder_head(s->recorder);
	bus_acquisition1_set_devices(s->bus, acquisition_devices(&h, s->error));
	bus_acquisition1_set_fault(s->bus,
		g_variant_new("(ss)", s->error ? s->error->message : "", advice_for(s->error)));
	bus_acquisition1_set_needs_reset(s->bus, recorder_is_latched(s->recorder));
}

/* In steps that can be seen: what stays the same is not sent. */
static void show_progress(acquisition_service *s)
{
	struct recorder_progress p = recorder_progress(s->recorder);
	BusAcquisition1 *b = s->bus;
	bus_acquisition1_set_state(b, recorder_state_names[p.state]);
	bus_acquisition1_set_site(b, p.site ? p.site : "");
	bus_acquisition1_set_scan(b, p.scan);
	bus_acquisition1_set_preset(b, p.preset ? p.preset : "");
	bus_acquisition1_set_doing(b, p.doing ? p.doing : "");
	bus_acquisition1_set_fraction(b, round(p.fraction * 1000) / 1000);
	bus_acquisition1_set_column_fraction(b, round(p.column_fraction * 1000) / 1000);
	bus_acquisition1_set_photos(b, g_variant_new("(uu)", p.photos_taken, p.photos_wanted));
	bus_acquisition1_set_seconds_left(b, round(p.seconds_left));
	recorder_progress_clear(&p);
	/* Now, not when nothing else is to do: a signal or an answer that follows must not come before. */
	g_dbus_interface_skeleton_flush(G_DBUS_INTERFACE_SKELETON(b));
}

static gboolean show_again(gpointer user_data)
{
	acquisition_service *s = user_data;
	show_progress(s);
	if (recorder_is_working(s->recorder))
		return G_SOURCE_CONTINUE;
	s->timer = 0;
	return G_SOURCE_REMOVE;
}

static void set_error(acquisition_service *s, const GError *error)
{
	g_clear_error(&s->error);
	/* That a contact is closed again does not make it good. */
	s->error =
		error ? g_error_copy(error)
		: recorder_is_latched(s->recorder)
			? g_error_new_literal(PUMP_ERROR, PUMP_ERROR_NOT_RESET, RECORDER_NOT_RESET)
			: NULL;
	show_devices(s);
}

/* ---- the scanner's own button ---- */

static void begin_wish(acquisition_service *s);

/* Goes on with a scan that was paused, else begins one in the last site; nobody is there to be told that it cannot be. */
static void button_pressed(gpointer user_data)
{
	acquisition_service *s = user_data;
	bool paused = g_str_equal(bus_acquisition1_get_state(s->bus), "paused");
	if (!s->last_site || (!paused && !s->last_preset) || s->ended)
		return;
	s->wish = (struct wish){ .resume = paused,
		.site = g_strdup(s->last_site),
		.preset = s->last_preset,
		.hdr = s->last_hdr };
	begin_wish(s);
}

/* Pins belong to one at a time: to the button here, or to an open head. */
static void watch_button(acquisition_service *s)
{
	g_clear_pointer(&s->button, button_free);
	/* Where it cannot be had, the check of the head says why. */
	if (s->device && !recorder_is_working(s->recorder))
		s->button = button_new(s->device, button_pressed, s, NULL);
}

/* ---- looking at the head ---- */

static void look(acquisition_service *s);

static gboolean look_later(gpointer user_data)
{
	acquisition_service *s = user_data;
	s->look_again = 0;
	if (!recorder_is_working(s->recorder))
		look(s);
	return G_SOURCE_REMOVE;
}

static void look(acquisition_service *s)
{
	g_autoptr(GError) error = NULL;
	g_clear_handle_id(&s->look_again, g_source_remove);
	g_clear_pointer(&s->button, button_free);
	if (s->device && !s->ended && !recorder_check(s->recorder, s->device, &error))
		g_printerr("pleinair acquired: %s\n", error->message);
}

static void answer_lookers(acquisition_service *s)
{
	g_autoptr(GPtrArray) calls = s->lookers;
	s->lookers = g_ptr_array_new();
	for (guint i = 0; i < calls->len; i++)
		bus_acquisition1_complete_check(
			s->bus, calls->pdata[i], bus_acquisition1_get_devices(s->bus));
}

/* ---- resetting ---- */

static void begin_reset(acquisition_service *s)
{
	GError *error = NULL;
	g_clear_handle_id(&s->look_again, g_source_remove);
	g_clear_pointer(&s->button, button_free);
	s->is_resetting = recorder_reset(s->recorder, s->device, &error);
	if (!s->is_resetting)
		service_refuse(g_steal_pointer(&s->reset), error);
}

/* Something else may be wrong with the head: that is not what was asked. */
static void answer_reset(acquisition_service *s, const GError *error)
{
	GDBusMethodInvocation *call = s->is_resetting ? g_steal_pointer(&s->reset) : NULL;
	s->is_resetting = false;
	g_dbus_interface_skeleton_flush(G_DBUS_INTERFACE_SKELETON(s->bus));
	if (call && recorder_is_latched(s->recorder))
		service_refuse(call, g_error_copy(error));
	else if (call)
		bus_acquisition1_complete_reset(s->bus, call);
}

/* ---- scans ---- */

static void wish_clear(struct wish *w)
{
	g_free(w->site);
	*w = (struct wish){ 0 };
}

static void refuse_wish(acquisition_service *s, GError *error)
{
	GDBusMethodInvocation *call = g_steal_pointer(&s->wish.call);
	wish_clear(&s->wish);
	if (call)
		service_refuse(call, error);
	else
		g_error_free(error);
}

static void begin_wish(acquisition_service *s)
{
	GError *error = NULL;
	struct wish *w = &s->wish;
	w->is_tried = true;
	g_clear_pointer(&s->button, button_free);
	bool good = w->resume ? recorder_resume(s->recorder, w->site, w->salvage, &error)
			      : recorder_start(
					s->recorder, s->device, w->site, w->preset, w->hdr, &error);
	if (!good) {
		refuse_wish(s, error);
		watch_button(s);
		return;
	}
	set_error(s, NULL);
	show_progress(s);
	if (!s->timer)
		s->timer = g_timeout_add(PROPERTIES_MS, show_again, s);
}

static void begun(gpointer user_data)
{
	acquisition_service *s = user_data;
	GDBusMethodInvocation *call = g_steal_pointer(&s->wish.call);
	bool resume = s->wish.resume;
	g_free(s->last_site);
	s->last_site = g_strdup(s->wish.site);
	if (s->wish.preset) {
		s->last_preset = s->wish.preset;
		s->last_hdr = s->wish.hdr;
	}
	wish_clear(&s->wish);
	show_progress(s);
	show_devices(s);
	guint number = bus_acquisition1_get_scan(s->bus);
	if (call && resume)
		bus_acquisition1_complete_resume(s->bus, call, number);
	else if (call)
		bus_acquisition1_complete_start(s->bus, call, number);
}

static void tell_end(acquisition_service *s, const char *site_path, uint32_t scan, bool partial,
	bool stopped, const GError *error)
{
	bool fault = error && !stopped;
	if (!error)
		bus_acquisition1_emit_finished(s->bus, site_path, scan);
	else
		bus_acquisition1_emit_stopped(s->bus, site_path, scan, partial,
			fault ? error->message : "", fault ? advice_for(error) : "");
}

static void ended(const char *site_path, uint32_t scan, bool partial, bool stopped,
	const GError *error, gpointer user_data)
{
	acquisition_service *s = user_data;
	set_error(s, stopped ? NULL : error);
	show_progress(s);
	/* One that has not begun: who asked for it is told, and nobody else. */
	if (s->wish.is_tried && error)
		refuse_wish(s, g_error_copy(error));
	else
		tell_end(s, site_path, scan, partial, stopped, error);
	if (s->ended)
		s->ended();
	else if (s->wish.call)
		begin_wish(s);
	watch_button(s);
}

static void checked(const GError *error, gpointer user_data)
{
	acquisition_service *s = user_data;
	set_error(s, error);
	answer_lookers(s);
	answer_reset(s, error);
	if (s->ended)
		s->ended();
	else if (s->reset)
		begin_reset(s);
	else if (s->wish.call)
		begin_wish(s);
	else if (error)
		s->look_again = g_timeout_add_seconds(LOOK_AGAIN_S, look_later, s);
	watch_button(s);
}

static void refuse_busy(GDBusMethodInvocation *call)
{
	g_dbus_method_invocation_return_error_literal(call, SERVICE_ERROR, SERVICE_ERROR_BUSY,
		"a scan is under way: wait for it, or stop it first");
}

/* And has not been told to stop. */
static bool is_scanning(acquisition_service *s)
{
	struct recorder_progress p = recorder_progress(s->recorder);
	bool stops = p.state == RECORDER_PAUSING;
	recorder_progress_clear(&p);
	return recorder_is_working(s->recorder) && !recorder_is_checking(s->recorder) && !stops;
}

/* Now, or as soon as the head was looked at, or the scan before has stopped. */
static void want(acquisition_service *s, struct wish wish)
{
	if (s->wish.call || is_scanning(s) || s->ended) {
		refuse_busy(wish.call);
		g_free(wish.site);
		return;
	}
	s->wish = wish;
	if (!recorder_is_working(s->recorder))
		begin_wish(s);
}

/* ---- methods ---- */

static bool allows(acquisition_service *s, GDBusMethodInvocation *call, const char *site_path)
{
	GError *error = NULL;
	if (service_allows(s->any_site ? NULL : s->folder, site_path, &error))
		return true;
	service_refuse(call, error);
	return false;
}

static gboolean list_presets(BusAcquisition1 *b, GDBusMethodInvocation *call, gpointer user_data)
{
	acquisition_service *s = user_data;
	struct identity h = recorder_head(s->recorder);
	bus_acquisition1_complete_list_presets(b, call, acquisition_presets(&h));
	return TRUE;
}

static gboolean check(BusAcquisition1 *b, GDBusMethodInvocation *call, gpointer user_data)
{
	acquisition_service *s = user_data;
	(void)b;
	if (!s->device) {
		g_dbus_method_invocation_return_error_literal(call, SERVICE_ERROR,
			SERVICE_ERROR_FAILED,
			"no scanner is set up: /etc/pleinair.conf names it, or --device");
		return TRUE;
	}
	if (recorder_is_working(s->recorder) && !recorder_is_checking(s->recorder)) {
		refuse_busy(call);
		return TRUE;
	}
	g_ptr_array_add(s->lookers, call);
	if (!recorder_is_checking(s->recorder))
		look(s);
	return TRUE;
}

static gboolean reset(BusAcquisition1 *b, GDBusMethodInvocation *call, gpointer user_data)
{
	acquisition_service *s = user_data;
	(void)b;
	bool scans = recorder_is_working(s->recorder) && !recorder_is_checking(s->recorder);
	if (!s->device || s->reset || s->ended || scans) {
		g_dbus_method_invocation_return_error_literal(call, SERVICE_ERROR,
			SERVICE_ERROR_BUSY,
			"nothing can be reset now: no scanner is set up, or it is at work");
		return TRUE;
	}
	s->reset = call;
	if (!recorder_is_checking(s->recorder))
		begin_reset(s);
	return TRUE;
}

/* A device that is a file, or a socket, can be made by whoever calls. */
static bool allows_device(acquisition_service *s, const char *uri, GError **error)
{
	if (s->any_site || !(g_str_has_prefix(uri, "replay:") || g_str_has_prefix(uri, "sim:/")))
		return true;
	g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_NOT_ALLOWED,
		"%s: not on this machine: its scanner is no file", uri);
	return false;
}

static gboolean set_device(
	BusAcquisition1 *b, GDBusMethodInvocation *call, const char *uri, gpointer user_data)
{
	acquisition_service *s = user_data;
	GError *error = NULL;
	if (!allows_device(s, uri, &error)) {
		service_refuse(call, error);
		return TRUE;
	}
	if (recorder_is_working(s->recorder)) {
		g_dbus_method_invocation_return_error_literal(call, SERVICE_ERROR,
			SERVICE_ERROR_BUSY, "the scanner is at work: wait until it is done");
		return TRUE;
	}
	g_free(s->device);
	s->device = *uri ? g_strdup(uri) : NULL;
	recorder_forget_head(s->recorder);
	bus_acquisition1_set_device(b, uri);
	set_error(s, NULL);
	look(s);
	bus_acquisition1_complete_set_device(b, call);
	return TRUE;
}

static gboolean start(BusAcquisition1 *b, GDBusMethodInvocation *call, const char *site_path,
	const char *preset, GVariant *options, gpointer user_data)
{
	acquisition_service *s = user_data;
	const struct preset *p = preset_find(preset);
	bool hdr;
	GError *error = NULL;
	(void)b;
	if (!allows(s, call, site_path))
		return TRUE;
	if (!acquisition_read_options(options, &hdr, &error))
		service_refuse(call, error);
	else if (!p)
		g_dbus_method_invocation_return_error(call, SERVICE_ERROR, SERVICE_ERROR_INVALID,
			"there is no preset '%s': draft, standard or fine", preset);
	else if (!s->device)
		g_dbus_method_invocation_return_error_literal(call, SERVICE_ERROR,
			SERVICE_ERROR_FAILED,
			"no scanner is set up: /etc/pleinair.conf names it, or --device");
	else
		want(s, (struct wish){ .call = call,
				.site = g_strdup(site_path),
				.preset = p,
				.hdr = hdr });
	return TRUE;
}

static gboolean resume(BusAcquisition1 *b, GDBusMethodInvocation *call, const char *site_path,
	gboolean salvage, gpointer user_data)
{
	acquisition_service *s = user_data;
	(void)b;
	if (allows(s, call, site_path))
		want(s, (struct wish){ .call = call,
				.resume = true,
				.salvage = salvage,
				.site = g_strdup(site_path) });
	return TRUE;
}

/* Answers a call that needs no waiting. */
static gboolean answer(
	acquisition_service *s, GDBusMethodInvocation *call, bool good, GError *error)
{
	if (!good) {
		service_refuse(call, error);
		return TRUE;
	}
	show_progress(s);
	g_dbus_method_invocation_return_value(call, NULL);
	return TRUE;
}

static gboolean pause_scan(BusAcquisition1 *b, GDBusMethodInvocation *call, gpointer user_data)
{
	acquisition_service *s = user_data;
	GError *error = NULL;
	(void)b;
	bool good = recorder_pause(s->recorder, &error);
	return answer(s, call, good, error);
}

static gboolean abort_scan(
	BusAcquisition1 *b, GDBusMethodInvocation *call, gboolean keep, gpointer user_data)
{
	acquisition_service *s = user_data;
	GError *error = NULL;
	(void)b;
	bool good = recorder_stop(s->recorder, keep, &error);
	return answer(s, call, good, error);
}

static gboolean discard(
	BusAcquisition1 *b, GDBusMethodInvocation *call, const char *site_path, gpointer user_data)
{
	acquisition_service *s = user_data;
	GError *error = NULL;
	(void)b;
	if (!allows(s, call, site_path))
		return TRUE;
	bool good = recorder_discard(s->recorder, site_path, &error);
	return answer(s, call, good, error);
}

static gboolean preview(BusAcquisition1 *b, GDBusMethodInvocation *call, GUnixFDList *fds,
	const char *name, gpointer user_data)
{
	acquisition_service *s = user_data;
	enum picture plane;
	GError *error = NULL;
	uint32_t columns, rows;
	uint64_t serial;
	(void)fds;
	if (!acquisition_find_plane(name, &plane, &error)) {
		service_refuse(call, error);
		return TRUE;
	}
	g_autofree uint8_t *rgba = recorder_preview(s->recorder, plane, &columns, &rows, &serial);
	if (!rgba) {
		g_dbus_method_invocation_return_error_literal(
			call, SERVICE_ERROR, SERVICE_ERROR_FAILED, "nothing has been scanned yet");
		return TRUE;
	}
	int fd = acquisition_seal(rgba, (size_t)4 * columns * rows, &error);
	if (fd < 0) {
		service_refuse(call, error);
		return TRUE;
	}
	g_autoptr(GUnixFDList) given = g_unix_fd_list_new_from_array(&fd, 1);
	bus_acquisition1_complete_preview(
		b, call, given, g_variant_new_handle(0), columns, rows, serial);
	return TRUE;
}

/* ---- the object ---- */

/* A head that was not there may be now, or the other way round. */
static void plugs_changed(gpointer user_data)
{
	acquisition_service *s = user_data;
	if (!recorder_is_working(s->recorder))
		look(s);
}

acquisition_service *acquisition_service_new(const struct acquisition_options *options)
{
	acquisition_service *s = g_new0(acquisition_service, 1);
	struct recorder_watcher w = { begun, ended, checked, s };
	s->device = g_strdup(options->device);
	s->folder = g_strdup(options->folder);
	s->any_site = options->any_site;
	s->lookers = g_ptr_array_new();
	s->recorder = recorder_new(&w);
	s->bus = bus_acquisition1_skeleton_new();
	s->plugs = hotplug_new(plugs_changed, s);
	bus_acquisition1_set_device(s->bus, s->device ? s->device : "");
	g_signal_connect(s->bus, "handle-list-presets", G_CALLBACK(list_presets), s);
	g_signal_connect(s->bus, "handle-check", G_CALLBACK(check), s);
	g_signal_connect(s->bus, "handle-reset", G_CALLBACK(reset), s);
	g_signal_connect(s->bus, "handle-set-device", G_CALLBACK(set_device), s);
	g_signal_connect(s->bus, "handle-start", G_CALLBACK(start), s);
	g_signal_connect(s->bus, "handle-pause", G_CALLBACK(pause_scan), s);
	g_signal_connect(s->bus, "handle-resume", G_CALLBACK(resume), s);
	g_signal_connect(s->bus, "handle-abort", G_CALLBACK(abort_scan), s);
	g_signal_connect(s->bus, "handle-discard", G_CALLBACK(discard), s);
	g_signal_connect(s->bus, "handle-preview", G_CALLBACK(preview), s);
	show_progress(s);
	show_devices(s);
	return s;
}

void acquisition_service_free(acquisition_service *s)
{
	if (!s)
		return;
	g_clear_handle_id(&s->timer, g_source_remove);
	g_clear_handle_id(&s->look_again, g_source_remove);
	hotplug_free(s->plugs);
	button_free(s->button);
	recorder_free(s->recorder);
	g_dbus_interface_skeleton_unexport(G_DBUS_INTERFACE_SKELETON(s->bus));
	g_object_unref(s->bus);
	g_clear_error(&s->error);
	g_ptr_array_unref(s->lookers);
	wish_clear(&s->wish);
	g_free(s->last_site);
	g_free(s->device);
	g_free(s->folder);
	g_free(s);
}

bool acquisition_service_export(acquisition_service *s, GDBusConnection *c, GError **error)
{
	return g_dbus_interface_skeleton_export(
		G_DBUS_INTERFACE_SKELETON(s->bus), c, OBJECT_PATH, error);
}

void acquisition_service_begin(acquisition_service *s)
{
	if (!recorder_is_working(s->recorder))
		look(s);
}

void acquisition_service_end(acquisition_service *s, void (*is_over)(void))
{
	s->ended = is_over;
	if (!recorder_is_working(s->recorder)) {
		is_over();
		return;
	}
	if (!recorder_is_checking(s->recorder))
		recorder_pause(s->recorder, NULL);
}
