#include "render/kiosk/box.h"
#include "render/kiosk/health.h"
#include "render/kiosk/status.h"
#include <gio/gio.h>
#include <math.h>

#define LOOK_AGAIN_S 2
#define HOT_C        80
/* Of the disk: from here on the bar warns. */
#define FULL 0.9

struct health_box {
	kiosk *kiosk;
	GtkWidget *bar, *room, *battery, *temperature, *scanner, *jobs;
	guint timer;
};

static void show_disk(struct health_box *h, const struct box_state *b)
{
	double used = b->total_bytes > 0 ? 1 - b->free_bytes / b->total_bytes : 0;
	g_autofree char *left = box_size_text(b->free_bytes), *all = box_size_text(b->total_bytes);
	g_autofree char *words = g_strdup_printf(_("%s free of %s"), left, all);
	kit_set_text(h->room, b->total_bytes > 0 ? words : _("Not known"));
	kit_set_verdict(h->room, used > FULL ? "bad" : NULL);
	gtk_level_bar_set_value(GTK_LEVEL_BAR(h->bar), used);
}

static void show_battery(struct health_box *h, const struct box_state *b)
{
	g_autofree char *words =
		b->battery_percent < 0
			? g_strdup(_("None: runs on mains"))
			: g_strdup_printf(b->is_charging ? _("%.0f %% charging") : "%.0f %%",
				  b->battery_percent);
	kit_set_text(h->battery, words);
}

static void show_temperature(struct health_box *h)
{
	double celsius = box_temperature_c("/sys/class/thermal");
	g_autofree char *words =
		isnan(celsius) ? g_strdup(_("No sensor")) : g_strdup_printf("%.0f °C", celsius);
	kit_set_text(h->temperature, words);
	kit_set_verdict(h->temperature, celsius > HOT_C ? "bad" : NULL);
}

static void show_service(GtkWidget *label, bool there)
{
	kit_set_text(label, there ? _("Runs") : _("Not there; is being started"));
	kit_set_verdict(label, there ? "good" : "bad");
}

static gboolean show(gpointer user_data)
{
	struct health_box *h = user_data;
	services *s = kiosk_services(h->kiosk);
	struct box_state b = box_state_now(kiosk_options_of(h->kiosk)->folder);
	show_disk(h, &b);
	show_battery(h, &b);
	show_temperature(h);
	show_service(h->scanner, services_has_acquisition(s));
	show_service(h->jobs, services_has_jobs(s));
	return G_SOURCE_CONTINUE;
}

static void health_box_free(gpointer data)
{
	struct health_box *h = data;
	g_source_remove(h->timer);
	g_free(h);
}

static GtkWidget *add_fact(GtkWidget *grid, int row, const char *name, const char *title)
{
	GtkWidget *value = kit_line(name, "", "number", true);
	gtk_grid_attach(GTK_GRID(grid), kit_line("fact-title", title, "soft", false), 0, row, 1, 1);
	gtk_grid_attach(GTK_GRID(grid), kit_grow(value, true, false), 1, row, 1, 1);
	return value;
}

GtkWidget *health_box_new(kiosk *k)
{
	struct health_box *h = g_new0(struct health_box, 1);
	GtkWidget *grid = gtk_grid_new();
	gtk_grid_set_row_spacing(GTK_GRID(grid), 10);
	gtk_grid_set_column_spacing(GTK_GRID(grid), 24);
	h->kiosk = k;
	h->room = add_fact(grid, 0, "health-room", _("Storage"));
	h->bar = gtk_level_bar_new();
	gtk_widget_set_name(h->bar, "health-storage");
	gtk_grid_attach(GTK_GRID(grid), h->bar, 1, 1, 1, 1);
	h->battery = add_fact(grid, 2, "health-battery", _("Battery"));
	h->temperature = add_fact(grid, 3, "health-temperature", _("Temperature"));
	h->scanner = add_fact(grid, 4, "health-acquired", _("Scanner service"));
	h->jobs = add_fact(grid, 5, "health-jobsd", _("Computing service"));
	kit_set_text(add_fact(grid, 6, "health-version", _("Version")), box_version());
	GtkWidget *card =
		kit_classed(kit_column(14, kit_text(_("This box"), "head"), grid, NULL), "card");
	h->timer = g_timeout_add_seconds(LOOK_AGAIN_S, show, h);
	g_object_set_data_full(G_OBJECT(card), "health-box", h, health_box_free);
	show(h);
	return card;
}
