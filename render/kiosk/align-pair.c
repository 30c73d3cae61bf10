#include "render/kiosk/align-pair.h"
#include <glib/gi18n.h>
#include <math.h>
#include <string.h>

/* ---- pictures ---- */

static void stretch(const float *value, size_t n, uint8_t *rgb)
{
	float low = INFINITY, high = -INFINITY;
	for (size_t i = 0; i < n; i++)
		if (value[i] > 0) {
			low = fminf(low, value[i]);
			high = fmaxf(high, value[i]);
		}
	for (size_t i = 0; i < n; i++) {
		float t = value[i] > 0 && high > low ? (value[i] - low) / (high - low) : 0;
		memset(rgb + 3 * i, (int)(value[i] > 0 ? 40 + 215 * t : 24), 3);
	}
}

/* Colours where there are some, else echoes, else how far it is. */
static uint8_t *look_of(const range_grid *g)
{
	size_t n = (size_t)g->columns * g->rows;
	if (g->rgb)
		return g_memdup2(g->rgb, 3 * n);
	uint8_t *rgb = g_malloc(3 * n);
	g_autofree float *value = g_new(float, n);
	for (size_t i = 0; i < n; i++) {
		bool seen = g->range_m[i] > 0;
		value[i] = !seen          ? 0
			   : g->intensity ? sqrtf((float)g->intensity[i] + 1)
					  : 10 - logf(1 + g->range_m[i]);
	}
	stretch(value, n, rgb);
	return rgb;
}

/* ---- which pair ---- */

static int find_number(const GArray *scans, uint32_t number)
{
	for (guint i = 0; i < scans->len; i++)
		if (g_array_index(scans, uint32_t, i) == number)
			return (int)i;
	return -1;
}

/* Pairs in the order 1-2, 1-3, ... 2-3. */
static void pair_at(const GArray *scans, uint32_t at, uint32_t ret[2])
{
	for (guint i = 0; i < scans->len; i++)
		for (guint j = i + 1; j < scans->len; j++)
			if (at-- == 0) {
				ret[0] = g_array_index(scans, uint32_t, i);
				ret[1] = g_array_index(scans, uint32_t, j);
				return;
			}
}

static uint32_t place_of(const GArray *scans, uint32_t a, uint32_t b)
{
	uint32_t n = scans->len, i = (uint32_t)find_number(scans, MIN(a, b)),
		 j = (uint32_t)find_number(scans, MAX(a, b));
	return i * (2 * n - i - 1) / 2 + j - i - 1;
}

/* One that is not used, and that nobody has decided about; else the first. */
static void find_needy(const align_pair *p, uint32_t ret[2])
{
	double best = -1;
	for (guint i = 0; i < p->graph->edges->len; i++) {
		const struct edge *e = &g_array_index(p->graph->edges, struct edge, i);
		if (edge_is_used(e) || e->decision != DECISION_NONE ||
			e->verification.agreement <= best)
			continue;
		best = e->verification.agreement;
		ret[0] = e->a;
		ret[1] = e->b;
	}
}

static void choose(align_pair *p, const GArray *scans, uint32_t a, uint32_t b, int step)
{
	uint32_t wanted[2] = { a, b };
	p->pairs = scans->len * (scans->len - 1) / 2;
	if (!a || !b)
		find_needy(p, wanted);
	if (find_number(scans, wanted[0]) < 0 || find_number(scans, wanted[1]) < 0 ||
		wanted[0] == wanted[1])
		pair_at(scans, 0, wanted);
	int at = (int)place_of(scans, wanted[0], wanted[1]) + step, n = (int)p->pairs;
	p->at = (uint32_t)((at % n + n) % n);
	pair_at(scans, p->at, p->scan);
}

/* ---- reading ---- */

static bool load(align_pair *p, const site *s, GError **error)
{
	for (int side = 0; side < 2; side++) {
		p->data[side] = scan_data_load(s, p->scan[side], error);
		if (!p->data[side])
			return false;
		if (p->data[side]->grid)
			p->rgb[side] = look_of(p->data[side]->grid);
	}
	return true;
}

align_pair *align_pair_new(const char *folder, uint32_t a, uint32_t b, int step, GError **error)
{
	g_autoptr(align_pair) p = g_new0(align_pair, 1);
	g_autoptr(site) s = site_open(folder, error);
	g_autoptr(GArray) scans = s ? site_scans(s, error) : NULL;
	if (!scans || !(p->graph = scan_graph_load(s, error)))
		return NULL;
	if (scans->len < 2)
		return g_steal_pointer(&p);
	choose(p, scans, a, b, step);
	p->edge = scan_graph_edge(p->graph, p->scan[0], p->scan[1]);
	return load(p, s, error) ? g_steal_pointer(&p) : NULL;
}

void align_pair_free(align_pair *p)
{
	if (!p)
		return;
	for (int side = 0; side < 2; side++) {
		scan_data_free(p->data[side]);
		g_free(p->rgb[side]);
	}
	scan_graph_free(p->graph);
	g_free(p);
}

/* ---- words ---- */

static const struct {
	const char *headline, *advice;
} words[VERDICTS] = {
	[VERDICT_NO_OVERLAP] = { N_("They share too little to be sure."),
		N_("Pick at least three points that both see, far from each other. Or scan once "
		   "more between "
		   "the two.") },
	[VERDICT_CONFLICT] = { N_("Put together, one would see through walls of the other."),
		N_("Pick three points that both see, on things that did not move.") },
	[VERDICT_SLIDING] = { N_("They could slide along each other."),
		N_("Pick points at both ends, and on things that stand out.") },
	[VERDICT_AMBIGUOUS] = { N_("They fit in more than one way."),
		N_("Pick three points that you know are the same: a sign, a door, a lamp.") },
	[VERDICT_NO_SOLUTION] = { N_("Nobody can tell yet how they belong together."),
		N_("Pick at least three points that both see, far from each other.") },
	[VERDICT_IMPRECISE] = { N_("They fit, but not closely enough."),
		N_("Pick points on walls that both see from near.") },
};

const char *align_pair_headline(
	const align_pair *p, const char **ret_verdict, const char **ret_advice)
{
	const struct edge *e = p->edge;
	*ret_verdict = "bad";
	*ret_advice = "";
	if (!p->pairs) {
		*ret_verdict = NULL;
		return _("There must be two scans to align.");
	}
	if (!e) {
		*ret_verdict = "doubt";
		*ret_advice = _("Tap \"Align by itself\", or pick points first.");
		return _("These two are not aligned yet.");
	}
	if (e->decision == DECISION_REFUSED)
		return _("You said that these two do not belong together.");
	if (e->outlier) {
		*ret_advice = _("One of the pairs in the loop is wrong: look at each.");
		return _("They fit each other, but contradict the other scans.");
	}
	if (edge_is_used(e)) {
		*ret_verdict = "good";
		return e->decision == DECISION_ACCEPTED ? _("You vouched that these two fit.")
							: _("These two scans fit together.");
	}
	*ret_advice = e->origin == EDGE_PICKED ? _("It stands as your points say. If you are sure "
						   "of them, tap \"They fit\".")
					       : _(words[e->verification.verdict].advice);
	return _(words[e->verification.verdict].headline);
}
