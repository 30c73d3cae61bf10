#include "render/kiosk/choice.h"
#include <gio/gio.h>

/* More than this are in two columns. */
#define ONE_COLUMN_MOST 6

struct choice {
	kiosk *kiosk;
	char *name, *title;
	void (*changed)(const char *value, gpointer user_data);
	gpointer user_data;
	GtkWidget *button, *label;
	GPtrArray *values, *words;
	guint chosen;
};

static void choice_free(gpointer data)
{
	choice *c = data;
	g_ptr_array_unref(c->values);
	g_ptr_array_unref(c->words);
	g_free(c->name);
	g_free(c->title);
	g_free(c);
}

static void show(choice *c)
{
	const char *words = c->words->len ? g_ptr_array_index(c->words, c->chosen) : "";
	g_autofree char *told = g_strdup_printf("%s: %s", c->title, words);
	kit_set_text(c->label, words);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(c->button), GTK_ACCESSIBLE_PROPERTY_LABEL, told, -1);
}

static void value_pressed(GtkButton *button, gpointer user_data)
{
	choice *c = user_data;
	c->chosen = GPOINTER_TO_UINT(g_object_get_data(G_OBJECT(button), "index"));
	show(c);
	/* The button is gone with its sheet. */
	kiosk_close_sheet(c->kiosk);
	if (c->changed)
		c->changed(choice_value(c), c->user_data);
}

static GtkWidget *value_button(choice *c, guint i)
{
	const char *value = g_ptr_array_index(c->values, i);
	g_autofree char *name = g_strdup_printf("%s-%s", c->name, value);
	GtkWidget *b = kit_button(name, NULL, g_ptr_array_index(c->words, i), NULL,
		i == c->chosen ? "main" : NULL, G_CALLBACK(value_pressed), c);
	g_object_set_data(G_OBJECT(b), "index", GUINT_TO_POINTER(i));
	return kit_grow(b, true, false);
}

static void pressed(GtkButton *button, gpointer user_data)
{
	choice *c = user_data;
	(void)button;
	int columns = c->values->len > ONE_COLUMN_MOST ? 2 : 1;
	GtkWidget *grid = gtk_grid_new();
	gtk_grid_set_row_spacing(GTK_GRID(grid), 10);
	gtk_grid_set_column_spacing(GTK_GRID(grid), 10);
	gtk_grid_set_column_homogeneous(GTK_GRID(grid), TRUE);
	for (guint i = 0; i < c->values->len; i++)
		gtk_grid_attach(GTK_GRID(grid), value_button(c, i), (int)i % columns,
			(int)i / columns, 1, 1);
	GtkWidget *scroll = kit_scroll(grid);
	gtk_scrolled_window_set_propagate_natural_height(GTK_SCROLLED_WINDOW(scroll), TRUE);
	gtk_scrolled_window_set_propagate_natural_width(GTK_SCROLLED_WINDOW(scroll), TRUE);
	gtk_widget_set_size_request(scroll, columns == 2 ? 720 : 420, -1);
	kiosk_open_sheet(c->kiosk, kit_column(18, kit_text(c->title, "title"), scroll, NULL));
}

choice *choice_new(kiosk *k, const char *name, const char *title,
	void (*changed)(const char *value, gpointer user_data), gpointer user_data)
{
	choice *c = g_new0(choice, 1);
	c->kiosk = k;
	c->name = g_strdup(name);
	c->title = g_strdup(title);
	c->changed = changed;
	c->user_data = user_data;
	c->values = g_ptr_array_new_with_free_func(g_free);
	c->words = g_ptr_array_new_with_free_func(g_free);
	c->label = kit_grow(kit_line("choice-words", "", NULL, true), true, false);
	c->button = kit_button(name, NULL, "", title, NULL, G_CALLBACK(pressed), c);
	gtk_button_set_child(GTK_BUTTON(c->button),
		kit_row(8, c->label, gtk_image_new_from_icon_name("pan-down-symbolic"), NULL));
	g_object_set_data_full(G_OBJECT(c->button), "choice", c, choice_free);
	return c;
}

GtkWidget *choice_button(choice *c)
{
	return c->button;
}

void choice_add(choice *c, const char *value, const char *words)
{
	g_ptr_array_add(c->values, g_strdup(value));
	g_ptr_array_add(c->words, g_strdup(words));
	if (c->values->len == 1)
		show(c);
}

const char *choice_value(const choice *c)
{
	return c->values->len ? g_ptr_array_index(c->values, c->chosen) : NULL;
}

void choice_set(choice *c, const char *value)
{
	guint i;
	if (!g_ptr_array_find_with_equal_func(c->values, value, g_str_equal, &i))
		return;
	c->chosen = i;
	show(c);
}
