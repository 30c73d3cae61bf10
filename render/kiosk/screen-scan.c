/* The scan that is under way: its panorama as it fills, what is left, and how to stop. */
#include "render/kiosk/canvas.h"
#include "render/kiosk/hold-button.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/site-words.h"
#include <gio/gio.h>
#include <gio/gunixfdlist.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define PREVIEW_MS 500
/* A panorama may be shown that much higher than it is, since it is wide and screens are not. */
#define HIGHER 1.5F

struct scan_screen {
	kiosk *kiosk;
	GtkWidget *widget, *panorama, *frame, *head, *doing, *bar, *columns, *left, *photos, *fault,
		*advice;
	GtkWidget *fault_box, *reset, *keep_clear, *pause, *resume, *stop;
	GCancellable *gone;
	guint timer;
	const char *plane;
	guint64 serial;
	bool asking;
};

static BusAcquisition1 *acquisition(struct scan_screen *s)
{
	return services_acquisition(kiosk_services(s->kiosk));
}

/* ---- the panorama ---- */

/* What nobody has seen yet is grey. */
static GBytes *to_show(const uint8_t (*rgba)[4], size_t n)
{
	uint8_t(*bgrx)[4] = g_malloc_n(n, 4);
	for (size_t i = 0; i < n; i++) {
		bool seen = rgba[i][3];
		bgrx[i][0] = seen ? rgba[i][2] : 120;
		bgrx[i][1] = seen ? rgba[i][1] : 124;
		bgrx[i][2] = seen ? rgba[i][0] : 128;
		bgrx[i][3] = 255;
	}
	return g_bytes_new_take(bgrx, 4 * n);
}

static void show_preview(struct scan_screen *s, int fd, guint columns, guint rows)
{
	size_t n = (size_t)columns * rows;
	void *at = columns && rows && n <= 1u << 26 && lseek(fd, 0, SEEK_END) >= (off_t)(4 * n)
			   ? mmap(NULL, 4 * n, PROT_READ, MAP_SHARED, fd, 0)
			   : MAP_FAILED;
	if (at == MAP_FAILED)
		return;
	g_autoptr(GBytes) shown = to_show(at, n);
	munmap(at, 4 * n);
	gtk_aspect_frame_set_ratio(
		GTK_ASPECT_FRAME(s->frame), (float)columns / (float)rows / HIGHER);
	canvas_show(s->panorama, shown, columns, rows);
}

static void got_preview(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GUnixFDList) fds = NULL;
	g_autoptr(GVariant) handle = NULL;
	guint columns, rows;
	guint64 serial;
	bool good = bus_acquisition1_call_preview_finish(
		BUS_ACQUISITION1(source), &handle, &columns, &rows, &serial, &fds, result, &error);
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct scan_screen *s = user_data;
	s->asking = false;
	if (!good || serial == s->serial || !fds)
		return;
	int fd = g_unix_fd_list_get(fds, g_variant_get_handle(handle), NULL);
	if (fd < 0)
		return;
	s->serial = serial;
	show_preview(s, fd, columns, rows);
	close(fd);
}

static gboolean ask_preview(gpointer user_data)
{
	struct scan_screen *s = user_data;
	if (s->asking || !services_has_acquisition(kiosk_services(s->kiosk)))
		return G_SOURCE_CONTINUE;
	s->asking = true;
	bus_acquisition1_call_preview(acquisition(s), s->plane, NULL, s->gone, got_preview, s);
	return G_SOURCE_CONTINUE;
}

static void plane_toggled(GtkToggleButton *b, gpointer user_data)
{
	struct scan_screen *s = user_data;
	if (!gtk_toggle_button_get_active(b))
		return;
	s->plane = g_object_get_data(G_OBJECT(b), "plane");
	s->serial = 0;
	ask_preview(s);
}

/* ---- how it goes ---- */

static bool is_in_front(struct scan_screen *s)
{
	return !g_strcmp0(kiosk_screen(s->kiosk), "scan");
}

