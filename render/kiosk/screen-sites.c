/* All sites of the folder as cards, and a new one. */
#include "acquire/site.h"
#include "render/kiosk/keyboard.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/site-words.h"
#include "render/kiosk/thumbnail.h"
#include <string.h>

#define CARD_WIDTH   372
#define PICTURE_HIGH 232

struct sites {
	kiosk *kiosk;
	GtkWidget *widget, *flow, *stack, *nothing;
	GtkWidget *name; /* entry of the sheet */
	GCancellable *gone;
};

/* ---- cards ---- */

static void opened(GtkButton *b, gpointer user_data)
{
	struct sites *s = user_data;
	const char *path = g_object_get_data(G_OBJECT(b), "path");
	const char *title = g_object_get_data(G_OBJECT(b), "title");
	const char *error = g_object_get_data(G_OBJECT(b), "error");
	if (error)
		kiosk_complain(s->kiosk, error,
			_("Copy the folder to a safe place before anybody "
			  "changes it."));
	else
		kiosk_push(s->kiosk, screen_site_new(s->kiosk, path), "site", title);
}

static guint number(GVariant *about, const char *key)
{
	guint32 n = 0;
	g_variant_lookup(about, key, "u", &n);
	return n;
}

static GtkWidget *words_of(GVariant *about, const char *name, const char *error)
{
	gint64 changed = 0;
	g_variant_lookup(about, "changed", "x", &changed);
	g_autofree char *date = words_date(changed);
	g_autofree char *scans = words_scans(
		number(about, "scans"), number(about, "placed"), number(about, "partial"));
	GtkWidget *line =
		error ? kit_line("card-error", _("Cannot be read"), "bad", true)
		      : kit_row(8,
				kit_grow(kit_line("card-scans", scans, "soft", true), true, false),
				kit_line("card-date", date, "soft", false), NULL);
	return kit_classed(
		kit_column(4, kit_line("card-name", name, "head", true), line, NULL), "words");
}

static GtkWidget *card(struct sites *s, GVariant *about)
{
	const char *path = "", *name = "", *error = NULL;
	g_variant_lookup(about, "path", "&s", &path);
	g_variant_lookup(about, "name", "&s", &name);
	g_variant_lookup(about, "error", "&s", &error);
	GtkWidget *picture = gtk_picture_new();
	GtkWidget *frame = gtk_overlay_new(), *room = gtk_box_new(GTK_ORIENTATION_VERTICAL, 0);
	/* All cards are of one size, whatever their pictures are. */
	gtk_widget_set_size_request(room, CARD_WIDTH, PICTURE_HIGH);
	gtk_overlay_set_child(GTK_OVERLAY(frame), room);
	gtk_overlay_add_overlay(GTK_OVERLAY(frame), picture);
	gtk_picture_set_content_fit(GTK_PICTURE(picture), GTK_CONTENT_FIT_COVER);
	GtkWidget *b = gtk_button_new();
	gtk_button_set_child(
		GTK_BUTTON(b), kit_column(0, frame, words_of(about, name, error), NULL));
	kit_classed(b, "site");
	g_autofree char *id = g_strconcat("site-", name, NULL);
	gtk_widget_set_name(b, id);
	gtk_widget_set_overflow(b, GTK_OVERFLOW_HIDDEN);
	gtk_accessible_update_property(GTK_ACCESSIBLE(b), GTK_ACCESSIBLE_PROPERTY_LABEL, name, -1);
	g_object_set_data_full(G_OBJECT(b), "path", g_strdup(path), g_free);
	g_object_set_data_full(G_OBJECT(b), "title", g_strdup(name), g_free);
	g_object_set_data_full(
		G_OBJECT(b), "error", error && *error ? g_strdup(error) : NULL, g_free);
	g_signal_connect(b, "clicked", G_CALLBACK(opened), s);
	gboolean has_model = FALSE;
	g_variant_lookup(about, "model", "b", &has_model);
	if (has_model)
		thumbnail_show(path, GTK_PICTURE(picture));
	return b;
}

/* ---- the list ---- */

