#include "render/drawn-site.h"
#include "render/kiosk/choice.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/settings.h"
#include "render/kiosk/take-drives.h"
#include "render/kiosk/take-made.h"
#include "render/kiosk/take-preset.h"
#include "render/kiosk/take-words.h"
#include <gio/gio.h>

#define MADE_KINDS   5
#define CHOICE_WIDTH 200

struct take {
	kiosk *kiosk;
	char *site;
	choice *style, *view, *preset[MADE_KINDS];
	take_jobs *jobs;
	take_made *made;
	take_drives *drives;
	GtkSizeGroup *choices, *buttons; /* those of all cards are as wide as each other */
};

/* Of the command, too. */
#define STYLE_FIRST "figure-7d"

static const struct card {
	const char *name, *icon, *title, *text;
	enum export_kind kind;
} cards[] = {
	{ "take-picture", "image-x-generic-symbolic", N_("Picture"),
		N_("A PNG to show and to print."), EXPORT_PICTURE },
	{ "take-drawing", "x-office-drawing-symbolic", N_("Drawing"),
		N_("Sharp at any scale, for the architect."), EXPORT_DRAWING },
	{ "take-film", "video-x-generic-symbolic", N_("Film"),
		N_("From station to station, or around."), EXPORT_FILM },
	{ "take-report", "x-office-document-symbolic", N_("Report"),
		N_("What was scanned, how well it fits."), EXPORT_REPORT },
	{ "take-points", "view-grid-symbolic", N_("Points"), N_("For CAD and other programs."),
		EXPORT_POINTS },
};

/* ---- what there is to choose from ---- */

static void add_style(choice *c, const char *name, const char *folder)
{
	g_autoptr(style) s = style_find(name, folder, NULL);
	if (s)
		choice_add(c, name, *s->title ? _(s->title) : name);
}

static void style_chosen(const char *value, gpointer user_data)
{
	(void)user_data;
	settings_keep_string("draw", "style", value);
}

static choice *choose_style(struct take *t)
{
	choice *c = choice_new(t->kiosk, "take-style", _("Style"), style_chosen, t);
	g_auto(GStrv) names = style_names(t->site);
	g_autofree char *kept = settings_string("draw", "style");
	const char *last = kept ? kept : STYLE_FIRST;
	add_style(c, last, t->site);
	for (char **n = names; n && *n; n++)
		if (g_strcmp0(*n, last))
			add_style(c, *n, t->site);
	return c;
}

static void add_saved_views(choice *c, const site *s)
{
	g_autoptr(GPtrArray) saved = view_list(s, NULL, NULL);
	for (guint i = 0; saved && i < saved->len; i++) {
		const view *v = g_ptr_array_index(saved, i);
		choice_add(c, v->name, v->title);
	}
}

static choice *choose_view(struct take *t, GError **error)
{
	choice *c = choice_new(t->kiosk, "take-view", _("View"), NULL, NULL);
	g_autoptr(drawn_site) d = drawn_site_new(t->site, 0, error);
	g_autoptr(GPtrArray) names = d ? view_built_in_names(&d->sources) : NULL;
	for (guint i = 0; names && i < names->len; i++) {
		g_autofree char *words = words_view(g_ptr_array_index(names, i));
		choice_add(c, g_ptr_array_index(names, i), words);
	}
	if (d)
		add_saved_views(c, d->site);
	return c;
}

static choice *choose_preset(struct take *t, const struct card *card)
{
	g_autofree char *name = g_strdup_printf("%s-size", card->name);
	choice *c = choice_new(t->kiosk, name, _(card->title), NULL, NULL);
	for (const struct take_preset *p = take_presets(card->kind); p->id; p++)
		choice_add(c, p->id, _(p->label));
	gtk_widget_set_hexpand(choice_button(c), FALSE);
	gtk_widget_set_size_request(choice_button(c), CHOICE_WIDTH, -1);
	gtk_size_group_add_widget(t->choices, choice_button(c));
	return c;
}

/* ---- making ---- */

static void make(struct take *t, const struct card *card, choice *preset)
{
	const struct take_preset *p = take_preset_find(card->kind, choice_value(preset));
	const char *drawn = choice_value(t->style), *seen = choice_value(t->view);
	g_autoptr(GError) error = NULL;
	g_autofree char *stem = take_stem(card->kind, p, drawn, seen);
	g_autofree char *path =
		exports_free_path(t->site, stem, p->ending, take_jobs_outputs(t->jobs), &error);
	if (!path) {
		kiosk_complain_of(t->kiosk, error);
		return;
	}
	g_autofree char *name = g_path_get_basename(path);
	take_jobs_start(t->jobs, take_job(card->kind), name, path,
		take_options(card->kind, p, drawn, seen, path), NULL, NULL);
}

static void make_pressed(GtkButton *button, gpointer user_data)
{
	struct take *t = user_data;
	const struct card *card = g_object_get_data(G_OBJECT(button), "card");
	make(t, card, t->preset[card - cards]);
}

