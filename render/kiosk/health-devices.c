#include "render/kiosk/device-sheet.h"
#include "render/kiosk/health.h"
#include "render/kiosk/site-words.h"
#include <gio/gio.h>

struct devices {
	kiosk *kiosk;
	GtkWidget *none, *rows, *spinner, *check, *uri, *fault, *fault_text, *fault_advice, *reset;
	GVariant *shown; /* of type aa{sv} */
	GCancellable *cancel;
};

/* ---- what they are ---- */

static const char *title_of(const char *name, const char *title)
{
	static const struct {
		const char *name, *title;
	} known[] = {
		{ "lidar", N_("Lidar") },
		{ "stage", N_("Stage") },
		{ "camera", N_("Camera") },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
		if (!g_strcmp0(known[i].name, name))
			return _(known[i].title);
	return title;
}

static const char *words_of(const char *state, const char **ret_verdict)
{
	static const struct {
		const char *state, *words, *verdict;
	} known[] = {
		{ "good", N_("Works"), "good" },
		{ "gone", N_("Not there"), "bad" },
		{ "fault", N_("Fault"), "bad" },
	};
	*ret_verdict = NULL;
	for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
		if (!g_strcmp0(known[i].state, state)) {
			*ret_verdict = known[i].verdict;
			return _(known[i].words);
		}
	return _("Not looked at yet");
}

static GtkWidget *row_of(GVariant *device)
{
	const char *name = "", *title = "", *state = "", *sentence = "", *verdict;
	g_variant_lookup(device, "name", "&s", &name);
	g_variant_lookup(device, "title", "&s", &title);
	g_variant_lookup(device, "state", "&s", &state);
	g_variant_lookup(device, "sentence", "&s", &sentence);
	const char *words = words_of(state, &verdict);
	g_autofree char *widget = g_strdup_printf("device-%s", name);
	GtkWidget *dot = kit_line("device-dot", "●", "soft", false);
	GtkWidget *says = kit_named_text(widget, words, NULL);
	gtk_label_set_xalign(GTK_LABEL(says), 1);
	if (verdict)
		gtk_widget_remove_css_class(dot, "soft");
	kit_set_verdict(dot, verdict);
	kit_set_verdict(says, verdict);
	GtkWidget *top =
		kit_row(10, dot, kit_line("device-title", title_of(name, title), NULL, true),
			kit_grow(says, true, false), NULL);
	g_autofree char *said = words_sentence(sentence);
	return *said ? kit_column(2, top, kit_text(said, "soft small"), NULL) : top;
}

static void show_devices(struct devices *d, GVariant *devices)
{
	if (!devices || (d->shown && g_variant_equal(devices, d->shown)))
		return;
	g_clear_pointer(&d->shown, g_variant_unref);
	d->shown = g_variant_ref(devices);
	kit_empty(d->rows);
	gtk_widget_set_visible(d->none, g_variant_n_children(devices) == 0);
	for (gsize i = 0; i < g_variant_n_children(devices); i++) {
		g_autoptr(GVariant) one = g_variant_get_child_value(devices, i);
		gtk_box_append(GTK_BOX(d->rows), row_of(one));
	}
}

static void show_fault(struct devices *d, GVariant *fault)
{
	const char *sentence = "", *advice = "";
	if (fault && g_variant_is_of_type(fault, G_VARIANT_TYPE("(ss)")))
		g_variant_get(fault, "(&s&s)", &sentence, &advice);
	g_autofree char *words = words_sentence(sentence);
	kit_set_text(d->fault_text, words);
	kit_set_text(d->fault_advice, words_advice(advice));
	gtk_widget_set_visible(d->fault, *sentence);
	gtk_widget_set_visible(d->fault_advice, *advice);
}

static void show(struct devices *d)
{
	services *s = kiosk_services(d->kiosk);
	BusAcquisition1 *a = services_acquisition(s);
	const char *uri = bus_acquisition1_get_device(a);
	GVariant *devices = bus_acquisition1_get_devices(a);
	bool there = services_has_acquisition(s);
	kit_set_text(d->uri, there && uri && *uri ? uri : _("None is chosen"));
	show_devices(d, devices);
	show_fault(d, bus_acquisition1_get_fault(a));
	gtk_widget_set_visible(d->reset, bus_acquisition1_get_needs_reset(a));
	gtk_widget_set_sensitive(
		d->check, there && !gtk_spinner_get_spinning(GTK_SPINNER(d->spinner)));
}

/* ---- what people ask for ---- */

static void set_checking(struct devices *d, bool checking)
{
	gtk_spinner_set_spinning(GTK_SPINNER(d->spinner), checking);
	gtk_widget_set_visible(d->spinner, checking);
	gtk_widget_set_sensitive(d->check, !checking);
}

static void checked(GObject *source, GAsyncResult *result, gpointer user_data)
{
	struct devices *d = user_data;
	g_autoptr(GError) error = NULL;
	g_autoptr(GVariant) devices = NULL;
	bool good = bus_acquisition1_call_check_finish(
		BUS_ACQUISITION1(source), &devices, result, &error);
	/* The screen is gone. */
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	set_checking(d, false);
	if (!good)
		kiosk_complain_of(d->kiosk, error);
	show_devices(d, devices);
}

static void check_pressed(GtkButton *button, gpointer user_data)
{
	struct devices *d = user_data;
	(void)button;
	set_checking(d, true);
	bus_acquisition1_call_check(
		services_acquisition(kiosk_services(d->kiosk)), d->cancel, checked, d);
}

static void was_reset(GObject *source, GAsyncResult *result, gpointer user_data)
{
	struct devices *d = user_data;
	g_autoptr(GError) error = NULL;
	bool good = bus_acquisition1_call_reset_finish(BUS_ACQUISITION1(source), result, &error);
	if (!good && !g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		kiosk_complain_of(d->kiosk, error);
}

static void reset_pressed(GtkButton *button, gpointer user_data)
{
	struct devices *d = user_data;
	(void)button;
	bus_acquisition1_call_reset(
		services_acquisition(kiosk_services(d->kiosk)), d->cancel, was_reset, d);
}

static void change_pressed(GtkButton *button, gpointer user_data)
{
	struct devices *d = user_data;
	(void)button;
	device_sheet_open(d->kiosk);
}

/* ---- the whole ---- */

static void devices_free(gpointer data)
{
	struct devices *d = data;
	g_signal_handlers_disconnect_by_data(services_acquisition(kiosk_services(d->kiosk)), d);
	g_cancellable_cancel(d->cancel);
	g_object_unref(d->cancel);
	g_clear_pointer(&d->shown, g_variant_unref);
	g_free(d);
}

static void build_fault(struct devices *d)
{
	d->fault_text = kit_named_text("health-fault", "", "bad");
	d->fault_advice = kit_named_text("health-advice", "", "small");
	d->reset = kit_button("health-reset", NULL, _("Reset"),
		_("It is safe: the scanner may be used again"), "main", G_CALLBACK(reset_pressed),
		d);
	d->fault = kit_column(4, d->fault_text, d->fault_advice, d->reset, NULL);
	gtk_widget_set_visible(d->fault, FALSE);
}

static void build_parts(struct devices *d)
{
	d->rows = kit_column(8, NULL);
	gtk_widget_set_name(d->rows, "health-devices");
	d->none = kit_text(_("Check now tells what is plugged in and whether it works."), "soft");
	d->spinner = gtk_spinner_new();
	gtk_widget_set_size_request(d->spinner, 28, 28);
	gtk_widget_set_visible(d->spinner, FALSE);
	d->check = kit_button(
		"health-check", NULL, _("Check now"), NULL, "main", G_CALLBACK(check_pressed), d);
	d->uri = kit_line("health-device-uri", "", "small", true);
	build_fault(d);
}

static GtkWidget *build(struct devices *d)
{
	build_parts(d);
	GtkWidget *title = kit_line("devices-title", _("Scanner"), "head", true);
	GtkWidget *top = kit_row(12, kit_grow(title, true, false), d->spinner, d->check, NULL);
	GtkWidget *texts = kit_column(
		2, kit_line("device-label", _("Device"), "soft small", true), d->uri, NULL);
	gtk_widget_set_valign(texts, GTK_ALIGN_CENTER);
	GtkWidget *change = kit_button("health-device", NULL, _("Change"), _("Change the device"),
		NULL, G_CALLBACK(change_pressed), d);
	GtkWidget *device = kit_row(12, kit_grow(texts, true, false), change, NULL);
	return kit_classed(kit_column(12, top, d->fault, d->none, d->rows, device, NULL), "card");
}

GtkWidget *health_devices_new(kiosk *k)
{
	struct devices *d = g_new0(struct devices, 1);
	BusAcquisition1 *a = services_acquisition(kiosk_services(k));
	d->kiosk = k;
	d->cancel = g_cancellable_new();
	GtkWidget *card = build(d);
	g_signal_connect_swapped(a, "g-properties-changed", G_CALLBACK(show), d);
	g_signal_connect_swapped(a, "notify::g-name-owner", G_CALLBACK(show), d);
	g_object_set_data_full(G_OBJECT(card), "devices", d, devices_free);
	show(d);
	return card;
}
