/* Two scans, how they fit, and what a person knows better: points picked in both. */
#include "render/kiosk/align-pair.h"
#include "render/kiosk/align-picks.h"
#include "render/kiosk/pick-pane.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/site-words.h"
#include <gio/gio.h>

#define SIDE_WIDTH 330
#define NONE       G_MAXUINT

struct align_screen {
	kiosk *kiosk;
	GtkWidget *widget, *headline, *advice, *reason, *chooser, *place, *pane[2], *title[2],
		*list, *hint;
	GtkWidget *align, *again, *vouch, *apart, *remove, *work, *work_words, *work_bar;
	char *folder;
	align_pair *pair; /* NULL while it is being read */
	align_picks *picks;
	double *residual_m; /* of each; below 0: not known */
	bool *blunder;
	guint selected; /* of the picks; NONE */
	GCancellable *gone;
	job_watch *job;
	const char *doing; /* what the job is, for undo; NULL: undoing itself */
};

static void show_picks(struct align_screen *s);

/* ---- reading a pair ---- */

struct wanted {
	char *folder;
	uint32_t a, b;
	int step;
};

static void wanted_free(gpointer data)
{
	struct wanted *w = data;
	g_free(w->folder);
	g_free(w);
}

static void read_there(GTask *task, gpointer source, gpointer data, GCancellable *cancellable)
{
	const struct wanted *w = data;
	GError *error = NULL;
	(void)source;
	(void)cancellable;
	align_pair *p = align_pair_new(w->folder, w->a, w->b, w->step, &error);
	if (p)
		g_task_return_pointer(task, p, (GDestroyNotify)align_pair_free);
	else
		g_task_return_error(task, error);
}

static char *picks_path(const struct align_screen *s)
{
	return g_strdup_printf("%s/picks/%u-%u.txt", s->folder, s->pair->scan[0], s->pair->scan[1]);
}

static void show_verdict(struct align_screen *s)
{
	const char *verdict, *advice;
	const char *headline = align_pair_headline(s->pair, &verdict, &advice);
	const struct edge *e = s->pair->edge;
	kit_set_text(s->headline, headline);
	kit_set_verdict(s->headline, verdict);
	kit_set_text(s->advice, advice);
	gtk_widget_set_visible(s->advice, *advice);
	kit_set_text(s->reason, e ? e->verification.reason : "");
	g_autofree char *place =
		g_strdup_printf(_("Scans %u and %u"), s->pair->scan[0], s->pair->scan[1]);
	kit_set_text(s->place, place);
	gtk_widget_set_visible(s->chooser, s->pair->pairs > 1);
}

static void show_panes(struct align_screen *s)
{
	for (int side = 0; side < 2; side++) {
		const align_pair *p = s->pair;
		g_autofree char *title = g_strdup_printf(_("Scan %u"), p->scan[side]);
		kit_set_text(s->title[side], title);
		if (p->rgb[side])
			pick_pane_set_picture(s->pane[side], p->rgb[side],
				p->data[side]->grid->columns, p->data[side]->grid->rows);
	}
}

static void has_read(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	align_pair *p = g_task_propagate_pointer(G_TASK(result), &error);
	(void)source;
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	struct align_screen *s = user_data;
	if (!p) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	bool same = s->pair && s->pair->scan[0] == p->scan[0] && s->pair->scan[1] == p->scan[1];
	align_pair_free(s->pair);
	s->pair = p;
	show_verdict(s);
	if (!same && p->pairs) {
		g_autofree char *path = picks_path(s);
		align_picks_free(s->picks);
		s->picks = align_picks_load(path);
		s->selected = NONE;
		show_panes(s);
	}
	show_picks(s);
}

static void read_pair(struct align_screen *s, uint32_t a, uint32_t b, int step)
{
	g_autoptr(GTask) task = g_task_new(NULL, s->gone, has_read, s);
	struct wanted *w = g_new0(struct wanted, 1);
	*w = (struct wanted){ g_strdup(s->folder), a, b, step };
	g_task_set_return_on_cancel(task, FALSE);
	g_task_set_task_data(task, w, wanted_free);
	g_task_run_in_thread(task, read_there);
}

static void step_to(struct align_screen *s, int step)
{
	if (s->pair && s->pair->pairs && !s->job)
		read_pair(s, s->pair->scan[0], s->pair->scan[1], step);
}

static void before_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	step_to(user_data, -1);
}

static void next_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	step_to(user_data, 1);
}

/* ---- picks ---- */

