#include "render/kiosk/kiosk-private.h"
#include "render/kiosk/site-words.h"
#include <gio/gio.h>
#include <string.h>

#define TOAST_DOWN    76
#define TOAST_SECONDS 6

/* ---- at the foot ---- */

static void show_toast(kiosk *k, const char *sentence, const char *advice, bool stays);

static void hide_toast(GtkButton *button, gpointer user_data)
{
	kiosk *k = user_data;
	(void)button;
	g_clear_handle_id(&k->toast_timer, g_source_remove);
	g_autofree char *next = g_queue_pop_head(&k->toasts);
	if (next) {
		show_toast(k, next, NULL, false);
		return;
	}
	gtk_revealer_set_reveal_child(GTK_REVEALER(k->toast), FALSE);
	gtk_widget_set_can_target(k->toast, FALSE);
}

static gboolean toast_is_over(gpointer user_data)
{
	kiosk *k = user_data;
	k->toast_timer = 0;
	hide_toast(NULL, k);
	return G_SOURCE_REMOVE;
}

static void show_toast(kiosk *k, const char *sentence, const char *advice, bool stays)
{
	g_clear_handle_id(&k->toast_timer, g_source_remove);
	kit_set_text(k->toast_text, sentence);
	kit_set_text(k->toast_advice, advice ? advice : "");
	gtk_widget_set_visible(k->toast_advice, advice && *advice);
	if (stays)
		gtk_widget_add_css_class(k->toast_box, "bad");
	else
		gtk_widget_remove_css_class(k->toast_box, "bad");
	gtk_widget_set_can_target(k->toast, TRUE);
	gtk_revealer_set_reveal_child(GTK_REVEALER(k->toast), TRUE);
	if (!stays)
		k->toast_timer = g_timeout_add_seconds(TOAST_SECONDS, toast_is_over, k);
}

void kiosk_say(kiosk *k, const char *sentence)
{
	journal_add(k->journal, sentence);
	/* What was said before is read first. */
	if (gtk_revealer_get_reveal_child(GTK_REVEALER(k->toast)))
		g_queue_push_tail(&k->toasts, g_strdup(sentence));
	else
		show_toast(k, sentence, NULL, false);
}

void kiosk_complain(kiosk *k, const char *sentence, const char *advice)
{
	g_autofree char *words = words_sentence(sentence);
	journal_add(k->journal, words);
	show_toast(k, words, advice, true);
}

void kiosk_hush(kiosk *k, const char *sentence)
{
	g_autofree char *words = words_sentence(sentence);
	if (gtk_revealer_get_reveal_child(GTK_REVEALER(k->toast)) &&
		g_strcmp0(gtk_label_get_text(GTK_LABEL(k->toast_text)), words) == 0)
		hide_toast(NULL, k);
}

/* GDBus has words for this that are none for people; it tells it by them alone. */
static bool nobody_answers(const GError *e)
{
	return g_error_matches(e, G_DBUS_ERROR, G_DBUS_ERROR_SERVICE_UNKNOWN) ||
	       g_error_matches(e, G_DBUS_ERROR, G_DBUS_ERROR_NAME_HAS_NO_OWNER) ||
	       g_error_matches(e, G_DBUS_ERROR, G_DBUS_ERROR_NO_REPLY) ||
	       (g_error_matches(e, G_IO_ERROR, G_IO_ERROR_FAILED) &&
		       strstr(e->message, "G_DBUS_PROXY_FLAGS_DO_NOT_AUTO_START"));
}

