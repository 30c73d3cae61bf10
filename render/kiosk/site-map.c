#include "render/kiosk/site-map.h"
#include <gio/gio.h>
#include <math.h>

#define STATION_PX 15.0
/* Around stations where there is no plan. */
#define ROOM_M 6.0

struct frame_m {
	double west, north, m_per_px, left, top;
};

static const site_state *state_of(GtkWidget *map)
{
	return g_object_get_data(G_OBJECT(map), "state");
}

/* ---- where ---- */

static void bounds_of_stations(const site_state *s, double low[2], double high[2])
{
	low[0] = low[1] = -ROOM_M;
	high[0] = high[1] = ROOM_M;
	for (guint i = 0; i < s->graph->scans->len; i++) {
		const struct placed_scan *p =
			&g_array_index(s->graph->scans, struct placed_scan, i);
		for (int k = 0; k < 2 && p->group == 1; k++) {
			low[k] = fmin(low[k], p->pose.translation_m[k] - ROOM_M);
			high[k] = fmax(high[k], p->pose.translation_m[k] + ROOM_M);
		}
	}
}

static struct frame_m frame_of(const site_state *s, double width, double height)
{
	struct frame_m f;
	double side = fmin(width, height), low[2], high[2];
	if (s->plan) {
		f.west = s->plan_west_m;
		f.north = s->plan_north_m;
		f.m_per_px = s->plan_m_per_px * SITE_PLAN_SIDE / side;
	} else {
		bounds_of_stations(s, low, high);
		double wide = fmax(high[0] - low[0], high[1] - low[1]);
		f.m_per_px = wide / side;
		f.west = (low[0] + high[0] - wide) / 2;
		f.north = (low[1] + high[1] + wide) / 2;
	}
	f.left = (width - side) / 2;
	f.top = (height - side) / 2;
	return f;
}

static void place(const struct frame_m *f, const double m[3], double *x, double *y)
{
	*x = f->left + (m[0] - f->west) / f->m_per_px;
	*y = f->top + (f->north - m[1]) / f->m_per_px;
}

/* ---- what ---- */

static void set_colour(cairo_t *cr, GtkWidget *map, const char *name)
{
	GdkRGBA c;
	if (!gtk_style_context_lookup_color(gtk_widget_get_style_context(map), name, &c))
		gdk_rgba_parse(&c, "#888");
	gdk_cairo_set_source_rgba(cr, &c);
}

static void draw_plan(cairo_t *cr, GtkWidget *map, const site_state *s, const struct frame_m *f)
{
	cairo_surface_t *plan = cairo_image_surface_create_for_data(
		s->plan, CAIRO_FORMAT_A8, SITE_PLAN_SIDE, SITE_PLAN_SIDE, SITE_PLAN_SIDE);
	double scale = s->plan_m_per_px / f->m_per_px;
	cairo_save(cr);
	cairo_translate(cr, f->left, f->top);
	cairo_scale(cr, scale, scale);
	set_colour(cr, map, "ink");
	cairo_mask_surface(cr, plan, 0, 0);
	cairo_restore(cr);
	cairo_surface_destroy(plan);
}

static void draw_edge(cairo_t *cr, GtkWidget *map, const site_state *s, const struct edge *e,
	const struct frame_m *f)
{
	const struct placed_scan *a = scan_graph_scan(s->graph, e->a);
	const struct placed_scan *b = scan_graph_scan(s->graph, e->b);
	double x[2], y[2];
	if (!a || !b || a->group != 1 || b->group != 1 || !edge_is_used(e))
		return;
	place(f, a->pose.translation_m, &x[0], &y[0]);
	place(f, b->pose.translation_m, &x[1], &y[1]);
	set_colour(cr, map, "good");
	cairo_set_line_width(cr, 3);
	cairo_move_to(cr, x[0], y[0]);
	cairo_line_to(cr, x[1], y[1]);
	cairo_stroke(cr);
}

