#include "process/segment-numbers.h"
#include "process/segment-things.h"
#include <stdlib.h>
#include <string.h>

#define SHARE_LEAST (1.0 / 3)
#define DEPTH_MAX   8

/* What comes first keeps its number first. */
enum rank { RANK_REST, RANK_SAME_DEPTH, RANK_OTHER_DEPTH };

/* The nodes that a leaf is in, itself first, below the classes. */
struct chain {
	uint16_t node[DEPTH_MAX];
	uint8_t count;
};

struct side {
	const segments *tree;
	struct chain *chain; /* by number */
	uint64_t *points;    /* of each node, in scans that both have */
	int8_t *rest; /* of each node: enum segment_class of what it is left over of; -1: it is a thing, or a part */
};

struct segment_numbers {
	struct side was, now;
	GHashTable *both; /* was << 16 | now: how many points they have in common */
};

/* ---- the trees ---- */

static struct chain chain_of(const segments *tree, const struct segment *node)
{
	struct chain c = { .count = 0 };
	for (; node && node->id >= SEGMENT_FIRST && c.count < DEPTH_MAX;
		node = segments_find(tree, node->parent))
		c.node[c.count++] = (uint16_t)node->id;
	return c;
}

static struct side side_of(const segments *tree)
{
	struct side s = { tree, g_new0(struct chain, SEGMENTS_MAX + 1),
		g_new0(uint64_t, SEGMENTS_MAX + 1), g_new(int8_t, SEGMENTS_MAX + 1) };
	memset(s.rest, -1, SEGMENTS_MAX + 1);
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		s.chain[node->id] = chain_of(tree, node);
		if (segment_things_is_rest(node))
			s.rest[node->id] = (int8_t)node->class;
	}
	return s;
}

static void side_clear(struct side *s)
{
	g_free(s->chain);
	g_free(s->points);
	g_free(s->rest);
}

segment_numbers *segment_numbers_new(const segments *was, const segments *now)
{
	segment_numbers *n = g_new0(segment_numbers, 1);
	n->was = side_of(was);
	n->now = side_of(now);
	n->both = g_hash_table_new(NULL, NULL);
	return n;
}

void segment_numbers_free(segment_numbers *n)
{
	if (!n)
		return;
	side_clear(&n->was);
	side_clear(&n->now);
	g_hash_table_unref(n->both);
	g_free(n);
}

/* ---- points ---- */

static void count_pair(segment_numbers *n, uint32_t was, uint32_t now, uint64_t points)
{
	gpointer key = GUINT_TO_POINTER(was << 16 | now);
	uint64_t before = GPOINTER_TO_SIZE(g_hash_table_lookup(n->both, key));
	g_hash_table_insert(n->both, key, GSIZE_TO_POINTER(before + points));
}

static void count_leaves(segment_numbers *n, uint16_t was, uint16_t now, uint64_t points)
{
	const struct chain *a = &n->was.chain[was], *b = &n->now.chain[now];
	for (int i = 0; i < a->count; i++)
		n->was.points[a->node[i]] += points;
	for (int k = 0; k < b->count; k++)
		n->now.points[b->node[k]] += points;
	for (int i = 0; i < a->count; i++)
		for (int k = 0; k < b->count; k++)
			count_pair(n, a->node[i], b->node[k], points);
}

/* Cells that follow each other mostly have the same leaves. */
void segment_numbers_count(
	segment_numbers *n, const uint16_t *was, const uint16_t *now, uint64_t count)
{
	uint64_t end;
	for (uint64_t i = 0; i < count; i = end) {
		end = i + 1;
		while (end < count && was[end] == was[i] && now[end] == now[i])
			end++;
		count_leaves(n, was[i], now[i], end - i);
	}
}

/* ---- what is the same ---- */

struct match {
	enum rank rank;
	double share;
	uint64_t points;
	uint32_t was, now;
};

static int first_first(const void *a, const void *b)
{
	const struct match *x = a, *y = b;
	if (x->rank != y->rank)
		return x->rank < y->rank ? -1 : 1;
	if (x->share != y->share)
		return x->share > y->share ? -1 : 1;
	if (x->points != y->points)
		return x->points > y->points ? -1 : 1;
	if (x->was != y->was)
		return x->was < y->was ? -1 : 1;
	return (x->now > y->now) - (x->now < y->now);
}