static struct align_pick *pick_at(const struct align_screen *s, guint n)
{
	return &g_array_index(s->picks->pairs, struct align_pick, n);
}

/* What stood before, for undo. */
struct before {
	struct align_screen *screen;
	align_picks *picks;
	uint32_t scan[2];
};

static void before_free(gpointer data)
{
	struct before *b = data;
	align_picks_free(b->picks);
	g_free(b);
}

static void take_back(gpointer data)
{
	struct before *b = data;
	struct align_screen *s = b->screen;
	if (!s->pair || s->pair->scan[0] != b->scan[0] || s->pair->scan[1] != b->scan[1])
		return;
	align_picks_free(s->picks);
	s->picks = g_steal_pointer(&b->picks);
	s->selected = NONE;
	show_picks(s);
}

/* Before the picks change. */
static void remember(struct align_screen *s, const char *did)
{
	struct before *b = g_new0(struct before, 1);
	*b = (struct before){ s, align_picks_copy(s->picks),
		{ s->pair->scan[0], s->pair->scan[1] } };
	kiosk_did(s->kiosk, did, take_back, b, before_free, s);
}

static void compute(struct align_screen *s)
{
	guint n = s->picks->pairs->len;
	s->residual_m = g_renew(double, s->residual_m, n + 1);
	s->blunder = g_renew(bool, s->blunder, n + 1);
	for (guint i = 0; i < n; i++) {
		s->residual_m[i] = -1;
		s->blunder[i] = false;
	}
	if (align_picks_whole(s->picks) >= ALIGN_PICKS_LEAST)
		align_picks_fit(s->picks, s->pair->data[0], s->pair->data[1], s->residual_m,
			s->blunder, NULL);
}

static void show_marks(struct align_screen *s, int side)
{
	g_autoptr(GArray) marks = g_array_new(FALSE, FALSE, sizeof(struct pick_mark));
	for (guint i = 0; i < s->picks->pairs->len; i++) {
		const struct align_pick *k = pick_at(s, i);
		struct pick_mark m = { k->column[side], k->row[side], i + 1, i == s->selected,
			!k->has[!side], s->blunder[i] };
		if (k->has[side])
			g_array_append_val(marks, m);
	}
	pick_pane_set_marks(
		s->pane[side], (const struct pick_mark *)(void *)marks->data, marks->len);
}

static void row_pressed(GtkButton *b, gpointer user_data)
{
	struct align_screen *s = user_data;
	guint n = GPOINTER_TO_UINT(g_object_get_data(G_OBJECT(b), "pick"));
	s->selected = s->selected == n ? NONE : n;
	show_picks(s);
}

static char *words_of(const struct align_screen *s, guint n)
{
	const struct align_pick *k = pick_at(s, n);
	if (!k->has[0] || !k->has[1])
		return g_strdup_printf(
			_("%u: now in scan %u"), n + 1, s->pair->scan[k->has[0] ? 1 : 0]);
	if (s->blunder[n])
		return g_strdup_printf(
			_("%u: %.0f cm, does not fit"), n + 1, 100 * s->residual_m[n]);
	if (s->residual_m[n] >= 0)
		return g_strdup_printf(_("%u: %.1f cm"), n + 1, 100 * s->residual_m[n]);
	return g_strdup_printf(_("%u: picked"), n + 1);
}

static GtkWidget *row_of(struct align_screen *s, guint n)
{
	g_autofree char *text = words_of(s, n), *name = g_strdup_printf("pick-%u", n + 1);
	GtkWidget *b = kit_button(name, NULL, text, NULL, n == s->selected ? "pick chosen" : "pick",
		G_CALLBACK(row_pressed), s);
	g_object_set_data(G_OBJECT(b), "pick", GUINT_TO_POINTER(n));
	if (s->blunder[n])
		kit_classed(b, "bad");
	return b;
}

static const char *hint_of(const struct align_screen *s, guint whole)
{
	if (!s->pair->rgb[0] || !s->pair->rgb[1])
		return _("A cloud without a grid cannot be shown as a picture: its pairs are given "
			 "in metres, with pleinair align --pairs.");
	if (whole < s->picks->pairs->len)
		return _("Tap the same point in the other scan. A mark that is drawn moves slower "
			 "than "
			 "the finger.");
	if (whole < ALIGN_PICKS_LEAST)
		return _("Tap a point in one scan, then the same in the other: three at least, far "
			 "apart.");
	return _("That is enough to align them. More points make it surer.");
}

