#include "acquire/doctor.h"
#include "render/kiosk/health.h"
#include "render/kiosk/site-words.h"
#include <gio/gio.h>

struct doctor {
	kiosk *kiosk;
	GtkWidget *intro, *rows, *spinner, *look;
	GCancellable *cancel;
};

static GtkWidget *row_of(const struct finding *f)
{
	static const char *const verdicts[] = {
		[FINDING_GOOD] = "good", [FINDING_NOTE] = NULL, [FINDING_BAD] = "bad"
	};
	GtkWidget *dot = kit_line("finding-dot", "●", "soft", false);
	GtkWidget *sentence = kit_grow(kit_text(f->sentence, NULL), true, false);
	GtkWidget *advice = kit_text(f->advice ? words_advice(f->advice) : "", "soft small");
	if (verdicts[f->state])
		gtk_widget_remove_css_class(dot, "soft");
	kit_set_verdict(dot, verdicts[f->state]);
	gtk_widget_set_valign(dot, GTK_ALIGN_START);
	gtk_widget_set_visible(advice, f->advice && *f->advice);
	return kit_row(10, dot, kit_grow(kit_column(2, sentence, advice, NULL), true, false), NULL);
}

static void append_row(struct doctor *d, const struct finding *f)
{
	GtkWidget *row = row_of(f);
	if (!gtk_widget_get_first_child(d->rows))
		gtk_widget_set_name(row, "finding-first");
	gtk_box_append(GTK_BOX(d->rows), row);
}

/* What is bad first, what is good last. */
static void show(struct doctor *d, const GPtrArray *findings)
{
	kit_empty(d->rows);
	gtk_widget_set_visible(d->intro, FALSE);
	for (int state = FINDING_BAD; state >= FINDING_GOOD; state--)
		for (guint i = 0; i < findings->len; i++) {
			const struct finding *f = findings->pdata[i];
			if ((int)f->state == state)
				append_row(d, f);
		}
}

static void set_looking(struct doctor *d, bool looking)
{
	gtk_spinner_set_spinning(GTK_SPINNER(d->spinner), looking);
	gtk_widget_set_visible(d->spinner, looking);
	gtk_widget_set_sensitive(d->look, !looking);
}

/* The scanner itself is asked by "Check now": its service owns it. */
static void look_there(GTask *task, gpointer source, gpointer folder, GCancellable *cancel)
{
	struct doctor_options options = { .folder = folder, .only_look = true };
	(void)source;
	(void)cancel;
	g_task_return_pointer(task, doctor_look(&options), (GDestroyNotify)g_ptr_array_unref);
}

static void looked(GObject *source, GAsyncResult *result, gpointer user_data)
{
	struct doctor *d = user_data;
	g_autoptr(GError) error = NULL;
	g_autoptr(GPtrArray) findings = g_task_propagate_pointer(G_TASK(result), &error);
	(void)source;
	/* The screen is gone. */
	if (!findings)
		return;
	set_looking(d, false);
	show(d, findings);
}

static void look_pressed(GtkButton *button, gpointer user_data)
{
	struct doctor *d = user_data;
	(void)button;
	set_looking(d, true);
	g_autoptr(GTask) task = g_task_new(NULL, d->cancel, looked, d);
	g_task_set_task_data(task, g_strdup(kiosk_options_of(d->kiosk)->folder), g_free);
	g_task_run_in_thread(task, look_there);
}

static void doctor_free(gpointer data)
{
	struct doctor *d = data;
	g_cancellable_cancel(d->cancel);
	g_object_unref(d->cancel);
	g_free(d);
}

GtkWidget *health_doctor_new(kiosk *k)
{
	struct doctor *d = g_new0(struct doctor, 1);
	d->kiosk = k;
	d->cancel = g_cancellable_new();
	d->intro = kit_text(
		_("Looks at plugs, rights, clocks and storage, and says what to do."), "soft");
	d->rows = kit_column(10, NULL);
	gtk_widget_set_name(d->rows, "health-findings");
	d->spinner = gtk_spinner_new();
	gtk_widget_set_size_request(d->spinner, 28, 28);
	gtk_widget_set_visible(d->spinner, FALSE);
	d->look = kit_button("health-doctor", NULL, _("Look at everything"), NULL, NULL,
		G_CALLBACK(look_pressed), d);
	GtkWidget *title =
		kit_grow(kit_line("doctor-title", _("Doctor"), "head", true), true, false);
	GtkWidget *top = kit_row(12, title, d->spinner, d->look, NULL);
	GtkWidget *card = kit_classed(kit_column(12, top, d->intro, d->rows, NULL), "card");
	g_object_set_data_full(G_OBJECT(card), "doctor", d, doctor_free);
	return card;
}
