/* What other scanners and programs left on a drive, into the site. */
#include "render/kiosk/choice.h"
#include "render/kiosk/drive-files.h"
#include "render/kiosk/drives.h"
#include "render/kiosk/screens.h"
#include "render/kiosk/take-jobs.h"
#include "render/kiosk/take-words.h"
#include <gio/gio.h>

#define SIDE_WIDTH 460

struct bring {
	kiosk *kiosk;
	char *site;
	GtkWidget *widget, *rows, *nothing, *all, *more, *chosen_words, *of_mesh, *start;
	choice *unit, *up, *spacing;
	take_jobs *jobs;
	drives_watch *watch;
	GPtrArray *files;    /* of drive_file; NULL: not read yet */
	GHashTable *chosen;  /* of char *, paths */
	GCancellable *looks; /* NULL: nobody looks through the drives */
	bool is_done;        /* nothing is left to be read or done here */
};

/* ---- what is chosen ---- */

struct chosen {
	guint files, meshes;
	double bytes;
	const char *name; /* of one of them */
};

static struct chosen sum_up(const struct bring *b)
{
	struct chosen c = { 0 };
	for (guint i = 0; b->files && i < b->files->len; i++) {
		const drive_file *f = g_ptr_array_index(b->files, i);
		if (!g_hash_table_contains(b->chosen, f->path))
			continue;
		c.files++;
		c.meshes += f->is_mesh;
		c.bytes += f->bytes;
		c.name = f->name;
	}
	return c;
}

static void show_chosen(struct bring *b)
{
	struct chosen c = sum_up(b);
	g_autofree char *size = g_format_size((guint64)c.bytes);
	g_autofree char *words =
		c.files ? g_strdup_printf(
				  ngettext("%u file, %s", "%u files, %s", c.files), c.files, size)
			: g_strdup(_("Tap the files that are to come into the site."));
	kit_set_text(b->chosen_words, words);
	gtk_widget_set_visible(b->of_mesh, c.meshes > 0);
	gtk_widget_set_sensitive(b->start, c.files > 0);
	gtk_widget_set_sensitive(b->all, b->files && b->files->len);
	gtk_button_set_label(GTK_BUTTON(b->all),
		c.files && c.files == b->files->len ? _("Choose none") : _("Choose all"));
}

static void row_toggled(GtkToggleButton *button, gpointer user_data)
{
	struct bring *b = user_data;
	const char *path = g_object_get_data(G_OBJECT(button), "path");
	GtkWidget *tick = g_object_get_data(G_OBJECT(button), "tick");
	bool on = gtk_toggle_button_get_active(button);
	gtk_widget_set_opacity(tick, on ? 1 : 0);
	if (on)
		g_hash_table_add(b->chosen, g_strdup(path));
	else
		g_hash_table_remove(b->chosen, path);
	show_chosen(b);
}

static void all_pressed(GtkButton *button, gpointer user_data)
{
	struct bring *b = user_data;
	bool on = sum_up(b).files < b->files->len;
	(void)button;
	for (GtkWidget *w = gtk_widget_get_first_child(b->rows); w;
		w = gtk_widget_get_next_sibling(w))
		gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(w), on);
}

/* ---- the list ---- */

static GtkWidget *row_of(struct bring *b, const drive_file *f)
{
	g_autofree char *size = g_format_size((guint64)f->bytes);
	g_autofree char *id = g_strconcat("file-", f->name, NULL);
	g_autofree char *words =
		g_strdup_printf("%s · %s · %s", f->is_mesh ? _("Mesh") : f->format, size, f->place);
	g_autofree char *told = g_strdup_printf("%s, %s", f->name, words);
	GtkWidget *tick = gtk_image_new_from_icon_name("object-select-symbolic");
	GtkWidget *texts = kit_column(2, kit_line("file-name", f->name, NULL, true),
		kit_line("file-words", words, "soft small number", true), NULL);
	GtkWidget *row = gtk_toggle_button_new();
	gtk_widget_set_opacity(tick, 0);
	gtk_widget_set_valign(texts, GTK_ALIGN_CENTER);
	gtk_widget_set_margin_top(texts, 6);
	gtk_widget_set_margin_bottom(texts, 6);
	gtk_button_set_child(
		GTK_BUTTON(row), kit_row(14, kit_grow(texts, true, false), tick, NULL));
	gtk_widget_set_name(row, id);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(row), GTK_ACCESSIBLE_PROPERTY_LABEL, told, -1);
	g_object_set_data_full(G_OBJECT(row), "path", g_strdup(f->path), g_free);
	g_object_set_data(G_OBJECT(row), "tick", tick);
	g_signal_connect(row, "toggled", G_CALLBACK(row_toggled), b);
	gtk_toggle_button_set_active(
		GTK_TOGGLE_BUTTON(row), g_hash_table_contains(b->chosen, f->path));
	return row;
}

