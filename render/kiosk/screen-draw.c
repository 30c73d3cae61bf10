/* The site drawn, as large as the screen: look at it, walk through it, choose how it is drawn. */
#include "render/kiosk/draw-screen.h"
#include "render/kiosk/screens.h"
#include <gio/gio.h>

#define ONE_SLIDE_US 2500000
/* A better one takes over when it stands in the person's own folder; else this is the first. */
#define FIRST_STYLE "figure-7c"

/* ---- drawing ---- */

void draw_screen_redraw(struct draw_screen *s, bool passing)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(style) now = style_edit_style(s->edit, s->folder, &error);
	drawing *d = now ? drawing_new(now, s->site->tree, NULL, &error) : NULL;
	if (d)
		easel_set_drawing(s->easel, d, passing);
	kiosk_complain_of(s->kiosk, error);
}

const char *draw_screen_node_key(const struct draw_screen *s, char buffer[32])
{
	const struct segment *node = s->site->tree ? segments_find(s->site->tree, s->node) : NULL;
	if (!node || s->node == SEGMENT_SITE)
		return "site";
	if (s->node == segment_of_class(node->class))
		return segment_classes[node->class].name;
	g_snprintf(buffer, 32, "#%u", s->node);
	return buffer;
}

/* ---- undo ---- */

struct before {
	struct draw_screen *screen;
	char *text;
};

static void before_free(gpointer data)
{
	struct before *b = data;
	g_free(b->text);
	g_free(b);
}

static void take_back(gpointer data)
{
	struct before *b = data;
	struct draw_screen *s = b->screen;
	g_autoptr(GError) error = NULL;
	style_edit *before = style_edit_parse(b->text, &error);
	if (!before) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	style_edit_free(s->edit);
	s->edit = before;
	g_clear_pointer(&s->last_slid, g_free);
	draw_screen_redraw(s, false);
	draw_panel_fill(s);
	draw_accents_refresh(s);
}

void draw_screen_will_change(struct draw_screen *s, const char *did)
{
	struct before *b = g_new0(struct before, 1);
	b->screen = s;
	b->text = style_edit_text(s->edit);
	kiosk_did(s->kiosk, did, take_back, b, before_free, s);
}

void draw_screen_will_slide(struct draw_screen *s, const char *what, const char *did)
{
	int64_t now_us = g_get_monotonic_time();
	if (g_strcmp0(what, s->last_slid) || now_us - s->last_slid_us > ONE_SLIDE_US)
		draw_screen_will_change(s, did);
	g_free(s->last_slid);
	s->last_slid = g_strdup(what);
	s->last_slid_us = now_us;
}

/* ---- buttons ---- */

static void adjust_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	(void)b;
	draw_panel_show(s, !gtk_widget_get_visible(s->panel));
}

static void take_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	(void)b;
	kiosk_push(s->kiosk, screen_take_new(s->kiosk, s->folder), "take", _("Take home"));
}

/* ---- what the easel tells ---- */

static void shown(const struct artist_picture *p, gpointer user_data)
{
	struct draw_screen *s = user_data;
	(void)p;
	gtk_stack_set_visible_child_name(GTK_STACK(s->stack), "draw");
}

static void small(uint32_t n, const struct artist_picture *p, gpointer user_data)
{
	draw_strip_got_small(user_data, n, p);
}

static void tapped(const struct scene_picked *picked, gpointer user_data)
{
	if (!draw_accents_tapped(user_data, picked))
		draw_panel_select(user_data, picked ? picked->leaf : 0);
}

static bool dragged(double right_px, double down_px, gpointer user_data)
{
	return draw_accents_dragged(user_data, right_px, down_px);
}

static void has_failed(const char *sentence, gpointer user_data)
{
	struct draw_screen *s = user_data;
	kiosk_complain(s->kiosk, sentence, NULL);
}

static void marks(cairo_t *cr, const struct camera *c, gpointer user_data)
{
	draw_panel_marks(user_data, cr, c);
	draw_accents_marks(user_data, cr, c);
}

/* ---- loading ---- */

static void load(GTask *task, gpointer source, gpointer data, GCancellable *cancel)
{
	g_autoptr(GError) error = NULL;
	(void)source;
	(void)cancel;
	g_autoptr(drawn_site) d = drawn_site_new(data, 1.6, &error);
	if (d && drawn_site_load(d, &error))
		g_task_return_pointer(task, g_steal_pointer(&d), (GDestroyNotify)drawn_site_free);
	else
		g_task_return_error(task, g_steal_pointer(&error));
}

static void loaded(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	drawn_site *d = g_task_propagate_pointer(G_TASK(result), &error);
	(void)source;
	if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return; /* the screen has been left */
	struct draw_screen *s = user_data;
	if (!d) {
		kit_set_text(s->nothing_text, error->message);
		gtk_stack_set_visible_child_name(GTK_STACK(s->stack), "nothing");
		return;
	}
	s->site = d;
	easel_set_site(s->easel, d);
	draw_views_look_from(s, d->stations->len ? "walk" : "overview", LOOKING_AROUND, 0);
	draw_strip_fill(s);
	draw_screen_use_style(s, FIRST_STYLE);
	gtk_stack_set_visible_child_name(GTK_STACK(s->stack), "draw");
}

