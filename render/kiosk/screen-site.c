/* One site: how its scans fit, what it looks like, and the next scan. */
#include "acquire/service.h"
#include "render/kiosk/easel.h"
#include "render/kiosk/preset-chooser.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/site-map.h"
#include "render/kiosk/site-words.h"
#include <gio/gio.h>

#define SIDE_WIDTH 420
#define STYLE      "figure-7c"

struct site_screen {
	kiosk *kiosk;
	char *folder;
	GtkWidget *widget, *stack, *empty_text;
	GtkWidget *map, *words, *chooser, *scan, *bring, *resume, *discard, *align, *draw, *take;
	GtkWidget *work, *work_words, *work_bar, *work_cancel;
	GCancellable *gone;
	site_state *state; /* NULL: not read yet */
	easel *easel;
	job_watch *job;
	bool asked; /* what is out of date was asked for already */
	bool looks; /* the job is for a first look only */
	/* A scan comes before all else: the computing is stopped for it, and begins again after. */
	bool scan_waits, scan_starts;
};

static void reload(struct site_screen *s);
static void start_scan(struct site_screen *s);

/* ---- what is computed ---- */

static void show_work(struct site_screen *s, bool visible)
{
	gtk_widget_set_visible(s->work, visible);
}

static void work_goes_on(
	double fraction, const char *doing, double seconds_left, gpointer user_data)
{
	struct site_screen *s = user_data;
	g_autofree char *left = words_duration(seconds_left);
	g_autofree char *words = g_strdup_printf(*left ? _("%s, %s left") : "%s%s",
		doing && *doing ? words_doing(doing) : _("Computing"), left);
	kit_set_text(s->work_words, words);
	gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(s->work_bar), CLAMP(fraction, 0, 1));
}

static void compute(struct site_screen *s, bool looks);

static void work_ended(
	const char *state, const char *result, const char *sentence, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)result;
	s->job = NULL;
	if (s->looks && !s->scan_waits && !g_strcmp0(state, "done")) {
		compute(s, false);
		reload(s);
		return;
	}
	show_work(s, false);
	if (s->scan_waits) {
		s->asked = false;
		start_scan(s);
		return;
	}
	if (!g_strcmp0(state, "failed"))
		kiosk_complain(s->kiosk, sentence, NULL);
	reload(s);
}

/* A first look is there while one still stands on the spot; all else takes its time. */
static void compute(struct site_screen *s, bool looks)
{
	g_auto(GVariantDict) options = G_VARIANT_DICT_INIT(NULL);
	if (looks)
		g_variant_dict_insert(&options, "to", "s", "look");
	s->looks = looks;
	s->job = services_start_job(kiosk_services(s->kiosk), "process", s->folder,
		g_variant_dict_end(&options), work_goes_on, work_ended, s);
}

/* Then nobody else can write to the site. */
static bool is_scanned(const struct site_screen *s)
{
	BusAcquisition1 *a = services_acquisition(kiosk_services(s->kiosk));
	const char *state = bus_acquisition1_get_state(a);
	return s->scan_starts || (state && strcmp(state, "idle") && strcmp(state, "paused") &&
					 !g_strcmp0(bus_acquisition1_get_site(a), s->folder));
}

static void start_work(struct site_screen *s)
{
	if (s->job || is_scanned(s) || !services_has_jobs(kiosk_services(s->kiosk)))
		return;
	s->asked = true;
	work_goes_on(0, NULL, -1, s);
	show_work(s, true);
	compute(s, true);
}

static void cancel_pressed(GtkButton *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	if (s->job)
		job_watch_cancel(s->job);
}

/* ---- showing ---- */

static void show_buttons(struct site_screen *s)
{
	const site_state *st = s->state;
	bool acquiring = services_has_acquisition(kiosk_services(s->kiosk));
	gtk_widget_set_visible(s->scan, !st || !st->partial);
	gtk_widget_set_visible(s->bring, !st || !st->partial);
	gtk_widget_set_visible(s->chooser, !st || !st->partial);
	gtk_widget_set_visible(s->resume, st && st->partial);
	gtk_widget_set_visible(s->discard, st && st->partial);
	gtk_widget_set_sensitive(s->scan, st && acquiring);
	gtk_widget_set_sensitive(s->bring, st && services_has_jobs(kiosk_services(s->kiosk)));
	gtk_widget_set_sensitive(s->resume, acquiring);
	gtk_widget_set_sensitive(s->align, st && st->scans->len > 1);
	gtk_widget_set_sensitive(s->draw, st && st->drawn);
	gtk_widget_set_sensitive(s->take, st && st->scans->len);
	if (st && st->refused_a)
		kit_classed(s->align, "main");
	else
		gtk_widget_remove_css_class(s->align, "main");
}

