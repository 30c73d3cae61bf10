#include "render/kiosk/kit.h"
#include <gio/gio.h>
#include <stdarg.h>

GtkWidget *kit_classed(GtkWidget *w, const char *classes)
{
	g_auto(GStrv) each = g_strsplit(classes ? classes : "", " ", -1);
	for (char **c = each; *c; c++)
		if (**c)
			gtk_widget_add_css_class(w, *c);
	return w;
}

GtkWidget *kit_text(const char *text, const char *classes)
{
	GtkWidget *label = gtk_label_new(text);
	gtk_label_set_xalign(GTK_LABEL(label), 0);
	gtk_label_set_wrap(GTK_LABEL(label), TRUE);
	gtk_label_set_wrap_mode(GTK_LABEL(label), PANGO_WRAP_WORD_CHAR);
	return kit_classed(label, classes);
}

GtkWidget *kit_named_text(const char *name, const char *text, const char *classes)
{
	GtkWidget *label = kit_text(text, classes);
	gtk_widget_set_name(label, name);
	return label;
}

void kit_narrow(GtkWidget *label, int least, int most)
{
	gtk_label_set_width_chars(GTK_LABEL(label), least);
	gtk_label_set_max_width_chars(GTK_LABEL(label), most);
}

GtkWidget *kit_line(const char *name, const char *text, const char *classes, bool ellipsis)
{
	GtkWidget *label = gtk_label_new(text);
	gtk_label_set_xalign(GTK_LABEL(label), 0);
	if (ellipsis)
		gtk_label_set_ellipsize(GTK_LABEL(label), PANGO_ELLIPSIZE_END);
	gtk_widget_set_name(label, name);
	return kit_classed(label, classes);
}

GtkWidget *kit_button(const char *name, const char *icon, const char *text, const char *tip,
	const char *classes, GCallback clicked, gpointer user_data)
{
	GtkWidget *button = gtk_button_new(), *label = text ? gtk_label_new(text) : NULL;
	gtk_widget_set_name(button, name);
	if (icon && label)
		gtk_button_set_child(GTK_BUTTON(button),
			kit_row(10, gtk_image_new_from_icon_name(icon), label, NULL));
	else
		gtk_button_set_child(
			GTK_BUTTON(button), label ? label : gtk_image_new_from_icon_name(icon));
	if (icon && label)
		gtk_widget_set_halign(gtk_button_get_child(GTK_BUTTON(button)), GTK_ALIGN_CENTER);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(button), GTK_ACCESSIBLE_PROPERTY_LABEL, tip ? tip : text, -1);
	if (clicked)
		g_signal_connect(button, "clicked", clicked, user_data);
	return kit_classed(button, classes);
}

static GtkWidget *box(GtkOrientation orientation, int spacing, va_list children)
{
	GtkWidget *b = gtk_box_new(orientation, spacing), *child;
	while ((child = va_arg(children, GtkWidget *)))
		gtk_box_append(GTK_BOX(b), child);
	return b;
}

GtkWidget *kit_row(int spacing, ...)
{
	va_list children;
	va_start(children, spacing);
	GtkWidget *b = box(GTK_ORIENTATION_HORIZONTAL, spacing, children);
	va_end(children);
	return b;
}

GtkWidget *kit_column(int spacing, ...)
{
	va_list children;
	va_start(children, spacing);
	GtkWidget *b = box(GTK_ORIENTATION_VERTICAL, spacing, children);
	va_end(children);
	return b;
}

static bool is_upright;

void kit_set_upright(bool upright)
{
	is_upright = upright;
}

bool kit_is_upright(void)
{
	return is_upright;
}

GtkWidget *kit_sides(int spacing, ...)
{
	va_list children;
	va_start(children, spacing);
	GtkWidget *b = box(is_upright ? GTK_ORIENTATION_VERTICAL : GTK_ORIENTATION_HORIZONTAL,
		spacing, children);
	va_end(children);
	return b;
}

GtkWidget *kit_scroll(GtkWidget *child)
{
	GtkWidget *scroll = gtk_scrolled_window_new();
	gtk_scrolled_window_set_policy(
		GTK_SCROLLED_WINDOW(scroll), GTK_POLICY_NEVER, GTK_POLICY_AUTOMATIC);
	gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scroll), child);
	return kit_grow(scroll, true, true);
}

GtkWidget *kit_space(void)
{
	return kit_grow(gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 0), true, true);
}

GtkWidget *kit_grow(GtkWidget *w, bool across, bool down)
{
	gtk_widget_set_hexpand(w, across);
	gtk_widget_set_vexpand(w, down);
	return w;
}

GtkWidget *kit_margin(GtkWidget *w, int px)
{
	gtk_widget_set_margin_start(w, px);
	gtk_widget_set_margin_end(w, px);
	gtk_widget_set_margin_top(w, px);
	gtk_widget_set_margin_bottom(w, px);
	return w;
}

void kit_empty(GtkWidget *b)
{
	GtkWidget *child;
	while ((child = gtk_widget_get_first_child(b)))
		gtk_box_remove(GTK_BOX(b), child);
}

void kit_set_text(GtkWidget *label, const char *text)
{
	if (g_strcmp0(gtk_label_get_text(GTK_LABEL(label)), text))
		gtk_label_set_text(GTK_LABEL(label), text);
}

void kit_set_verdict(GtkWidget *w, const char *verdict)
{
	static const char *const all[] = { "good", "doubt", "bad" };
	for (size_t i = 0; i < G_N_ELEMENTS(all); i++)
		if (!g_strcmp0(all[i], verdict))
			gtk_widget_add_css_class(w, all[i]);
		else
			gtk_widget_remove_css_class(w, all[i]);
}

/* ---- keys ---- */

bool kit_arrow_of_key(guint key, int *ret_right, int *ret_down)
{
	*ret_right = (key == GDK_KEY_Right) - (key == GDK_KEY_Left);
	*ret_down = (key == GDK_KEY_Down) - (key == GDK_KEY_Up);
	return *ret_right || *ret_down;
}

int kit_zoom_of_key(guint key)
{
	/* Of + that is typed without Shift too. */
	bool in = key == GDK_KEY_plus || key == GDK_KEY_equal || key == GDK_KEY_KP_Add;
	bool out = key == GDK_KEY_minus || key == GDK_KEY_KP_Subtract;
	return in - out;
}