static void draw_station(
	cairo_t *cr, GtkWidget *map, const site_state *s, uint32_t number, double x, double y)
{
	const char *verdict = site_state_scan_verdict(s, number);
	g_autofree char *text = g_strdup_printf("%u", number);
	cairo_text_extents_t size;
	cairo_arc(cr, x, y, STATION_PX, 0, 2 * G_PI);
	set_colour(cr, map, verdict ? verdict : "soft");
	cairo_fill_preserve(cr);
	set_colour(cr, map, "paper");
	cairo_set_line_width(cr, 2.5);
	cairo_stroke(cr);
	cairo_set_font_size(cr, 17);
	cairo_select_font_face(cr, "Inter", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
	cairo_text_extents(cr, text, &size);
	cairo_move_to(
		cr, x - size.width / 2 - size.x_bearing, y - size.height / 2 - size.y_bearing);
	cairo_show_text(cr, text);
}

static void draw_scale(cairo_t *cr, GtkWidget *map, const struct frame_m *f, double height)
{
	static const double steps_m[] = { 1, 2, 5, 10, 20, 50, 100, 200, 500 };
	double metres = 1;
	for (size_t i = 0; i < G_N_ELEMENTS(steps_m); i++)
		if (steps_m[i] / f->m_per_px < 120)
			metres = steps_m[i];
	g_autofree char *text = g_strdup_printf("%.0f m", metres);
	double x = 14, y = height - 16, long_px = metres / f->m_per_px;
	set_colour(cr, map, "ink");
	cairo_set_line_width(cr, 3);
	cairo_move_to(cr, x, y - 6);
	cairo_line_to(cr, x, y);
	cairo_line_to(cr, x + long_px, y);
	cairo_line_to(cr, x + long_px, y - 6);
	cairo_stroke(cr);
	cairo_select_font_face(cr, "Inter", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
	cairo_set_font_size(cr, 15);
	cairo_move_to(cr, x + long_px + 8, y + 2);
	cairo_show_text(cr, text);
}

/* Those that nothing ties to the others stand in a row at the edge. */
static void draw_stations(cairo_t *cr, GtkWidget *map, const site_state *s, const struct frame_m *f)
{
	double aside = 24;
	for (guint i = 0; i < s->scans->len; i++) {
		uint32_t number = g_array_index(s->scans, uint32_t, i);
		const struct placed_scan *p = scan_graph_scan(s->graph, number);
		double x = aside, y = 24, origin[3] = { 0 };
		if (s->scans->len == 1)
			place(f, origin, &x, &y);
		else if (p && p->group == 1)
			place(f, p->pose.translation_m, &x, &y);
		else
			aside += 2.5 * STATION_PX;
		draw_station(cr, map, s, number, x, y);
	}
}

/* A place without a scan yet. */
static void draw_next(cairo_t *cr, GtkWidget *map, const site_state *s, const struct frame_m *f)
{
	static const double dashes[] = { 5, 4 };
	double x, y, at[3] = { s->next.x_m, s->next.y_m };
	place(f, at, &x, &y);
	cairo_arc(cr, x, y, STATION_PX, 0, 2 * G_PI);
	set_colour(cr, map, "paper");
	cairo_fill(cr);
	set_colour(cr, map, "main");
	cairo_set_line_width(cr, 3);
	cairo_set_dash(cr, dashes, G_N_ELEMENTS(dashes), 0);
	cairo_arc(cr, x, y, STATION_PX, 0, 2 * G_PI);
	cairo_stroke(cr);
	cairo_set_dash(cr, NULL, 0, 0);
	cairo_move_to(cr, x - 7, y);
	cairo_line_to(cr, x + 7, y);
	cairo_move_to(cr, x, y - 7);
	cairo_line_to(cr, x, y + 7);
	cairo_stroke(cr);
}

static void draw(GtkDrawingArea *area, cairo_t *cr, int width, int height, gpointer user_data)
{
	GtkWidget *map = GTK_WIDGET(area);
	const site_state *s = state_of(map);
	(void)user_data;
	if (!s || !s->scans->len)
		return;
	struct frame_m f = frame_of(s, width, height);
	if (s->plan)
		draw_plan(cr, map, s, &f);
	for (guint i = 0; i < s->graph->edges->len; i++)
		draw_edge(cr, map, s, &g_array_index(s->graph->edges, struct edge, i), &f);
	if (s->has_next)
		draw_next(cr, map, s, &f);
	draw_stations(cr, map, s, &f);
	draw_scale(cr, map, &f, height);
}

GtkWidget *site_map_new(void)
{
	GtkWidget *map = gtk_drawing_area_new();
	gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(map), draw, NULL, NULL);
	gtk_widget_set_name(map, "site-map");
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(map), GTK_ACCESSIBLE_PROPERTY_LABEL, _("Plan of the stations"), -1);
	return map;
}

void site_map_show(GtkWidget *map, const site_state *state)
{
	g_object_set_data(G_OBJECT(map), "state", (gpointer)state);
	gtk_widget_queue_draw(map);
}
