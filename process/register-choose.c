#include "process/register-choose.h"

#define TOGETHER       8
#define NEIGHBOURS     6
#define DISTANCE_MAX_M 25

static void add(GArray *pairs, uint32_t a, uint32_t b)
{
	struct scan_pair pair = { MIN(a, b), MAX(a, b) };
	for (guint i = 0; i < pairs->len; i++) {
		const struct scan_pair *p = &g_array_index(pairs, struct scan_pair, i);
		if (p->a == pair.a && p->b == pair.b)
			return;
	}
	g_array_append_val(pairs, pair);
}

static void add_untried(GArray *pairs, const scan_graph *g, uint32_t a, uint32_t b)
{
	if (!scan_graph_edge(g, a, b))
		add(pairs, a, b);
}

static void add_following(
	GArray *pairs, const scan_graph *g, const struct scan_given *given, size_t count)
{
	for (size_t i = 0; i + 1 < count; i++)
		add_untried(pairs, g, given[i].number, given[i + 1].number);
}

/* 0: in none. */
static uint32_t group_of(const scan_graph *g, uint32_t number)
{
	const struct placed_scan *p = scan_graph_scan(g, number);
	return p ? p->group : 0;
}

static bool are_tied(const scan_graph *g, uint32_t a, uint32_t b)
{
	uint32_t group = group_of(g, a);
	return group && group == group_of(g, b);
}

static void add_between_groups(
	GArray *pairs, const scan_graph *g, const struct scan_given *given, size_t count)
{
	for (size_t apart = 1; apart < count; apart++)
		for (size_t i = 0; i + apart < count && pairs->len < TOGETHER; i++)
			if (!are_tied(g, given[i].number, given[i + apart].number))
				add_untried(pairs, g, given[i].number, given[i + apart].number);
}

struct neighbour {
	uint32_t number;
	double distance_m;
};

static int by_distance(gconstpointer a, gconstpointer b)
{
	const struct neighbour *p = a, *q = b;
	if (p->distance_m != q->distance_m)
		return p->distance_m < q->distance_m ? -1 : 1;
	return p->number < q->number ? -1 : 1;
}

/* Tried or not: who has enough neighbours that were tried needs no more. */
static GArray *neighbours_of(const scan_graph *g, const struct placed_scan *of)
{
	GArray *near = g_array_new(FALSE, FALSE, sizeof(struct neighbour));
	for (guint i = 0; i < g->scans->len; i++) {
		const struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, i);
		struct pose between = pose_between(&of->pose, &p->pose);
		struct neighbour n = { p->number, pose_distance_m(&between) };
		if (p != of && p->group == of->group && n.distance_m <= DISTANCE_MAX_M)
			g_array_append_val(near, n);
	}
	g_array_sort(near, by_distance);
	return near;
}

static void add_neighbours(GArray *pairs, const scan_graph *g)
{
	for (guint i = 0; i < g->scans->len; i++) {
		const struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, i);
		if (!p->group)
			continue;
		g_autoptr(GArray) near = neighbours_of(g, p);
		for (guint k = 0; k < MIN(near->len, NEIGHBOURS); k++)
			add_untried(pairs, g, p->number,
				g_array_index(near, struct neighbour, k).number);
	}
}

GArray *register_choose(const scan_graph *g, const struct scan_given *given, size_t count)
{
	GArray *pairs = g_array_new(FALSE, FALSE, sizeof(struct scan_pair));
	add_following(pairs, g, given, count);
	if (!pairs->len)
		add_between_groups(pairs, g, given, count);
	if (!pairs->len)
		add_neighbours(pairs, g);
	return pairs;
}