static void show_drawn(struct site_screen *s)
{
	g_autoptr(GError) error = NULL;
	const site_state *st = s->state;
	easel_set_site(s->easel, st->drawn);
	if (!st->drawn) {
		kit_set_text(s->empty_text,
			st->why_not      ? st->why_not
			: st->scans->len ? _("The drawing comes when the scans are computed.")
					 : _("Here the place will be drawn."));
		gtk_stack_set_visible_child_name(GTK_STACK(s->stack), "empty");
		return;
	}
	drawing *d = drawn_site_style(st->drawn, STYLE, &error);
	g_autoptr(view) v = view_built_in(&st->drawn->sources, "overview");
	if (d && v) {
		struct looking l = looking_of_view(v);
		easel_set_drawing(s->easel, d, false);
		easel_look(s->easel, &l, 0);
		gtk_stack_set_visible_child_name(GTK_STACK(s->stack), "drawn");
	} else
		drawing_free(d);
	kiosk_complain_of(s->kiosk, error);
}

static void show_state(struct site_screen *s)
{
	const char *verdict;
	g_autofree char *words = site_state_words(s->state, &verdict);
	kit_set_text(s->words, words);
	kit_set_verdict(s->words, verdict);
	site_map_show(s->map, s->state);
	show_drawn(s);
	show_buttons(s);
}

/* ---- reading ---- */

static void read_state(GTask *task, gpointer source, gpointer data, GCancellable *cancel)
{
	g_autoptr(GError) error = NULL;
	(void)source;
	(void)cancel;
	site_state *state = site_state_new(data, &error);
	if (state)
		g_task_return_pointer(task, state, (GDestroyNotify)site_state_free);
	else
		g_task_return_error(task, g_steal_pointer(&error));
}

static void state_read(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	site_state *state = g_task_propagate_pointer(G_TASK(result), &error);
	(void)source;
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct site_screen *s = user_data;
	if (!state) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	site_map_show(s->map, NULL);
	easel_set_site(s->easel, NULL);
	site_state_free(s->state);
	s->state = state;
	show_state(s);
	if (state->needs_work && !s->asked)
		start_work(s);
}

static void reload(struct site_screen *s)
{
	GTask *task = g_task_new(NULL, s->gone, state_read, s);
	g_task_set_task_data(task, g_strdup(s->folder), g_free);
	g_task_run_in_thread(task, read_state);
	g_object_unref(task);
}

static void scan_finished(BusAcquisition1 *a, const char *folder, guint number, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)a;
	(void)number;
	if (g_strcmp0(folder, s->folder))
		return;
	s->asked = false;
	reload(s);
}

static void service_changed(struct site_screen *s)
{
	show_buttons(s);
	if (s->state && s->state->needs_work && !s->asked)
		start_work(s);
}

/* ---- pressed ---- */

static void show_scan(struct site_screen *s)
{
	kiosk_push(s->kiosk, screen_scan_new(s->kiosk), "scan", _("Scanning"));
}

static void started(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	bool good =
		bus_acquisition1_call_start_finish(BUS_ACQUISITION1(source), NULL, result, &error);
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct site_screen *s = user_data;
	s->scan_starts = false;
	gtk_widget_set_sensitive(s->scan, TRUE);
	kiosk_complain_of(s->kiosk, error);
	if (good)
		show_scan(s);
	else
		reload(s);
}

static void resume(struct site_screen *s, bool salvage);

static void salvage_is_sure(GtkButton *b, gpointer user_data)
{
	(void)b;
	resume(user_data, true);
}

/* What is whole of the record can be gone on with. */
static bool is_damaged(const GError *error)
{
	g_autofree char *name = error ? g_dbus_error_get_remote_error(error) : NULL;
	return !g_strcmp0(name, SERVICE_ERROR_DAMAGED_NAME);
}

static void resumed(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	bool good =
		bus_acquisition1_call_resume_finish(BUS_ACQUISITION1(source), NULL, result, &error);
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct site_screen *s = user_data;
	if (is_damaged(error)) {
		g_dbus_error_strip_remote_error(error);
		g_autofree char *text = g_strdup_printf(
			_("%s\n\nWhat is whole of it can be gone on with: the rest is scanned once "
			  "more, and the damaged file stays beside it."),
			error->message);
		kiosk_ask(s->kiosk, _("The record of this scan is damaged"), text,
			_("Go on without it"), G_CALLBACK(salvage_is_sure), s);
		return;
	}
	kiosk_complain_of(s->kiosk, error);
	if (good)
		show_scan(s);
}

