#include "render/kiosk/kiosk-private.h"
#include "render/kiosk/kiosk-probe.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/sleep.h"
#include "render/kiosk/theme.h"
#include <gio/gio.h>
#include <unistd.h>

/* ---- screens ---- */

static void show_bar(kiosk *k)
{
	guint n = k->titles->len;
	kit_set_text(k->title, n ? g_ptr_array_index(k->titles, n - 1) : "");
	gtk_widget_set_visible(k->back, n > 1);
	if (n)
		kiosk_probe_set("screen", "%s", kiosk_screen(k));
	guint undos = k->undos->len;
	gtk_widget_set_sensitive(k->undo, undos > 0);
	const struct undo *u = undos ? g_ptr_array_index(k->undos, undos - 1) : NULL;
	g_autofree char *tip = u ? g_strdup_printf(_("Undo: %s"), u->did) : g_strdup(_("Undo"));
	gtk_widget_set_tooltip_text(k->undo, tip);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(k->undo), GTK_ACCESSIBLE_PROPERTY_LABEL, tip, -1);
}

static GtkWidget *front(kiosk *k)
{
	return gtk_stack_get_visible_child(GTK_STACK(k->stack));
}

void kiosk_push(kiosk *k, GtkWidget *screen, const char *name, const char *title)
{
	g_autofree char *page = g_strdup_printf("%u-%s", k->titles->len, name);
	gtk_widget_set_name(screen, name);
	g_ptr_array_add(k->titles, g_strdup(title));
	gtk_stack_add_named(GTK_STACK(k->stack), screen, page);
	gtk_stack_set_visible_child(GTK_STACK(k->stack), screen);
	show_bar(k);
}

void kiosk_back(kiosk *k)
{
	GtkWidget *gone = front(k), *before = gone ? gtk_widget_get_prev_sibling(gone) : NULL;
	kiosk_close_sheet(k);
	if (!before)
		return;
	gtk_stack_set_visible_child(GTK_STACK(k->stack), before);
	g_ptr_array_remove_index(k->titles, k->titles->len - 1);
	gtk_stack_remove(GTK_STACK(k->stack), gone);
	show_bar(k);
}

const char *kiosk_screen(const kiosk *k)
{
	GtkWidget *w = front((kiosk *)k);
	return w ? gtk_widget_get_name(w) : "";
}

/* ---- undo ---- */

static void undo_free(gpointer data)
{
	struct undo *u = data;
	if (u->data_free)
		u->data_free(u->data);
	g_free(u->did);
	g_free(u);
}

void kiosk_did(kiosk *k, const char *did, void (*undo)(gpointer data), gpointer data,
	GDestroyNotify data_free, gpointer owner)
{
	struct undo *u = g_new0(struct undo, 1);
	*u = (struct undo){ g_strdup(did), undo, data, data_free, owner };
	g_ptr_array_add(k->undos, u);
	show_bar(k);
}

void kiosk_forget_undo(kiosk *k, gpointer owner)
{
	for (guint i = k->undos->len; i-- > 0;)
		if (((struct undo *)g_ptr_array_index(k->undos, i))->owner == owner)
			g_ptr_array_remove_index(k->undos, i);
	show_bar(k);
}

static void undo_pressed(GtkButton *button, gpointer user_data)
{
	kiosk *k = user_data;
	(void)button;
	if (!k->undos->len)
		return;
	struct undo *u = g_ptr_array_steal_index(k->undos, k->undos->len - 1);
	g_autofree char *said = g_strdup_printf(_("Taken back: %s"), u->did);
	u->undo(u->data);
	undo_free(u);
	kiosk_say(k, said);
	show_bar(k);
}

/* ---- the window ---- */

static void back_pressed(GtkButton *button, gpointer user_data)
{
	(void)button;
	kiosk_back(user_data);
}

static void theme_pressed(GtkButton *button, gpointer user_data)
{
	kiosk *k = user_data;
	(void)button;
	kiosk_set_dark(k, !k->options.dark);
	theme_keep(k->options.dark);
}

static void status_pressed(GtkButton *button, gpointer user_data)
{
	kiosk *k = user_data;
	(void)button;
	if (g_strcmp0(kiosk_screen(k), "health"))
		kiosk_push(k, screen_health_new(k), "health", _("Health"));
}

