#include "render/kiosk/take-drives.h"
#include "render/kiosk/take-words.h"
#include <gio/gio.h>
#include <string.h>

struct take_drives {
	kiosk *kiosk;
	char *site;
	take_jobs *jobs;
	GtkWidget *box, *rows, *none;
	drives_watch *watch;
	guint timer;       /* room on drives changes by itself */
	GHashTable *said;  /* path: what became of the last copy to it */
	GHashTable *busy;  /* paths that are copied or brought to rest */
	GPtrArray *copies; /* of struct copy */
	char *shown;       /* what the rows say */
};
#define LOOK_AGAIN_S 5

static void show_drives(take_drives *d);

static void say_of(take_drives *d, const char *path, const char *sentence)
{
	g_hash_table_insert(d->said, g_strdup(path), g_strdup(sentence));
	show_drives(d);
}

/* ---- copying ---- */

struct copy {
	take_drives *all;
	char *path, *name;
};

static struct copy *copy_new(take_drives *d, const char *path)
{
	struct copy *c = g_new0(struct copy, 1);
	*c = (struct copy){ d, g_strdup(path), g_path_get_basename(path) };
	return c;
}

static void copy_free(gpointer data)
{
	struct copy *c = data;
	g_free(c->path);
	g_free(c->name);
	g_free(c);
}

static void copied(const char *state, const char *result, const char *sentence, gpointer user_data)
{
	struct copy *c = user_data;
	take_drives *d = c->all;
	g_autofree char *words = g_strcmp0(state, "done") ? NULL : words_copied(result);
	g_hash_table_remove(d->busy, c->path);
	if (words) {
		g_autofree char *said = g_strdup_printf("%s: %s.", c->name, words);
		kiosk_say(d->kiosk, said);
		say_of(d, c->path, words);
	} else
		say_of(d, c->path,
			g_strcmp0(state, "failed") ? _("Stopped before all was copied.")
						   : sentence);
}

static void start_copy(take_drives *d, const char *path, const char *what)
{
	g_autofree char *name = g_path_get_basename(path);
	g_autofree char *title = g_strdup_printf(_("Copy to %s"), name);
	g_auto(GVariantDict) options = G_VARIANT_DICT_INIT(NULL);
	g_variant_dict_insert(&options, "to", "s", path);
	g_variant_dict_insert(&options, "what", "s", what);
	g_hash_table_remove(d->said, path);
	g_hash_table_add(d->busy, g_strdup(path));
	show_drives(d);
	struct copy *c = copy_new(d, path);
	g_ptr_array_add(d->copies, c);
	take_jobs_start(d->jobs, "copy", title, NULL, g_variant_dict_end(&options), copied, c);
}

static void what_pressed(GtkButton *button, gpointer user_data)
{
	take_drives *d = user_data;
	g_autofree char *path = g_strdup(g_object_get_data(G_OBJECT(button), "drive"));
	const char *what = g_object_get_data(G_OBJECT(button), "what");
	kiosk_close_sheet(d->kiosk);
	start_copy(d, path, what);
}

static GtkWidget *what_button(
	take_drives *d, const drive *to, const char *what, const char *title, double bytes)
{
	g_autofree char *name = g_strdup_printf("copy-%s", what),
			*size = g_format_size((guint64)bytes);
	bool fits = to->total_bytes <= 0 || bytes < to->free_bytes;
	g_autofree char *words =
		fits ? g_strdup(size) : g_strdup_printf(_("%s, for which there is no room"), size);
	GtkWidget *texts =
		kit_column(2, kit_text(title, NULL), kit_text(words, "soft small"), NULL);
	GtkWidget *b = kit_button(name, NULL, "", title, "great", G_CALLBACK(what_pressed), d);
	gtk_widget_set_valign(texts, GTK_ALIGN_CENTER);
	gtk_button_set_child(GTK_BUTTON(b), texts);
	gtk_widget_set_sensitive(b, fits && bytes > 0);
	g_object_set_data_full(G_OBJECT(b), "drive", g_strdup(to->path), g_free);
	g_object_set_data(G_OBJECT(b), "what", (gpointer)what);
	return b;
}