static void start_scan(struct site_screen *s)
{
	const char *preset = preset_chooser_preset(s->chooser);
	g_auto(GVariantDict) options = G_VARIANT_DICT_INIT(NULL);
	g_variant_dict_insert(&options, "hdr", "b", preset_chooser_hdr(s->chooser));
	s->scan_waits = false;
	s->scan_starts = true;
	bus_acquisition1_call_start(services_acquisition(kiosk_services(s->kiosk)), s->folder,
		preset, g_variant_dict_end(&options), s->gone, started, s);
}

static void scan_pressed(GtkButton *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	if (!preset_chooser_preset(s->chooser))
		return;
	gtk_widget_set_sensitive(s->scan, FALSE);
	s->scan_waits = s->job != NULL;
	if (s->job)
		job_watch_cancel(s->job);
	else
		start_scan(s);
}

static void resume(struct site_screen *s, bool salvage)
{
	bus_acquisition1_call_resume(services_acquisition(kiosk_services(s->kiosk)), s->folder,
		salvage, s->gone, resumed, s);
}

static void resume_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	resume(user_data, false);
}

static void discarded(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	bus_acquisition1_call_discard_finish(BUS_ACQUISITION1(source), result, &error);
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct site_screen *s = user_data;
	kiosk_complain_of(s->kiosk, error);
	reload(s);
}

static void discard_is_sure(GtkButton *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	bus_acquisition1_call_discard(
		services_acquisition(kiosk_services(s->kiosk)), s->folder, s->gone, discarded, s);
}

static void discard_pressed(GtkButton *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	kiosk_ask(s->kiosk, _("Throw the unfinished scan away?"),
		_("What it has recorded so far is removed for good. The finished scans stay."),
		_("Throw away"), G_CALLBACK(discard_is_sure), s);
}

static void align_pressed(GtkButton *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	kiosk_push(s->kiosk,
		screen_align_new(s->kiosk, s->folder, s->state->refused_a, s->state->refused_b),
		"align", _("Align"));
}

static void draw_pressed(GtkWidget *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	kiosk_push(s->kiosk, screen_draw_new(s->kiosk, s->folder), "draw", s->state->name);
}

static void take_pressed(GtkButton *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	kiosk_push(s->kiosk, screen_take_new(s->kiosk, s->folder), "take", _("Take home"));
}

static void bring_pressed(GtkButton *b, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)b;
	/* What comes in is computed, whatever became of what was asked for before. */
	s->asked = false;
	kiosk_push(s->kiosk, screen_bring_new(s->kiosk, s->folder), "bring", _("Bring in scans"));
}

static void picture_tapped(const struct scene_picked *picked, gpointer user_data)
{
	struct site_screen *s = user_data;
	(void)picked;
	draw_pressed(NULL, s);
}

static void picture_failed(const char *sentence, gpointer user_data)
{
	struct site_screen *s = user_data;
	kiosk_complain(s->kiosk, sentence, NULL);
}

/* ---- building ---- */

