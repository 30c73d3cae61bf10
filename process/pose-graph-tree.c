/* The links as a graph: what hangs together, what hangs by one link, a tree to begin with. */
#include "process/pose-graph-private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- what hangs together ---- */

static uint32_t find(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

/* The lower one stays on top, so that the top is the first of its set. */
static bool join(uint32_t *parent, uint32_t a, uint32_t b)
{
	a = find(parent, a);
	b = find(parent, b);
	parent[MAX(a, b)] = MIN(a, b);
	return a != b;
}

static uint32_t *sets_new(const struct pose_node *node, size_t nodes)
{
	uint32_t *parent = g_new(uint32_t, nodes + 1);
	uint32_t fixed = UINT32_MAX;
	for (uint32_t i = 0; i < nodes; i++)
		parent[i] = i;
	for (uint32_t i = 0; i < nodes; i++) {
		if (!node[i].fixed)
			continue;
		fixed = MIN(fixed, i);
		join(parent, fixed, i);
	}
	return parent;
}

uint32_t pose_graph_components(const struct pose_node *node, size_t nodes,
	const struct pose_link *link, size_t links, const double *weight, uint32_t *ret_component,
	uint32_t *ret_first)
{
	g_autofree uint32_t *parent = sets_new(node, nodes);
	uint32_t count = 0, fixed_set = UINT32_MAX;
	for (size_t i = 0; i < links; i++)
		if (weight[i] > 0)
			join(parent, link[i].a, link[i].b);
	for (uint32_t i = 0; i < nodes && fixed_set == UINT32_MAX; i++)
		if (node[i].fixed) {
			fixed_set = find(parent, i);
			ret_component[fixed_set] = 0;
			ret_first[count++] = i;
		}
	for (uint32_t i = 0; i < nodes; i++) {
		uint32_t top = find(parent, i);
		if (top == i && top != fixed_set) {
			ret_first[count] = i;
			ret_component[i] = count++;
		}
	}
	for (uint32_t i = 0; i < nodes; i++)
		if (find(parent, i) != i)
			ret_component[i] = ret_component[find(parent, i)];
	return count;
}

/* ---- neighbours ---- */

/* The links of each node: link[first[i]] .. link[first[i + 1]]. */
struct around {
	uint32_t *first, *link;
};

static struct around around_new(
	size_t nodes, const struct pose_link *link, size_t links, const double *weight)
{
	struct around r = { g_new0(uint32_t, nodes + 2), g_new(uint32_t, 2 * links + 1) };
	for (size_t i = 0; i < links; i++)
		if (!weight || weight[i] > 0) {
			r.first[link[i].a + 2]++;
			r.first[link[i].b + 2]++;
		}
	for (size_t i = 2; i < nodes + 2; i++)
		r.first[i] += r.first[i - 1];
	for (uint32_t i = 0; i < links; i++)
		if (!weight || weight[i] > 0) {
			r.link[r.first[link[i].a + 1]++] = i;
			r.link[r.first[link[i].b + 1]++] = i;
		}
	return r;
}

static void around_clear(struct around *r)
{
	g_free(r->first);
	g_free(r->link);
}

static uint32_t other_end(const struct pose_link *l, uint32_t node)
{
	return l->a == node ? l->b : l->a;
}

/* ---- bridges (Tarjan 1974), without recursion ---- */

struct walk {
	uint32_t *entered, *low, *came_by, *next, *stack;
	uint32_t depth, time;
};

static void enter(struct walk *w, uint32_t node, uint32_t by)
{
	w->entered[node] = w->low[node] = ++w->time;
	w->came_by[node] = by;
	w->stack[w->depth++] = node;
}

static void leave(struct walk *w, uint32_t node, bool *ret_bridge)
{
	uint32_t by = w->came_by[node];
	w->depth--;
	if (by == UINT32_MAX)
		return;
	uint32_t up = w->stack[w->depth - 1];
	w->low[up] = MIN(w->low[up], w->low[node]);
	if (w->low[node] > w->entered[up])
		ret_bridge[by] = true;
}

static void walk_from(struct walk *w, uint32_t start, const struct around *around,
	const struct pose_link *link, bool *ret_bridge)
{
	enter(w, start, UINT32_MAX);
	while (w->depth) {
		uint32_t node = w->stack[w->depth - 1];
		if (w->next[node] == around->first[node + 1]) {
			leave(w, node, ret_bridge);
			continue;
		}
		uint32_t by = around->link[w->next[node]++], to = other_end(&link[by], node);
		if (by == w->came_by[node])
			continue;
		if (w->entered[to])
			w->low[node] = MIN(w->low[node], w->entered[to]);
		else
			enter(w, to, by);
	}
}

/* All fixed nodes are taken for one: links are looked at as if they ended at the first. */
static struct pose_link *merge_fixed(
	const struct pose_node *node, size_t nodes, const struct pose_link *link, size_t links)
{
	struct pose_link *merged = g_memdup2(link, links * sizeof *link);
	uint32_t fixed = 0;
	while (fixed < nodes && !node[fixed].fixed)
		fixed++;
	for (size_t i = 0; i < links; i++) {
		merged[i].a = node[link[i].a].fixed ? fixed : link[i].a;
		merged[i].b = node[link[i].b].fixed ? fixed : link[i].b;
	}
	return merged;
}

void pose_graph_bridges(const struct pose_node *node, size_t nodes, const struct pose_link *link,
	size_t links, const double *weight, bool *ret_bridge)
{
	g_autofree struct pose_link *merged = merge_fixed(node, nodes, link, links);
	struct around around = around_new(nodes, merged, links, weight);
	g_autofree uint32_t *memory = g_new0(uint32_t, 5 * nodes + 5);
	struct walk w = { memory, memory + nodes, memory + 2 * nodes, memory + 3 * nodes,
		memory + 4 * nodes };
	memcpy(w.next, around.first, nodes * sizeof(uint32_t));
	for (size_t i = 0; i < links; i++)
		ret_bridge[i] = false;
	for (uint32_t i = 0; i < nodes; i++)
		if (!w.entered[i])
			walk_from(&w, i, &around, merged, ret_bridge);
	around_clear(&around);
}

/* ---- a tree to begin with ---- */

struct branch {
	uint32_t link;
	bool trusted;
	uint32_t triangles;
	double spread; /* of the covariance */
};

static int by_worth(const void *x, const void *y)
{
	const struct branch *a = x, *b = y;
	if (a->trusted != b->trusted)
		return a->trusted ? -1 : 1;
	if (a->triangles != b->triangles)
		return a->triangles > b->triangles ? -1 : 1;
	return a->spread != b->spread ? (a->spread > b->spread) - (a->spread < b->spread)
				      : (a->link > b->link) - (a->link < b->link);
}

/* The link's pose as seen from one of its ends. */
static struct pose pose_from(const struct pose_link *l, uint32_t node)
{
	return l->a == node ? l->pose : pose_inverse(&l->pose);
}

/* Whether l is what the way over a third node says. */
static bool closes(const struct pose_link *l, const struct pose_link *to_third,
	const struct pose_link *from_third, const matrix6 gate, double limit)
{
	uint32_t third = other_end(to_third, l->a);
	struct pose there = pose_from(to_third, l->a), on = pose_from(from_third, third);
	struct pose b = pose_compose(&there, &on);
	return pose_link_error(l, gate, &POSE_IDENTITY, &b) <= 3 * limit;
}

static uint32_t count_triangles(const struct pose_link *link, uint32_t at,
	const struct around *around, const matrix6 gate, double limit)
{
	const struct pose_link *l = &link[at];
	uint32_t count = 0;
	for (uint32_t i = around->first[l->a]; i < around->first[l->a + 1]; i++) {
		uint32_t one = around->link[i], third = other_end(&link[one], l->a);
		if (one == at || third == l->b)
			continue;
		for (uint32_t j = around->first[l->b]; j < around->first[l->b + 1]; j++) {
			uint32_t two = around->link[j];
			if (other_end(&link[two], l->b) == third &&
				closes(l, &link[one], &link[two], gate, limit))
				count++;
		}
	}
	return count;
}

static double spread_of(const struct pose_link *l)
{
	double sum = 0;
	for (int i = 0; i < 6; i++)
		sum += l->covariance[i][i] * (i < 3 ? 100 : 1); /* a turn counts as at 10 m */
	return sum;
}

static struct branch *rank(const struct pose_link *link, size_t links, const struct around *around,
	const matrix6 *gate, double limit)
{
	struct branch *branch = g_new(struct branch, links + 1);
	for (uint32_t i = 0; i < links; i++)
		branch[i] = (struct branch){ i, link[i].trusted,
			count_triangles(link, i, around, gate[i], limit), spread_of(&link[i]) };
	qsort(branch, links, sizeof *branch, by_worth);
	return branch;
}

/* From nodes that are placed along the tree. */
static void place_from(struct pose_node *node, uint32_t start, const struct pose_link *link,
	const struct around *tree, bool *placed, uint32_t *queue)
{
	size_t head = 0, tail = 0;
	queue[tail++] = start;
	placed[start] = true;
	while (head < tail) {
		uint32_t from = queue[head++];
		for (uint32_t i = tree->first[from]; i < tree->first[from + 1]; i++) {
			const struct pose_link *l = &link[tree->link[i]];
			uint32_t to = other_end(l, from);
			if (placed[to])
				continue;
			struct pose by = pose_from(l, from);
			node[to].pose = pose_compose(&node[from].pose, &by);
			pose_orthonormalise(&node[to].pose);
			placed[to] = true;
			queue[tail++] = to;
		}
	}
}

void pose_graph_spread(struct pose_node *node, size_t nodes, const struct pose_link *link,
	size_t links, const matrix6 *gate, double limit)
{
	struct around around = around_new(nodes, link, links, NULL);
	g_autofree struct branch *branch = rank(link, links, &around, gate, limit);
	g_autofree uint32_t *parent = sets_new(node, nodes), *queue = g_new(uint32_t, nodes + 1);
	g_autofree double *in_tree = g_new0(double, links + 1);
	g_autofree bool *placed = g_new0(bool, nodes + 1);
	for (size_t i = 0; i < links; i++) {
		const struct pose_link *l = &link[branch[i].link];
		in_tree[branch[i].link] = join(parent, l->a, l->b);
	}
	struct around tree = around_new(nodes, link, links, in_tree);
	for (uint32_t i = 0; i < nodes; i++)
		if (node[i].fixed)
			place_from(node, i, link, &tree, placed, queue);
	for (uint32_t i = 0; i < nodes; i++)
		if (!placed[i]) {
			node[i].pose = POSE_IDENTITY;
			place_from(node, i, link, &tree, placed, queue);
		}
	around_clear(&tree);
	around_clear(&around);
}