static gboolean rebuild_list(gpointer user_data)
{
	GtkWidget *list = user_data;
	struct align_screen *s = g_object_get_data(G_OBJECT(list), "align");
	if (!s || !s->pair)
		return G_SOURCE_REMOVE;
	kit_empty(list);
	for (guint i = 0; i < s->picks->pairs->len; i++)
		gtk_box_append(GTK_BOX(list), row_of(s, i));
	return G_SOURCE_REMOVE;
}

static void show_buttons(struct align_screen *s)
{
	bool ready = s->pair && s->pair->pairs && !s->job;
	guint whole = align_picks_whole(s->picks);
	const struct edge *e = s->pair ? s->pair->edge : NULL;
	gtk_widget_set_sensitive(s->align, ready && whole >= ALIGN_PICKS_LEAST);
	gtk_widget_set_sensitive(s->again, ready);
	gtk_widget_set_sensitive(s->vouch, ready && e && !edge_is_used(e));
	gtk_widget_set_sensitive(s->apart, ready && e && e->decision != DECISION_REFUSED);
	gtk_widget_set_visible(s->remove, s->selected < s->picks->pairs->len);
	gtk_widget_set_visible(s->work, s->job != NULL);
}

static void show_picks(struct align_screen *s)
{
	if (!s->pair || !s->pair->pairs) {
		show_buttons(s);
		return;
	}
	compute(s);
	show_marks(s, 0);
	show_marks(s, 1);
	kit_set_text(s->hint, hint_of(s, align_picks_whole(s->picks)));
	/* Not at once: it may be one of its buttons that was pressed. */
	g_idle_add_full(G_PRIORITY_DEFAULT, rebuild_list, g_object_ref(s->list), g_object_unref);
	show_buttons(s);
}

struct side {
	struct align_screen *screen;
	int side;
};

static void pane_tapped(uint32_t column, uint32_t row, gpointer user_data)
{
	const struct side *at = user_data;
	struct align_screen *s = at->screen;
	if (!s->pair || !s->pair->pairs)
		return;
	if (!align_picks_find(s->pair->data[at->side]->grid, &column, &row)) {
		kiosk_say(s->kiosk,
			_("There is nothing there that the scanner measured: tap beside it."));
		return;
	}
	remember(s, _("Point picked"));
	s->selected = align_picks_add(s->picks, at->side, column, row);
	show_picks(s);
}

static void mark_tapped(uint32_t number, gpointer user_data)
{
	const struct side *at = user_data;
	struct align_screen *s = at->screen;
	s->selected = s->selected == number - 1 ? NONE : number - 1;
	show_picks(s);
}

static void mark_moved(
	uint32_t number, uint32_t column, uint32_t row, bool last, gpointer user_data)
{
	const struct side *at = user_data;
	struct align_screen *s = at->screen;
	if (!last || !s->pair || number > s->picks->pairs->len)
		return;
	if (align_picks_find(s->pair->data[at->side]->grid, &column, &row)) {
		remember(s, _("Point moved"));
		align_picks_move(s->picks, number - 1, at->side, column, row);
	} else
		kiosk_say(s->kiosk,
			_("There is nothing there that the scanner measured: tap beside it."));
	s->selected = number - 1;
	show_picks(s);
}

static void remove_pressed(GtkButton *b, gpointer user_data)
{
	struct align_screen *s = user_data;
	(void)b;
	if (s->selected >= s->picks->pairs->len)
		return;
	remember(s, _("Pair removed"));
	align_picks_remove(s->picks, s->selected);
	s->selected = NONE;
	show_picks(s);
}

/* ---- work ---- */

static void start_job(
	struct align_screen *s, const char *doing, const char *option, const char *value);

static void undo_alignment(gpointer data)
{
	start_job(data, NULL, "undo", NULL);
}

static void goes_on(double fraction, const char *doing, double seconds_left, gpointer user_data)
{
	struct align_screen *s = user_data;
	(void)seconds_left;
	gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(s->work_bar), CLAMP(fraction, 0, 1));
	kit_set_text(s->work_words, words_doing(doing));
}

/* A verdict against the pair comes as a failure too, and then stands in the graph. */
static void has_ended(
	const char *state, const char *result, const char *sentence, gpointer user_data)
{
	struct align_screen *s = user_data;
	bool failed = g_strcmp0(state, "done");
	(void)result;
	s->job = NULL;
	if (s->doing)
		kiosk_did(s->kiosk, s->doing, undo_alignment, s, NULL, s);
	if (failed && sentence && !strstr(sentence, "refused ("))
		kiosk_complain(s->kiosk, sentence, NULL);
	read_pair(s, s->pair->scan[0], s->pair->scan[1], 0);
}