static void show_fault(struct scan_screen *s)
{
	GVariant *fault = bus_acquisition1_get_fault(acquisition(s));
	const char *sentence = "", *advice = "";
	if (fault && g_variant_is_of_type(fault, G_VARIANT_TYPE("(ss)")))
		g_variant_get(fault, "(&s&s)", &sentence, &advice);
	g_autofree char *words = words_sentence(sentence);
	if (*sentence && is_in_front(s))
		kiosk_hush(s->kiosk, sentence);
	kit_set_text(s->fault, words);
	kit_set_text(s->advice, words_advice(advice));
	gtk_widget_set_visible(s->fault_box, *sentence);
	gtk_widget_set_visible(s->reset, bus_acquisition1_get_needs_reset(acquisition(s)));
}

static const char *headline(const char *state)
{
	if (!g_strcmp0(state, "starting"))
		return _("The scanner gets ready");
	if (!g_strcmp0(state, "scanning"))
		return _("Scanning");
	if (!g_strcmp0(state, "developing"))
		return _("The panorama is made");
	if (!g_strcmp0(state, "pausing"))
		return _("Stopping");
	if (!g_strcmp0(state, "paused"))
		return _("Paused");
	return state ? _("No scan is under way") : _("The scanner service is being started again");
}

/* While it waits, it says for what. */
static char *doing_words(const char *doing)
{
	const char *waits = "waiting: ";
	if (!doing || !g_str_has_prefix(doing, waits))
		return g_strdup(words_doing(doing));
	g_autofree char *why = words_sentence(doing + strlen(waits));
	return g_strdup_printf(_("Waiting: %s"), why);
}

static void show_numbers(struct scan_screen *s)
{
	BusAcquisition1 *a = acquisition(s);
	double fraction = bus_acquisition1_get_fraction(a);
	g_autofree char *left = words_duration(bus_acquisition1_get_seconds_left(a));
	g_autofree char *left_words = *left ? g_strdup_printf(_("%s left"), left) : g_strdup("");
	g_autofree char *percent = g_strdup_printf(
		_("%.0f %% of the columns"), 100 * bus_acquisition1_get_column_fraction(a));
	guint taken = 0, wanted = 0;
	GVariant *photos = bus_acquisition1_get_photos(a);
	if (photos && g_variant_is_of_type(photos, G_VARIANT_TYPE("(uu)")))
		g_variant_get(photos, "(uu)", &taken, &wanted);
	g_autofree char *photo_words = g_strdup_printf(_("%u of %u photos"), taken, wanted);
	g_autofree char *doing = doing_words(bus_acquisition1_get_doing(a));
	gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(s->bar), CLAMP(fraction, 0, 1));
	kit_set_text(s->left, left_words);
	kit_set_text(s->columns, percent);
	kit_set_text(s->photos, wanted ? photo_words : "");
	kit_set_text(s->doing, doing);
}

static void show(struct scan_screen *s)
{
	const char *state = bus_acquisition1_get_state(acquisition(s));
	bool paused = !g_strcmp0(state, "paused");
	bool turns = !g_strcmp0(state, "scanning") || !g_strcmp0(state, "starting");
	kit_set_text(s->head, headline(state));
	show_numbers(s);
	gtk_widget_set_visible(s->doing, !paused);
	show_fault(s);
	gtk_widget_set_visible(s->pause, !paused);
	gtk_widget_set_visible(s->resume, paused);
	gtk_widget_set_sensitive(s->pause, turns);
	gtk_widget_set_sensitive(s->resume, !bus_acquisition1_get_needs_reset(acquisition(s)));
	gtk_widget_set_sensitive(s->stop, turns || paused);
	gtk_widget_set_visible(s->keep_clear, turns);
}

static void changed(struct scan_screen *s)
{
	show(s);
}

/* ---- the end ---- */

static void finished(BusAcquisition1 *a, const char *folder, guint number, gpointer user_data)
{
	struct scan_screen *s = user_data;
	kiosk *k = s->kiosk;
	(void)a;
	(void)folder;
	g_autofree char *said = g_strdup_printf(_("Scan %u is whole."), number);
	if (is_in_front(s))
		kiosk_back(k);
	kiosk_say(k, said);
}

