#include "render/scene-tree.h"
#include "process/model-coarse.h"
#include "process/morton.h"
#include <gio/gio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(SCENE_TREE_FAN *SCENE_TREE_FAN == MODEL_GROUP_CHUNKS &&
		       MODEL_GROUP_CHUNKS == MODEL_COARSE_ONE_IN,
	"the second level are the groups");

static struct scene_node node_of_chunk(const struct model_chunk *c, uint32_t number)
{
	struct scene_node n = {
		.part = 1, .child = number, .leaf = c->leaf, .points = (uint16_t)c->points
	};
	memcpy(n.centre_m, c->centre_m, sizeof n.centre_m);
	memcpy(n.half_m, c->half_size_m, sizeof n.half_m);
	return n;
}

/* Up by the rounding, so that no child's box reaches out of it. */
static void hold_boxes(struct scene_node *n, const struct scene_node *child)
{
	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (uint32_t i = 0; i < n->children; i++) {
			low = fmin(low, child[i].centre_m[k] - (double)child[i].half_m[k]);
			high = fmax(high, child[i].centre_m[k] + (double)child[i].half_m[k]);
		}
		n->centre_m[k] = (low + high) / 2;
		n->half_m[k] = nextafterf((float)((high - low) / 2), INFINITY);
	}
}

/* Of the children that follow each other from the number on. */
static struct scene_node node_above(const scene_tree *t, uint32_t from, uint32_t children)
{
	const struct scene_node *child = &t->node[from];
	struct scene_node n = { .child = from,
		.leaf = child->leaf,
		.children = (uint8_t)children,
		.level = child->level + 1 };
	double all = 0, sum = 0;
	hold_boxes(&n, child);
	for (uint32_t i = 0; i < children; i++) {
		uint32_t gives = model_gives(child[i].points, SCENE_TREE_FAN);
		sum += gives;
		all += (double)child[i].points / (double)child[i].part;
	}
	n.points = (uint16_t)sum;
	n.part = (float)(sum / all);
	return n;
}

static uint32_t runs(uint32_t count)
{
	return (count + SCENE_TREE_FAN - 1) / SCENE_TREE_FAN;
}

static void add(scene_tree *t, uint32_t *count, const struct scene_node *n)
{
	t->node[(*count)++] = *n;
}

/* Runs of nodes of one level, from .. end, that have one leaf. */
static void add_runs(scene_tree *t, uint32_t *count, uint32_t from, uint32_t end)
{
	while (from < end) {
		uint32_t n = 1;
		while (n < MIN(SCENE_TREE_FAN, end - from) &&
			t->node[from + n].leaf == t->node[from].leaf)
			n++;
		struct scene_node above = node_above(t, from, n);
		add(t, count, &above);
		from += n;
	}
}

/* A group has its points in the file, so it is as it is there. */
static void add_groups(scene_tree *t, uint32_t *count, const struct model_short *s)
{
	uint32_t from = t->first[1];
	for (uint64_t g = 0; g < s->groups; g++) {
		uint32_t children = runs(s->group[g].reserved[1]);
		struct scene_node n = node_above(t, from, children);
		double all = 0;
		for (uint32_t i = 0; i < s->group[g].reserved[1]; i++)
			all += t->node[s->group[g].reserved[0] + i].points;
		n.points = (uint16_t)s->group[g].points;
		n.part = (float)(n.points / all);
		add(t, count, &n);
		from += children;
	}
}

/* ---- bunches ---- */

/* Larger ones are apart from the others, whose boxes would all be as large. */
#define WIDE_M    16.f
#define PLACE_MAX 0x1FFFFF

struct placed {
	uint64_t place;
	uint32_t node;
};

static int by_place(const void *a, const void *b)
{
	const struct placed *x = a, *y = b;
	return x->place != y->place ? (x->place < y->place ? -1 : 1)
				    : (x->node > y->node) - (x->node < y->node);
}

/* Along a curve, to the metre. */
static uint64_t place_of(const struct scene_node *n)
{
	uint64_t code = 0;
	for (int k = 0; k < 3; k++)
		code |= morton_spread((uint64_t)(int64_t)floor(n->centre_m[k]) & PLACE_MAX) << k;
	bool is_wide = fmaxf(fmaxf(n->half_m[0], n->half_m[1]), n->half_m[2]) > WIDE_M;
	return code | (uint64_t)is_wide << 63;
}

static void bound_bunch(const scene_tree *t, const uint32_t *top, struct scene_bunch *b)
{
	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (uint32_t i = 0; i < b->count; i++) {
			const struct scene_node *n = &t->node[top[i]];
			low = fmin(low, n->centre_m[k] - (double)n->half_m[k]);
			high = fmax(high, n->centre_m[k] + (double)n->half_m[k]);
		}
		b->centre_m[k] = (low + high) / 2;
		b->half_m[k] = nextafterf((float)((high - low) / 2), INFINITY);
	}
}

static void make_bunches(scene_tree *t)
{
	uint32_t first = scene_tree_top(t), tops = scene_tree_end(t) - first;
	g_autofree struct placed *placed = g_new(struct placed, tops + 1);
	for (uint32_t n = 0; n < tops; n++)
		placed[n] = (struct placed){ place_of(&t->node[first + n]), first + n };
	qsort(placed, tops, sizeof *placed, by_place);
	t->top = g_new(uint32_t, tops + 1);
	for (uint32_t n = 0; n < tops; n++)
		t->top[n] = placed[n].node;
	t->bunches = (tops + SCENE_TREE_BUNCH - 1) / SCENE_TREE_BUNCH;
	t->bunch = g_new0(struct scene_bunch, t->bunches + 1);
	for (uint32_t n = 0; n < t->bunches; n++) {
		t->bunch[n].count = MIN(SCENE_TREE_BUNCH, tops - n * SCENE_TREE_BUNCH);
		bound_bunch(t, t->top + n * SCENE_TREE_BUNCH, &t->bunch[n]);
	}
}

/* ---- all ---- */

scene_tree *scene_tree_new(const model *m, GError **error)
{
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(m, &chunks);
	struct model_short s = model_in_short(m);
	if (chunks > UINT32_MAX / 8) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE,
			"%s: its %" G_GUINT64_FORMAT " chunks are more than this program can count",
			product_path(model_file(m)), chunks);
		return NULL;
	}
	scene_tree *t = g_new0(scene_tree, 1);
	/* Never more nodes than two a chunk and one for each group and top. */
	t->node = g_new(struct scene_node, 2 * chunks + 2 * s.groups + 1);
	uint32_t count = 0;
	for (uint64_t n = 0; n < chunks; n++) {
		struct scene_node one = node_of_chunk(&c[n], (uint32_t)n);
		add(t, &count, &one);
	}
	t->first[1] = count;
	for (uint64_t g = 0; g < s.groups; g++)
		add_runs(t, &count, s.group[g].reserved[0],
			s.group[g].reserved[0] + s.group[g].reserved[1]);
	t->first[2] = count;
	add_groups(t, &count, &s);
	t->first[3] = count;
	add_runs(t, &count, t->first[2], t->first[3]);
	t->first[4] = count;
	make_bunches(t);
	return t;
}

void scene_tree_free(scene_tree *t)
{
	if (!t)
		return;
	g_free(t->node);
	g_free(t->top);
	g_free(t->bunch);
	g_free(t);
}