static double bytes_made(const char *site, bool pictures_only)
{
	g_autoptr(GPtrArray) items = exports_list(site);
	double bytes = 0;
	for (guint i = 0; i < items->len; i++) {
		const export_item *e = g_ptr_array_index(items, i);
		if (!pictures_only || e->kind == EXPORT_PICTURE || e->kind == EXPORT_FOLDER)
			bytes += e->bytes;
	}
	return bytes;
}

static double bytes_scanned(const char *site)
{
	g_autofree char *path = g_build_filename(site, "scans", NULL);
	g_autoptr(GFile) folder = g_file_new_for_path(path);
	guint64 bytes = 0;
	g_file_measure_disk_usage(
		folder, G_FILE_MEASURE_APPARENT_SIZE, NULL, NULL, NULL, &bytes, NULL, NULL, NULL);
	return (double)bytes;
}

static void ask_what(take_drives *d, const drive *to)
{
	g_autofree char *title = g_strdup_printf(_("Copy to %s"), to->name);
	GtkWidget *sheet = kit_column(14, kit_text(title, "title"),
		what_button(d, to, "exports", _("All that was made"), bytes_made(d->site, false)),
		what_button(d, to, "pictures", _("Pictures"), bytes_made(d->site, true)),
		what_button(d, to, "scans", _("All scans"), bytes_scanned(d->site)), NULL);
	gtk_widget_set_size_request(sheet, 460, -1);
	kiosk_open_sheet(d->kiosk, sheet);
}

static void copy_pressed(GtkButton *button, gpointer user_data)
{
	ask_what(user_data, g_object_get_data(G_OBJECT(button), "drive"));
}

void take_drives_ask(take_drives *d)
{
	const struct kiosk_options *o = kiosk_options_of(d->kiosk);
	g_autoptr(GPtrArray) all = drives_list(o->drives);
	for (guint i = 0; i < all->len; i++) {
		const drive *to = g_ptr_array_index(all, i);
		if (to->is_writable && !g_hash_table_contains(d->busy, to->path)) {
			ask_what(d, to);
			return;
		}
	}
	kiosk_say(d->kiosk, all->len ? _("Wait until the drive has taken what it is given.")
				     : _("Plug in a USB drive first."));
}

/* ---- to pull it out ---- */

static void sync_there(GTask *task, gpointer source, gpointer data, GCancellable *cancellable)
{
	GError *error = NULL;
	(void)source;
	(void)cancellable;
	if (drive_sync(((const struct copy *)data)->path, &error))
		g_task_return_boolean(task, TRUE);
	else
		g_task_return_error(task, error);
}

static void is_at_rest(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	const struct copy *c = g_task_get_task_data(G_TASK(result));
	take_drives *d = user_data;
	bool good = g_task_propagate_boolean(G_TASK(result), &error);
	/* Nobody waits for it any more: the screen was left. */
	if (!gtk_widget_get_parent(GTK_WIDGET(source)))
		return;
	g_hash_table_remove(d->busy, c->path);
	if (!good)
		kiosk_complain_of(d->kiosk, error);
	say_of(d, c->path, good ? _("You can pull it out now.") : error->message);
}

static void eject_pressed(GtkButton *button, gpointer user_data)
{
	take_drives *d = user_data;
	const drive *which = g_object_get_data(G_OBJECT(button), "drive");
	g_autoptr(GTask) task = g_task_new(d->box, NULL, is_at_rest, d);
	struct copy *c = copy_new(d, which->path);
	g_task_set_task_data(task, c, copy_free);
	g_hash_table_add(d->busy, g_strdup(c->path));
	say_of(d, c->path, _("What is still in memory is being written."));
	g_task_run_in_thread(task, sync_there);
}

/* ---- the list ---- */

