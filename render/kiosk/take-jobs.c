#include "render/kiosk/take-jobs.h"
#include "render/kiosk/site-words.h"
#include "render/kiosk/take-words.h"
#include <gio/gio.h>

struct take_jobs {
	kiosk *kiosk;
	char *site;
	void (*ended)(gpointer user_data);
	gpointer user_data;
	GtkWidget *box, *notes; /* notes: what is to be known of what was made, in the box */
	GPtrArray *rows;        /* of struct row, that run */
	GPtrArray *outputs;     /* of char * */
	GCancellable *looking;
};

struct row {
	take_jobs *all;
	job_watch *watch;
	char *kind, *title, *output;
	GtkWidget *widget, *bar, *words, *stop;
	job_ended done;
	gpointer user_data;
};

static void row_free(struct row *r)
{
	g_free(r->kind);
	g_free(r->title);
	g_free(r->output);
	g_free(r);
}

/* ---- a row ---- */

static void row_progress(double fraction, const char *doing, double left_s, gpointer user_data)
{
	struct row *r = user_data;
	g_autofree char *left = words_left(left_s);
	g_autofree char *words = *left && doing && *doing
					 ? g_strdup_printf("%s · %s", words_doing(doing), left)
				 : *left           ? g_strdup(left)
				 : doing && *doing ? g_strdup(words_doing(doing))
						   : g_strdup(_("Waits for its turn"));
	kit_set_text(r->words, words);
	gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(r->bar), CLAMP(fraction, 0, 1));
}

static void say_end(const struct row *r, const char *state, const char *sentence)
{
	kiosk *k = r->all->kiosk;
	if (!g_strcmp0(state, "failed")) {
		kiosk_complain(
			k, sentence && *sentence ? sentence : _("It could not be done."), NULL);
		return;
	}
	bool stopped = !g_strcmp0(state, "cancelled");
	g_autofree char *said =
		g_strdup_printf(stopped ? _("Stopped: %s") : _("Done: %s"), r->title);
	/* Who started a copy has more to say of it. */
	if (stopped || !r->done)
		kiosk_say(k, said);
}

static void show_box(take_jobs *j)
{
	gtk_widget_set_visible(
		j->box, j->rows->len > 0 || gtk_widget_get_first_child(j->notes) != NULL);
}

/* ---- notes ---- */

static void note_read(GtkButton *button, gpointer user_data)
{
	take_jobs *j = user_data;
	gtk_box_remove(GTK_BOX(j->notes), gtk_widget_get_parent(GTK_WIDGET(button)));
	show_box(j);
}

static void show_notes(take_jobs *j, const char *title, const char *result)
{
	g_autofree char *notes = words_notes(result);
	if (!notes)
		return;
	GtkWidget *read = kit_button("job-note-read", "window-close-symbolic", NULL, _("Close"),
		"flat", G_CALLBACK(note_read), j);
	GtkWidget *texts = kit_column(
		2, kit_text(title, NULL), kit_named_text("job-notes", notes, "small"), NULL);
	gtk_widget_set_valign(read, GTK_ALIGN_START);
	gtk_box_append(GTK_BOX(j->notes),
		kit_classed(kit_row(12, kit_grow(texts, true, false), read, NULL), "card"));
}

/* ---- the end of one ---- */

static void row_ended(
	const char *state, const char *result, const char *sentence, gpointer user_data)
{
	struct row *r = user_data;
	take_jobs *j = r->all;
	gtk_box_remove(GTK_BOX(j->box), r->widget);
	g_ptr_array_remove(j->rows, r);
	show_notes(j, r->title, g_strcmp0(state, "done") ? NULL : result);
	show_box(j);
	say_end(r, state, sentence);
	if (r->done)
		r->done(state, result, sentence, r->user_data);
	row_free(r);
	j->ended(j->user_data);
}

static void stop_pressed(GtkButton *button, gpointer user_data)
{
	struct row *r = user_data;
	gtk_widget_set_sensitive(GTK_WIDGET(button), FALSE);
	kit_set_text(r->words, _("Is being stopped"));
	job_watch_cancel(r->watch);
}

