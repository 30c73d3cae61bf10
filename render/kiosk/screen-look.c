#include "render/kiosk/screen-look.h"
#include "render/kiosk/picture-load.h"
#include <gio/gio.h>

struct look {
	char **paths;
	guint index, count;
	int width, height;
	GtkWidget *picture, *caption, *previous, *next;
};

static void look_free(gpointer data)
{
	struct look *l = data;
	g_strfreev(l->paths);
	g_free(l);
}

static void show(struct look *l)
{
	g_autofree char *name = g_path_get_basename(l->paths[l->index]);
	g_autofree char *text =
		l->count > 1 ? g_strdup_printf("%s  ·  %u/%u", name, l->index + 1, l->count)
			     : g_strdup(name);
	picture_load(l->picture, l->paths[l->index], l->width, l->height);
	kit_set_text(l->caption, text);
	gtk_widget_set_sensitive(l->previous, l->index > 0);
	gtk_widget_set_sensitive(l->next, l->index + 1 < l->count);
}

static void previous_pressed(GtkButton *button, gpointer user_data)
{
	struct look *l = user_data;
	(void)button;
	l->index--;
	show(l);
}

static void next_pressed(GtkButton *button, gpointer user_data)
{
	struct look *l = user_data;
	(void)button;
	l->index++;
	show(l);
}

static GtkWidget *build_strip(struct look *l)
{
	l->previous = kit_button("look-previous", "go-previous-symbolic", NULL,
		_("Previous picture"), NULL, G_CALLBACK(previous_pressed), l);
	l->next = kit_button("look-next", "go-next-symbolic", NULL, _("Next picture"), NULL,
		G_CALLBACK(next_pressed), l);
	l->caption = kit_line("look-caption", "", "head", true);
	gtk_label_set_xalign(GTK_LABEL(l->caption), 0.5f);
	gtk_widget_set_visible(l->previous, l->count > 1);
	gtk_widget_set_visible(l->next, l->count > 1);
	return kit_classed(
		kit_row(12, l->previous, kit_grow(l->caption, true, false), l->next, NULL),
		"strip");
}

void screen_look_open(kiosk *k, const char *const *paths, unsigned index)
{
	const struct kiosk_options *o = kiosk_options_of(k);
	struct look *l = g_new0(struct look, 1);
	l->paths = g_strdupv((char **)paths);
	l->count = g_strv_length(l->paths);
	l->index = index;
	/* Full-screen windows may be larger than what was asked for. */
	l->width = MAX(o->width, 1920);
	l->height = MAX(o->height, 1200);
	l->picture = kit_grow(gtk_picture_new(), true, true);
	gtk_picture_set_content_fit(GTK_PICTURE(l->picture), GTK_CONTENT_FIT_SCALE_DOWN);
	gtk_widget_set_name(l->picture, "look-picture");
	GtkWidget *screen = kit_column(0, kit_margin(l->picture, 8), build_strip(l), NULL);
	g_object_set_data_full(G_OBJECT(screen), "look", l, look_free);
	show(l);
	kiosk_push(k, screen, "look", _("Picture"));
}