static GtkWidget *build_bar(kiosk *k)
{
	k->back = kit_button("back", "go-previous-symbolic", NULL, _("Back"), "flat",
		G_CALLBACK(back_pressed), k);
	k->title = kit_line("screen-title", "", "title", true);
	k->undo = kit_button(
		"undo", "edit-undo-symbolic", NULL, _("Undo"), "flat", G_CALLBACK(undo_pressed), k);
	k->theme = kit_button("theme", "weather-clear-night-symbolic", NULL, _("Light or dark"),
		"flat", G_CALLBACK(theme_pressed), k);
	k->status = status_new(k->services, k->options.folder, G_CALLBACK(status_pressed), k);
	GtkWidget *bar = kit_row(8, k->back, kit_grow(k->title, true, false),
		status_widget(k->status), k->undo, k->theme, NULL);
	for (GtkWidget *w = gtk_widget_get_first_child(bar); w; w = gtk_widget_get_next_sibling(w))
		gtk_widget_set_valign(w, GTK_ALIGN_CENTER);
	return kit_classed(bar, "bar");
}

static gboolean key_pressed(
	GtkEventControllerKey *c, guint key, guint code, GdkModifierType m, gpointer user_data)
{
	kiosk *k = user_data;
	(void)c;
	(void)code;
	if (key == GDK_KEY_Escape && gtk_widget_get_visible(k->shade)) {
		kiosk_close_sheet(k);
		return GDK_EVENT_STOP;
	}
	if (key == GDK_KEY_Escape || (key == GDK_KEY_Left && (m & GDK_ALT_MASK))) {
		kiosk_back(k);
		return GDK_EVENT_STOP;
	}
	if (key == GDK_KEY_z && (m & GDK_CONTROL_MASK)) {
		undo_pressed(NULL, k);
		return GDK_EVENT_STOP;
	}
	return GDK_EVENT_PROPAGATE;
}

static void service_came(const char *sentence, gpointer user_data)
{
	kiosk_say(user_data, sentence);
}

static void service_went(const char *sentence, gpointer user_data)
{
	kiosk_complain(user_data, sentence, NULL);
}

static gboolean close_asked(GtkWindow *window, gpointer user_data)
{
	kiosk *k = user_data;
	(void)window;
	k->closed(k->closed_data);
	return GDK_EVENT_STOP;
}

static void build_content(kiosk *k)
{
	k->stack = kit_grow(gtk_stack_new(), true, true);
	gtk_stack_set_hhomogeneous(GTK_STACK(k->stack), FALSE);
	gtk_stack_set_vhomogeneous(GTK_STACK(k->stack), FALSE);
	k->overlay = gtk_overlay_new();
	/* What needs more than a small screen has is dragged to: a window that is larger than the screen ends the program. */
	GtkWidget *scroll = gtk_scrolled_window_new();
	gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scroll), k->stack);
	gtk_widget_set_focusable(scroll, FALSE);
	k->under = kit_column(0, build_bar(k), kit_grow(scroll, true, true), NULL);
	gtk_overlay_set_child(GTK_OVERLAY(k->overlay), k->under);
	kiosk_build_says(k);
	sleep_add(k->window, k->overlay, k->options.asleep_after_s);
	gtk_window_set_child(GTK_WINDOW(k->window), k->overlay);
}

static void build_window(kiosk *k)
{
	k->window = gtk_window_new();
	g_signal_connect(k->window, "close-request", G_CALLBACK(close_asked), k);
	kit_classed(k->window, "kiosk");
	gtk_window_set_title(GTK_WINDOW(k->window), "pleinair");
	gtk_window_set_default_size(GTK_WINDOW(k->window), k->options.width, k->options.height);
	build_content(k);
	GtkEventController *keys = gtk_event_controller_key_new();
	g_signal_connect(keys, "key-pressed", G_CALLBACK(key_pressed), k);
	gtk_widget_add_controller(k->window, keys);
	if (k->options.fullscreen)
		gtk_window_fullscreen(GTK_WINDOW(k->window));
}

/* ---- as people like it ---- */

void kiosk_set_dark(kiosk *k, bool dark)
{
	k->options.dark = dark;
	theme_use(dark);
}

void kiosk_set_asleep_after(kiosk *k, double seconds)
{
	k->options.asleep_after_s = seconds;
	sleep_after(k->window, seconds);
}

