#include "render/kiosk/take-made.h"
#include "render/kiosk/picture-load.h"
#include "render/kiosk/screen-look.h"
#include "render/kiosk/take-words.h"
#include <gio/gio.h>

#define THUMB_WIDTH  104
#define THUMB_HEIGHT 72
/* Vector drawings beyond this take too long to become a picture. */
#define DRAWING_SHOWN_MOST 8e6

struct take_made {
	kiosk *kiosk;
	char *site;
	GtkWidget *box, *rows, *none;
	GPtrArray *items;   /* of export_item */
	GPtrArray *removed; /* of struct removal, that can be brought back; the undo has them */
};

/* ---- removing ---- */

struct removal {
	take_made *from;
	char *name, *aside;
};

static void removal_free(gpointer data)
{
	struct removal *r = data;
	g_ptr_array_remove(r->from->removed, r);
	g_free(r->name);
	g_free(r->aside);
	g_free(r);
}

static void bring_back(gpointer data)
{
	struct removal *r = data;
	g_autoptr(GError) error = NULL;
	if (!exports_restore(r->from->site, r->aside, r->name, &error))
		kiosk_complain_of(r->from->kiosk, error);
	take_made_refresh(r->from);
}

static void remove_item(take_made *m, const char *name)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *aside = exports_remove(m->site, name, &error);
	g_autofree char *did = g_strdup_printf(_("%s removed"), name);
	if (!aside) {
		kiosk_complain_of(m->kiosk, error);
		return;
	}
	struct removal *r = g_new0(struct removal, 1);
	*r = (struct removal){ m, g_strdup(name), g_steal_pointer(&aside) };
	g_ptr_array_add(m->removed, r);
	kiosk_did(m->kiosk, did, bring_back, r, removal_free, m);
	kiosk_say(m->kiosk, did);
	take_made_refresh(m);
}

static gboolean remove_later(gpointer user_data)
{
	GtkWidget *row = user_data;
	take_made *m = g_object_get_data(G_OBJECT(row), "made");
	g_autofree char *name = g_strdup(g_object_get_data(G_OBJECT(row), "item"));
	if (gtk_widget_get_parent(row))
		remove_item(m, name);
	return G_SOURCE_REMOVE;
}

/* Not at once: the row goes, and the button in it is still busy with being pressed. */
static void remove_pressed(GtkButton *button, gpointer user_data)
{
	(void)button;
	g_idle_add_full(G_PRIORITY_DEFAULT, remove_later, g_object_ref(user_data), g_object_unref);
}

/* ---- looking ---- */

static bool can_be_seen(const export_item *e)
{
	return e->kind == EXPORT_PICTURE ||
	       (g_str_has_suffix(e->name, ".svg") && e->bytes < DRAWING_SHOWN_MOST);
}

static void look_from(take_made *m, const char *name)
{
	g_autoptr(GPtrArray) paths = g_ptr_array_new();
	guint at = 0;
	for (guint i = 0; i < m->items->len; i++) {
		const export_item *e = g_ptr_array_index(m->items, i);
		if (!g_strcmp0(e->name, name))
			at = paths->len;
		if (can_be_seen(e))
			g_ptr_array_add(paths, e->path);
	}
	g_ptr_array_add(paths, NULL);
	screen_look_open(m->kiosk, (const char *const *)paths->pdata, at);
}

static void look_at(take_made *m, const export_item *e)
{
	g_auto(GStrv) inside = e->kind == EXPORT_FOLDER ? exports_pictures_in(e->path) : NULL;
	if (can_be_seen(e))
		look_from(m, e->name);
	else if (inside && *inside)
		screen_look_open(m->kiosk, (const char *const *)inside, 0);
	else
		kiosk_say(
			m->kiosk, e->kind == EXPORT_FILM
					  ? _("Films are played on a computer: copy it to a drive.")
					  : _("This is read on a computer: copy it to a drive."));
}

static void row_pressed(GtkButton *button, gpointer user_data)
{
	take_made *m = g_object_get_data(user_data, "made");
	const char *name = g_object_get_data(user_data, "item");
	(void)button;
	for (guint i = 0; i < m->items->len; i++) {
		const export_item *e = g_ptr_array_index(m->items, i);
		if (!g_strcmp0(e->name, name)) {
			look_at(m, e);
			return;
		}
	}
}