static bool is_listed(const GPtrArray *files, const char *path)
{
	for (guint i = 0; i < files->len; i++)
		if (!g_strcmp0(((const drive_file *)g_ptr_array_index(files, i))->path, path))
			return true;
	return false;
}

static gboolean is_gone(gpointer key, gpointer value, gpointer files)
{
	(void)value;
	return !is_listed(files, key);
}

static void show_files(struct bring *b)
{
	const struct kiosk_options *o = kiosk_options_of(b->kiosk);
	g_autoptr(GPtrArray) drives = drives_list(o->drives);
	g_hash_table_foreach_remove(b->chosen, is_gone, b->files);
	kit_empty(b->rows);
	for (guint i = 0; i < b->files->len; i++)
		gtk_box_append(GTK_BOX(b->rows), row_of(b, g_ptr_array_index(b->files, i)));
	kit_set_text(b->nothing, drives->len
					 ? _("There is no file of points on the drive, nor a mesh.")
					 : _("Plug in a USB drive."));
	gtk_widget_set_visible(b->nothing, b->files->len == 0);
	show_chosen(b);
}

struct looked {
	char *const *drives; /* of the kiosk's options */
	bool all;
};

static void look_through(GTask *task, gpointer source, gpointer data, GCancellable *cancellable)
{
	struct looked *l = data;
	(void)source;
	g_task_return_pointer(task, drive_files_list(l->drives, cancellable, &l->all),
		(GDestroyNotify)g_ptr_array_unref);
}

static void files_found(GObject *source, GAsyncResult *result, gpointer user_data)
{
	struct looked *l = g_task_get_task_data(G_TASK(result));
	GPtrArray *files = g_task_propagate_pointer(G_TASK(result), NULL);
	struct bring *b = user_data;
	(void)source;
	/* The screen was left, or a drive came meanwhile. */
	if (!files)
		return;
	g_clear_object(&b->looks);
	g_clear_pointer(&b->files, g_ptr_array_unref);
	b->files = files;
	gtk_widget_set_visible(b->more, !l->all);
	show_files(b);
}

static void look(gpointer user_data)
{
	struct bring *b = user_data;
	struct looked *l = g_new0(struct looked, 1);
	if (b->looks)
		g_cancellable_cancel(b->looks);
	g_clear_object(&b->looks);
	b->looks = g_cancellable_new();
	l->drives = kiosk_options_of(b->kiosk)->drives;
	g_autoptr(GTask) task = g_task_new(NULL, b->looks, files_found, b);
	g_task_set_task_data(task, l, g_free);
	g_task_run_in_thread(task, look_through);
}

/* ---- it comes in ---- */

static void brought(const char *state, const char *result, const char *sentence, gpointer user_data)
{
	struct bring *b = user_data;
	g_autofree char *words = g_strcmp0(state, "done") ? NULL : words_brought(result);
	g_autofree char *notes = words ? words_notes(result) : NULL;
	(void)sentence;
	if (!words)
		return;
	g_autofree char *said = g_strdup_printf(_("Brought in: %s."), words);
	kiosk_say(b->kiosk, said);
	b->is_done = !notes;
}

static GVariant *options_of(const struct bring *b)
{
	g_auto(GVariantDict) options = G_VARIANT_DICT_INIT(NULL);
	GVariantBuilder paths;
	g_variant_builder_init(&paths, G_VARIANT_TYPE_STRING_ARRAY);
	for (guint i = 0; i < b->files->len; i++) {
		const drive_file *f = g_ptr_array_index(b->files, i);
		if (g_hash_table_contains(b->chosen, f->path))
			g_variant_builder_add(&paths, "s", f->path);
	}
	g_variant_dict_insert_value(&options, "arguments", g_variant_builder_end(&paths));
	if (!sum_up(b).meshes)
		return g_variant_dict_end(&options);
	const char *spacing = choice_value(b->spacing);
	g_variant_dict_insert(&options, "unit", "s", choice_value(b->unit));
	g_variant_dict_insert(&options, "up", "s", choice_value(b->up));
	if (g_strcmp0(spacing, "any"))
		g_variant_dict_insert(&options, "spacing", "d", g_ascii_strtod(spacing, NULL));
	return g_variant_dict_end(&options);
}

static void start_pressed(GtkButton *button, gpointer user_data)
{
	struct bring *b = user_data;
	struct chosen c = sum_up(b);
	(void)button;
	if (!c.files)
		return;
	g_autofree char *many = g_strdup_printf(ngettext("%u file", "%u files", c.files), c.files);
	GVariant *options = options_of(b);
	g_hash_table_remove_all(b->chosen);
	show_files(b);
	take_jobs_start(b->jobs, "import", c.files == 1 ? c.name : many, NULL, options, brought, b);
}

static void job_has_ended(gpointer user_data)
{
	struct bring *b = user_data;
	/* The site shows what came; but first what is to be known of it is read. */
	if (b->is_done && !g_strcmp0(kiosk_screen(b->kiosk), "bring"))
		kiosk_back(b->kiosk);
}

