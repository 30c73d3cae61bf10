/* The strip of styles: each drawn small as it would look from here. */
#include "render/kiosk/draw-screen.h"
#include <gio/gio.h>

#define SMALL_WIDTH  168
#define SMALL_HEIGHT 105

static void mark_chosen(struct draw_screen *s)
{
	GtkWidget *b = gtk_widget_get_first_child(s->strip);
	for (guint n = 0; b; b = gtk_widget_get_next_sibling(b), n++)
		if (!g_strcmp0(s->names[n], s->style_name))
			gtk_widget_set_state_flags(b, GTK_STATE_FLAG_CHECKED, FALSE);
		else
			gtk_widget_unset_state_flags(b, GTK_STATE_FLAG_CHECKED);
}

void draw_screen_use_style(struct draw_screen *s, const char *name)
{
	g_autoptr(GError) error = NULL;
	style_edit *edit = style_edit_new(name, s->folder, &error);
	if (!edit) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	g_autofree char *old = s->style_name;
	s->style_name = g_strdup(name);
	/* Light and focus are the person's, whatever it is drawn with. */
	if (s->edit)
		style_edit_take_accents(edit, s->edit);
	style_edit_free(s->edit);
	s->edit = edit;
	draw_screen_redraw(s, false);
	draw_panel_fill(s);
	draw_accents_refresh(s);
	mark_chosen(s);
}

/* The thing that is selected gets the steps that this style has for it. */
static void use_for_node(struct draw_screen *s, const char *name)
{
	char key[32];
	g_autoptr(GError) error = NULL;
	g_autoptr(style) other = style_find(name, s->folder, &error);
	g_autoptr(GArray) steps = other ? style_steps(other, s->site->tree, s->node, &error) : NULL;
	if (!steps) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	const struct segment *node = segments_find(s->site->tree, s->node);
	g_autofree char *did = g_strdup_printf(_("%s as \"%s\""), node->name, other->title);
	draw_screen_will_change(s, did);
	style_edit_set_steps(s->edit, draw_screen_node_key(s, key), steps);
	draw_screen_redraw(s, false);
	draw_panel_fill(s);
	kiosk_say(s->kiosk, did);
}

static void style_back(gpointer data)
{
	char **pair = g_object_get_data(data, "names");
	struct draw_screen *s = g_object_get_data(data, "screen");
	draw_screen_use_style(s, pair[0]);
}

static void keep_old_style(struct draw_screen *s, const char *now)
{
	const char *names[] = { s->style_name, NULL };
	GObject *o = g_object_new(G_TYPE_OBJECT, NULL);
	g_object_set_data_full(o, "names", g_strdupv((char **)names), (GDestroyNotify)g_strfreev);
	g_object_set_data(o, "screen", s);
	kiosk_did(s->kiosk, now, style_back, o, g_object_unref, s);
}

static void pressed(GtkButton *button, gpointer user_data)
{
	struct draw_screen *s = user_data;
	const char *name = g_object_get_data(G_OBJECT(button), "style");
	if (s->node != SEGMENT_SITE) {
		use_for_node(s, name);
		return;
	}
	if (!g_strcmp0(name, s->style_name))
		return;
	keep_old_style(s, _("Another style"));
	draw_screen_use_style(s, name);
}

static GtkWidget *style_button(struct draw_screen *s, const char *name, const char *title)
{
	GtkWidget *picture = gtk_picture_new();
	gtk_picture_set_can_shrink(GTK_PICTURE(picture), TRUE);
	gtk_picture_set_content_fit(GTK_PICTURE(picture), GTK_CONTENT_FIT_COVER);
	gtk_widget_set_size_request(picture, SMALL_WIDTH, SMALL_HEIGHT);
	gtk_widget_set_overflow(picture, GTK_OVERFLOW_HIDDEN);
	kit_classed(picture, "picture");
	g_ptr_array_add(s->pictures, picture);
	GtkWidget *label = kit_line("style-title", title, NULL, true);
	/* As much as two lines hold. */
	gtk_label_set_wrap(GTK_LABEL(label), TRUE);
	gtk_label_set_lines(GTK_LABEL(label), 2);
	kit_narrow(label, -1, 16);
	gtk_label_set_justify(GTK_LABEL(label), GTK_JUSTIFY_CENTER);
	gtk_widget_set_vexpand(label, TRUE);
	gtk_label_set_xalign(GTK_LABEL(label), 0.5F);
	GtkWidget *button = gtk_button_new();
	gtk_button_set_child(GTK_BUTTON(button), kit_column(2, picture, label, NULL));
	g_autofree char *id = g_strconcat("style-", name, NULL);
	gtk_widget_set_name(button, id);
	gtk_widget_set_vexpand(button, FALSE); /* not as its label */
	gtk_widget_set_tooltip_text(button, title);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(button), GTK_ACCESSIBLE_PROPERTY_LABEL, title, -1);
	g_object_set_data_full(G_OBJECT(button), "style", g_strdup(name), g_free);
	g_signal_connect(button, "clicked", G_CALLBACK(pressed), s);
	return button;
}

