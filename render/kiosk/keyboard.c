#include "render/kiosk/keyboard.h"
#include <gio/gio.h>
#include <string.h>

/* Of both languages; the last letters of a row are those that only German has. */
static const char *const rows[] = { "1234567890", "qwertzuiopü", "asdfghjklöä", "yxcvbnmß-_" };

struct keyboard {
	GtkEditable *entry;
	GPtrArray *letters; /* labels */
	bool is_shifted;
};

static void show_case(struct keyboard *k)
{
	for (guint i = 0; i < k->letters->len; i++) {
		GtkWidget *label = g_ptr_array_index(k->letters, i);
		const char *letter = g_object_get_data(G_OBJECT(label), "letter");
		g_autofree char *shown =
			k->is_shifted ? g_utf8_strup(letter, -1) : g_strdup(letter);
		gtk_label_set_text(GTK_LABEL(label), strcmp(letter, "ß") ? shown : letter);
	}
}

static void insert(struct keyboard *k, const char *text)
{
	int at;
	gtk_editable_delete_selection(k->entry);
	at = gtk_editable_get_position(k->entry);
	gtk_editable_insert_text(k->entry, text, -1, &at);
	gtk_editable_set_position(k->entry, at);
}

static void letter_pressed(GtkButton *b, gpointer user_data)
{
	struct keyboard *k = user_data;
	insert(k, gtk_label_get_text(GTK_LABEL(gtk_button_get_child(b))));
	k->is_shifted = false;
	show_case(k);
}

static void shift_pressed(GtkButton *b, gpointer user_data)
{
	struct keyboard *k = user_data;
	(void)b;
	k->is_shifted = !k->is_shifted;
	show_case(k);
}

static void space_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	insert(user_data, " ");
}

static void erase_pressed(GtkButton *b, gpointer user_data)
{
	struct keyboard *k = user_data;
	int at = gtk_editable_get_position(k->entry);
	(void)b;
	if (gtk_editable_get_selection_bounds(k->entry, NULL, NULL))
		gtk_editable_delete_selection(k->entry);
	else if (at > 0)
		gtk_editable_delete_text(k->entry, at - 1, at);
}

static GtkWidget *letter_key(struct keyboard *k, const char *letter)
{
	GtkWidget *label = gtk_label_new(letter), *b = gtk_button_new();
	g_autofree char *name = g_strconcat("key-", letter, NULL);
	g_object_set_data_full(G_OBJECT(label), "letter", g_strdup(letter), g_free);
	gtk_button_set_child(GTK_BUTTON(b), label);
	gtk_widget_set_name(b, name);
	/* The entry keeps the cursor. */
	gtk_widget_set_focus_on_click(b, FALSE);
	kit_classed(b, "key");
	g_signal_connect(b, "clicked", G_CALLBACK(letter_pressed), k);
	g_ptr_array_add(k->letters, label);
	return kit_grow(b, true, false);
}

static GtkWidget *letter_row(struct keyboard *k, const char *letters)
{
	GtkWidget *row = kit_row(6, NULL);
	for (const char *c = letters; *c; c = g_utf8_next_char(c)) {
		char letter[8] = { 0 };
		memcpy(letter, c, (size_t)(g_utf8_next_char(c) - c));
		gtk_box_append(GTK_BOX(row), letter_key(k, letter));
	}
	gtk_box_set_homogeneous(GTK_BOX(row), TRUE);
	return row;
}

static void keyboard_free(gpointer data)
{
	struct keyboard *k = data;
	g_ptr_array_unref(k->letters);
	g_free(k);
}

static GtkWidget *plain_key(const char *name, const char *icon, const char *text, const char *tip,
	GCallback pressed, struct keyboard *k)
{
	GtkWidget *b = kit_button(name, icon, text, tip, "key", pressed, k);
	gtk_widget_set_focus_on_click(b, FALSE);
	return b;
}

GtkWidget *keyboard_new(GtkEditable *entry)
{
	struct keyboard *k = g_new0(struct keyboard, 1);
	GtkWidget *all = kit_column(6, NULL);
	k->entry = entry;
	k->letters = g_ptr_array_new();
	for (size_t i = 0; i < G_N_ELEMENTS(rows); i++)
		gtk_box_append(GTK_BOX(all), letter_row(k, rows[i]));
	gtk_box_append(
		GTK_BOX(all), kit_row(6,
				      plain_key("key-shift", "go-up-symbolic", NULL,
					      _("Capital letter"), G_CALLBACK(shift_pressed), k),
				      kit_grow(plain_key("key-space", NULL, _("Space"), NULL,
						       G_CALLBACK(space_pressed), k),
					      true, false),
				      plain_key("key-erase", "edit-clear-symbolic", NULL,
					      _("Erase"), G_CALLBACK(erase_pressed), k),
				      NULL));
	g_object_set_data_full(G_OBJECT(all), "keyboard", k, keyboard_free);
	return all;
}
