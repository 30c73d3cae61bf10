#include "render/kiosk/name-sheet.h"
#include "render/kiosk/keyboard.h"
#include <gio/gio.h>
#include <string.h>

#define LETTERS_MOST 120

struct asked {
	kiosk *kiosk;
	GtkWidget *entry;
	void (*done)(const char *name, gpointer user_data);
	gpointer user_data;
	GDestroyNotify user_data_free;
};

static void asked_free(gpointer data)
{
	struct asked *a = data;
	if (a->user_data_free)
		a->user_data_free(a->user_data);
	g_free(a);
}

/* NULL and a sentence: no site can be called so. */
static const char *refusal(const char *name)
{
	if (!*name)
		return _("Give the site a name.");
	if (name[0] == '.' || strchr(name, '/') || strlen(name) > LETTERS_MOST)
		return _("A name has no slash, does not begin with a dot, and has at most 120 "
			 "letters.");
	return NULL;
}

static void yes_pressed(GtkWidget *w, gpointer user_data)
{
	struct asked *a = user_data;
	g_autofree char *name = g_strstrip(g_strdup(gtk_editable_get_text(GTK_EDITABLE(a->entry))));
	const char *why = refusal(name);
	(void)w;
	if (why)
		kiosk_complain(a->kiosk, why, NULL);
	else
		a->done(name, a->user_data);
}

static void cancel_pressed(GtkButton *b, gpointer user_data)
{
	struct asked *a = user_data;
	(void)b;
	kiosk_close_sheet(a->kiosk);
}

static GtkWidget *button(const struct name_sheet *desc, const char *part, const char *text,
	const char *classes, GCallback pressed, struct asked *a)
{
	g_autofree char *id = g_strconcat(desc->id, part, NULL);
	return kit_grow(kit_button(id, NULL, text, NULL, classes, pressed, a), true, false);
}

void name_sheet_open(kiosk *k, const struct name_sheet *desc)
{
	struct asked *a = g_new0(struct asked, 1);
	g_autofree char *id = g_strconcat(desc->id, "-name", NULL);
	*a = (struct asked){ k, gtk_entry_new(), desc->done, desc->user_data,
		desc->user_data_free };
	gtk_editable_set_text(GTK_EDITABLE(a->entry), desc->name);
	gtk_widget_set_name(a->entry, id);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(a->entry), GTK_ACCESSIBLE_PROPERTY_LABEL, desc->label, -1);
	g_signal_connect(a->entry, "activate", G_CALLBACK(yes_pressed), a);
	GtkWidget *buttons = kit_row(16,
		button(desc, "-cancel", _("Cancel"), "great", G_CALLBACK(cancel_pressed), a),
		button(desc, "-yes", desc->yes, "main great", G_CALLBACK(yes_pressed), a), NULL);
	GtkWidget *sheet = kit_column(16, kit_text(desc->title, "title"), a->entry,
		keyboard_new(GTK_EDITABLE(a->entry)), buttons, NULL);
	gtk_widget_set_size_request(sheet, kit_is_upright() ? -1 : 760, -1);
	g_object_set_data_full(G_OBJECT(sheet), "asked", a, asked_free);
	kiosk_open_sheet(k, sheet);
	gtk_editable_select_region(GTK_EDITABLE(a->entry), 0, -1);
}