static GtkWidget *picture_side(struct site_screen *s)
{
	s->empty_text = kit_named_text("site-empty", "", "head soft");
	gtk_label_set_justify(GTK_LABEL(s->empty_text), GTK_JUSTIFY_CENTER);
	gtk_widget_set_halign(s->empty_text, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(s->empty_text, GTK_ALIGN_CENTER);
	s->stack = kit_grow(gtk_stack_new(), true, true);
	gtk_stack_add_named(GTK_STACK(s->stack), s->empty_text, "empty");
	gtk_stack_add_named(GTK_STACK(s->stack), easel_widget(s->easel), "drawn");
	s->draw = kit_button("site-draw", "image-x-generic-symbolic", _("Draw"), NULL, "great",
		G_CALLBACK(draw_pressed), s);
	s->align = kit_button("site-align", "insert-link-symbolic", _("Align"), NULL, "great",
		G_CALLBACK(align_pressed), s);
	s->take = kit_button("site-take", "document-save-symbolic", _("Take home"), NULL, "great",
		G_CALLBACK(take_pressed), s);
	GtkWidget *buttons = kit_row(12, kit_grow(s->align, true, false),
		kit_grow(s->draw, true, false), kit_grow(s->take, true, false), NULL);
	gtk_box_set_homogeneous(GTK_BOX(buttons), TRUE);
	GtkWidget *over = kit_classed(kit_grow(gtk_overlay_new(), true, true), "picture");
	gtk_overlay_set_child(GTK_OVERLAY(over), s->stack);
	gtk_widget_set_overflow(over, GTK_OVERFLOW_HIDDEN);
	return kit_column(16, over, buttons, NULL);
}

static GtkWidget *work_box(struct site_screen *s)
{
	s->work_words = kit_line("work-words", "", "small", true);
	s->work_bar = gtk_progress_bar_new();
	gtk_widget_set_name(s->work_bar, "work-bar");
	s->work_cancel = kit_button("work-cancel", "window-close-symbolic", NULL,
		_("Stop computing"), "flat", G_CALLBACK(cancel_pressed), s);
	GtkWidget *words = kit_column(8, s->work_words, s->work_bar, NULL);
	gtk_widget_set_valign(words, GTK_ALIGN_CENTER);
	s->work = kit_row(8, kit_grow(words, true, false), s->work_cancel, NULL);
	gtk_widget_set_visible(s->work, FALSE);
	return s->work;
}

static GtkWidget *facts_side(struct site_screen *s)
{
	/* It goes before us. */
	s->map = g_object_ref_sink(kit_grow(site_map_new(), true, true));
	s->words = kit_named_text("site-words", "", "head");
	s->chooser = preset_chooser_new(kiosk_services(s->kiosk));
	s->scan = kit_button("scan-start", "media-record-symbolic", _("Scan"), NULL, "main great",
		G_CALLBACK(scan_pressed), s);
	s->bring = kit_button("site-bring", "document-open-symbolic", NULL,
		_("Bring in scans from a drive"), "great", G_CALLBACK(bring_pressed), s);
	s->resume = kit_button("scan-resume", "media-playback-start-symbolic",
		_("Go on with the scan"), NULL, "main great", G_CALLBACK(resume_pressed), s);
	s->discard = kit_button("scan-discard", "user-trash-symbolic", _("Throw it away"), NULL,
		"danger", G_CALLBACK(discard_pressed), s);
	GtkWidget *side = kit_column(14, s->map, s->words, work_box(s), s->chooser,
		kit_row(12, kit_grow(s->scan, true, false), s->bring, NULL), s->resume, s->discard,
		NULL);
	gtk_widget_set_size_request(side, kit_is_upright() ? -1 : SIDE_WIDTH, -1);
	return side;
}

static void destroyed(GtkWidget *w, gpointer user_data)
{
	struct site_screen *s = user_data;
	services *all = kiosk_services(s->kiosk);
	(void)w;
	g_cancellable_cancel(s->gone);
	g_signal_handlers_disconnect_by_data(services_acquisition(all), s);
	g_signal_handlers_disconnect_by_data(services_jobs(all), s);
	job_watch_let_go(s->job);
	site_map_show(s->map, NULL);
	easel_free(s->easel);
}

static void site_screen_free(gpointer data)
{
	struct site_screen *s = data;
	g_clear_object(&s->gone);
	g_object_unref(s->map);
	site_state_free(s->state);
	g_free(s->folder);
	g_free(s);
}

GtkWidget *screen_site_new(kiosk *k, const char *folder)
{
	struct site_screen *s = g_new0(struct site_screen, 1);
	BusAcquisition1 *a = services_acquisition(kiosk_services(k));
	BusJobs1 *jobs = services_jobs(kiosk_services(k));
	s->kiosk = k;
	s->folder = g_strdup(folder);
	s->gone = g_cancellable_new();
	s->easel = easel_new("site-picture", kiosk_options_of(k)->backend,
		&(struct easel_watcher){
			.tapped = picture_tapped, .failed = picture_failed, .user_data = s });
	s->widget = kit_margin(kit_sides(20, kit_grow(picture_side(s), true, true),
				       kit_grow(facts_side(s), false, true), NULL),
		20);
	g_signal_connect(a, "finished", G_CALLBACK(scan_finished), s);
	g_signal_connect_swapped(a, "notify::g-name-owner", G_CALLBACK(service_changed), s);
	g_signal_connect_swapped(jobs, "notify::g-name-owner", G_CALLBACK(service_changed), s);
	/* What the screens before it did, or those behind it. */
	g_signal_connect_swapped(s->widget, "map", G_CALLBACK(reload), s);
	g_signal_connect(s->widget, "destroy", G_CALLBACK(destroyed), s);
	g_object_set_data_full(G_OBJECT(s->widget), "screen", s, site_screen_free);
	show_buttons(s);
	return s->widget;
}