void kiosk_complain_of(kiosk *k, const GError *error)
{
	if (!error || g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		return;
	if (nobody_answers(error)) {
		kiosk_complain(k, _("The service that does this is not there just now."),
			_("It is being started again. Try once more in a moment."));
		return;
	}
	g_autoptr(GError) plain = g_error_copy(error);
	g_dbus_error_strip_remote_error(plain);
	kiosk_complain(k, plain->message, NULL);
}

static void build_toast(kiosk *k)
{
	k->toast_text = kit_named_text("toast-text", "", NULL);
	k->toast_advice = kit_named_text("toast-advice", "", "small");
	GtkWidget *texts = kit_column(2, k->toast_text, k->toast_advice, NULL);
	gtk_widget_set_valign(texts, GTK_ALIGN_CENTER);
	GtkWidget *close = kit_button("toast-close", "window-close-symbolic", NULL, _("Close"),
		NULL, G_CALLBACK(hide_toast), k);
	gtk_widget_set_valign(close, GTK_ALIGN_CENTER);
	k->toast_box = kit_classed(kit_row(16, kit_grow(texts, true, false), close, NULL), "toast");
	k->toast = gtk_revealer_new();
	gtk_revealer_set_child(GTK_REVEALER(k->toast), k->toast_box);
	gtk_revealer_set_transition_type(
		GTK_REVEALER(k->toast), GTK_REVEALER_TRANSITION_TYPE_SLIDE_DOWN);
	gtk_widget_set_halign(k->toast, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(k->toast, GTK_ALIGN_START);
	/* Below the bar, where no screen has buttons that are needed at once. */
	gtk_widget_set_margin_top(k->toast, TOAST_DOWN);
	gtk_widget_set_can_target(k->toast, FALSE);
	gtk_overlay_add_overlay(GTK_OVERLAY(k->overlay), k->toast);
}

/* ---- sheets ---- */

/* Keys go on where they were, or where they can. */
static void give_focus_back(kiosk *k)
{
	GtkWidget *before = k->focus_before, *front;
	g_clear_weak_pointer(&k->focus_before);
	if (before && gtk_widget_get_mapped(before) && gtk_widget_grab_focus(before))
		return;
	front = gtk_stack_get_visible_child(GTK_STACK(k->stack));
	if (front)
		gtk_widget_child_focus(front, GTK_DIR_TAB_FORWARD);
}

void kiosk_close_sheet(kiosk *k)
{
	bool was_open = gtk_widget_get_visible(k->shade);
	gtk_widget_set_can_focus(k->under, TRUE);
	gtk_widget_set_visible(k->shade, FALSE);
	kit_empty(k->sheet_box);
	if (was_open)
		give_focus_back(k);
}

static void pressed_beside(GtkGestureClick *g, int n, double x, double y, gpointer user_data)
{
	kiosk *k = user_data;
	(void)g;
	(void)n;
	graphene_rect_t box;
	if (gtk_widget_compute_bounds(k->sheet_box, k->shade, &box) &&
		!graphene_rect_contains_point(&box, &GRAPHENE_POINT_INIT((float)x, (float)y)))
		kiosk_close_sheet(k);
}

void kiosk_open_sheet(kiosk *k, GtkWidget *content)
{
	kit_empty(k->sheet_box);
	gtk_box_append(GTK_BOX(k->sheet_box), content);
	if (!gtk_widget_get_visible(k->shade))
		g_set_weak_pointer(&k->focus_before, gtk_window_get_focus(GTK_WINDOW(k->window)));
	gtk_widget_set_can_focus(k->under, FALSE);
	gtk_widget_set_visible(k->shade, TRUE);
	gtk_widget_child_focus(k->sheet_box, GTK_DIR_TAB_FORWARD);
}

static void build_shade(kiosk *k)
{
	k->shade = kit_classed(gtk_box_new(GTK_ORIENTATION_VERTICAL, 0), "shade");
	gtk_widget_set_name(k->shade, "shade");
	k->sheet_box = kit_classed(gtk_box_new(GTK_ORIENTATION_VERTICAL, 0), "sheet");
	gtk_widget_set_halign(k->sheet_box, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(k->sheet_box, GTK_ALIGN_CENTER);
	kit_grow(k->sheet_box, true, true);
	gtk_box_append(GTK_BOX(k->shade), k->sheet_box);
	gtk_widget_set_visible(k->shade, FALSE);
	GtkGesture *press = gtk_gesture_click_new();
	g_signal_connect(press, "released", G_CALLBACK(pressed_beside), k);
	gtk_widget_add_controller(k->shade, GTK_EVENT_CONTROLLER(press));
	gtk_overlay_add_overlay(GTK_OVERLAY(k->overlay), k->shade);
}

static void close_sheet_of(GtkButton *button, gpointer user_data)
{
	(void)button;
	kiosk_close_sheet(user_data);
}

void kiosk_ask(kiosk *k, const char *title, const char *text, const char *yes, GCallback done,
	gpointer user_data)
{
	GtkWidget *body = kit_text(text, NULL);
	kit_narrow(body, -1, 46);
	GtkWidget *sure =
		kit_button("sure", NULL, yes, NULL, "danger great", G_CALLBACK(close_sheet_of), k);
	/* Closed first: what is done may open the next one. */
	g_signal_connect(sure, "clicked", done, user_data);
	GtkWidget *no =
		kit_button("keep", NULL, _("Keep"), NULL, "great", G_CALLBACK(close_sheet_of), k);
	GtkWidget *buttons =
		kit_row(16, kit_grow(no, true, false), kit_grow(sure, true, false), NULL);
	kiosk_open_sheet(k, kit_column(18, kit_text(title, "title"), body, buttons, NULL));
}

void kiosk_build_says(kiosk *k)
{
	build_shade(k);
	build_toast(k);
}