/* ---- the list ---- */

static const char *icon_of(enum export_kind kind)
{
	switch (kind) {
	case EXPORT_FILM: return "video-x-generic-symbolic";
	case EXPORT_REPORT: return "x-office-document-symbolic";
	case EXPORT_POINTS: return "view-grid-symbolic";
	case EXPORT_FOLDER: return "folder-pictures-symbolic";
	case EXPORT_DRAWING: return "x-office-drawing-symbolic";
	case EXPORT_PICTURE: return "image-x-generic-symbolic";
	default: return "text-x-generic-symbolic";
	}
}

static GtkWidget *thumb_of(const export_item *e)
{
	GtkWidget *w;
	if (can_be_seen(e)) {
		w = gtk_picture_new();
		picture_load(w, e->path, THUMB_WIDTH, THUMB_HEIGHT);
	} else {
		w = kit_classed(gtk_image_new_from_icon_name(icon_of(e->kind)), "soft");
		gtk_image_set_pixel_size(GTK_IMAGE(w), 40);
	}
	gtk_widget_set_size_request(w, THUMB_WIDTH, THUMB_HEIGHT);
	return w;
}

static GtkWidget *row_of(take_made *m, const export_item *e)
{
	g_autofree char *words = words_export(e, g_get_real_time());
	g_autofree char *shown = g_strdup_printf("made-%s", e->name);
	g_autofree char *remove = g_strdup_printf("remove-%s", e->name);
	g_autofree char *tip = g_strdup_printf(_("Remove %s"), e->name);
	GtkWidget *row = kit_row(4, NULL);
	GtkWidget *texts = kit_column(2, kit_line("made-name", e->name, NULL, true),
		kit_line("made-words", words, "soft small number", true), NULL);
	gtk_widget_set_valign(texts, GTK_ALIGN_CENTER);
	GtkWidget *look =
		kit_button(shown, NULL, "", e->name, "flat made", G_CALLBACK(row_pressed), row);
	gtk_button_set_child(
		GTK_BUTTON(look), kit_row(14, thumb_of(e), kit_grow(texts, true, false), NULL));
	GtkWidget *away = kit_button(
		remove, "user-trash-symbolic", NULL, tip, "flat", G_CALLBACK(remove_pressed), row);
	gtk_widget_set_valign(away, GTK_ALIGN_CENTER);
	gtk_box_append(GTK_BOX(row), kit_grow(look, true, false));
	gtk_box_append(GTK_BOX(row), away);
	g_object_set_data(G_OBJECT(row), "made", m);
	g_object_set_data_full(G_OBJECT(row), "item", g_strdup(e->name), g_free);
	return row;
}

void take_made_refresh(take_made *m)
{
	g_ptr_array_unref(m->items);
	m->items = exports_list(m->site);
	kit_empty(m->rows);
	for (guint i = 0; i < m->items->len; i++)
		gtk_box_append(GTK_BOX(m->rows), row_of(m, g_ptr_array_index(m->items, i)));
	gtk_widget_set_visible(m->none, m->items->len == 0);
}

static void take_made_free(gpointer data)
{
	take_made *m = data;
	g_autoptr(GError) error = NULL;
	kiosk_forget_undo(m->kiosk, m);
	if (!exports_forget_removed(m->site, &error))
		g_printerr("pleinair kiosk: %s\n", error->message);
	g_ptr_array_unref(m->removed);
	g_ptr_array_unref(m->items);
	g_free(m->site);
	g_free(m);
}

take_made *take_made_new(kiosk *k, const char *site)
{
	take_made *m = g_new0(take_made, 1);
	m->kiosk = k;
	m->site = g_strdup(site);
	m->items = g_ptr_array_new();
	m->removed = g_ptr_array_new();
	m->rows = kit_column(0, NULL);
	gtk_widget_set_name(m->rows, "made");
	m->none = kit_text(_("Nothing yet. What is made appears here."), "soft");
	m->box = kit_column(8, m->none, m->rows, NULL);
	g_object_set_data_full(G_OBJECT(m->box), "take-made", m, take_made_free);
	take_made_refresh(m);
	return m;
}

GtkWidget *take_made_box(take_made *m)
{
	return m->box;
}