/* Screens go before what they speak to. */
static void take_down(kiosk *k)
{
	GtkWidget *child;
	g_clear_handle_id(&k->toast_timer, g_source_remove);
	g_queue_clear_full(&k->toasts, g_free);
	g_clear_handle_id(&k->start_over, g_source_remove);
	kiosk_close_sheet(k);
	while ((child = gtk_widget_get_last_child(k->stack)))
		gtk_stack_remove(GTK_STACK(k->stack), child);
	g_ptr_array_set_size(k->titles, 0);
	status_free(k->status);
	k->status = NULL;
}

static gboolean start_over(gpointer user_data)
{
	kiosk *k = user_data;
	k->start_over = 0;
	take_down(k);
	g_ptr_array_set_size(k->undos, 0);
	build_content(k);
	kiosk_push(k, screen_sites_new(k), "sites", _("Sites"));
	return G_SOURCE_REMOVE;
}

void kiosk_start_over(kiosk *k)
{
	if (!k->start_over)
		k->start_over = g_idle_add(start_over, k);
}

void kiosk_close(kiosk *k)
{
	gtk_window_close(GTK_WINDOW(k->window));
}

/* ---- from start to end ---- */

/* Turning it starts the program anew. */
static bool stands_upright(const struct kiosk_options *o)
{
	GdkRectangle screen = { 0, 0, o->width, o->height };
	GListModel *all = gdk_display_get_monitors(gdk_display_get_default());
	g_autoptr(GdkMonitor) first = o->fullscreen ? g_list_model_get_item(all, 0) : NULL;
	if (first)
		gdk_monitor_get_geometry(first, &screen);
	return screen.height > screen.width;
}

static char *journal_path(void)
{
	g_autofree char *folder = g_build_filename(g_get_user_state_dir(), "pleinair", NULL);
	g_mkdir_with_parents(folder, 0700);
	return g_build_filename(folder, "kiosk.log", NULL);
}

/* Is there while a screen runs: when one finds it at its start, the last one was killed. */
static char *running_path(void)
{
	return g_build_filename(g_get_user_state_dir(), "pleinair", "kiosk-runs", NULL);
}

static void say_how_it_ended(kiosk *k)
{
	g_autofree char *path = running_path();
	if (g_file_test(path, G_FILE_TEST_EXISTS))
		kiosk_say(
			k, _("The screen had stopped unexpectedly and was started again. Scans and "
			     "jobs went on meanwhile."));
	g_file_set_contents(path, "", 0, NULL);
}

/* A scan that goes on is what people want to see first. */
static void go_to_scan(kiosk *k)
{
	BusAcquisition1 *a = services_acquisition(k->services);
	const char *state = bus_acquisition1_get_state(a), *folder = bus_acquisition1_get_site(a);
	g_autofree char *name = folder ? g_path_get_basename(folder) : NULL;
	if (!state || !strcmp(state, "idle") || !strcmp(state, "paused") || !folder || !*folder)
		return;
	kiosk_push(k, screen_site_new(k, folder), "site", name);
	kiosk_push(k, screen_scan_new(k), "scan", _("Scanning"));
}

kiosk *kiosk_new(services *s, const struct kiosk_options *options,
	void (*closed)(gpointer user_data), gpointer user_data)
{
	kiosk *k = g_new0(kiosk, 1);
	g_autofree char *log = journal_path();
	k->options = *options;
	k->services = s;
	k->journal = journal_new(log);
	k->titles = g_ptr_array_new_with_free_func(g_free);
	k->undos = g_ptr_array_new_with_free_func(undo_free);
	theme_use(k->options.dark);
	kit_set_upright(stands_upright(options));
	k->closed = closed;
	k->closed_data = user_data;
	build_window(k);
	services_watch(s, &(struct services_watcher){ service_came, service_went, k });
	kiosk_push(k, screen_sites_new(k), "sites", _("Sites"));
	go_to_scan(k);
	gtk_window_present(GTK_WINDOW(k->window));
	say_how_it_ended(k);
	return k;
}

void kiosk_free(kiosk *k)
{
	if (!k)
		return;
	g_autofree char *path = running_path();
	services_watch(k->services, &(struct services_watcher){ 0 });
	take_down(k);
	gtk_window_destroy(GTK_WINDOW(k->window));
	g_ptr_array_unref(k->undos);
	g_ptr_array_unref(k->titles);
	journal_free(k->journal);
	services_free(k->services);
	unlink(path);
	g_free(k);
}

services *kiosk_services(kiosk *k)
{
	return k->services;
}

const struct kiosk_options *kiosk_options_of(const kiosk *k)
{
	return &k->options;
}

struct journal *kiosk_journal(kiosk *k)
{
	return k->journal;
}