static void stopped(BusAcquisition1 *a, const char *folder, guint number, gboolean partial,
	const char *sentence, const char *advice, gpointer user_data)
{
	struct scan_screen *s = user_data;
	(void)a;
	(void)folder;
	(void)number;
	if (sentence && *sentence)
		kiosk_complain(s->kiosk, sentence, words_advice(advice));
	show_fault(s);
	if (!partial && is_in_front(s))
		kiosk_back(s->kiosk);
}

/* ---- pressed ---- */

static void asked(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GVariant) nothing =
		g_dbus_proxy_call_finish(G_DBUS_PROXY(source), result, &error);
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct scan_screen *s = user_data;
	kiosk_complain_of(s->kiosk, error);
}

static void ask(struct scan_screen *s, const char *method, GVariant *arguments)
{
	g_dbus_proxy_call(G_DBUS_PROXY(acquisition(s)), method, arguments, G_DBUS_CALL_FLAGS_NONE,
		-1, s->gone, asked, s);
}

static void pause_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	ask(user_data, "Pause", NULL);
}

static void resume_pressed(GtkButton *b, gpointer user_data)
{
	struct scan_screen *s = user_data;
	const char *folder = bus_acquisition1_get_site(acquisition(s));
	(void)b;
	ask(s, "Resume", g_variant_new("(sb)", folder ? folder : "", FALSE));
}

static void reset_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	ask(user_data, "Reset", NULL);
}

static void stop_keep(GtkButton *b, gpointer user_data)
{
	struct scan_screen *s = user_data;
	(void)b;
	kiosk_close_sheet(s->kiosk);
	ask(s, "Abort", g_variant_new("(b)", TRUE));
	if (is_in_front(s))
		kiosk_back(s->kiosk);
}

static void stop_throw(GtkButton *b, gpointer user_data)
{
	struct scan_screen *s = user_data;
	(void)b;
	kiosk_close_sheet(s->kiosk);
	ask(s, "Abort", g_variant_new("(b)", FALSE));
	if (is_in_front(s))
		kiosk_back(s->kiosk);
}

static void go_on(GtkButton *b, gpointer user_data)
{
	struct scan_screen *s = user_data;
	(void)b;
	kiosk_close_sheet(s->kiosk);
	resume_pressed(NULL, s);
}

/* The stage stops at once; what becomes of the scan is asked after. */
static void stop_held(gpointer user_data)
{
	struct scan_screen *s = user_data;
	ask(s, "Pause", NULL);
	kiosk_open_sheet(s->kiosk,
		kit_column(16, kit_text(_("The scan has stopped"), "title"),
			kit_text(_("What was scanned is kept. What shall become of it?"), NULL),
			kit_button("stop-go-on", NULL, _("Go on with it"), NULL, "great",
				G_CALLBACK(go_on), s),
			kit_button("stop-keep", NULL, _("Keep it for later"), NULL, "main great",
				G_CALLBACK(stop_keep), s),
			kit_button("stop-throw", NULL, _("Throw it away"), NULL, "danger great",
				G_CALLBACK(stop_throw), s),
			NULL));
}

/* ---- building ---- */

static GtkWidget *plane_button(struct scan_screen *s, GtkWidget *group, const char *name,
	const char *plane, const char *title)
{
	GtkWidget *b = gtk_toggle_button_new_with_label(title);
	gtk_widget_set_name(b, name);
	g_object_set_data(G_OBJECT(b), "plane", (gpointer)plane);
	if (group)
		gtk_toggle_button_set_group(GTK_TOGGLE_BUTTON(b), GTK_TOGGLE_BUTTON(group));
	else
		gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(b), TRUE);
	g_signal_connect(b, "toggled", G_CALLBACK(plane_toggled), s);
	return b;
}

static GtkWidget *plane_buttons(struct scan_screen *s)
{
	GtkWidget *range = plane_button(s, NULL, "plane-range", "range", _("Distance"));
	return kit_row(8, range, plane_button(s, range, "plane-intensity", "intensity", _("Echo")),
		plane_button(s, range, "plane-colour", "colour", _("Colour")), NULL);
}

