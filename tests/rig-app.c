/* A small GTK program with one of each thing that a test may touch, for test-kiosk-rig.c. What it notices of fingers stands in
 * its probe's state. */
#include "render/kiosk/kiosk-probe.h"
#include <gio/gio.h>
#include <gtk/gtk.h>
#include <math.h>

static void named(GtkWidget *box, GtkWidget *widget, const char *name)
{
	gtk_widget_set_name(widget, name);
	gtk_box_append(GTK_BOX(box), widget);
}

/* ---- buttons, entry, slider ---- */

static void count(const char *key)
{
	static GHashTable *counts;
	if (!counts)
		counts = g_hash_table_new(g_str_hash, g_str_equal);
	gpointer now = GINT_TO_POINTER(GPOINTER_TO_INT(g_hash_table_lookup(counts, key)) + 1);
	g_hash_table_insert(counts, (gpointer)key, now);
	kiosk_probe_set(key, "%d", GPOINTER_TO_INT(now));
}

static void on_button(GtkButton *button, gpointer key)
{
	(void)button;
	count(key);
}

static void on_remove(GtkButton *button, GtkWidget *victim)
{
	gtk_widget_set_sensitive(GTK_WIDGET(button), FALSE);
	gtk_widget_set_visible(victim, FALSE);
}

static void add_buttons(GtkWidget *box)
{
	GtkWidget *press = gtk_button_new_with_label("Press");
	GtkWidget *victim = gtk_label_new("Für kurze Zeit");
	GtkWidget *away = gtk_button_new_from_icon_name("list-remove-symbolic");
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(away), GTK_ACCESSIBLE_PROPERTY_LABEL, "Take the label away", -1);
	g_signal_connect(press, "clicked", G_CALLBACK(on_button), (gpointer) "presses");
	g_signal_connect(away, "clicked", G_CALLBACK(on_remove), victim);
	named(box, press, "press");
	named(box, away, "away");
	named(box, victim, "victim");
}

static void add_fields(GtkWidget *box)
{
	GtkWidget *slider = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, 0, 100, 1);
	named(box, gtk_entry_new(), "entry");
	named(box, slider, "slider");
}

static void add_popover(GtkWidget *box)
{
	GtkWidget *menu = gtk_menu_button_new(), *popover = gtk_popover_new();
	GtkWidget *inside = gtk_button_new_with_label("Inside");
	gtk_widget_set_name(inside, "inside");
	g_signal_connect(inside, "clicked", G_CALLBACK(on_button), (gpointer) "insides");
	gtk_popover_set_child(GTK_POPOVER(popover), inside);
	gtk_menu_button_set_popover(GTK_MENU_BUTTON(menu), popover);
	named(box, menu, "menu");
}

/* ---- the picture that fingers move ---- */

static void on_drag(GtkGestureDrag *drag, double x, double y)
{
	(void)drag;
	kiosk_probe_set("drag", "%.0f %.0f", x, y);
}

/* Of two fingers the middle moves; a GtkGestureDrag of two points tells of whichever finger moved last. */
static double pan_from_x, pan_from_y;

static void on_two_begin(GtkGesture *two)
{
	gtk_gesture_get_bounding_box_center(two, &pan_from_x, &pan_from_y);
}

static void on_two_update(GtkGesture *two)
{
	double x, y;
	if (gtk_gesture_get_bounding_box_center(two, &x, &y))
		kiosk_probe_set("pan", "%.0f %.0f", x - pan_from_x, y - pan_from_y);
}

static void on_zoom(GtkGestureZoom *zoom, double scale)
{
	(void)zoom;
	kiosk_probe_set("zoom", "%.2f", scale);
}

static void on_rotate(GtkGestureRotate *rotate, double angle, double delta)
{
	(void)rotate;
	(void)angle;
	kiosk_probe_set("angle", "%.2f", delta);
}

