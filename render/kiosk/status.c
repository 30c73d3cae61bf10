#include "render/kiosk/status.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define LOOK_AGAIN_S 10
/* A fine scan is about 200 MB with what is computed of it. */
#define LITTLE_ROOM_BYTES 5e9
#define LITTLE_BATTERY    20

struct status {
	services *services;
	char *folder;
	GtkWidget *button, *scanner, *scanner_dot, *disk, *battery;
	guint timer;
};

static double number_in(const char *folder, const char *file)
{
	g_autofree char *path = g_build_filename(folder, file, NULL), *text = NULL;
	if (!g_file_get_contents(path, &text, NULL, NULL))
		return -1;
	return g_ascii_strtod(text, NULL);
}

static bool says(const char *folder, const char *file, const char *word)
{
	g_autofree char *path = g_build_filename(folder, file, NULL), *text = NULL;
	return g_file_get_contents(path, &text, NULL, NULL) && g_str_has_prefix(text, word);
}

static void look_at_battery(struct box_state *b)
{
	const char *root = "/sys/class/power_supply", *name;
	g_autoptr(GDir) dir = g_dir_open(root, 0, NULL);
	b->battery_percent = -1;
	while (dir && (name = g_dir_read_name(dir))) {
		g_autofree char *folder = g_build_filename(root, name, NULL);
		/* Of a mouse or a pen is not of the box. */
		if (!says(folder, "type", "Battery") || says(folder, "scope", "Device"))
			continue;
		b->battery_percent = number_in(folder, "capacity");
		b->is_charging =
			says(folder, "status", "Charging") || says(folder, "status", "Full");
	}
}

struct box_state box_state_now(const char *folder)
{
	struct box_state b = { 0 };
	g_autoptr(GFile) file = g_file_new_for_path(folder);
	g_autoptr(GFileInfo) info = g_file_query_filesystem_info(file, "filesystem::*", NULL, NULL);
	if (info) {
		b.free_bytes = (double)g_file_info_get_attribute_uint64(
			info, G_FILE_ATTRIBUTE_FILESYSTEM_FREE);
		b.total_bytes = (double)g_file_info_get_attribute_uint64(
			info, G_FILE_ATTRIBUTE_FILESYSTEM_SIZE);
	}
	look_at_battery(&b);
	return b;
}

char *box_size_text(double bytes)
{
	return g_format_size((guint64)fmax(bytes, 0));
}

static void show_scanner(status *s)
{
	BusAcquisition1 *a = services_acquisition(s->services);
	const char *state = bus_acquisition1_get_state(a), *verdict = "good", *words = _("Scanner");
	GVariant *fault = bus_acquisition1_get_fault(a);
	const char *sentence = "";
	if (fault && g_variant_is_of_type(fault, G_VARIANT_TYPE("(ss)")))
		g_variant_get_child(fault, 0, "&s", &sentence);
	if (!services_has_acquisition(s->services)) {
		verdict = "bad";
		words = _("No scanner service");
	} else if (*sentence) {
		verdict = "bad";
		words = _("Scanner fault");
	} else if (state && strcmp(state, "idle")) {
		words = !strcmp(state, "paused") ? _("Paused") : _("Scanning");
		verdict = "doubt";
	}
	kit_set_text(s->scanner, words);
	kit_set_verdict(s->scanner_dot, verdict);
}

static gboolean show_box(gpointer user_data)
{
	status *s = user_data;
	struct box_state b = box_state_now(s->folder);
	g_autofree char *size = box_size_text(b.free_bytes);
	g_autofree char *room = g_strdup_printf(_("%s free"), size);
	kit_set_text(s->disk, b.total_bytes > 0 ? room : _("Disk?"));
	kit_set_verdict(s->disk, b.free_bytes < LITTLE_ROOM_BYTES ? "bad" : NULL);
	g_autofree char *percent = g_strdup_printf(
		b.is_charging ? _("%.0f %% charging") : "%.0f %%", b.battery_percent);
	gtk_widget_set_visible(s->battery, b.battery_percent >= 0);
	kit_set_text(s->battery, percent);
	kit_set_verdict(
		s->battery, b.battery_percent < LITTLE_BATTERY && !b.is_charging ? "bad" : NULL);
	return G_SOURCE_CONTINUE;
}

static void changed(status *s)
{
	show_scanner(s);
}

status *status_new(services *all, const char *folder, GCallback pressed, gpointer user_data)
{
	status *s = g_new0(status, 1);
	s->services = all;
	s->folder = g_strdup(folder);
	s->scanner_dot = kit_line("status-dot", "●", "good", false);
	s->scanner = kit_line("status-scanner", "", "small", false);
	s->disk = kit_line("status-disk", "", "small number", false);
	s->battery = kit_line("status-battery", "", "small number", false);
	s->button = gtk_button_new();
	gtk_widget_set_name(s->button, "status");
	gtk_button_set_child(
		GTK_BUTTON(s->button), kit_row(14, kit_row(6, s->scanner_dot, s->scanner, NULL),
					       s->disk, s->battery, NULL));
	gtk_accessible_update_property(GTK_ACCESSIBLE(s->button), GTK_ACCESSIBLE_PROPERTY_LABEL,
		_("Scanner, disk and battery"), -1);
	kit_classed(s->button, "flat");
	g_signal_connect(s->button, "clicked", pressed, user_data);
	BusAcquisition1 *a = services_acquisition(all);
	g_signal_connect_swapped(a, "g-properties-changed", G_CALLBACK(changed), s);
	g_signal_connect_swapped(a, "notify::g-name-owner", G_CALLBACK(changed), s);
	s->timer = g_timeout_add_seconds(LOOK_AGAIN_S, show_box, s);
	show_box(s);
	show_scanner(s);
	return s;
}

void status_free(status *s)
{
	if (!s)
		return;
	g_signal_handlers_disconnect_by_data(services_acquisition(s->services), s);
	g_source_remove(s->timer);
	g_free(s->folder);
	g_free(s);
}

GtkWidget *status_widget(status *s)
{
	return s->button;
}