static void scans_pressed(GtkButton *button, gpointer user_data)
{
	struct take *t = user_data;
	(void)button;
	take_drives_ask(t->drives);
}

static void job_has_ended(gpointer user_data)
{
	struct take *t = user_data;
	take_made_refresh(t->made);
}

/* ---- how it looks ---- */

static GtkWidget *card_around(
	const char *icon, const char *title, const char *text, GtkWidget *choose, GtkWidget *button)
{
	GtkWidget *image = gtk_image_new_from_icon_name(icon);
	GtkWidget *texts =
		kit_column(2, kit_text(title, "head"), kit_text(text, "soft small"), NULL);
	gtk_image_set_pixel_size(GTK_IMAGE(image), 36);
	gtk_widget_set_valign(texts, GTK_ALIGN_CENTER);
	GtkWidget *row = kit_row(14, image, kit_grow(texts, true, false), NULL);
	if (choose)
		gtk_box_append(GTK_BOX(row), choose);
	gtk_box_append(GTK_BOX(row), button);
	for (GtkWidget *w = gtk_widget_get_first_child(row); w; w = gtk_widget_get_next_sibling(w))
		gtk_widget_set_valign(w, GTK_ALIGN_CENTER);
	return kit_classed(row, "card");
}

static GtkWidget *card_of(struct take *t, const struct card *card, bool can_draw)
{
	choice *preset = t->preset[card - cards] = choose_preset(t, card);
	GtkWidget *button =
		kit_button(card->name, NULL, _("Make"), NULL, "main", G_CALLBACK(make_pressed), t);
	g_object_set_data(G_OBJECT(button), "card", (gpointer)card);
	gtk_size_group_add_widget(t->buttons, button);
	gtk_widget_set_sensitive(
		button, can_draw || card->kind == EXPORT_REPORT || card->kind == EXPORT_POINTS);
	return card_around(
		card->icon, _(card->title), _(card->text), choice_button(preset), button);
}

static GtkWidget *labelled(const char *label, choice *c)
{
	return kit_grow(
		kit_column(4, kit_text(label, "soft small"), choice_button(c), NULL), true, false);
}

static GtkWidget *build_making(struct take *t)
{
	g_autoptr(GError) error = NULL;
	t->style = choose_style(t);
	t->view = choose_view(t, &error);
	bool can_draw = choice_value(t->view) && choice_value(t->style);
	GtkWidget *what =
		kit_row(12, labelled(_("Style"), t->style), labelled(_("View"), t->view), NULL);
	gtk_box_set_homogeneous(GTK_BOX(what), TRUE);
	GtkWidget *none = kit_named_text("take-none",
		_("There is nothing to draw yet: the site's model has to be computed first."),
		"card doubt");
	gtk_widget_set_visible(what, can_draw);
	gtk_widget_set_visible(none, !can_draw);
	GtkWidget *column = kit_column(12, what, none, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(cards); i++)
		gtk_box_append(GTK_BOX(column), card_of(t, &cards[i], can_draw));
	GtkWidget *scans =
		kit_button("take-scans", NULL, _("Copy"), NULL, NULL, G_CALLBACK(scans_pressed), t);
	gtk_size_group_add_widget(t->buttons, scans);
	gtk_box_append(
		GTK_BOX(column), card_around("drive-harddisk-symbolic", _("Scans"),
					 _("All that was measured, onto a drive."), NULL, scans));
	return column;
}

static GtkWidget *build_taking(struct take *t)
{
	t->jobs = take_jobs_new(t->kiosk, t->site, job_has_ended, t);
	t->made = take_made_new(t->kiosk, t->site);
	t->drives = take_drives_new(t->kiosk, t->site, t->jobs);
	GtkWidget *drives = kit_classed(
		kit_column(12, kit_text(_("Drives"), "head"), take_drives_box(t->drives), NULL),
		"card");
	GtkWidget *made =
		kit_classed(kit_column(10, kit_text(_("Made here"), "head"), take_jobs_box(t->jobs),
				    kit_scroll(take_made_box(t->made)), NULL),
			"card");
	return kit_column(12, drives, made, NULL);
}

static void take_free(gpointer data)
{
	struct take *t = data;
	g_object_unref(t->choices);
	g_object_unref(t->buttons);
	g_free(t->site);
	g_free(t);
}

GtkWidget *screen_take_new(kiosk *k, const char *folder)
{
	struct take *t = g_new0(struct take, 1);
	t->kiosk = k;
	t->site = g_strdup(folder);
	t->choices = gtk_size_group_new(GTK_SIZE_GROUP_HORIZONTAL);
	t->buttons = gtk_size_group_new(GTK_SIZE_GROUP_HORIZONTAL);
	/* On a low screen the cards scroll, on others nothing does. */
	GtkWidget *taking = build_taking(t), *making = kit_scroll(build_making(t));
	GtkWidget *screen = kit_margin(kit_sides(16, making, taking, NULL), 16);
	gtk_box_set_homogeneous(GTK_BOX(screen), TRUE);
	g_object_set_data_full(G_OBJECT(screen), "take", t, take_free);
	return screen;
}
