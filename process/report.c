#include "process/report.h"
#include "acquire/scan.h"
#include "process/report-private.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

static void clear_scan(gpointer data)
{
	struct report_scan *s = data;
	g_free(s->what);
	g_free(s->when);
}

static void clear_edge(gpointer data)
{
	g_free(((struct report_edge *)data)->map_png);
}

static void clear_plan(gpointer data)
{
	g_free(((struct report_plan *)data)->png);
}

static GArray *array_of(size_t size, GDestroyNotify clear)
{
	GArray *array = g_array_new(FALSE, TRUE, (guint)size);
	g_array_set_clear_func(array, clear);
	return array;
}

void report_free(report *r)
{
	if (!r)
		return;
	g_array_unref(r->scans);
	g_array_unref(r->edges);
	g_array_unref(r->plans);
	g_free(r);
}

/* ---- how edges stand ---- */

const char *report_standing_class(const struct edge *e)
{
	if (!edge_is_used(e))
		return e->outlier ? "outlier" : "refused";
	return e->decision == DECISION_ACCEPTED ? "byhand" : "accepted";
}

/* ---- collecting ---- */

struct collecting {
	report *r;
	const struct report_options *options;
	uint32_t done, steps;
};

static bool step_on(struct collecting *c, const char *doing, GError **error)
{
	const struct report_options *o = c->options;
	double fraction = (double)c->done++ / c->steps;
	if (!o || !o->progress || o->progress(fraction, doing, o->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	return false;
}

static char *describe(const manifest *m)
{
	const char *file =
		manifest_has(m, "source.file") ? manifest_get_string(m, "source.file", NULL) : NULL;
	if (file)
		return g_strdup(file);
	const char *preset = manifest_get_string(m, "preset", NULL),
		   *model = manifest_get_string(m, "lidar.model", NULL);
	return g_strdup_printf(
		"%s, %s", preset ? preset : "unknown preset", model ? model : "unknown scanner");
}

static void read_manifest(struct report_scan *facts, const site *s)
{
	g_autofree char *folder = site_scan_path(s, facts->placed->number);
	g_autofree char *path = g_build_filename(folder, "scan.json", NULL);
	g_autoptr(manifest) m = manifest_load(path, SCAN_SCHEMA, NULL);
	if (!m)
		return;
	facts->what = describe(m);
	facts->when = g_strdup(manifest_get_string(m, "started", NULL));
	if (!facts->when)
		facts->when = g_strdup(manifest_get_string(m, "created", NULL));
}

static void measure_scan(struct report_scan *facts, const scan_data *d)
{
	const struct pose *pose = &facts->placed->pose;
	facts->kind = d->kind;
	facts->points = d->grid ? range_grid_count(d->grid) : d->points->count;
	facts->columns = d->grid ? d->grid->columns : 0;
	facts->rows = d->grid ? d->grid->rows : 0;
	facts->yaw_deg = fmod(pose_yaw_rad(pose) * 180 / G_PI + 360, 360);
	facts->tilt_deg = acos(CLAMP(pose->rotation[2][2], -1, 1)) * 180 / G_PI;
}

static report_plotter *plotter_of(GPtrArray *plotters, uint32_t group)
{
	while (plotters->len < group)
		g_ptr_array_add(plotters, report_plotter_new(plotters->len + 1));
	return plotters->pdata[group - 1];
}

static bool collect_scan(
	struct collecting *c, const struct placed_scan *placed, GPtrArray *plotters, GError **error)
{
	struct report_scan facts = { .placed = placed };
	g_autofree char *doing = g_strdup_printf("reading scan %u", placed->number);
	g_autoptr(scan_data) d =
		step_on(c, doing, error) ? scan_data_load(c->r->site, placed->number, error) : NULL;
	if (!d)
		return false;
	read_manifest(&facts, c->r->site);
	measure_scan(&facts, d);
	g_array_append_val(c->r->scans, facts);
	if (placed->group)
		report_plotter_add(plotter_of(plotters, placed->group), d, &placed->pose);
	return true;
}

static void finish_plans(report *r, GPtrArray *plotters)
{
	for (guint i = 0; i < plotters->len; i++) {
		struct report_plan plan = report_plotter_finish(plotters->pdata[i]);
		g_array_append_val(r->plans, plan);
	}
}

static bool collect_scans(struct collecting *c, GError **error)
{
	g_autoptr(GPtrArray) plotters =
		g_ptr_array_new_with_free_func((GDestroyNotify)report_plotter_free);
	const GArray *scans = c->r->graph->scans;
	for (guint i = 0; i < scans->len; i++)
		if (!collect_scan(c, &g_array_index(scans, struct placed_scan, i), plotters, error))
			return false;
	finish_plans(c->r, plotters);
	return true;
}

/* Edges come sorted by their first scan, which is kept from one to the next. */
struct kept_scan {
	uint32_t number;
	scan_data *data;
	pair_scan *prepared;
};

static void drop_scan(struct kept_scan *k)
{
	pair_scan_free(k->prepared);
	scan_data_free(k->data);
	*k = (struct kept_scan){ 0 };
}

static bool take_scan(struct kept_scan *k, const site *s, uint32_t number, GError **error)
{
	if (k->number == number)
		return true;
	drop_scan(k);
	k->data = scan_data_load(s, number, error);
	k->number = number;
	if (k->data && k->data->grid)
		k->prepared = pair_scan_new(k->data->grid);
	return k->data;
}

static void draw_edge(
	struct report_edge *facts, const struct kept_scan *a, const struct kept_scan *b)
{
	const struct edge *e = facts->edge;
	struct fine_result fine = { .pose = e->pose, .converged = true };
	struct verification ignored;
	struct verify_map map = { 0 };
	if (!a->prepared || !b->prepared || e->verification.verdict == VERDICT_NO_SOLUTION)
		return;
	memcpy(fine.covariance, e->covariance, sizeof fine.covariance);
	pair_verify(a->prepared, b->prepared, &fine, &ignored, &map);
	report_draw_map(facts, &map);
	verify_map_clear(&map);
}

static bool collect_edge(
	struct collecting *c, const struct edge *e, struct kept_scan kept[2], GError **error)
{
	struct report_edge facts = { .edge = e };
	g_autofree char *doing = g_strdup_printf("comparing %u and %u", e->a, e->b);
	if (!step_on(c, doing, error))
		return false;
	if (!c->options || !c->options->no_maps) {
		if (!take_scan(&kept[0], c->r->site, e->a, error) ||
			!take_scan(&kept[1], c->r->site, e->b, error))
			return false;
		draw_edge(&facts, &kept[0], &kept[1]);
	}
	g_array_append_val(c->r->edges, facts);
	return true;
}

static bool collect_edges(struct collecting *c, GError **error)
{
	struct kept_scan kept[2] = { 0 };
	const GArray *edges = c->r->graph->edges;
	bool good = true;
	for (guint i = 0; i < edges->len && good; i++)
		good = collect_edge(c, &g_array_index(edges, struct edge, i), kept, error);
	drop_scan(&kept[0]);
	drop_scan(&kept[1]);
	return good;
}

report *report_new(
	const site *s, const scan_graph *g, const struct report_options *options, GError **error)
{
	g_autoptr(report) r = g_new0(report, 1);
	r->site = s;
	r->graph = g;
	r->scans = array_of(sizeof(struct report_scan), clear_scan);
	r->edges = array_of(sizeof(struct report_edge), clear_edge);
	r->plans = array_of(sizeof(struct report_plan), clear_plan);
	struct collecting c = {
		.r = r, .options = options, .steps = g->scans->len + g->edges->len + 1
	};
	if (!collect_scans(&c, error) || !collect_edges(&c, error))
		return NULL;
	return g_steal_pointer(&r);
}