static void fill(struct sites *s, GVariant *sites)
{
	GtkWidget *child;
	while ((child = gtk_widget_get_first_child(s->flow)))
		gtk_flow_box_remove(GTK_FLOW_BOX(s->flow), child);
	for (gsize i = 0; i < g_variant_n_children(sites); i++) {
		g_autoptr(GVariant) one = g_variant_get_child_value(sites, i);
		gtk_flow_box_append(GTK_FLOW_BOX(s->flow), card(s, one));
	}
	gtk_stack_set_visible_child_name(
		GTK_STACK(s->stack), g_variant_n_children(sites) ? "cards" : "nothing");
}

static void listed(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GVariant) sites = NULL;
	bool good = bus_jobs1_call_list_sites_finish(BUS_JOBS1(source), &sites, result, &error);
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct sites *s = user_data;
	if (good) {
		fill(s, sites);
		return;
	}
	/* On its way: it is asked again when it is there. */
	if (services_has_jobs(kiosk_services(s->kiosk)))
		kiosk_complain_of(s->kiosk, error);
}

static void refresh(struct sites *s)
{
	bus_jobs1_call_list_sites(services_jobs(kiosk_services(s->kiosk)),
		kiosk_options_of(s->kiosk)->folder, s->gone, listed, s);
}

static void job_ended_anywhere(BusJobs1 *jobs, const char *job, const char *kind,
	const char *folder, const char *state, gpointer user_data)
{
	struct sites *s = user_data;
	(void)jobs;
	(void)job;
	(void)kind;
	(void)folder;
	(void)state;
	if (gtk_widget_get_mapped(s->widget))
		refresh(s);
}

static void service_changed(struct sites *s)
{
	if (services_has_jobs(kiosk_services(s->kiosk)))
		refresh(s);
}

/* ---- a new site ---- */

static char *free_name(const char *folder)
{
	for (int n = 1;; n++) {
		g_autofree char *name = g_strdup_printf(_("Site %d"), n);
		g_autofree char *path = g_build_filename(folder, name, NULL);
		if (!g_file_test(path, G_FILE_TEST_EXISTS))
			return g_steal_pointer(&name);
	}
}

/* NULL and a sentence: no folder can be called so. */
static const char *refusal(const char *name)
{
	if (!*name)
		return _("Give the site a name.");
	if (name[0] == '.' || strchr(name, '/') || strlen(name) > 120)
		return _("A name has no slash, does not begin with a dot, and has at most 120 "
			 "letters.");
	return NULL;
}

static void create_pressed(GtkWidget *w, gpointer user_data)
{
	struct sites *s = user_data;
	g_autofree char *name = g_strstrip(g_strdup(gtk_editable_get_text(GTK_EDITABLE(s->name))));
	const char *why = refusal(name);
	(void)w;
	if (why) {
		kiosk_complain(s->kiosk, why, NULL);
		return;
	}
	g_autofree char *path = g_build_filename(kiosk_options_of(s->kiosk)->folder, name, NULL);
	g_autoptr(GError) error = NULL;
	if (g_file_test(path, G_FILE_TEST_EXISTS)) {
		kiosk_complain(s->kiosk, _("There is a site of that name already."), NULL);
		return;
	}
	g_autoptr(site) made = site_open_for_writing(path, &error);
	if (!made) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	kiosk_close_sheet(s->kiosk);
	kiosk_push(s->kiosk, screen_site_new(s->kiosk, path), "site", name);
}

static void cancel_pressed(GtkButton *b, gpointer user_data)
{
	struct sites *s = user_data;
	(void)b;
	kiosk_close_sheet(s->kiosk);
}

static void new_pressed(GtkButton *b, gpointer user_data)
{
	struct sites *s = user_data;
	(void)b;
	g_autofree char *name = free_name(kiosk_options_of(s->kiosk)->folder);
	s->name = gtk_entry_new();
	gtk_editable_set_text(GTK_EDITABLE(s->name), name);
	gtk_widget_set_name(s->name, "new-site-name");
	gtk_accessible_update_property(GTK_ACCESSIBLE(s->name), GTK_ACCESSIBLE_PROPERTY_LABEL,
		_("Name of the new site"), -1);
	g_signal_connect(s->name, "activate", G_CALLBACK(create_pressed), s);
	GtkWidget *buttons = kit_row(16,
		kit_grow(kit_button("new-site-cancel", NULL, _("Cancel"), NULL, "great",
				 G_CALLBACK(cancel_pressed), s),
			true, false),
		kit_grow(kit_button("new-site-create", NULL, _("Create"), NULL, "main great",
				 G_CALLBACK(create_pressed), s),
			true, false),
		NULL);
	GtkWidget *sheet = kit_column(16, kit_text(_("New site"), "title"), s->name,
		keyboard_new(GTK_EDITABLE(s->name)), buttons, NULL);
	gtk_widget_set_size_request(sheet, kit_is_upright() ? -1 : 760, -1);
	kiosk_open_sheet(s->kiosk, sheet);
	gtk_editable_select_region(GTK_EDITABLE(s->name), 0, -1);
}

