#include "firmware-io/files.h"
#include "render/kiosk/drives.h"
#include "render/kiosk/health.h"
#include "render/kiosk/journal.h"
#include <gio/gio.h>
#include <string.h>

struct health_log {
	kiosk *kiosk;
	GtkWidget *label;
	char *last; /* line that is shown */
	guint timer;
};

#define TIME_LETTERS 19

/* Newest first, times in bold. */
static char *markup_of(const GPtrArray *lines)
{
	GString *s = g_string_new("");
	for (guint i = lines->len; i-- > 0;) {
		const char *line = g_ptr_array_index(lines, i);
		size_t time = MIN(strlen(line), TIME_LETTERS);
		g_autofree char *rest = g_markup_escape_text(line + time, -1);
		g_autofree char *when = g_markup_escape_text(line, (gssize)time);
		g_string_append_printf(s, "<b>%s</b>%s%s", when, rest, i ? "\n" : "");
	}
	return g_string_free(s, FALSE);
}

/* As it came. */
static char *text_of(const GPtrArray *lines)
{
	GString *s = g_string_new("");
	for (guint i = 0; i < lines->len; i++)
		g_string_append_printf(s, "%s\n", (const char *)g_ptr_array_index(lines, i));
	return g_string_free(s, FALSE);
}

static gboolean show(gpointer user_data)
{
	struct health_log *h = user_data;
	GPtrArray *lines = journal_lines(kiosk_journal(h->kiosk));
	const char *last = lines->len ? g_ptr_array_index(lines, lines->len - 1) : "";
	if (!g_strcmp0(last, h->last))
		return G_SOURCE_CONTINUE;
	g_autofree char *markup = markup_of(lines);
	g_free(h->last);
	h->last = g_strdup(last);
	if (lines->len)
		gtk_label_set_markup(GTK_LABEL(h->label), markup);
	else
		kit_set_text(h->label, _("Nothing has happened yet."));
	return G_SOURCE_CONTINUE;
}

/* ---- onto a drive ---- */

static char *log_name(void)
{
	g_autoptr(GDateTime) now = g_date_time_new_now_local();
	return g_date_time_format(now, "pleinair-log-%Y-%m-%d-%H%M%S.txt");
}

static void save_to(kiosk *k, const drive *d)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *name = log_name(), *path = g_build_filename(d->path, name, NULL);
	g_autofree char *text = text_of(journal_lines(kiosk_journal(k)));
	g_autofree char *said = g_strdup_printf(_("%s is on %s."), name, d->name);
	if (files_write(path, text, strlen(text), &error))
		kiosk_say(k, said);
	else
		kiosk_complain_of(k, error);
}

static void drive_pressed(GtkButton *button, gpointer user_data)
{
	kiosk *k = user_data;
	/* The sheet owns the drive. */
	save_to(k, g_object_get_data(G_OBJECT(button), "drive"));
	kiosk_close_sheet(k);
}

static void ask_which(kiosk *k, GPtrArray *drives)
{
	GtkWidget *sheet = kit_column(14, kit_text(_("Save log to"), "title"), NULL);
	while (drives->len) {
		drive *d = g_ptr_array_steal_index(drives, 0);
		g_autofree char *name = g_strdup_printf("log-to-%s", d->name);
		GtkWidget *b = kit_button(
			name, NULL, d->name, NULL, "great", G_CALLBACK(drive_pressed), k);
		g_object_set_data_full(G_OBJECT(b), "drive", d, (GDestroyNotify)drive_free);
		gtk_box_append(GTK_BOX(sheet), b);
	}
	gtk_widget_set_size_request(sheet, 420, -1);
	kiosk_open_sheet(k, sheet);
}

static void save_pressed(GtkButton *button, gpointer user_data)
{
	kiosk *k = user_data;
	g_autoptr(GPtrArray) drives = drives_list(kiosk_options_of(k)->drives);
	(void)button;
	if (!drives->len)
		kiosk_say(k, _("Plug in a USB drive first."));
	else if (drives->len == 1)
		save_to(k, g_ptr_array_index(drives, 0));
	else
		ask_which(k, drives);
}

/* ---- the whole ---- */

static void health_log_free(gpointer data)
{
	struct health_log *h = data;
	g_source_remove(h->timer);
	g_free(h->last);
	g_free(h);
}

GtkWidget *health_log_new(kiosk *k)
{
	struct health_log *h = g_new0(struct health_log, 1);
	h->kiosk = k;
	h->label = kit_named_text("health-log", "", "small number");
	gtk_label_set_yalign(GTK_LABEL(h->label), 0);
	GtkWidget *save = kit_button("health-log-save", "document-save-symbolic",
		_("Save log to drive"), NULL, NULL, G_CALLBACK(save_pressed), k);
	GtkWidget *top = kit_row(12,
		kit_grow(kit_line("log-title", _("What happened"), "head", true), true, false),
		save, NULL);
	GtkWidget *card = kit_classed(kit_column(10, top, kit_scroll(h->label), NULL), "card");
	h->timer = g_timeout_add_seconds(1, show, h);
	g_object_set_data_full(G_OBJECT(card), "health-log", h, health_log_free);
	show(h);
	return card;
}
