#include "render/kiosk/sleep.h"

struct sleep {
	GtkWidget *dark;
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
	struct sleep *s = g_new0(struct sleep, 1);
	s->dark = kit_classed(gtk_box_new(GTK_ORIENTATION_VERTICAL, 0), "asleep");
	gtk_widget_set_name(s->dark, "asleep");
	gtk_widget_set_visible(s->dark, FALSE);
	gtk_overlay_add_overlay(GTK_OVERLAY(overlay), s->dark);
	s->after_s = after_s;
	s->touched_us = g_get_monotonic_time();
	GtkEventController *all = gtk_event_controller_legacy_new();
	gtk_event_controller_set_propagation_phase(all, GTK_PHASE_CAPTURE);
	g_signal_connect(all, "event", G_CALLBACK(event), s);
	gtk_widget_add_controller(window, all);
	if (after_s > 0)
		s->timer = g_timeout_add(500, look, s);
	g_object_set_data_full(G_OBJECT(window), "sleep", s, sleep_free);
}