/* ---- building ---- */

static GtkWidget *cards_page(struct sites *s)
{
	s->flow = gtk_flow_box_new();
	gtk_flow_box_set_selection_mode(GTK_FLOW_BOX(s->flow), GTK_SELECTION_NONE);
	gtk_flow_box_set_max_children_per_line(GTK_FLOW_BOX(s->flow), 6);
	gtk_flow_box_set_row_spacing(GTK_FLOW_BOX(s->flow), 20);
	gtk_flow_box_set_column_spacing(GTK_FLOW_BOX(s->flow), 20);
	gtk_flow_box_set_homogeneous(GTK_FLOW_BOX(s->flow), TRUE);
	gtk_widget_set_valign(s->flow, GTK_ALIGN_START);
	gtk_widget_set_halign(s->flow, GTK_ALIGN_START);
	return kit_scroll(kit_margin(s->flow, 24));
}

static GtkWidget *nothing_page(void)
{
	GtkWidget *page = kit_column(12, kit_text(_("No sites yet"), "large"),
		kit_text(_("A site is one place that you scan from several stations."), "soft"),
		NULL);
	gtk_widget_set_halign(page, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(page, GTK_ALIGN_CENTER);
	return page;
}

static GtkWidget *wait_page(void)
{
	GtkWidget *spinner = gtk_spinner_new();
	gtk_spinner_start(GTK_SPINNER(spinner));
	gtk_widget_set_size_request(spinner, 56, 56);
	gtk_widget_set_halign(spinner, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(spinner, GTK_ALIGN_CENTER);
	return spinner;
}

static void build(struct sites *s)
{
	GtkWidget *make = kit_button("new-site", "list-add-symbolic", _("New site"), NULL,
		"main great", G_CALLBACK(new_pressed), s);
	s->stack = kit_grow(gtk_stack_new(), true, true);
	gtk_stack_add_named(GTK_STACK(s->stack), wait_page(), "wait");
	gtk_stack_add_named(GTK_STACK(s->stack), cards_page(s), "cards");
	gtk_stack_add_named(GTK_STACK(s->stack), nothing_page(), "nothing");
	gtk_widget_set_halign(make, GTK_ALIGN_END);
	gtk_widget_set_margin_end(make, 24);
	gtk_widget_set_margin_bottom(make, 20);
	gtk_widget_set_margin_top(make, 12);
	s->widget = kit_column(0, s->stack, make, NULL);
}

static void destroyed(GtkWidget *w, gpointer user_data)
{
	struct sites *s = user_data;
	BusJobs1 *jobs = services_jobs(kiosk_services(s->kiosk));
	(void)w;
	g_cancellable_cancel(s->gone);
	g_signal_handlers_disconnect_by_data(jobs, s);
}

static void sites_free(gpointer data)
{
	struct sites *s = data;
	g_clear_object(&s->gone);
	g_free(s);
}

GtkWidget *screen_sites_new(kiosk *k)
{
	struct sites *s = g_new0(struct sites, 1);
	BusJobs1 *jobs = services_jobs(kiosk_services(k));
	s->kiosk = k;
	s->gone = g_cancellable_new();
	build(s);
	g_signal_connect(jobs, "ended", G_CALLBACK(job_ended_anywhere), s);
	g_signal_connect_swapped(jobs, "notify::g-name-owner", G_CALLBACK(service_changed), s);
	g_signal_connect_swapped(s->widget, "map", G_CALLBACK(refresh), s);
	g_signal_connect(s->widget, "destroy", G_CALLBACK(destroyed), s);
	g_object_set_data_full(G_OBJECT(s->widget), "screen", s, sites_free);
	return s->widget;
}
