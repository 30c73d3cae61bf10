#include "process/scan-graph.h"
#include "process/pose-graph.h"
#include "process/scan-data.h"
#include <math.h>
#include <string.h>

/* Poses of files that are off by more than this are wrong, not only rough. */
#define GIVEN_OFF_M   0.3
#define GIVEN_OFF_RAD (1 * G_PI / 180)

void edge_clear(struct edge *e)
{
	g_clear_pointer(&e->inputs, g_free);
}

static void clear_edge(gpointer e)
{
	edge_clear(e);
}

scan_graph *scan_graph_new(void)
{
	scan_graph *g = g_new0(scan_graph, 1);
	g->edges = g_array_new(FALSE, TRUE, sizeof(struct edge));
	g_array_set_clear_func(g->edges, clear_edge);
	g->scans = g_array_new(FALSE, TRUE, sizeof(struct placed_scan));
	return g;
}

void scan_graph_free(scan_graph *g)
{
	if (!g)
		return;
	g_array_unref(g->edges);
	g_array_unref(g->scans);
	g_free(g->change);
	g_free(g->time);
	g_free(g->inputs);
	g_free(g);
}

/* ---- edges and scans ---- */

static bool is_accepted(const struct edge *e)
{
	return e->decision == DECISION_ACCEPTED ||
	       (e->decision == DECISION_NONE && e->verification.verdict == VERDICT_ACCEPTED);
}

bool edge_is_used(const struct edge *e)
{
	return is_accepted(e) && !e->outlier;
}

/* Index of the first edge that does not stand before a, b. */
static guint find_edge(const scan_graph *g, uint32_t a, uint32_t b)
{
	guint low = 0, high = g->edges->len;
	while (low < high) {
		guint middle = (low + high) / 2;
		const struct edge *e = &g_array_index(g->edges, struct edge, middle);
		if (e->a < a || (e->a == a && e->b < b))
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

struct edge *scan_graph_edge(const scan_graph *g, uint32_t a, uint32_t b)
{
	guint at = find_edge(g, MIN(a, b), MAX(a, b));
	if (at == g->edges->len)
		return NULL;
	struct edge *e = &g_array_index(g->edges, struct edge, at);
	return e->a == MIN(a, b) && e->b == MAX(a, b) ? e : NULL;
}

struct placed_scan *scan_graph_scan(const scan_graph *g, uint32_t number)
{
	for (guint i = 0; i < g->scans->len; i++) {
		struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, i);
		if (p->number == number)
			return p;
	}
	return NULL;
}

/* Rounding leaves a covariance not quite symmetric; a file has one half of it, and must give the same solution. */
static void make_symmetric(struct edge *e)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < i; j++)
			e->covariance[i][j] = e->covariance[j][i];
}

void scan_graph_set_edge(scan_graph *g, const struct edge *edge)
{
	struct edge *old = scan_graph_edge(g, edge->a, edge->b), copy = *edge;
	make_symmetric(&copy);
	if (!old) {
		g_array_insert_vals(g->edges, find_edge(g, edge->a, edge->b), &copy, 1);
		return;
	}
	edge_clear(old);
	*old = copy;
}

void scan_graph_remove_edge(scan_graph *g, uint32_t a, uint32_t b)
{
	if (scan_graph_edge(g, a, b))
		g_array_remove_index(g->edges, find_edge(g, MIN(a, b), MAX(a, b)));
}

/* ---- solving ---- */

GArray *scan_graph_given(const site *s, GError **error)
{
	g_autoptr(GArray) numbers = site_scans(s, error);
	if (!numbers)
		return NULL;
	g_autoptr(GArray) given = g_array_new(FALSE, TRUE, sizeof(struct scan_given));
	for (guint i = 0; i < numbers->len; i++) {
		g_autoptr(scan_data) d =
			scan_data_peek(s, g_array_index(numbers, uint32_t, i), error);
		if (!d)
			return NULL;
		struct scan_given entry = { d->number, d->has_given_pose, d->given_pose };
		g_array_append_val(given, entry);
	}
	return g_steal_pointer(&given);
}

static size_t find_given(const struct scan_given *given, size_t count, uint32_t number)
{
	size_t i = 0;
	while (i < count && given[i].number != number)
		i++;
	return i;
}

/* Accepted, by the scans themselves or by a person, with another pose than the files say. */
static bool contradicts_given(const struct edge *e, const struct scan_given *given, size_t count)
{
	size_t a = find_given(given, count, e->a), b = find_given(given, count, e->b);
	if (e->origin == EDGE_GIVEN || !is_accepted(e) || a == count || b == count ||
		!given[a].has_pose || !given[b].has_pose)
		return false;
	struct pose between = pose_between(&given[a].pose, &given[b].pose);
	struct pose off = pose_between(&between, &e->pose);
	return pose_distance_m(&off) > GIVEN_OFF_M || pose_angle_rad(&off) > GIVEN_OFF_RAD;
}