/* The style that is drawn is where one looks when the strip comes, once it has a place: true. */
static bool show_chosen(GtkWidget *strip, GtkAdjustment *at)
{
	graphene_rect_t place;
	for (GtkWidget *b = gtk_widget_get_first_child(strip); b;
		b = gtk_widget_get_next_sibling(b)) {
		if (!(gtk_widget_get_state_flags(b) & GTK_STATE_FLAG_CHECKED) ||
			!gtk_widget_compute_bounds(b, strip, &place) || place.size.width <= 0)
			continue;
		gtk_adjustment_set_value(at, (double)(place.origin.x + place.size.width / 2) -
						     gtk_adjustment_get_page_size(at) / 2);
		return true;
	}
	return false;
}

static gboolean has_a_place(gpointer user_data)
{
	struct draw_screen *s = user_data;
	GtkAdjustment *at = gtk_scrolled_window_get_hadjustment(
		GTK_SCROLLED_WINDOW(gtk_widget_get_ancestor(s->strip, GTK_TYPE_SCROLLED_WINDOW)));
	s->strip_timer = 0;
	if (show_chosen(s->strip, at))
		s->strip_is_new = false;
	return G_SOURCE_REMOVE;
}

/* The strip is as long as its styles now; they get their places next. */
static void has_length(GtkAdjustment *at, gpointer user_data)
{
	struct draw_screen *s = user_data;
	if (s->strip_is_new && !s->strip_timer &&
		gtk_adjustment_get_upper(at) > gtk_adjustment_get_page_size(at))
		s->strip_timer = g_idle_add(has_a_place, s);
}

void draw_strip_fill(struct draw_screen *s)
{
	g_auto(GStrv) all = style_names(s->folder);
	g_autoptr(GPtrArray) good = g_ptr_array_new();
	GPtrArray *drawings = g_ptr_array_new_with_free_func((GDestroyNotify)drawing_free);
	kit_empty(s->strip);
	g_ptr_array_set_size(s->pictures, 0);
	for (char **n = all; *n; n++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(style) each = style_find(*n, s->folder, &error);
		drawing *d = each ? drawing_new(each, s->site->tree, NULL, &error) : NULL;
		if (!d) {
			/* One that is broken does not hide the others. */
			kiosk_complain_of(s->kiosk, error);
			continue;
		}
		g_ptr_array_add(drawings, d);
		g_ptr_array_add(good, g_strdup(*n));
		gtk_box_append(
			GTK_BOX(s->strip), style_button(s, *n, *each->title ? _(each->title) : *n));
	}
	g_ptr_array_add(good, NULL);
	g_strfreev(s->names);
	s->names = (char **)g_ptr_array_free(g_steal_pointer(&good), FALSE);
	easel_set_small(s->easel, drawings, SMALL_WIDTH, SMALL_HEIGHT);
	mark_chosen(s);
	s->strip_is_new = true;
}

void draw_strip_got_small(struct draw_screen *s, uint32_t n, const struct artist_picture *p)
{
	if (n >= s->pictures->len)
		return;
	g_autoptr(GdkTexture) texture = canvas_texture(p->bgrx, p->width, p->height);
	gtk_picture_set_paintable(
		GTK_PICTURE(g_ptr_array_index(s->pictures, n)), GDK_PAINTABLE(texture));
}

GtkWidget *draw_strip_new(struct draw_screen *s)
{
	s->strip = kit_row(8, NULL);
	GtkWidget *scroll = gtk_scrolled_window_new();
	gtk_scrolled_window_set_policy(
		GTK_SCROLLED_WINDOW(scroll), GTK_POLICY_AUTOMATIC, GTK_POLICY_NEVER);
	gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scroll), s->strip);
	gtk_widget_set_name(scroll, "draw-strip");
	g_signal_connect(gtk_scrolled_window_get_hadjustment(GTK_SCROLLED_WINDOW(scroll)),
		"changed", G_CALLBACK(has_length), s);
	return kit_classed(scroll, "strip");
}