static struct row *add_row(take_jobs *j, const char *kind, const char *title, const char *output)
{
	struct row *r = g_new0(struct row, 1);
	r->all = j;
	r->kind = g_strdup(kind);
	r->title = g_strdup(title);
	r->output = g_strdup(output);
	r->words = kit_line("job-words", _("Waits for its turn"), "soft small number", true);
	r->bar = gtk_progress_bar_new();
	gtk_widget_set_name(r->bar, "job-progress");
	r->stop = kit_button("job-stop", NULL, _("Stop"), NULL, NULL, G_CALLBACK(stop_pressed), r);
	gtk_widget_set_valign(r->stop, GTK_ALIGN_CENTER);
	GtkWidget *texts =
		kit_column(4, kit_line("job-title", title, NULL, true), r->bar, r->words, NULL);
	r->widget = kit_classed(kit_row(16, kit_grow(texts, true, false), r->stop, NULL), "card");
	gtk_widget_set_name(r->widget, "job");
	gtk_box_append(GTK_BOX(j->box), r->widget);
	g_ptr_array_add(j->rows, r);
	show_box(j);
	return r;
}

void take_jobs_start(take_jobs *j, const char *kind, const char *title, const char *output,
	GVariant *options, job_ended done, gpointer user_data)
{
	struct row *r = add_row(j, kind, title, output);
	r->done = done;
	r->user_data = user_data;
	r->watch = services_start_job(
		kiosk_services(j->kiosk), kind, j->site, options, row_progress, row_ended, r);
}

GPtrArray *take_jobs_outputs(take_jobs *j)
{
	g_ptr_array_set_size(j->outputs, 0);
	for (guint i = 0; i < j->rows->len; i++) {
		const struct row *r = g_ptr_array_index(j->rows, i);
		if (r->output)
			g_ptr_array_add(j->outputs, r->output);
	}
	return j->outputs;
}

/* ---- those that were started before ---- */

static const char *title_of(const char *kind)
{
	static const struct {
		const char *kind, *title;
	} titles[] = {
		{ "render", N_("A picture or film") },
		{ "report", N_("Report") },
		{ "export", N_("Points") },
		{ "copy", N_("Copy to a drive") },
		{ "import", N_("Scans from a drive") },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(titles); i++)
		if (!g_strcmp0(titles[i].kind, kind))
			return _(titles[i].title);
	return NULL;
}

static bool is_under_way(BusJobs1Job *job)
{
	const char *state = bus_jobs1_job_get_state(job);
	return !g_strcmp0(state, "waiting") || !g_strcmp0(state, "running");
}

static void found_job(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(BusJobs1Job) job = bus_jobs1_job_proxy_new_finish(result, &error);
	take_jobs *j = user_data;
	(void)source;
	/* The screen may be gone by now, and only then it is cancelled. */
	if (!job)
		return;
	const char *title = title_of(bus_jobs1_job_get_kind(job));
	if (!title || !is_under_way(job) || g_strcmp0(bus_jobs1_job_get_site(job), j->site))
		return;
	struct row *r = add_row(j, bus_jobs1_job_get_kind(job), title, NULL);
	r->watch = services_follow_job(kiosk_services(j->kiosk),
		g_dbus_proxy_get_object_path(G_DBUS_PROXY(job)), row_progress, row_ended, r);
}

static void look_for_jobs(take_jobs *j)
{
	BusJobs1 *jobs = services_jobs(kiosk_services(j->kiosk));
	const char *const *paths = bus_jobs1_get_jobs(jobs);
	for (; paths && *paths; paths++)
		bus_jobs1_job_proxy_new(g_dbus_proxy_get_connection(G_DBUS_PROXY(jobs)),
			G_DBUS_PROXY_FLAGS_DO_NOT_AUTO_START, "org.pleinair.Jobs1", *paths,
			j->looking, found_job, j);
}

/* ---- all of them ---- */

static void take_jobs_free(gpointer data)
{
	take_jobs *j = data;
	g_cancellable_cancel(j->looking);
	g_object_unref(j->looking);
	for (guint i = 0; i < j->rows->len; i++) {
		struct row *r = g_ptr_array_index(j->rows, i);
		job_watch_let_go(r->watch);
		row_free(r);
	}
	g_ptr_array_unref(j->rows);
	g_ptr_array_unref(j->outputs);
	g_free(j->site);
	g_free(j);
}

take_jobs *take_jobs_new(
	kiosk *k, const char *site, void (*ended)(gpointer user_data), gpointer user_data)
{
	take_jobs *j = g_new0(take_jobs, 1);
	j->kiosk = k;
	j->site = g_strdup(site);
	j->ended = ended;
	j->user_data = user_data;
	j->rows = g_ptr_array_new();
	j->outputs = g_ptr_array_new();
	j->looking = g_cancellable_new();
	j->notes = kit_column(10, NULL);
	j->box = kit_column(10, j->notes, NULL);
	gtk_widget_set_visible(j->box, FALSE);
	g_object_set_data_full(G_OBJECT(j->box), "jobs", j, take_jobs_free);
	look_for_jobs(j);
	return j;
}

GtkWidget *take_jobs_box(take_jobs *j)
{
	return j->box;
}
