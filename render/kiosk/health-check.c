#include "process/site-list.h"
#include "render/kiosk/health.h"
#include <json-glib/json-glib.h>

struct health_check {
	kiosk *kiosk;
	GtkWidget *button, *says;
	job_watch *job; /* NULL: none runs */
};

static void say(struct health_check *h, const char *words, const char *verdict)
{
	kit_set_text(h->says, words);
	kit_set_verdict(h->says, verdict);
	gtk_widget_set_visible(h->says, *words != 0);
}

/* The document that pleinair calibrate --check prints. */
static void say_result(struct health_check *h, const char *result)
{
	g_autoptr(JsonNode) node = json_from_string(result ? result : "", NULL);
	JsonObject *o = node && JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
	if (!o || !json_object_has_member(o, "holds")) {
		say(h, _("The check gave no answer."), "bad");
		return;
	}
	bool holds = json_object_get_boolean_member(o, "holds");
	double apart_mm = json_object_get_double_member_with_default(o, "two_face_error_mm", 0);
	g_autofree char *words =
		g_strdup_printf(holds ? _("Good: both faces of the lidar agree to %.1f mm.")
				      : _("The two faces of the lidar are %.1f mm apart: the head "
					  "wants to be calibrated."),
			apart_mm);
	say(h, words, holds ? "good" : "bad");
}

static void ended(const char *state, const char *result, const char *sentence, gpointer user_data)
{
	struct health_check *h = user_data;
	h->job = NULL;
	gtk_widget_set_sensitive(h->button, TRUE);
	if (!g_strcmp0(state, "done"))
		say_result(h, result);
	else
		say(h, sentence ? sentence : "", "bad");
}

static void progress(double fraction, const char *doing, double seconds_left, gpointer user_data)
{
	struct health_check *h = user_data;
	g_autofree char *words = g_strdup_printf(_("Checking: %.0f %%"), 100 * fraction);
	(void)doing;
	(void)seconds_left;
	say(h, words, NULL);
}

/* The site that was scanned last has the scan that tells how the head is now. */
static char *last_site(kiosk *k)
{
	g_autoptr(GPtrArray) sites = site_list(kiosk_options_of(k)->folder, NULL);
	for (guint i = 0; sites && i < sites->len; i++) {
		const struct listed_site *s = g_ptr_array_index(sites, i);
		if (s->scans > 0)
			return g_strdup(s->path);
	}
	return NULL;
}

static void pressed(GtkButton *button, gpointer user_data)
{
	struct health_check *h = user_data;
	g_autofree char *site = last_site(h->kiosk);
	GVariantDict options;
	(void)button;
	if (!site) {
		say(h, _("Scan a place first: the check needs a scan."), NULL);
		return;
	}
	g_variant_dict_init(&options, NULL);
	g_variant_dict_insert(&options, "check", "b", TRUE);
	gtk_widget_set_sensitive(h->button, FALSE);
	say(h, _("Checking the last scan"), NULL);
	h->job = services_start_job(kiosk_services(h->kiosk), "calibrate", site,
		g_variant_dict_end(&options), progress, ended, h);
}

static void health_check_free(gpointer data)
{
	struct health_check *h = data;
	job_watch_let_go(h->job);
	g_free(h);
}

GtkWidget *health_check_new(kiosk *k)
{
	struct health_check *h = g_new0(struct health_check, 1);
	h->kiosk = k;
	h->button = kit_button("health-calibration", NULL, _("Check the scanner"), NULL, NULL,
		G_CALLBACK(pressed), h);
	h->says = kit_named_text("health-calibration-says", "", NULL);
	GtkWidget *box = kit_column(8,
		kit_text(_("Whether lidar and axis still sit as they were calibrated, by the last "
			   "scan."),
			"soft small"),
		h->says, h->button, NULL);
	say(h, "", NULL);
	g_object_set_data_full(G_OBJECT(box), "health-check", h, health_check_free);
	return kit_classed(box, "card");
}
