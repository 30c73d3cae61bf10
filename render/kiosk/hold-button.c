#include "render/kiosk/hold-button.h"
#include <gio/gio.h>

struct hold {
	GtkWidget *button, *bar, *label;
	void (*held)(gpointer);
	gpointer user_data;
	int64_t since_us; /* 0: it is not held */
	guint tick;
};

static void let_go(struct hold *h)
{
	if (h->tick)
		gtk_widget_remove_tick_callback(h->button, h->tick);
	h->tick = 0;
	h->since_us = 0;
	gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(h->bar), 0);
}

static gboolean goes_on(GtkWidget *w, GdkFrameClock *clock, gpointer user_data)
{
	struct hold *h = user_data;
	double part = (double)(g_get_monotonic_time() - h->since_us) * 1e-6 / HOLD_SECONDS;
	(void)w;
	(void)clock;
	gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(h->bar), MIN(part, 1));
	if (part < 1)
		return G_SOURCE_CONTINUE;
	h->tick = 0;
	let_go(h);
	h->held(h->user_data);
	return G_SOURCE_REMOVE;
}

static void begin(struct hold *h)
{
	if (h->since_us)
		return;
	h->since_us = g_get_monotonic_time();
	h->tick = gtk_widget_add_tick_callback(h->button, goes_on, h, NULL);
}

static void end(struct hold *h)
{
	if (!h->since_us)
		return;
	gtk_label_set_text(GTK_LABEL(h->label), _("Hold it"));
	let_go(h);
}

static void pressed(GtkGestureClick *g, int n, double x, double y, gpointer user_data)
{
	(void)g;
	(void)n;
	(void)x;
	(void)y;
	begin(user_data);
}

static void released(GtkGestureClick *g, int n, double x, double y, gpointer user_data)
{
	(void)g;
	(void)n;
	(void)x;
	(void)y;
	end(user_data);
}

static void cancelled(GtkGesture *g, GdkEventSequence *s, gpointer user_data)
{
	(void)g;
	(void)s;
	end(user_data);
}

static bool presses(guint key)
{
	return key == GDK_KEY_space || key == GDK_KEY_Return || key == GDK_KEY_KP_Enter;
}

static gboolean key_down(
	GtkEventControllerKey *c, guint key, guint code, GdkModifierType m, gpointer user_data)
{
	(void)c;
	(void)code;
	(void)m;
	if (!presses(key))
		return GDK_EVENT_PROPAGATE;
	begin(user_data);
	return GDK_EVENT_STOP;
}

static void key_up(
	GtkEventControllerKey *c, guint key, guint code, GdkModifierType m, gpointer user_data)
{
	(void)c;
	(void)code;
	(void)m;
	if (presses(key))
		end(user_data);
}

GtkWidget *hold_button_new(const char *name, const char *text, const char *classes,
	void (*held)(gpointer user_data), gpointer user_data)
{
	struct hold *h = g_new0(struct hold, 1);
	h->held = held;
	h->user_data = user_data;
	h->label = gtk_label_new(text);
	h->bar = gtk_progress_bar_new();
	h->button = gtk_button_new();
	gtk_widget_set_name(h->button, name);
	gtk_button_set_child(
		GTK_BUTTON(h->button), kit_margin(kit_column(8, h->label, h->bar, NULL), 6));
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(h->button), GTK_ACCESSIBLE_PROPERTY_LABEL, text, -1);
	GtkGesture *click = gtk_gesture_click_new();
	gtk_event_controller_set_propagation_phase(GTK_EVENT_CONTROLLER(click), GTK_PHASE_CAPTURE);
	g_signal_connect(click, "pressed", G_CALLBACK(pressed), h);
	g_signal_connect(click, "released", G_CALLBACK(released), h);
	g_signal_connect(click, "cancel", G_CALLBACK(cancelled), h);
	gtk_widget_add_controller(h->button, GTK_EVENT_CONTROLLER(click));
	GtkEventController *keys = gtk_event_controller_key_new();
	gtk_event_controller_set_propagation_phase(keys, GTK_PHASE_CAPTURE);
	g_signal_connect(keys, "key-pressed", G_CALLBACK(key_down), h);
	g_signal_connect(keys, "key-released", G_CALLBACK(key_up), h);
	gtk_widget_add_controller(h->button, keys);
	g_object_set_data_full(G_OBJECT(h->button), "hold", h, g_free);
	return kit_classed(h->button, classes);
}