/* ---- how it looks ---- */

static choice *choose(struct bring *b, const char *name, const char *title,
	const char *const values[], const char *const words[])
{
	choice *c = choice_new(b->kiosk, name, title, NULL, NULL);
	for (size_t i = 0; values[i]; i++)
		choice_add(c, values[i], _(words[i]));
	return c;
}

static GtkWidget *labelled(const char *label, choice *c)
{
	return kit_column(4, kit_text(label, "soft small"), choice_button(c), NULL);
}

static GtkWidget *build_of_mesh(struct bring *b)
{
	static const char *const units[] = { "m", "cm", "mm", "in", "ft", NULL },
				 *const unit_words[] = { N_("Metres"), N_("Centimetres"),
					 N_("Millimetres"), N_("Inches"), N_("Feet") },
				 *const ups[] = { "z", "y", NULL },
				 *const up_words[] = { N_("z looks up"), N_("y looks up") },
				 *const spacings[] = { "any", "0.005", "0.01", "0.02", "0.05",
					 NULL },
				 *const spacing_words[] = { N_("Half a million points"),
					 N_("A point each 5 mm"), N_("A point each 1 cm"),
					 N_("A point each 2 cm"), N_("A point each 5 cm") };
	b->unit = choose(b, "bring-unit", _("Lengths in the mesh"), units, unit_words);
	b->up = choose(b, "bring-up", _("Which way is up"), ups, up_words);
	b->spacing = choose(b, "bring-spacing", _("Points on it"), spacings, spacing_words);
	b->of_mesh = kit_column(10, labelled(_("Lengths in the mesh"), b->unit),
		labelled(_("Which way is up"), b->up), labelled(_("Points on it"), b->spacing),
		NULL);
	return b->of_mesh;
}

static GtkWidget *build_files(struct bring *b)
{
	b->rows = kit_column(8, NULL);
	gtk_widget_set_name(b->rows, "files");
	b->nothing =
		kit_named_text("bring-nothing", _("The drives are being looked through."), "soft");
	b->more = kit_text(
		_("There are more files, or deeper folders, than are listed here."), "soft small");
	gtk_widget_set_visible(b->more, FALSE);
	b->all = kit_button(
		"bring-all", NULL, _("Choose all"), NULL, NULL, G_CALLBACK(all_pressed), b);
	GtkWidget *title = kit_grow(kit_text(_("On the drives"), "head"), true, false);
	gtk_widget_set_valign(title, GTK_ALIGN_CENTER);
	return kit_classed(kit_column(12, kit_row(12, title, b->all, NULL), b->nothing,
				   kit_scroll(b->rows), b->more, NULL),
		"card");
}

static GtkWidget *build_side(struct bring *b)
{
	b->jobs = take_jobs_new(b->kiosk, b->site, job_has_ended, b);
	b->chosen_words = kit_named_text("bring-chosen", "", "head");
	b->start = kit_button("bring-start", "document-open-symbolic", _("Bring in"), NULL,
		"main great", G_CALLBACK(start_pressed), b);
	GtkWidget *text = kit_text(
		_("E57 and PTX keep their grids, colours and poses; LAS, PLY, PCD and tables of "
		  "numbers come as points; on meshes (OBJ, PLY, STL, OFF) points are spread."),
		"soft small");
	GtkWidget *side = kit_column(16, b->chosen_words, text, build_of_mesh(b), b->start,
		kit_scroll(take_jobs_box(b->jobs)), NULL);
	gtk_widget_set_size_request(side, kit_is_upright() ? -1 : SIDE_WIDTH, -1);
	return side;
}

static void destroyed(GtkWidget *w, gpointer user_data)
{
	struct bring *b = user_data;
	(void)w;
	if (b->looks)
		g_cancellable_cancel(b->looks);
	g_clear_pointer(&b->watch, drives_watch_free);
}

static void bring_free(gpointer data)
{
	struct bring *b = data;
	g_clear_object(&b->looks);
	g_clear_pointer(&b->files, g_ptr_array_unref);
	g_hash_table_unref(b->chosen);
	g_free(b->site);
	g_free(b);
}

GtkWidget *screen_bring_new(kiosk *k, const char *folder)
{
	struct bring *b = g_new0(struct bring, 1);
	b->kiosk = k;
	b->site = g_strdup(folder);
	b->chosen = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	GtkWidget *files = kit_grow(build_files(b), true, true);
	b->widget =
		kit_margin(kit_sides(20, files, kit_grow(build_side(b), false, true), NULL), 20);
	b->watch = drives_watch_new(kiosk_options_of(k)->drives, look, b);
	g_signal_connect(b->widget, "destroy", G_CALLBACK(destroyed), b);
	g_object_set_data_full(G_OBJECT(b->widget), "bring", b, bring_free);
	show_chosen(b);
	look(b);
	return b->widget;
}