static void on_click(GtkGestureClick *click, int presses)
{
	(void)click;
	kiosk_probe_set("clicks", "%d", presses);
}

/* Tests wait for this, and then read what the fingers did. */
static void on_end(GtkGesture *gesture, GdkEventSequence *sequence, gpointer key)
{
	(void)gesture;
	(void)sequence;
	count(key);
}

static void on_long_press(void)
{
	count("holds");
}

static void listen(GtkWidget *area, GtkGesture *gesture, const char *signal, GCallback callback,
	const char *ends)
{
	g_signal_connect(gesture, signal, callback, NULL);
	if (ends)
		g_signal_connect(gesture, "end", G_CALLBACK(on_end), (gpointer)ends);
	gtk_widget_add_controller(area, GTK_EVENT_CONTROLLER(gesture));
}

static void paint(GtkDrawingArea *area, cairo_t *cr, int width, int height, gpointer data)
{
	(void)area;
	(void)data;
	cairo_set_source_rgb(cr, 0.2, 0.4, 0.8);
	cairo_rectangle(cr, 0, 0, width, height);
	cairo_fill(cr);
}

static void add_area(GtkWidget *box)
{
	GtkWidget *area = gtk_drawing_area_new();
	GtkGesture *zoom = gtk_gesture_zoom_new();
	g_signal_connect(zoom, "begin", G_CALLBACK(on_two_begin), NULL);
	g_signal_connect(zoom, "update", G_CALLBACK(on_two_update), NULL);
	gtk_widget_set_vexpand(area, TRUE);
	gtk_widget_set_hexpand(area, TRUE);
	gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(area), paint, NULL, NULL);
	listen(area, gtk_gesture_drag_new(), "drag-update", G_CALLBACK(on_drag), "drags");
	listen(area, zoom, "scale-changed", G_CALLBACK(on_zoom), "zooms");
	listen(area, gtk_gesture_rotate_new(), "angle-changed", G_CALLBACK(on_rotate), "twists");
	listen(area, gtk_gesture_click_new(), "pressed", G_CALLBACK(on_click), NULL);
	listen(area, gtk_gesture_long_press_new(), "pressed", G_CALLBACK(on_long_press), NULL);
	named(box, area, "area");
}

static void add_list(GtkWidget *box)
{
	GtkWidget *rows = gtk_box_new(GTK_ORIENTATION_VERTICAL, 4);
	GtkWidget *list = gtk_scrolled_window_new();
	for (int i = 0; i < 60; i++) {
		g_autofree char *name = g_strdup_printf("row-%d", i);
		GtkWidget *row = gtk_button_new_with_label(name);
		g_signal_connect(row, "clicked", G_CALLBACK(on_button), (gpointer) "rows");
		named(rows, row, name);
	}
	gtk_widget_set_size_request(list, 240, -1);
	gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(list), rows);
	named(box, list, "list");
}

int main(void)
{
	g_autoptr(GError) error = NULL;
	gtk_init();
	if (!kiosk_probe_start(&error)) {
		g_printerr("rig-app: %s\n", error->message);
		return 1;
	}
	GtkWidget *window = gtk_window_new(), *column = gtk_box_new(GTK_ORIENTATION_VERTICAL, 8);
	GtkWidget *row = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8);
	GtkWidget *low = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8);
	gtk_window_fullscreen(GTK_WINDOW(window));
	add_buttons(row);
	add_popover(row);
	gtk_box_append(GTK_BOX(column), row);
	add_fields(column);
	add_area(low);
	add_list(low);
	gtk_box_append(GTK_BOX(column), low);
	gtk_window_set_child(GTK_WINDOW(window), column);
	gtk_window_present(GTK_WINDOW(window));
	while (g_list_model_get_n_items(gtk_window_get_toplevels()) > 0)
		g_main_context_iteration(NULL, TRUE);
	kiosk_probe_stop();
	return 0;
}
