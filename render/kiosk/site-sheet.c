#include "render/kiosk/site-sheet.h"
#include "acquire/site-removal.h"
#include "acquire/site.h"
#include "render/kiosk/name-sheet.h"
#include <json-glib/json-glib.h>

/* So long it can be taken back; as the sentence says. */
#define KEPT_S 600

/* Of a sheet, and of what can be undone. */
struct managed {
	kiosk *kiosk;
	char *path, *name;
	char *was; /* to be undone: the name before, or where the removed site is */
	void (*changed)(gpointer user_data);
	gpointer user_data;
};

static struct managed *managed_new(
	kiosk *k, const char *path, const char *name, const struct site_sheet *of)
{
	struct managed *m = g_new0(struct managed, 1);
	*m = (struct managed){ k, g_strdup(path), g_strdup(name), NULL, of->changed,
		of->user_data };
	return m;
}

static struct managed *to_undo(const struct managed *m, const char *was)
{
	struct managed *u = managed_new(m->kiosk, m->path, m->name,
		&(struct site_sheet){ .changed = m->changed, .user_data = m->user_data });
	u->was = g_strdup(was);
	return u;
}

static void managed_free(gpointer data)
{
	struct managed *m = data;
	g_free(m->path);
	g_free(m->name);
	g_free(m->was);
	g_free(m);
}

/* ---- another name ---- */

static bool set_name(struct managed *m, const char *name)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(m->path, &error);
	JsonNode *node = s ? json_node_init_string(json_node_alloc(), name) : NULL;
	if (node && site_set(s, "name", node, &error)) {
		m->changed(m->user_data);
		return true;
	}
	kiosk_complain_of(m->kiosk, error);
	return false;
}

static void undo_name(gpointer data)
{
	struct managed *m = data;
	set_name(m, m->was);
}

static void named(const char *name, gpointer user_data)
{
	struct managed *m = user_data;
	/* The sheet has m, and goes. */
	g_autofree char *did = g_strdup_printf(_("%s is called %s"), m->name, name);
	if (!set_name(m, name))
		return;
	kiosk_did(m->kiosk, did, undo_name, to_undo(m, m->name), managed_free, m->user_data);
	kiosk_close_sheet(m->kiosk);
}

static void rename_pressed(GtkButton *b, gpointer user_data)
{
	struct managed *m = user_data;
	(void)b;
	struct managed *next = to_undo(m, NULL);
	/* Closes the sheet that has m. */
	name_sheet_open(m->kiosk, &(struct name_sheet){ .id = "rename-site",
					  .title = _("Another name"),
					  .label = _("Name of the site"),
					  .yes = _("Rename"),
					  .name = next->name,
					  .done = named,
					  .user_data = next,
					  .user_data_free = managed_free });
}

/* ---- away with it ---- */

static void undo_removal(gpointer data)
{
	struct managed *m = data;
	g_autoptr(GError) error = NULL;
	if (!site_restore(m->was, NULL, &error))
		kiosk_complain_of(m->kiosk, error);
	m->changed(m->user_data);
}

static void remove_pressed(GtkButton *b, gpointer user_data)
{
	struct managed *m = user_data;
	g_autoptr(GError) error = NULL;
	g_autofree char *hidden = NULL, *did = g_strdup_printf(_("%s removed"), m->name);
	g_autofree char *said =
		g_strdup_printf(_("%s is removed. For ten minutes Undo brings it back."), m->name);
	(void)b;
	if (!site_remove(m->path, &hidden, &error)) {
		kiosk_complain_of(m->kiosk, error);
		return;
	}
	kiosk_say(m->kiosk, said);
	kiosk_did(m->kiosk, did, undo_removal, to_undo(m, hidden), managed_free, m->user_data);
	m->changed(m->user_data);
	kiosk_close_sheet(m->kiosk);
}

static void clear_there(GTask *task, gpointer source, gpointer folder, GCancellable *cancellable)
{
	(void)source;
	(void)cancellable;
	site_clear_removed(folder, KEPT_S);
	g_task_return_boolean(task, TRUE);
}

void site_sheet_clear_removed(kiosk *k)
{
	g_autoptr(GTask) task = g_task_new(NULL, NULL, NULL, NULL);
	g_task_set_task_data(task, g_strdup(kiosk_options_of(k)->folder), g_free);
	g_task_run_in_thread(task, clear_there);
}

/* ---- the sheet ---- */

static void close_pressed(GtkButton *b, gpointer user_data)
{
	struct managed *m = user_data;
	(void)b;
	kiosk_close_sheet(m->kiosk);
}

void site_sheet_open(kiosk *k, const struct site_sheet *desc)
{
	struct managed *m = managed_new(k, desc->path, desc->name, desc);
	GtkWidget *buttons = kit_row(16,
		kit_grow(kit_button("site-rename", "document-edit-symbolic", _("Another name"),
				 NULL, "great", G_CALLBACK(rename_pressed), m),
			true, false),
		kit_grow(kit_button("site-remove", "user-trash-symbolic", _("Remove"), NULL,
				 "danger great", G_CALLBACK(remove_pressed), m),
			true, false),
		NULL);
	GtkWidget *sheet = kit_column(16, kit_text(desc->name, "title"),
		kit_text(desc->facts, "soft"), buttons,
		kit_button("site-sheet-close", NULL, _("Close"), NULL, "great",
			G_CALLBACK(close_pressed), m),
		NULL);
	gtk_widget_set_size_request(sheet, kit_is_upright() ? -1 : 640, -1);
	g_object_set_data_full(G_OBJECT(sheet), "managed", m, managed_free);
	kiosk_open_sheet(k, sheet);
}
