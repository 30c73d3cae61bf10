#include "render/kiosk/site-state.h"
#include <gio/gio.h>
#include <glib/gi18n.h>
#include <math.h>

/* ---- the plan ---- */

/* Points in a cell of the plan that make it black: upright surface has many above each other. */
#define PLAN_BLACK 40

static void find_extent(site_state *s, const struct view_box *box)
{
	double wide = box->high_m[0] - box->low_m[0], deep = box->high_m[1] - box->low_m[1];
	s->plan_m_per_px = fmax(fmax(wide, deep) * 1.15, 4) / SITE_PLAN_SIDE;
	double half = s->plan_m_per_px * SITE_PLAN_SIDE / 2;
	s->plan_west_m = (box->low_m[0] + box->high_m[0]) / 2 - half;
	s->plan_north_m = (box->low_m[1] + box->high_m[1]) / 2 + half;
}

static void add_chunk(const site_state *s, const struct scene_chunk *c, uint16_t *hits)
{
	/* Any first part of a chunk is a subset of the whole. */
	uint32_t n = MIN(c->count, 1024);
	/* Some that stand for many count as these would. */
	uint32_t weight = MAX((uint32_t)(0.25f / c->part), 1);
	for (uint32_t i = 0; i < n; i++) {
		double p[3];
		scene_position(s->drawn->scene, c, i, p);
		int x = (int)floor((p[0] - s->plan_west_m) / s->plan_m_per_px);
		int y = (int)floor((s->plan_north_m - p[1]) / s->plan_m_per_px);
		if (x >= 0 && y >= 0 && x < (int)SITE_PLAN_SIDE && y < (int)SITE_PLAN_SIDE &&
			hits[y * (int)SITE_PLAN_SIDE + x] < PLAN_BLACK)
			hits[y * (int)SITE_PLAN_SIDE + x] += (uint16_t)MIN(weight, PLAN_BLACK);
	}
}

static void draw_plan(site_state *s)
{
	const scene *points = s->drawn->scene;
	size_t n = (size_t)SITE_PLAN_SIDE * SITE_PLAN_SIDE;
	g_autofree uint16_t *hits = g_new0(uint16_t, n);
	struct view_box box = view_bulk(&s->drawn->sources);
	find_extent(s, &box);
	for (uint32_t c = 0; c < points->chunks; c++)
		add_chunk(s, &points->chunk[c], hits);
	s->plan = g_malloc(n);
	for (size_t i = 0; i < n; i++)
		s->plan[i] = (uint8_t)(255 * sqrt(fmin((double)hits[i] / PLAN_BLACK, 1)));
}

/* ---- how the scans fit ---- */

static guint largest_group(const scan_graph *g)
{
	g_autoptr(GHashTable) sizes = g_hash_table_new(NULL, NULL);
	guint most = 0;
	for (guint i = 0; i < g->scans->len; i++) {
		uint32_t group = g_array_index(g->scans, struct placed_scan, i).group;
		guint n = GPOINTER_TO_UINT(g_hash_table_lookup(sizes, GUINT_TO_POINTER(group))) + 1;
		if (group)
			g_hash_table_insert(sizes, GUINT_TO_POINTER(group), GUINT_TO_POINTER(n));
		if (group && n > most)
			most = n;
	}
	return most;
}

static bool in_first_group(const scan_graph *g, uint32_t number)
{
	const struct placed_scan *p = scan_graph_scan(g, number);
	return p && p->group == 1;
}

/* The pair of one that is not placed with one that is: the one that nearly was accepted. */
static void find_refused(site_state *s)
{
	double best = -1;
	for (guint i = 0; i < s->graph->edges->len; i++) {
		const struct edge *e = &g_array_index(s->graph->edges, struct edge, i);
		if (edge_is_used(e) ||
			in_first_group(s->graph, e->a) == in_first_group(s->graph, e->b))
			continue;
		double overlap = e->verification.agreement;
		if (overlap > best) {
			best = overlap;
			s->refused_a = e->a;
			s->refused_b = e->b;
		}
	}
}