static GtkWidget *row_of(take_drives *d, drive *one)
{
	g_autofree char *words = words_drive(one);
	bool busy = g_hash_table_contains(d->busy, one->path);
	const char *said = g_hash_table_lookup(d->said, one->path);
	GtkWidget *icon = gtk_image_new_from_icon_name("drive-removable-media-symbolic");
	gtk_image_set_pixel_size(GTK_IMAGE(icon), 36);
	GtkWidget *texts = kit_column(2, kit_line("drive-name", one->name, NULL, true),
		kit_line("drive-room", words, "soft small number", true), NULL);
	if (said)
		gtk_box_append(GTK_BOX(texts), kit_named_text("drive-said", said, "small"));
	gtk_widget_set_valign(texts, GTK_ALIGN_CENTER);
	GtkWidget *copy = kit_button(
		"drive-copy", NULL, _("Copy to drive"), NULL, NULL, G_CALLBACK(copy_pressed), d);
	GtkWidget *eject = kit_button("drive-eject", "media-eject-symbolic", NULL, _("Eject"), NULL,
		G_CALLBACK(eject_pressed), d);
	g_object_set_data(G_OBJECT(copy), "drive", one);
	g_object_set_data(G_OBJECT(eject), "drive", one);
	gtk_widget_set_sensitive(copy, one->is_writable && !busy);
	gtk_widget_set_sensitive(eject, one->is_writable && !busy);
	gtk_widget_set_valign(copy, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(eject, GTK_ALIGN_CENTER);
	GtkWidget *row = kit_row(14, icon, kit_grow(texts, true, false), copy, eject, NULL);
	g_object_set_data_full(G_OBJECT(row), "drive", one, (GDestroyNotify)drive_free);
	gtk_widget_set_name(row, "drive");
	return row;
}

/* All that the rows show. */
static char *summary_of(take_drives *d, const GPtrArray *all)
{
	g_autoptr(GString) s = g_string_new("");
	for (guint i = 0; i < all->len; i++) {
		const drive *one = g_ptr_array_index(all, i);
		g_autofree char *words = words_drive(one);
		const char *said = g_hash_table_lookup(d->said, one->path);
		g_string_append_printf(s, "%s\n%s\n%s\n%d\n", one->path, words, said ? said : "",
			g_hash_table_contains(d->busy, one->path));
	}
	return g_string_free(g_steal_pointer(&s), FALSE);
}

static void show_drives(take_drives *d)
{
	const struct kiosk_options *o = kiosk_options_of(d->kiosk);
	g_autoptr(GPtrArray) all = drives_list(o->drives);
	g_autofree char *summary = summary_of(d, all);
	/* A row that is being pressed must not go without need. */
	if (!g_strcmp0(summary, d->shown))
		return;
	g_free(d->shown);
	d->shown = g_steal_pointer(&summary);
	gtk_widget_set_visible(d->none, all->len == 0);
	kit_empty(d->rows);
	while (all->len)
		gtk_box_append(GTK_BOX(d->rows), row_of(d, g_ptr_array_steal_index(all, 0)));
}

static gboolean look_again(gpointer user_data)
{
	show_drives(user_data);
	return G_SOURCE_CONTINUE;
}

static void drives_changed(gpointer user_data)
{
	show_drives(user_data);
}

static void take_drives_free(gpointer data)
{
	take_drives *d = data;
	g_clear_handle_id(&d->timer, g_source_remove);
	drives_watch_free(d->watch);
	g_hash_table_unref(d->said);
	g_hash_table_unref(d->busy);
	g_ptr_array_unref(d->copies);
	g_free(d->shown);
	g_free(d->site);
	g_free(d);
}

take_drives *take_drives_new(kiosk *k, const char *site, take_jobs *jobs)
{
	take_drives *d = g_new0(take_drives, 1);
	d->kiosk = k;
	d->site = g_strdup(site);
	d->jobs = jobs;
	d->said = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
	d->busy = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	d->copies = g_ptr_array_new_with_free_func(copy_free);
	d->none = kit_text(
		_("Plug in a USB drive: what was made, and the scans, can be copied to it."),
		"soft");
	d->rows = kit_column(12, NULL);
	gtk_widget_set_name(d->rows, "drives");
	d->box = kit_column(0, d->none, d->rows, NULL);
	d->watch = drives_watch_new(kiosk_options_of(k)->drives, drives_changed, d);
	d->timer = g_timeout_add_seconds(LOOK_AGAIN_S, look_again, d);
	g_object_set_data_full(G_OBJECT(d->box), "take-drives", d, take_drives_free);
	show_drives(d);
	return d;
}

GtkWidget *take_drives_box(take_drives *d)
{
	return d->box;
}