static void start_job(
	struct align_screen *s, const char *doing, const char *option, const char *value)
{
	g_auto(GVariantDict) options = G_VARIANT_DICT_INIT(NULL);
	g_autofree char *a = g_strdup_printf("%u", s->pair->scan[0]);
	g_autofree char *b = g_strdup_printf("%u", s->pair->scan[1]);
	const char *pair[] = { a, b, NULL };
	if (s->job)
		return;
	if (value)
		g_variant_dict_insert(&options, option, "s", value);
	else if (option)
		g_variant_dict_insert(&options, option, "b", TRUE);
	/* The last change, of whatever pair, is what undo takes back. */
	if (g_strcmp0(option, "undo"))
		g_variant_dict_insert(&options, "arguments", "^as", pair);
	s->doing = doing;
	goes_on(0, "", -1, s);
	s->job = services_start_job(kiosk_services(s->kiosk), "align", s->folder,
		g_variant_dict_end(&options), goes_on, has_ended, s);
	show_buttons(s);
}

static void align_pressed(GtkButton *button, gpointer user_data)
{
	struct align_screen *s = user_data;
	g_autoptr(GError) error = NULL;
	g_autofree char *path = picks_path(s);
	(void)button;
	if (align_picks_save(s->picks, path, &error))
		start_job(s, _("Aligned by points"), "pairs", path);
	else
		kiosk_complain_of(s->kiosk, error);
}

static void again_pressed(GtkButton *button, gpointer user_data)
{
	(void)button;
	start_job(user_data, _("Aligned by itself"), NULL, NULL);
}

static void is_vouched(GtkButton *button, gpointer user_data)
{
	(void)button;
	start_job(user_data, _("Vouched for"), "accept", NULL);
}

static void vouch_pressed(GtkButton *button, gpointer user_data)
{
	struct align_screen *s = user_data;
	(void)button;
	kiosk_ask(s->kiosk, _("Are you sure that they fit?"),
		_("The scanner could not tell. If they do not fit, all that hangs on this pair "
		  "stands "
		  "in the wrong place."),
		_("They fit"), G_CALLBACK(is_vouched), s);
}

static void apart_pressed(GtkButton *button, gpointer user_data)
{
	(void)button;
	start_job(user_data, _("Kept apart"), "refuse", NULL);
}

static void cancel_pressed(GtkButton *button, gpointer user_data)
{
	struct align_screen *s = user_data;
	(void)button;
	if (s->job)
		job_watch_cancel(s->job);
}

/* ---- building ---- */

static GtkWidget *pane_box(struct align_screen *s, int side)
{
	struct side *at = g_new0(struct side, 1);
	*at = (struct side){ s, side };
	struct pick_pane_watcher w = { pane_tapped, mark_tapped, mark_moved, at };
	s->pane[side] = pick_pane_new(side ? "pane-b" : "pane-a",
		side ? _("Panorama of the second scan") : _("Panorama of the first scan"), &w);
	g_object_ref_sink(s->pane[side]);
	g_object_set_data_full(G_OBJECT(s->pane[side]), "side", at, g_free);
	s->title[side] =
		kit_classed(kit_line(side ? "title-b" : "title-a", "", "head", false), "tag");
	gtk_widget_set_halign(s->title[side], GTK_ALIGN_START);
	gtk_widget_set_valign(s->title[side], GTK_ALIGN_START);
	gtk_widget_set_can_target(s->title[side], FALSE);
	GtkWidget *over = kit_classed(kit_grow(gtk_overlay_new(), true, true), "picture");
	gtk_overlay_set_child(GTK_OVERLAY(over), s->pane[side]);
	gtk_overlay_add_overlay(GTK_OVERLAY(over), s->title[side]);
	gtk_widget_set_overflow(over, GTK_OVERFLOW_HIDDEN);
	return over;
}

static GtkWidget *verdict_box(struct align_screen *s)
{
	s->headline = kit_named_text("align-verdict", _("The scans are being read."), "title");
	s->advice = kit_named_text("align-advice", "", NULL);
	s->reason = kit_named_text("align-reason", "", "small soft");
	kit_narrow(s->headline, 20, 24);
	kit_narrow(s->advice, 20, 24);
	kit_narrow(s->reason, 20, 24);
	return kit_column(4, s->headline, s->advice, s->reason, NULL);
}