const char *site_state_scan_verdict(const site_state *s, uint32_t number)
{
	const struct placed_scan *p = scan_graph_scan(s->graph, number);
	if (s->scans->len == 1)
		return "good";
	if (!p)
		return NULL;
	return p->group == 1 ? "good" : p->group ? "doubt" : "bad";
}

static char *next_words(const site_state *s)
{
	if (!s->next_is_known)
		return NULL;
	if (!s->has_next)
		return g_strdup(_("They see all that there is around them."));
	return g_strdup_printf(
		_("From the ring on the plan, %.0f m² more would be seen."), s->next.new_m2);
}

char *site_state_words(const site_state *s, const char **ret_verdict)
{
	guint n = s->scans->len, known = s->graph->scans->len;
	g_autofree char *next = next_words(s);
	*ret_verdict = NULL;
	if (!n)
		return g_strdup(_("Nothing is scanned yet. Set the tripod up and tap Scan."));
	if (n == 1)
		return next ? g_strdup_printf(_("One scan. %s"), next)
			    : g_strdup(_("One scan. Set the tripod up where it sees part of the "
					 "same, and scan again."));
	if (known < n)
		return g_strdup_printf(ngettext("%u new scan is not yet aligned.",
					       "%u new scans are not yet aligned.", n - known),
			n - known);
	*ret_verdict = s->placed >= n ? "good" : "bad";
	if (s->placed >= n) {
		g_autofree char *fit = g_strdup_printf(_("All %u scans fit together."), n);
		return next ? g_strconcat(fit, " ", next, NULL) : g_steal_pointer(&fit);
	}
	return g_strdup_printf(ngettext("%u scan does not fit the others for sure. Tap Align and "
					"pick points that both see.",
				       "%u scans do not fit the others for sure. Tap Align and "
				       "pick points that both see.",
				       n - s->placed),
		n - s->placed);
}

/* ---- reading ---- */

static bool model_has_all(const site_state *s)
{
	if (!s->drawn)
		return false;
	return !s->drawn->is_look && s->drawn->stations->len >= s->placed;
}

static void open_drawn(site_state *s)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(drawn_site) d = drawn_site_new(s->folder, 1.6, &error);
	if (d && drawn_site_load(d, &error)) {
		s->drawn = g_steal_pointer(&d);
		draw_plan(s);
	} else if (!g_error_matches(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND) &&
		   !g_error_matches(error, G_FILE_ERROR, G_FILE_ERROR_NOENT))
		s->why_not = g_strdup(error->message);
}

site_state *site_state_new(const char *folder, GError **error)
{
	g_autoptr(site_state) s = g_new0(site_state, 1);
	s->folder = g_strdup(folder);
	g_autoptr(site) opened = site_open(folder, error);
	s->scans = opened ? site_scans(opened, error) : NULL;
	s->graph = s->scans ? scan_graph_load(opened, error) : NULL;
	if (!s->graph || !site_find_partial(opened, &s->partial, error))
		return NULL;
	const char *name = manifest_get_string(site_manifest(opened), "name", NULL);
	s->name = g_strdup(name ? name : "");
	s->placed = s->scans->len == 1 ? 1 : largest_group(s->graph);
	find_refused(s);
	open_drawn(s);
	s->needs_work =
		s->scans->len && (s->graph->scans->len < s->scans->len || !model_has_all(s));
	if (s->drawn && !s->needs_work)
		s->has_next = site_next_find(s->drawn, &s->next, &s->next_is_known);
	return g_steal_pointer(&s);
}

void site_state_free(site_state *s)
{
	if (!s)
		return;
	drawn_site_free(s->drawn);
	scan_graph_free(s->graph);
	if (s->scans)
		g_array_unref(s->scans);
	g_free(s->plan);
	g_free(s->why_not);
	g_free(s->name);
	g_free(s->folder);
	g_free(s);
}
