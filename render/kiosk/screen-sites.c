/* All sites of the folder as cards, and a new one. */
#include "acquire/site.h"
#include "render/kiosk/name-sheet.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/site-sheet.h"
#include "render/kiosk/site-words.h"
#include "render/kiosk/thumbnail.h"
#include <gio/gio.h>

#define CARD_WIDTH   372
#define PICTURE_HIGH 232
#define CLEAR_EACH_S 60

struct sites {
	kiosk *kiosk;
	GtkWidget *widget, *flow, *stack, *nothing;
	GCancellable *gone;
	guint clearing; /* timer */
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

static void listed_anew(gpointer user_data);

static void manage_pressed(GtkButton *b, gpointer user_data)
{
	struct sites *s = user_data;
	site_sheet_open(
		s->kiosk, &(struct site_sheet){ g_object_get_data(G_OBJECT(b), "path"),
				  g_object_get_data(G_OBJECT(b), "title"),
				  g_object_get_data(G_OBJECT(b), "facts"), listed_anew, s });
}

/* In the card's corner: what can be done with the site as a whole. */
static GtkWidget *manage_button(
	struct sites *s, GVariant *about, const char *path, const char *name)
{
	guint64 bytes = 0;
	g_variant_lookup(about, "bytes", "t", &bytes);
	g_autofree char *id = g_strconcat("manage-", name, NULL), *size = g_format_size(bytes);
	g_autofree char *scans = words_scans(
		number(about, "scans"), number(about, "placed"), number(about, "partial"));
	g_autofree char *tip = g_strdup_printf(_("Rename or remove %s"), name);
	GtkWidget *b = kit_button(
		id, "view-more-symbolic", NULL, tip, "over", G_CALLBACK(manage_pressed), s);
	g_object_set_data_full(G_OBJECT(b), "path", g_strdup(path), g_free);
	g_object_set_data_full(G_OBJECT(b), "title", g_strdup(name), g_free);
	g_object_set_data_full(
		G_OBJECT(b), "facts", g_strdup_printf("%s · %s", scans, size), g_free);
	gtk_widget_set_halign(b, GTK_ALIGN_END);
	gtk_widget_set_valign(b, GTK_ALIGN_START);
	return kit_margin(b, 10);
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
	GtkWidget *both = gtk_overlay_new();
	gtk_overlay_set_child(GTK_OVERLAY(both), b);
	gtk_overlay_add_overlay(GTK_OVERLAY(both), manage_button(s, about, path, name));
	return both;
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
		gtk_widget_set_focusable(gtk_widget_get_last_child(s->flow), FALSE);
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

static void listed_anew(gpointer user_data)
{
	refresh(user_data);
}

static gboolean clear_removed(gpointer user_data)
{
	struct sites *s = user_data;
	site_sheet_clear_removed(s->kiosk);
	return G_SOURCE_CONTINUE;
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

static void create(const char *name, gpointer user_data)
{
	struct sites *s = user_data;
	g_autofree char *path = g_build_filename(kiosk_options_of(s->kiosk)->folder, name, NULL);
	g_autofree char *title = g_strdup(name);
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
	kiosk_push(s->kiosk, screen_site_new(s->kiosk, path), "site", title);
}

static void new_pressed(GtkButton *b, gpointer user_data)
{
	struct sites *s = user_data;
	(void)b;
	g_autofree char *name = free_name(kiosk_options_of(s->kiosk)->folder);
	name_sheet_open(s->kiosk, &(struct name_sheet){ .id = "new-site",
					  .title = _("New site"),
					  .label = _("Name of the new site"),
					  .yes = _("Create"),
					  .name = name,
					  .done = create,
					  .user_data = s });
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
	g_clear_handle_id(&s->clearing, g_source_remove);
	g_signal_handlers_disconnect_by_data(jobs, s);
	kiosk_forget_undo(s->kiosk, s);
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
	site_sheet_clear_removed(k);
	s->clearing = g_timeout_add_seconds(CLEAR_EACH_S, clear_removed, s);
	g_signal_connect(jobs, "ended", G_CALLBACK(job_ended_anywhere), s);
	g_signal_connect_swapped(jobs, "notify::g-name-owner", G_CALLBACK(service_changed), s);
	g_signal_connect_swapped(s->widget, "map", G_CALLBACK(refresh), s);
	g_signal_connect(s->widget, "destroy", G_CALLBACK(destroyed), s);
	g_object_set_data_full(G_OBJECT(s->widget), "screen", s, sites_free);
	return s->widget;
}
