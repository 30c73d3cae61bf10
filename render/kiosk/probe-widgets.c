#include "render/kiosk/probe-widgets.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

typedef void (*visit)(GtkWidget *widget, gpointer data);

/* Parents before children, lower before higher; what is not mapped has nothing mapped in it. */
static void walk(GtkWidget *widget, visit each, gpointer data)
{
	if (!gtk_widget_get_mapped(widget))
		return;
	each(widget, data);
	for (GtkWidget *child = gtk_widget_get_first_child(widget); child;
		child = gtk_widget_get_next_sibling(child))
		walk(child, each, data);
}

static void walk_windows(visit each, gpointer data)
{
	GListModel *windows = gtk_window_get_toplevels();
	for (guint i = 0; i < g_list_model_get_n_items(windows); i++) {
		g_autoptr(GtkWidget) window = g_list_model_get_item(windows, i);
		walk(window, each, data);
	}
}

/* GTK gives a widget without a name that of its type. */
static bool has_name(GtkWidget *widget)
{
	return strcmp(gtk_widget_get_name(widget), G_OBJECT_TYPE_NAME(widget)) != 0;
}

struct search {
	const char *name;
	GtkWidget *found;
};

static void compare_name(GtkWidget *widget, gpointer data)
{
	struct search *search = data;
	if (has_name(widget) && strcmp(gtk_widget_get_name(widget), search->name) == 0)
		search->found = widget;
}

GtkWidget *probe_widget(const char *name)
{
	struct search search = { .name = name };
	walk_windows(compare_name, &search);
	return search.found;
}

/* From a native widget to its window: a popover is a surface of its own that its parent's surface places. */
static void add_popup_offset(GtkNative *native, double *x, double *y)
{
	GdkSurface *surface = gtk_native_get_surface(native);
	if (!GDK_IS_POPUP(surface))
		return;
	GtkNative *parent = gtk_widget_get_native(gtk_widget_get_parent(GTK_WIDGET(native)));
	double inside_x, inside_y, outside_x, outside_y;
	gtk_native_get_surface_transform(native, &inside_x, &inside_y);
	gtk_native_get_surface_transform(parent, &outside_x, &outside_y);
	*x += inside_x + gdk_popup_get_position_x(GDK_POPUP(surface)) - outside_x;
	*y += inside_y + gdk_popup_get_position_y(GDK_POPUP(surface)) - outside_y;
	add_popup_offset(parent, x, y);
}

static bool reachable(GtkWidget *widget, GtkNative *native, const graphene_rect_t *bounds)
{
	GtkWidget *hit =
		gtk_widget_pick(GTK_WIDGET(native), bounds->origin.x + bounds->size.width / 2,
			bounds->origin.y + bounds->size.height / 2, GTK_PICK_INSENSITIVE);
	return hit && (hit == widget || gtk_widget_is_ancestor(hit, widget));
}

void probe_tell_place(GtkWidget *widget, GString *answer)
{
	GtkNative *native = gtk_widget_get_native(widget);
	graphene_rect_t bounds;
	if (!gtk_widget_compute_bounds(widget, GTK_WIDGET(native), &bounds))
		bounds = GRAPHENE_RECT_INIT(0, 0, 0, 0);
	double x = bounds.origin.x, y = bounds.origin.y;
	add_popup_offset(native, &x, &y);
	g_string_append_printf(answer, "%ld %ld %ld %ld %d %d", lround(x), lround(y),
		lround(bounds.size.width), lround(bounds.size.height),
		reachable(widget, native, &bounds), gtk_widget_is_sensitive(widget));
}

static void tell_one(GtkWidget *widget, gpointer data)
{
	if (!has_name(widget))
		return;
	g_string_append_printf(
		data, "%s %s ", gtk_widget_get_name(widget), G_OBJECT_TYPE_NAME(widget));
	probe_tell_place(widget, data);
	g_string_append_c(data, '\n');
}

void probe_tell_all(GString *answer)
{
	walk_windows(tell_one, answer);
}

static void collect_label(GtkWidget *widget, gpointer data)
{
	GString *text = data;
	if (!GTK_IS_LABEL(widget))
		return;
	g_string_append_printf(
		text, "%s%s", text->len ? " " : "", gtk_label_get_text(GTK_LABEL(widget)));
}

