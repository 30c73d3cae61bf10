#include "render/kiosk/device-sheet.h"
#include <gio/gio.h>

/* %n becomes the number of the scan: a simulated scanner then stands somewhere else each time. */
static const struct preset {
	const char *name, *words, *uri;
} presets[] = {
	{ "device-auto", N_("The one that is plugged in"), "auto" },
	{ "device-court", N_("Simulated courtyard"), "sim:court?station=%n" },
	{ "device-street", N_("Simulated street"), "sim:street?station=%n" },
	{ "device-bridge", N_("Simulated bridge"), "sim:bridge?station=%n" },
	{ "device-hall", N_("Simulated hall"), "sim:hall?station=%n" },
};

struct sheet {
	kiosk *kiosk;
	GtkWidget *entry;
};

static void was_set(GObject *source, GAsyncResult *result, gpointer user_data)
{
	kiosk *k = user_data;
	g_autoptr(GError) error = NULL;
	if (bus_acquisition1_call_set_device_finish(BUS_ACQUISITION1(source), result, &error))
		kiosk_say(k, _("The device is changed. Check now tells whether it answers."));
	else
		kiosk_complain_of(k, error);
}

static void use(kiosk *k, const char *uri)
{
	bus_acquisition1_call_set_device(
		services_acquisition(kiosk_services(k)), uri, NULL, was_set, k);
	kiosk_close_sheet(k);
}

static void preset_pressed(GtkButton *button, gpointer user_data)
{
	const struct preset *p = g_object_get_data(G_OBJECT(button), "preset");
	struct sheet *s = user_data;
	use(s->kiosk, p->uri);
}

static void use_pressed(GtkWidget *widget, gpointer user_data)
{
	struct sheet *s = user_data;
	g_autofree char *uri = g_strdup(gtk_editable_get_text(GTK_EDITABLE(s->entry)));
	(void)widget;
	if (*g_strstrip(uri))
		use(s->kiosk, uri);
}

static GtkWidget *preset_buttons(struct sheet *s)
{
	GtkWidget *grid = gtk_grid_new();
	gtk_grid_set_row_spacing(GTK_GRID(grid), 10);
	gtk_grid_set_column_spacing(GTK_GRID(grid), 10);
	gtk_grid_set_column_homogeneous(GTK_GRID(grid), TRUE);
	for (int i = 0; i < (int)G_N_ELEMENTS(presets); i++) {
		const struct preset *p = &presets[i];
		GtkWidget *b = kit_button(
			p->name, NULL, _(p->words), NULL, NULL, G_CALLBACK(preset_pressed), s);
		g_object_set_data(G_OBJECT(b), "preset", (gpointer)p);
		gtk_grid_attach(GTK_GRID(grid), kit_grow(b, true, false), i % 2, i / 2, 1, 1);
	}
	return grid;
}

void device_sheet_open(kiosk *k)
{
	struct sheet *s = g_new0(struct sheet, 1);
	const char *now = bus_acquisition1_get_device(services_acquisition(kiosk_services(k)));
	s->kiosk = k;
	s->entry = kit_grow(gtk_entry_new(), true, false);
	gtk_widget_set_name(s->entry, "device-entry");
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(s->entry), GTK_ACCESSIBLE_PROPERTY_LABEL, _("Which scanner?"), -1);
	gtk_editable_set_text(GTK_EDITABLE(s->entry), now ? now : "");
	g_signal_connect(s->entry, "activate", G_CALLBACK(use_pressed), s);
	GtkWidget *sure =
		kit_button("device-use", NULL, _("Use"), NULL, "main", G_CALLBACK(use_pressed), s);
	GtkWidget *sheet = kit_column(16, kit_text(_("Which scanner?"), "title"),
		kit_row(12, s->entry, sure, NULL),
		kit_text(_("tim: or scip:/dev/ttyACM0 for a scanner that is plugged in, "
			   "replay:FILE for a record."),
			"soft small"),
		preset_buttons(s), NULL);
	gtk_widget_set_size_request(sheet, 640, -1);
	g_object_set_data_full(G_OBJECT(sheet), "sheet", s, g_free);
	kiosk_open_sheet(k, sheet);
}