static GtkWidget *chooser(struct align_screen *s)
{
	s->place = kit_line("align-place", "", "head", true);
	gtk_widget_set_halign(s->place, GTK_ALIGN_CENTER);
	s->chooser = kit_row(8,
		kit_button("pair-before", "go-previous-symbolic", NULL, _("Pair before"), NULL,
			G_CALLBACK(before_pressed), s),
		kit_grow(s->place, true, false),
		kit_button("pair-next", "go-next-symbolic", NULL, _("Next pair"), NULL,
			G_CALLBACK(next_pressed), s),
		NULL);
	return s->chooser;
}

static GtkWidget *work_box(struct align_screen *s)
{
	s->work_words = kit_line("align-doing", "", "small", true);
	s->work_bar = gtk_progress_bar_new();
	gtk_widget_set_name(s->work_bar, "align-bar");
	s->work = kit_row(8, kit_grow(kit_column(4, s->work_words, s->work_bar, NULL), true, false),
		kit_button("align-cancel", "window-close-symbolic", NULL, _("Stop"), "flat",
			G_CALLBACK(cancel_pressed), s),
		NULL);
	gtk_widget_set_visible(s->work, FALSE);
	return s->work;
}

static GtkWidget *side_panel(struct align_screen *s)
{
	s->hint = kit_named_text("align-hint", "", "small soft");
	kit_narrow(s->hint, 20, 24);
	s->list = g_object_ref_sink(kit_column(6, NULL));
	gtk_widget_set_name(s->list, "picks");
	g_object_set_data(G_OBJECT(s->list), "align", s);
	s->remove = kit_button("pick-remove", "user-trash-symbolic", _("Remove pair"), NULL, NULL,
		G_CALLBACK(remove_pressed), s);
	s->align = kit_button("align-points", NULL, _("Align by these points"), NULL, "main great",
		G_CALLBACK(align_pressed), s);
	s->again = kit_button("align-again", NULL, _("Align by itself"), NULL, NULL,
		G_CALLBACK(again_pressed), s);
	s->vouch = kit_button(
		"align-vouch", NULL, _("They fit"), NULL, NULL, G_CALLBACK(vouch_pressed), s);
	s->apart = kit_button(
		"align-apart", NULL, _("They do not"), NULL, NULL, G_CALLBACK(apart_pressed), s);
	GtkWidget *decide =
		kit_row(8, kit_grow(s->vouch, true, false), kit_grow(s->apart, true, false), NULL);
	gtk_box_set_homogeneous(GTK_BOX(decide), TRUE);
	GtkWidget *panel = kit_column(10, verdict_box(s), chooser(s), s->hint,
		kit_grow(kit_scroll(s->list), false, true), s->remove, work_box(s), s->align,
		s->again, decide, NULL);
	gtk_widget_set_size_request(panel, kit_is_upright() ? -1 : SIDE_WIDTH, -1);
	gtk_widget_set_hexpand(panel, FALSE);
	return panel;
}

static void destroyed(GtkWidget *w, gpointer user_data)
{
	struct align_screen *s = user_data;
	(void)w;
	g_cancellable_cancel(s->gone);
	job_watch_let_go(s->job);
	kiosk_forget_undo(s->kiosk, s);
	pick_pane_forget(s->pane[0]);
	pick_pane_forget(s->pane[1]);
	g_object_set_data(G_OBJECT(s->list), "align", NULL);
}

static void align_screen_free(gpointer data)
{
	struct align_screen *s = data;
	align_pair_free(s->pair);
	align_picks_free(s->picks);
	g_object_unref(s->pane[0]);
	g_object_unref(s->pane[1]);
	g_object_unref(s->list);
	g_clear_object(&s->gone);
	g_free(s->residual_m);
	g_free(s->blunder);
	g_free(s->folder);
	g_free(s);
}

GtkWidget *screen_align_new(kiosk *k, const char *folder, uint32_t a, uint32_t b)
{
	struct align_screen *s = g_new0(struct align_screen, 1);
	s->kiosk = k;
	s->folder = g_strdup(folder);
	s->gone = g_cancellable_new();
	s->picks = align_picks_new();
	s->selected = NONE;
	GtkWidget *panes =
		kit_grow(kit_column(12, pane_box(s, 0), pane_box(s, 1), NULL), true, true);
	gtk_box_set_homogeneous(GTK_BOX(panes), TRUE);
	s->widget = kit_margin(kit_sides(20, panes, side_panel(s), NULL), 20);
	g_signal_connect(s->widget, "destroy", G_CALLBACK(destroyed), s);
	g_object_set_data_full(G_OBJECT(s->widget), "screen", s, align_screen_free);
	show_buttons(s);
	read_pair(s, a, b, 0);
	return s->widget;
}
