/* The site from above: what stands upright is drawn dark, as in an architect's plan. */
#include "process/report-private.h"
#include <math.h>
#include <string.h>

#define REACH_M       60.0 /* further points tell little of the plan */
#define PIXELS_MAX    1400.0
#define UPRIGHT_MIN_M 0.3 /* height within one pixel from which it is drawn */
#define UPRIGHT_MAX_M 3.0 /* from which it is black */

struct spot {
	float x, y, z;
};
struct report_plotter {
	uint32_t group;
	GArray *spots; /* of struct spot, in the site's frame */
	double west, east, south, north;
};

report_plotter *report_plotter_new(uint32_t group)
{
	report_plotter *p = g_new0(report_plotter, 1);
	p->group = group;
	p->spots = g_array_new(FALSE, FALSE, sizeof(struct spot));
	p->west = p->south = INFINITY;
	p->east = p->north = -INFINITY;
	return p;
}

void report_plotter_free(report_plotter *p)
{
	if (!p)
		return;
	g_array_unref(p->spots);
	g_free(p);
}

static void add_spot(report_plotter *p, const struct pose *pose, const double point[3])
{
	double there[3];
	pose_apply(pose, point, there);
	struct spot spot = { (float)there[0], (float)there[1], (float)there[2] };
	g_array_append_val(p->spots, spot);
}

static void widen(report_plotter *p, double x, double y)
{
	p->west = fmin(p->west, x);
	p->east = fmax(p->east, x);
	p->south = fmin(p->south, y);
	p->north = fmax(p->north, y);
}

#define SPOTS_PER_SCAN 400000u

static void add_grid(report_plotter *p, const range_grid *g, const struct pose *pose)
{
	size_t n = range_grid_cells(g), step = n / SPOTS_PER_SCAN + 1;
	for (size_t i = 0; i < n; i += step)
		if (g->range_m[i] > 0 && g->range_m[i] < REACH_M)
			add_spot(p, pose, (const double[3]){ g->x_m[i], g->y_m[i], g->z_m[i] });
}

static void add_cloud(report_plotter *p, const points *cloud, const struct pose *pose)
{
	size_t step = cloud->count / SPOTS_PER_SCAN + 1;
	for (uint64_t i = 0; i < cloud->count; i += step) {
		const struct point_record *r = &cloud->record[i];
		add_spot(p, pose, (const double[3]){ r->x_m, r->y_m, r->z_m });
	}
}