/* ---- building ---- */

static GtkWidget *tools(struct draw_screen *s)
{
	GtkWidget *all = kit_row(8, draw_views_tools(s), draw_accents_tools(s), NULL);
	gtk_widget_set_halign(all, GTK_ALIGN_START);
	gtk_widget_set_valign(all, GTK_ALIGN_START);
	return kit_margin(all, 12);
}

static GtkWidget *corner(struct draw_screen *s)
{
	GtkWidget *row = kit_row(8,
		kit_button("draw-adjust", "document-edit-symbolic", _("Adjust"), NULL, NULL,
			G_CALLBACK(adjust_pressed), s),
		kit_button("draw-take", "document-save-symbolic", _("Take home"), NULL, NULL,
			G_CALLBACK(take_pressed), s),
		NULL);
	gtk_widget_set_halign(row, GTK_ALIGN_END);
	gtk_widget_set_valign(row, GTK_ALIGN_START);
	return kit_margin(row, 12);
}

static GtkWidget *message_page(GtkWidget *above, GtkWidget *text)
{
	GtkWidget *page = kit_column(24, above, text, NULL);
	gtk_widget_set_halign(page, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(page, GTK_ALIGN_CENTER);
	kit_narrow(text, -1, 50);
	return page;
}

static void build(struct draw_screen *s)
{
	GtkWidget *spinner = gtk_spinner_new();
	gtk_spinner_start(GTK_SPINNER(spinner));
	gtk_widget_set_size_request(spinner, 64, 64);
	s->wait_text = kit_text(_("The site is being opened."), "head");
	s->nothing_text = kit_named_text("draw-nothing", "", "head");
	s->stack = gtk_stack_new();
	gtk_stack_add_named(GTK_STACK(s->stack), message_page(spinner, s->wait_text), "wait");
	gtk_stack_add_named(GTK_STACK(s->stack),
		message_page(kit_text(_("There is nothing to draw yet"), "title"), s->nothing_text),
		"nothing");
	GtkWidget *over = gtk_overlay_new();
	gtk_overlay_set_child(GTK_OVERLAY(over), easel_widget(s->easel));
	gtk_overlay_add_overlay(GTK_OVERLAY(over), tools(s));
	gtk_overlay_add_overlay(GTK_OVERLAY(over), draw_accents_bar(s));
	gtk_overlay_add_overlay(GTK_OVERLAY(over), corner(s));
	gtk_overlay_add_overlay(GTK_OVERLAY(over), draw_panel_new(s));
	gtk_stack_add_named(GTK_STACK(s->stack),
		kit_column(0, kit_grow(over, true, true), draw_strip_new(s), NULL), "draw");
	s->widget = kit_column(0, kit_grow(s->stack, true, true), NULL);
}

static void destroyed(GtkWidget *w, gpointer user_data)
{
	struct draw_screen *s = user_data;
	(void)w;
	g_cancellable_cancel(s->gone);
	kiosk_forget_undo(s->kiosk, s);
	draw_accents_stop(s);
	s->strip_is_new = false;
	g_clear_handle_id(&s->strip_timer, g_source_remove);
	easel_free(s->easel);
	s->easel = NULL;
}

static void draw_screen_free(gpointer data)
{
	struct draw_screen *s = data;
	g_clear_object(&s->gone);
	drawn_site_free(s->site);
	style_edit_free(s->edit);
	g_strfreev(s->names);
	g_ptr_array_unref(s->pictures);
	g_free(s->style_name);
	g_free(s->last_slid);
	g_free(s->folder);
	g_free(s);
}

GtkWidget *screen_draw_new(kiosk *k, const char *folder)
{
	struct draw_screen *s = g_new0(struct draw_screen, 1);
	s->kiosk = k;
	s->folder = g_strdup(folder);
	s->gone = g_cancellable_new();
	s->node = SEGMENT_SITE;
	s->pictures = g_ptr_array_new();
	s->easel = easel_new("draw-canvas", kiosk_options_of(k)->backend,
		&(struct easel_watcher){ .shown = shown,
			.small = small,
			.tapped = tapped,
			.dragged = dragged,
			.failed = has_failed,
			.marks = marks,
			.user_data = s });
	build(s);
	g_signal_connect(s->widget, "destroy", G_CALLBACK(destroyed), s);
	g_object_set_data_full(G_OBJECT(s->widget), "screen", s, draw_screen_free);
	GTask *task = g_task_new(NULL, s->gone, loaded, s);
	g_task_set_return_on_cancel(task, FALSE);
	g_task_set_task_data(task, g_strdup(folder), g_free);
	g_task_run_in_thread(task, load);
	g_object_unref(task);
	return s->widget;
}
