#include "render/kiosk/preset-chooser.h"
#include "render/kiosk/site-words.h"
#include "render/kiosk/status.h"
#include <gio/gio.h>

#define FIRST_PRESET "standard"

struct chooser {
	services *services;
	GtkWidget *box, *words, *hdr;
	GCancellable *gone;
	char *preset;
	GVariant *presets; /* NULL: not known */
};

static GVariant *find(struct chooser *c, const char *name)
{
	for (gsize i = 0; c->presets && i < g_variant_n_children(c->presets); i++) {
		g_autoptr(GVariant) p = g_variant_get_child_value(c->presets, i);
		const char *this = "";
		g_variant_lookup(p, "name", "&s", &this);
		if (!g_strcmp0(this, name))
			return g_steal_pointer(&p);
	}
	return NULL;
}

static bool is_hdr(const struct chooser *c)
{
	return gtk_widget_get_visible(c->hdr) &&
	       gtk_toggle_button_get_active(GTK_TOGGLE_BUTTON(c->hdr));
}

/* What is known of it: without a scanner only the grid. */
static char *words_of(GVariant *p, bool hdr)
{
	double seconds = -1;
	guint64 points = 0, bytes = 0;
	guint32 columns = 0, rows = 0;
	g_variant_lookup(p, "columns", "u", &columns);
	g_variant_lookup(p, "rows", "u", &rows);
	g_variant_lookup(p, hdr ? "hdr_bytes" : "bytes", "t", &bytes);
	g_variant_lookup(p, "points", "t", &points);
	if (!g_variant_lookup(p, hdr ? "hdr_seconds" : "seconds", "d", &seconds))
		return g_strdup_printf("%u × %u", columns, rows);
	g_autofree char *time = words_duration(seconds), *many = words_points((double)points),
			*size = box_size_text((double)bytes);
	return g_strdup_printf("%s · %s · %s", time, many, size);
}

static void show_words(struct chooser *c)
{
	g_autoptr(GVariant) p = c->preset ? find(c, c->preset) : NULL;
	/* A head without a camera has nothing to say of it. */
	gtk_widget_set_visible(c->hdr, p && g_variant_lookup(p, "hdr_seconds", "d", NULL));
	g_autofree char *words = p ? words_of(p, is_hdr(c)) : g_strdup("");
	kit_set_text(c->words, words);
}

static void hdr_toggled(GtkToggleButton *b, gpointer user_data)
{
	(void)b;
	show_words(user_data);
}

static void toggled(GtkToggleButton *b, gpointer user_data)
{
	struct chooser *c = user_data;
	if (!gtk_toggle_button_get_active(b))
		return;
	g_free(c->preset);
	c->preset = g_strdup(g_object_get_data(G_OBJECT(b), "preset"));
	show_words(c);
}

static GtkWidget *button(struct chooser *c, GVariant *p, GtkToggleButton *first)
{
	const char *name = "", *title = "";
	g_variant_lookup(p, "name", "&s", &name);
	g_variant_lookup(p, "title", "&s", &title);
	GtkWidget *b = gtk_toggle_button_new_with_label(_(title));
	g_autofree char *id = g_strconcat("preset-", name, NULL);
	gtk_widget_set_name(b, id);
	g_object_set_data_full(G_OBJECT(b), "preset", g_strdup(name), g_free);
	if (first)
		gtk_toggle_button_set_group(GTK_TOGGLE_BUTTON(b), first);
	g_signal_connect(b, "toggled", G_CALLBACK(toggled), c);
	if (!g_strcmp0(name, c->preset ? c->preset : FIRST_PRESET))
		gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(b), TRUE);
	return kit_grow(b, true, false);
}

static void got_presets(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GVariant) presets = NULL;
	bool good = bus_acquisition1_call_list_presets_finish(
		BUS_ACQUISITION1(source), &presets, result, &error);
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED) || !good)
		return;
	struct chooser *c = user_data;
	GtkWidget *row = gtk_widget_get_first_child(c->box);
	GtkToggleButton *first = NULL;
	g_clear_pointer(&c->presets, g_variant_unref);
	c->presets = g_steal_pointer(&presets);
	kit_empty(row);
	for (gsize i = 0; i < g_variant_n_children(c->presets); i++) {
		g_autoptr(GVariant) p = g_variant_get_child_value(c->presets, i);
		GtkWidget *b = button(c, p, first);
		if (!first)
			first = GTK_TOGGLE_BUTTON(b);
		gtk_box_append(GTK_BOX(row), b);
	}
	show_words(c);
}

static void ask(struct chooser *c)
{
	if (services_has_acquisition(c->services))
		bus_acquisition1_call_list_presets(
			services_acquisition(c->services), c->gone, got_presets, c);
}

static void destroyed(GtkWidget *w, gpointer user_data)
{
	struct chooser *c = user_data;
	(void)w;
	g_cancellable_cancel(c->gone);
	g_signal_handlers_disconnect_by_data(services_acquisition(c->services), c);
}

static void chooser_free(gpointer data)
{
	struct chooser *c = data;
	g_clear_object(&c->gone);
	g_clear_pointer(&c->presets, g_variant_unref);
	g_free(c->preset);
	g_free(c);
}

GtkWidget *preset_chooser_new(services *s)
{
	struct chooser *c = g_new0(struct chooser, 1);
	c->services = s;
	c->gone = g_cancellable_new();
	c->words = kit_named_text("preset-words", "", "small soft number");
	c->hdr = gtk_toggle_button_new_with_label(_("HDR photos"));
	gtk_widget_set_name(c->hdr, "preset-hdr");
	gtk_widget_set_visible(c->hdr, FALSE);
	g_signal_connect(c->hdr, "toggled", G_CALLBACK(hdr_toggled), c);
	c->box = kit_column(6, kit_row(8, NULL),
		kit_row(8, kit_grow(c->words, true, false), c->hdr, NULL), NULL);
	/* Predictions come with the first lidar that was seen. */
	g_signal_connect_swapped(
		services_acquisition(s), "notify::g-name-owner", G_CALLBACK(ask), c);
	g_signal_connect_swapped(services_acquisition(s), "notify::devices", G_CALLBACK(ask), c);
	g_signal_connect_swapped(c->box, "map", G_CALLBACK(ask), c);
	g_signal_connect(c->box, "destroy", G_CALLBACK(destroyed), c);
	g_object_set_data_full(G_OBJECT(c->box), "chooser", c, chooser_free);
	return c->box;
}

const char *preset_chooser_preset(GtkWidget *chooser)
{
	struct chooser *c = g_object_get_data(G_OBJECT(chooser), "chooser");
	return c->preset;
}

bool preset_chooser_hdr(GtkWidget *chooser)
{
	return is_hdr(g_object_get_data(G_OBJECT(chooser), "chooser"));
}