static int by_float(gconstpointer a, gconstpointer b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* A few stray points must not shrink the plan: the middle 98 % of the spots, in each direction. */
static void frame_spots(report_plotter *p, guint from)
{
	guint n = p->spots->len - from;
	g_autofree float *x = g_new(float, n + 1), *y = g_new(float, n + 1);
	for (guint i = 0; i < n; i++) {
		const struct spot *spot = &g_array_index(p->spots, struct spot, from + i);
		x[i] = spot->x;
		y[i] = spot->y;
	}
	qsort(x, n, sizeof *x, by_float);
	qsort(y, n, sizeof *y, by_float);
	if (n) {
		widen(p, x[n / 100], y[n / 100]);
		widen(p, x[n - 1 - n / 100], y[n - 1 - n / 100]);
	}
}

void report_plotter_add(report_plotter *p, const scan_data *d, const struct pose *pose)
{
	guint from = p->spots->len;
	if (d->grid)
		add_grid(p, d->grid, pose);
	else
		add_cloud(p, d->points, pose);
	frame_spots(p, from);
	widen(p, pose->translation_m[0], pose->translation_m[1]);
}

/* Lowest and highest point of each pixel. */
static void raise_columns(
	const report_plotter *p, const struct report_plan *plan, float *low, float *high)
{
	for (guint i = 0; i < p->spots->len; i++) {
		const struct spot *spot = &g_array_index(p->spots, struct spot, i);
		double column = (spot->x - plan->west_m) / plan->metres_per_pixel,
		       row = (plan->north_m - spot->y) / plan->metres_per_pixel;
		if (!(column >= 0 && column < plan->width && row >= 0 && row < plan->height))
			continue;
		size_t at = (size_t)row * plan->width + (size_t)column;
		low[at] = fminf(low[at], spot->z);
		high[at] = fmaxf(high[at], spot->z);
	}
}

static uint8_t tone(float low, float high)
{
	if (!(high >= low))
		return 255;
	double upright = (high - low - UPRIGHT_MIN_M) / (UPRIGHT_MAX_M - UPRIGHT_MIN_M);
	return (uint8_t)(236 - 200 * sqrt(CLAMP(upright, 0, 1)));
}

struct report_plan report_plotter_finish(report_plotter *p)
{
	double margin = 2, width = p->east - p->west + 2 * margin,
	       height = p->north - p->south + 2 * margin;
	struct report_plan plan = {
		.group = p->group, .west_m = p->west - margin, .north_m = p->north + margin
	};
	plan.metres_per_pixel = fmax(fmax(width, height) / PIXELS_MAX, 0.02);
	plan.width = (uint32_t)ceil(width / plan.metres_per_pixel);
	plan.height = (uint32_t)ceil(height / plan.metres_per_pixel);
	size_t n = (size_t)plan.width * plan.height;
	g_autofree float *low = g_new(float, n), *high = g_new(float, n);
	g_autofree uint8_t *grey = g_new(uint8_t, n);
	for (size_t i = 0; i < n; i++) {
		low[i] = INFINITY;
		high[i] = -INFINITY;
	}
	raise_columns(p, &plan, low, high);
	for (size_t i = 0; i < n; i++)
		grey[i] = tone(low[i], high[i]);
	plan.png = report_encode(grey, plan.width, plan.height, 1);
	return plan;
}

/* ---- SVG ---- */

/* 1, 2, 5, 10, 20 ... m: about a fifth of the plan. */
static double scale_bar_m(const struct report_plan *plan)
{
	double want = plan->width * plan->metres_per_pixel / 5, unit = pow(10, floor(log10(want)));
	return want >= 5 * unit ? 5 * unit : want >= 2 * unit ? 2 * unit : unit;
}

static void to_pixel(const struct report_plan *plan, const struct pose *pose, double ret[2])
{
	ret[0] = (pose->translation_m[0] - plan->west_m) / plan->metres_per_pixel;
	ret[1] = (plan->north_m - pose->translation_m[1]) / plan->metres_per_pixel;
}

static void append_edge(
	GString *html, const report *r, const struct report_plan *plan, const struct edge *e)
{
	const struct placed_scan *a = scan_graph_scan(r->graph, e->a),
				 *b = scan_graph_scan(r->graph, e->b);
	double from[2], to[2];
	if (!a || !b || a->group != plan->group || b->group != plan->group)
		return;
	to_pixel(plan, &a->pose, from);
	to_pixel(plan, &b->pose, to);
	g_string_append_printf(html,
		"<a href=\"#edge-%u-%u\"><line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" "
		"y2=\"%.1f\"><title>%u and %u: %s, overlap %.0f %%, rms %.1f "
		"mm</title></line></a>\n",
		e->a, e->b, report_standing_class(e), from[0], from[1], to[0], to[1], e->a, e->b,
		edge_standing(e), 100 * e->verification.overlap, 1000 * e->verification.rms_m);
}

static void append_station(
	GString *html, const struct report_plan *plan, const struct placed_scan *scan, double size)
{
	double at[2], yaw = pose_yaw_rad(&scan->pose);
	if (scan->group != plan->group)
		return;
	to_pixel(plan, &scan->pose, at);
	g_string_append_printf(html,
		"<a href=\"#scan-%u\"><line class=\"home\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" "
		"y2=\"%.1f\"/><circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/><text x=\"%.1f\" "
		"y=\"%.1f\" font-size=\"%.1f\">%u</text></a>\n",
		scan->number, at[0], at[1], at[0] + 1.9 * size * sin(yaw),
		at[1] - 1.9 * size * cos(yaw), at[0], at[1], size, at[0], at[1] + 0.36 * size,
		1.1 * size, scan->number);
}

static void append_scale(GString *html, const struct report_plan *plan, double size)
{
	double bar = scale_bar_m(plan), length = bar / plan->metres_per_pixel,
	       y = plan->height - size;
	g_string_append_printf(html,
		"<path class=\"scale\" d=\"M%.1f %.1fv%.1fh%.1fv%.1f\"/><text class=\"label\" "
		"x=\"%.1f\" y=\"%.1f\" font-size=\"%.1f\">%g m</text>\n",
		size, y - size / 2, size / 2, length, -size / 2, size + length / 2, y - size / 2,
		1.1 * size, bar);
}

void report_append_plan(GString *html, const report *r, const struct report_plan *plan)
{
	double size = MAX(plan->width, plan->height) / 70.0;
	g_string_append_printf(html,
		"<svg class=\"plan\" viewBox=\"0 0 %u %u\" role=\"img\" aria-label=\"plan of the "
		"stations\" style=\"--line:%.1f\"><image width=\"%u\" height=\"%u\" "
		"href=\"data:image/png;base64,%s\"/>\n",
		plan->width, plan->height, size / 4, plan->width, plan->height, plan->png);
	for (int pass = 0; pass < 2; pass++) /* what counts lies on top */
		for (guint i = 0; i < r->graph->edges->len; i++) {
			const struct edge *e = &g_array_index(r->graph->edges, struct edge, i);
			if (edge_is_used(e) == (pass == 1))
				append_edge(html, r, plan, e);
		}
	for (guint i = 0; i < r->graph->scans->len; i++)
		append_station(
			html, plan, &g_array_index(r->graph->scans, struct placed_scan, i), size);
	append_scale(html, plan, size);
	g_string_append(html, "</svg>\n");
}
