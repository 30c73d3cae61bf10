/* Where one looks from: the whole site, plans, elevations and sections, from scan to scan, and what is kept. */
#include "render/kiosk/draw-screen.h"
#include "render/kiosk/take-words.h"
#include "render/view-parallel.h"
#include <gio/gio.h>

#define WALK_SECONDS 1.4
#define LOOK_SECONDS 0.9
#define COLUMNS      2

static void look_at_view(
	struct draw_screen *s, const view *v, enum looking_mode mode, double seconds)
{
	struct looking to = looking_of_view(v);
	if (to.mode != LOOKING_PARALLEL)
		to.mode = mode;
	easel_look(s->easel, &to, seconds);
	gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(s->around), to.mode == LOOKING_FROM);
}

void draw_views_look_from(
	struct draw_screen *s, const char *name, enum looking_mode mode, double seconds)
{
	g_autoptr(view) v = view_built_in(&s->site->sources, name);
	if (v)
		look_at_view(s, v, mode, seconds);
}

static void overview_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	(void)b;
	s->station = 0;
	draw_views_look_from(s, "overview", LOOKING_AROUND, LOOK_SECONDS);
}

/* ---- plans, elevations and sections ---- */

static void plan_chosen(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	g_autofree char *name = g_strdup(g_object_get_data(G_OBJECT(b), "view"));
	kiosk_close_sheet(s->kiosk); /* the button is gone with it */
	s->station = 0;
	draw_views_look_from(s, name, LOOKING_PARALLEL, LOOK_SECONDS);
}

static GtkWidget *plan_button(struct draw_screen *s, const char *name)
{
	g_autofree char *own = g_strdup_printf("draw-plan-%s", name), *words = words_view(name);
	GtkWidget *b = kit_button(own, NULL, words, NULL, NULL, G_CALLBACK(plan_chosen), s);
	g_object_set_data_full(G_OBJECT(b), "view", g_strdup(name), g_free);
	return kit_grow(b, true, false);
}

static void plan_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
	GtkWidget *grid = gtk_grid_new();
	(void)b;
	view_parallel_add_names(names);
	gtk_grid_set_row_spacing(GTK_GRID(grid), 10);
	gtk_grid_set_column_spacing(GTK_GRID(grid), 10);
	gtk_grid_set_column_homogeneous(GTK_GRID(grid), TRUE);
	for (guint n = 0; n < names->len; n++)
		gtk_grid_attach(GTK_GRID(grid), plan_button(s, g_ptr_array_index(names, n)),
			(int)n % COLUMNS, (int)n / COLUMNS, 1, 1);
	gtk_widget_set_size_request(grid, 720, -1);
	kiosk_open_sheet(s->kiosk,
		kit_column(18, kit_text(_("Plans, elevations and sections"), "title"),
			kit_text(
				_("All of it has one scale. A finger moves it, two make it larger; "
				  "taken home as a PDF it is on paper at 1:50, 1:100 or what "
				  "fits."),
				"soft"),
			grid, NULL));
}

/* ---- from scan to scan ---- */

static void walk_by(struct draw_screen *s, int by)
{
	guint n = s->site->stations->len;
	if (!n)
		return;
	s->station = s->station ? (s->station - 1 + n + (guint)(by + (int)n)) % n + 1 : 1;
	g_autofree char *name = g_strdup_printf("station-%u", s->station);
	draw_views_look_from(s, name, LOOKING_FROM, WALK_SECONDS);
	const struct view_station *at =
		&g_array_index(s->site->stations, struct view_station, s->station - 1);
	g_autofree char *said = g_strdup_printf(_("At scan %u"), at->number);
	kiosk_say(s->kiosk, said);
}

static void next_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	walk_by(user_data, 1);
}

static void previous_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	walk_by(user_data, -1);
}

/* Round things, or round oneself. What has no perspective gets it when one looks around from it, not when the button is let go for it. */
static void around_toggled(GtkToggleButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	struct looking l = easel_looking(s->easel);
	enum looking_mode mode = gtk_toggle_button_get_active(b) ? LOOKING_FROM : LOOKING_AROUND;
	if (l.mode == mode || (l.mode == LOOKING_PARALLEL && mode == LOOKING_AROUND))
		return;
	l.mode = mode;
	easel_look(s->easel, &l, 0);
}

/* ---- keeping ---- */

static void keep_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	struct looking l = easel_looking(s->easel);
	struct camera c = easel_camera(s->easel);
	g_autoptr(GError) error = NULL;
	g_autoptr(GDateTime) now = g_date_time_new_now_local();
	g_autofree char *name = g_date_time_format(now, "view-%Y%m%d-%H%M%S");
	g_autofree char *title = g_date_time_format(now, _("View of %H:%M"));
	g_autoptr(view) v = looking_view(&l, name, title, (double)c.width / MAX(c.height, 1));
	(void)b;
	v->style = g_strdup(s->style_name);
	if (!view_save(v, s->site->site, &error)) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	g_autofree char *said = g_strdup_printf(_("Kept as \"%s\"."), title);
	kiosk_say(s->kiosk, said);
}

GtkWidget *draw_views_tools(struct draw_screen *s)
{
	s->around = gtk_toggle_button_new();
	gtk_button_set_child(
		GTK_BUTTON(s->around), gtk_image_new_from_icon_name("view-refresh-symbolic"));
	gtk_widget_set_name(s->around, "draw-around");
	gtk_widget_set_tooltip_text(s->around, _("Look around from here"));
	gtk_accessible_update_property(GTK_ACCESSIBLE(s->around), GTK_ACCESSIBLE_PROPERTY_LABEL,
		_("Look around from here"), -1);
	g_signal_connect(s->around, "toggled", G_CALLBACK(around_toggled), s);
	return kit_column(8,
		kit_button("draw-overview", "go-home-symbolic", NULL, _("Whole site"), NULL,
			G_CALLBACK(overview_pressed), s),
		kit_button("draw-plan", "view-grid-symbolic", NULL,
			_("Plans, elevations and sections"), NULL, G_CALLBACK(plan_pressed), s),
		kit_button("draw-previous", "go-up-symbolic", NULL, _("Station before"), NULL,
			G_CALLBACK(previous_pressed), s),
		kit_button("draw-next", "go-down-symbolic", NULL, _("Next station"), NULL,
			G_CALLBACK(next_pressed), s),
		s->around,
		kit_button("draw-keep-view", "bookmark-new-symbolic", NULL, _("Keep this view"),
			NULL, G_CALLBACK(keep_pressed), s),
		NULL);
}