/* Refuted: a comparison with another given pose was refused or came out otherwise, and none was accepted. */
static bool holds(const scan_graph *g, const struct scan_given *s, const struct scan_given *given,
	size_t count)
{
	bool refused = false;
	if (!s->has_pose)
		return false;
	for (guint i = 0; i < g->edges->len; i++) {
		const struct edge *e = &g_array_index(g->edges, struct edge, i);
		if (e->a != s->number && e->b != s->number)
			continue;
		if (e->origin == EDGE_GIVEN && is_accepted(e))
			return true;
		refused |= e->decision == DECISION_REFUSED && e->origin == EDGE_GIVEN;
		refused |= e->origin == EDGE_GIVEN && e->verification.verdict == VERDICT_CONFLICT;
		refused |= contradicts_given(e, given, count);
	}
	return !refused;
}

static struct pose_node *make_nodes(
	const scan_graph *g, const struct scan_given *given, size_t count)
{
	struct pose_node *node = g_new0(struct pose_node, count + 1);
	for (size_t i = 0; i < count; i++) {
		node[i].fixed = holds(g, &given[i], given, count);
		node[i].pose = node[i].fixed ? given[i].pose : POSE_IDENTITY;
	}
	return node;
}

/* Links of the accepted edges; ret_edge: of each, its edge. */
static struct pose_link *make_links(const scan_graph *g, const struct scan_given *given,
	size_t count, struct edge **ret_edge, size_t *ret_links)
{
	struct pose_link *link = g_new0(struct pose_link, g->edges->len + 1);
	size_t links = 0;
	for (guint i = 0; i < g->edges->len; i++) {
		struct edge *e = &g_array_index(g->edges, struct edge, i);
		size_t a = find_given(given, count, e->a), b = find_given(given, count, e->b);
		e->outlier = false;
		e->loop_rad = e->loop_m = 0;
		if (!is_accepted(e) || a == count || b == count)
			continue;
		struct pose_link *l = &link[links];
		*l = (struct pose_link){ .a = (uint32_t)a, .b = (uint32_t)b, .pose = e->pose };
		memcpy(l->covariance, e->covariance, sizeof l->covariance);
		l->trusted = e->decision == DECISION_ACCEPTED;
		ret_edge[links++] = e;
	}
	*ret_links = links;
	return link;
}

struct component {
	uint32_t old, size, first; /* number in the pose graph, nodes, lowest node */
	bool fixed;
};

static int by_size(gconstpointer a, gconstpointer b)
{
	const struct component *p = a, *q = b;
	if (p->fixed != q->fixed)
		return p->fixed ? -1 : 1;
	if (p->size != q->size)
		return p->size > q->size ? -1 : 1;
	return p->first < q->first ? -1 : 1;
}

static GArray *count_components(const struct pose_node *node, size_t count)
{
	GArray *components = g_array_new(FALSE, TRUE, sizeof(struct component));
	for (size_t i = 0; i < count; i++) {
		if (components->len < node[i].component)
			g_array_set_size(components, node[i].component);
		struct component *c =
			&g_array_index(components, struct component, node[i].component - 1);
		if (!c->size++)
			c->first = (uint32_t)i;
		c->old = node[i].component;
		c->fixed |= node[i].fixed;
	}
	g_array_sort(components, by_size);
	return components;
}

/* Group of each component, by its number in the pose graph; caller frees. */
static uint32_t *number_groups(const struct pose_node *node, size_t count)
{
	g_autoptr(GArray) components = count_components(node, count);
	uint32_t *group = g_new0(uint32_t, components->len + 1), groups = 0;
	for (guint i = 0; i < components->len; i++) {
		const struct component *c = &g_array_index(components, struct component, i);
		if (c->fixed || c->size > 1 || !groups)
			group[c->old] = ++groups;
	}
	return group;
}

static double root_of_trace(const double m[6][6], int from)
{
	return sqrt(fmax(m[from][from] + m[from + 1][from + 1] + m[from + 2][from + 2], 0));
}

static void set_scans(
	scan_graph *g, const struct scan_given *given, const struct pose_node *node, size_t count)
{
	g_autofree uint32_t *group = number_groups(node, count);
	g_array_set_size(g->scans, 0);
	for (size_t i = 0; i < count; i++) {
		struct placed_scan p = { .number = given[i].number,
			.group = group[node[i].component],
			.pose = POSE_IDENTITY };
		if (p.group) {
			p.pose = node[i].pose;
			p.deviation_rad = root_of_trace(node[i].covariance, 0);
			p.deviation_m = root_of_trace(node[i].covariance, 3);
		}
		g_array_append_val(g->scans, p);
	}
}

void scan_graph_solve(scan_graph *g, const struct scan_given *given, size_t count)
{
	size_t links;
	g_autofree struct edge **edge = g_new0(struct edge *, g->edges->len + 1);
	g_autofree struct pose_node *node = make_nodes(g, given, count);
	g_autofree struct pose_link *link = make_links(g, given, count, edge, &links);
	pose_graph_solve(node, count, link, links, NULL);
	for (size_t i = 0; i < links; i++) {
		edge[i]->outlier = link[i].outlier;
		edge[i]->loop_rad = link[i].loop_rad;
		edge[i]->loop_m = link[i].loop_m;
	}
	set_scans(g, given, node, count);
}