/* GTK shows what it tells screen readers only as what was found in place of what was expected. */
static char *accessible_label(GtkWidget *widget)
{
	GtkAccessible *accessible = GTK_ACCESSIBLE(widget);
	if (!gtk_test_accessible_has_property(accessible, GTK_ACCESSIBLE_PROPERTY_LABEL))
		return NULL;
	return gtk_test_accessible_check_property(
		accessible, GTK_ACCESSIBLE_PROPERTY_LABEL, "\001");
}

char *probe_text(GtkWidget *widget)
{
	if (GTK_IS_LABEL(widget))
		return g_strdup(gtk_label_get_text(GTK_LABEL(widget)));
	if (GTK_IS_EDITABLE(widget))
		return g_strdup(gtk_editable_get_text(GTK_EDITABLE(widget)));
	if (GTK_IS_RANGE(widget))
		return g_strdup_printf("%g", gtk_range_get_value(GTK_RANGE(widget)));
	char *told = accessible_label(widget);
	if (told)
		return told;
	GString *text = g_string_new(NULL);
	walk(widget, collect_label, text);
	return g_string_free(text, FALSE);
}

/* ---- what keys reach ---- */

static bool is_control(GtkWidget *widget)
{
	return GTK_IS_BUTTON(widget) || GTK_IS_SCALE(widget) || GTK_IS_SWITCH(widget) ||
	       GTK_IS_EDITABLE(widget) || GTK_IS_DROP_DOWN(widget) || GTK_IS_EXPANDER(widget) ||
	       (gtk_widget_get_focusable(widget) && !GTK_IS_SCROLLED_WINDOW(widget));
}

/* Its own name or that of what it is in. */
static const char *name_near(GtkWidget *widget)
{
	while (widget && !has_name(widget))
		widget = gtk_widget_get_parent(widget);
	return widget ? gtk_widget_get_name(widget) : "-";
}

/* What a screen reader says: a label that was given, else for what may be named by what is in it the labels there. */
static char *said(GtkWidget *widget)
{
	char *told = accessible_label(widget);
	if (told)
		return told;
	if (gtk_test_accessible_has_relation(
		    GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_RELATION_LABELLED_BY))
		return g_strdup("labelled by another");
	GString *text = g_string_new(NULL);
	if (GTK_IS_BUTTON(widget) || GTK_IS_EXPANDER(widget))
		walk(widget, collect_label, text);
	return g_string_free(text, FALSE);
}

static void tell_controls(GtkWidget *widget, GString *answer)
{
	if (!gtk_widget_get_mapped(widget) || !gtk_widget_is_sensitive(widget))
		return;
	if (is_control(widget)) {
		g_autofree char *words = said(widget);
		g_autofree char *line = g_strdelimit(g_strdup(words), "\n", ' ');
		g_string_append_printf(
			answer, "%s %s %s\n", name_near(widget), G_OBJECT_TYPE_NAME(widget), line);
		/* What a part of it takes is its own affair; only what unfolds holds others. */
		if (!GTK_IS_EXPANDER(widget))
			return;
	}
	for (GtkWidget *child = gtk_widget_get_first_child(widget); child;
		child = gtk_widget_get_next_sibling(child))
		tell_controls(child, answer);
}

void probe_tell_controls(GString *answer)
{
	GListModel *windows = gtk_window_get_toplevels();
	for (guint i = 0; i < g_list_model_get_n_items(windows); i++) {
		g_autoptr(GtkWidget) window = g_list_model_get_item(windows, i);
		for (GtkWidget *child = gtk_widget_get_first_child(window); child;
			child = gtk_widget_get_next_sibling(child))
			tell_controls(child, answer);
	}
}

const char *probe_focus(void)
{
	GListModel *windows = gtk_window_get_toplevels();
	for (guint i = 0; i < g_list_model_get_n_items(windows); i++) {
		g_autoptr(GtkWindow) window = g_list_model_get_item(windows, i);
		GtkWidget *focus = gtk_window_get_focus(window);
		if (focus)
			return name_near(focus);
	}
	return "-";
}