static bool match_of(
	const segment_numbers *n, uint32_t was, uint32_t now, uint64_t points, struct match *ret)
{
	int rest = n->was.rest[was];
	uint64_t either = n->was.points[was] + n->now.points[now] - points;
	bool same_depth = n->was.chain[was].count == n->now.chain[now].count;
	*ret = (struct match){ rest >= 0    ? RANK_REST
			       : same_depth ? RANK_SAME_DEPTH
					    : RANK_OTHER_DEPTH,
		(double)points / (double)either, points, was, now };
	return rest == n->now.rest[now] && (rest >= 0 || ret->share >= SHARE_LEAST);
}

/* Sorted; caller frees. */
static GArray *find_matches(const segment_numbers *n)
{
	GArray *matches = g_array_new(FALSE, FALSE, sizeof(struct match));
	GHashTableIter iter;
	gpointer key, value;
	g_hash_table_iter_init(&iter, n->both);
	while (g_hash_table_iter_next(&iter, &key, &value)) {
		uint32_t pair = GPOINTER_TO_UINT(key);
		struct match m;
		if (match_of(n, pair >> 16, pair & 0xFFFF, GPOINTER_TO_SIZE(value), &m))
			g_array_append_val(matches, m);
	}
	g_array_sort(matches, first_first);
	return matches;
}

static void match_by_points(const segment_numbers *n, uint16_t *becomes)
{
	g_autoptr(GArray) matches = find_matches(n);
	g_autofree bool *is_kept = g_new0(bool, SEGMENTS_MAX + 1);
	for (guint i = 0; i < matches->len; i++) {
		const struct match *m = &g_array_index(matches, struct match, i);
		if (becomes[m->now] || is_kept[m->was])
			continue;
		becomes[m->now] = (uint16_t)m->was;
		is_kept[m->was] = true;
	}
}

/* false: the order of before is not there for all. */
static bool match_by_order(const segment_numbers *n, uint16_t *becomes)
{
	const segments *was = n->was.tree, *now = n->now.tree;
	g_autofree uint16_t *number = g_new0(uint16_t, SEGMENTS_MAX + 1);
	if (strcmp(was->key, now->key))
		return false;
	for (guint i = 0; i < was->nodes->len; i++) {
		const struct segment *node = &g_array_index(was->nodes, struct segment, i);
		number[node->found] = (uint16_t)node->id;
	}
	for (guint i = 0; i < now->nodes->len; i++) {
		const struct segment *node = &g_array_index(now->nodes, struct segment, i);
		if (node->id < SEGMENT_FIRST)
			continue;
		becomes[node->id] = node->found ? number[node->found] : 0;
		if (becomes[node->id] < SEGMENT_FIRST)
			return false;
	}
	return true;
}

/* ---- numbers ---- */

/* 0: there is none. */
static uint32_t new_number(uint32_t *next, bool *is_taken)
{
	uint32_t id = *next;
	for (id = id > SEGMENTS_MAX ? SEGMENT_FIRST : id; id <= SEGMENTS_MAX && is_taken[id];)
		id++;
	if (id > SEGMENTS_MAX)
		return 0;
	*next = MAX(*next, id + 1);
	is_taken[id] = true;
	return id;
}

static void clear_numbers(uint16_t *becomes)
{
	for (uint32_t id = 0; id <= SEGMENTS_MAX; id++)
		becomes[id] = (uint16_t)(id < SEGMENT_FIRST ? id : 0);
}

bool segment_numbers_find(const segment_numbers *n, uint32_t *next, uint16_t *ret_becomes)
{
	const segments *was = n->was.tree, *now = n->now.tree;
	g_autofree bool *is_taken = g_new0(bool, SEGMENTS_MAX + 1);
	clear_numbers(ret_becomes);
	if (match_by_order(n, ret_becomes))
		return true;
	clear_numbers(ret_becomes);
	match_by_points(n, ret_becomes);
	for (guint i = 0; i < was->nodes->len; i++)
		is_taken[g_array_index(was->nodes, struct segment, i).id] = true;
	for (guint i = 0; i < now->nodes->len; i++) {
		uint32_t id = g_array_index(now->nodes, struct segment, i).id;
		if (!ret_becomes[id] && !(ret_becomes[id] = (uint16_t)new_number(next, is_taken)))
			return false;
	}
	return true;
}
