#include "render/kiosk/sleep.h"
#include <gio/gio.h>

struct sleep {
	GtkWidget *dark;
	GtkEventController *events;
	double after_s;
	int64_t touched_us;
	guint timer;
};

static gboolean look(gpointer user_data)
{
	struct sleep *s = user_data;
	if ((double)(g_get_monotonic_time() - s->touched_us) * 1e-6 >= s->after_s)
		gtk_widget_set_visible(s->dark, TRUE);
	return G_SOURCE_CONTINUE;
}

/* On its way down to what is pressed: while dark, nothing goes on. The end of the touch that wakes is held back too, since only it
 * makes the screen light again. */
static gboolean event(GtkEventControllerLegacy *c, GdkEvent *e, gpointer user_data)
{
	struct sleep *s = user_data;
	GdkEventType type = gdk_event_get_event_type(e);
	(void)c;
	s->touched_us = g_get_monotonic_time();
	if (!gtk_widget_get_visible(s->dark))
		return GDK_EVENT_PROPAGATE;
	if (type == GDK_TOUCH_END || type == GDK_TOUCH_CANCEL || type == GDK_BUTTON_RELEASE ||
		type == GDK_KEY_RELEASE)
		gtk_widget_set_visible(s->dark, FALSE);
	return GDK_EVENT_STOP;
}

static void sleep_free(gpointer data)
{
	struct sleep *s = data;
	g_clear_handle_id(&s->timer, g_source_remove);
	g_free(s);
}

void sleep_add(GtkWidget *window, GtkWidget *overlay, double after_s)
{
	struct sleep *s = g_new0(struct sleep, 1),
		     *before = g_object_get_data(G_OBJECT(window), "sleep");
	/* The content of the window was built anew. */
	if (before)
		gtk_widget_remove_controller(window, before->events);
	s->dark = kit_classed(gtk_box_new(GTK_ORIENTATION_VERTICAL, 0), "asleep");
	gtk_widget_set_name(s->dark, "asleep");
	gtk_widget_set_visible(s->dark, FALSE);
	gtk_overlay_add_overlay(GTK_OVERLAY(overlay), s->dark);
	s->touched_us = g_get_monotonic_time();
	s->events = gtk_event_controller_legacy_new();
	gtk_event_controller_set_propagation_phase(s->events, GTK_PHASE_CAPTURE);
	g_signal_connect(s->events, "event", G_CALLBACK(event), s);
	gtk_widget_add_controller(window, s->events);
	g_object_set_data_full(G_OBJECT(window), "sleep", s, sleep_free);
	sleep_after(window, after_s);
}

void sleep_after(GtkWidget *window, double after_s)
{
	struct sleep *s = g_object_get_data(G_OBJECT(window), "sleep");
	g_clear_handle_id(&s->timer, g_source_remove);
	s->after_s = after_s;
	if (after_s > 0)
		s->timer = g_timeout_add(500, look, s);
}