static GtkWidget *fault_area(struct scan_screen *s)
{
	s->fault = kit_named_text("scan-fault", "", "head bad");
	s->advice = kit_named_text("scan-advice", "", NULL);
	s->reset = kit_button("scan-reset", NULL, _("Reset"),
		_("It is safe: the scanner may be used again"), "main great",
		G_CALLBACK(reset_pressed), s);
	s->fault_box = kit_classed(
		kit_row(16, kit_grow(kit_column(4, s->fault, s->advice, NULL), true, false),
			s->reset, NULL),
		"card");
	gtk_widget_set_visible(s->fault_box, FALSE);
	return s->fault_box;
}

static GtkWidget *facts(struct scan_screen *s)
{
	s->head = kit_named_text("scan-state", "", "title");
	s->doing = kit_line("scan-doing", "", "soft", true);
	s->left = kit_line("scan-left", "", "large number", false);
	s->columns = kit_line("scan-columns", "", "number", false);
	s->photos = kit_line("scan-photos", "", "number", false);
	s->keep_clear = kit_named_text("scan-keep-clear",
		_("The head turns: stay an arm's length away, and out of its view where you can."),
		"doubt");
	return kit_sides(kit_is_upright() ? 12 : 40,
		kit_grow(kit_column(4, s->head, s->doing, s->keep_clear, NULL), true, false),
		kit_column(4, s->left, kit_row(20, s->columns, s->photos, NULL), NULL), NULL);
}

static GtkWidget *buttons(struct scan_screen *s)
{
	s->pause = kit_button("scan-pause", "media-playback-pause-symbolic", _("Pause"), NULL,
		"great", G_CALLBACK(pause_pressed), s);
	s->resume = kit_button("scan-go-on", "media-playback-start-symbolic", _("Go on"), NULL,
		"main great", G_CALLBACK(resume_pressed), s);
	s->stop = hold_button_new("scan-stop", _("Hold to stop"), "danger great", stop_held, s);
	gtk_widget_set_size_request(s->stop, 220, -1);
	return kit_sides(16, kit_grow(plane_buttons(s), true, false),
		kit_row(16, s->pause, s->resume, s->stop, NULL), NULL);
}

static void destroyed(GtkWidget *w, gpointer user_data)
{
	struct scan_screen *s = user_data;
	(void)w;
	g_cancellable_cancel(s->gone);
	g_signal_handlers_disconnect_by_data(acquisition(s), s);
	g_clear_handle_id(&s->timer, g_source_remove);
	/* It may go before us. */
	canvas_forget(s->panorama);
}

static void scan_screen_free(gpointer data)
{
	struct scan_screen *s = data;
	g_clear_object(&s->gone);
	g_object_unref(s->panorama);
	g_free(s);
}

GtkWidget *screen_scan_new(kiosk *k)
{
	struct scan_screen *s = g_new0(struct scan_screen, 1);
	BusAcquisition1 *a = services_acquisition(kiosk_services(k));
	s->kiosk = k;
	s->gone = g_cancellable_new();
	s->plane = "range";
	s->panorama = canvas_new("scan-panorama", _("The panorama as far as it is scanned"),
		&(struct canvas_watcher){ 0 });
	g_object_ref_sink(s->panorama);
	s->frame = gtk_aspect_frame_new(0.5F, 0.5F, 2.6F, FALSE);
	gtk_aspect_frame_set_child(GTK_ASPECT_FRAME(s->frame), s->panorama);
	kit_grow(s->frame, true, true);
	s->bar = gtk_progress_bar_new();
	gtk_widget_set_name(s->bar, "scan-bar");
	s->widget = kit_margin(
		kit_column(14, facts(s), s->bar, fault_area(s), s->frame, buttons(s), NULL), 20);
	g_signal_connect_swapped(a, "g-properties-changed", G_CALLBACK(changed), s);
	g_signal_connect_swapped(a, "notify::g-name-owner", G_CALLBACK(changed), s);
	g_signal_connect(a, "finished", G_CALLBACK(finished), s);
	g_signal_connect(a, "stopped", G_CALLBACK(stopped), s);
	g_signal_connect(s->widget, "destroy", G_CALLBACK(destroyed), s);
	g_object_set_data_full(G_OBJECT(s->widget), "screen", s, scan_screen_free);
	s->timer = g_timeout_add(PREVIEW_MS, ask_preview, s);
	show(s);
	return s->widget;
}
