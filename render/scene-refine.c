#include "render/scene-pager-private.h"
#include <math.h>

/* Pixels from point to point that are near enough: of pictures that move, and of those that stay. Discs of points stand in for each
 * other from less than 0.45 on (disc-lanes.h). */
#define NEAR_MOVING_PX 1.f
#define NEAR_STILL_PX  0.35f
/* Around the view it needs not be as fine. */
#define AROUND_COARSER 4.f
/* Beyond the picture, by which discs and strokes may reach into it (chunk-view.c), of pixels and of the style's. */
#define MARGIN_PX     50.0
#define MARGIN_INK_PX 64.0
/* What is so near is in view: patches may be moved into it. */
#define BESIDE_M 2.0
/* Of the memory may be wanted at once: what is there no more must stay until what comes instead is there. */
#define WANTED_PART 0.9
/* How far ahead is looked. */
static const double ahead_s[] = { 0.5, 1.5 };
#define AHEAD_TURN_MOST 1.2
/* Nodes in view, more than are read before the next turn: then there is no need to look farther. */
#define WANTS_ENOUGH 1024u

struct view {
	struct camera_plane plane[SIDES];
	bool is_around; /* all directions */
	double eye_m[3], near_m;
	double parallel_m; /* of struct camera */
	float px; /* focal length by pixels that are near enough; INFINITY: all points are wanted */
};

static struct view view_of(const struct camera *c, float ink_px, float near_px)
{
	struct view v = {
		.near_m = c->near_m, .parallel_m = c->parallel_m, .px = (float)c->focal_px / near_px
	};
	struct camera wider = *c;
	double margin = MARGIN_PX + MARGIN_INK_PX * (double)ink_px;
	wider.width += 2 * (uint32_t)ceil(margin);
	wider.height += 2 * (uint32_t)ceil(margin);
	camera_frustum_planes(&wider, v.plane);
	for (int k = 0; k < 3; k++)
		v.eye_m[k] = c->eye_m[k];
	return v;
}

static double away_m(const struct view *v, const double centre_m[3], const float half_m[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++) {
		double away = fabs(centre_m[k] - v->eye_m[k]) - (double)half_m[k];
		sum += away > 0 ? away * away : 0;
	}
	return sqrt(sum);
}

static bool box_is_in_view(const struct view *v, const double centre_m[3], const float half_m[3])
{
	if (v->is_around)
		return true;
	for (int side = 0; side < SIDES; side++) {
		const struct camera_plane *p = &v->plane[side];
		double middle = p->offset_m, reach = 0;
		for (int k = 0; k < 3; k++) {
			middle += p->inward[k] * centre_m[k];
			reach += fabs(p->inward[k]) * (double)half_m[k];
		}
		if (middle < -reach)
			return away_m(v, centre_m, half_m) < BESIDE_M;
	}
	return true;
}

static bool is_in_view(const struct view *v, const struct scene_node *n)
{
	return box_is_in_view(v, n->centre_m, n->half_m);
}

/* ---- the sparsest first ---- */

static bool is_before(const struct heap_entry *a, const struct heap_entry *b)
{
	return a->sparse != b->sparse ? a->sparse > b->sparse : a->node < b->node;
}

static void push(GArray *heap, struct heap_entry one)
{
	g_array_append_val(heap, one);
	struct heap_entry *h = (struct heap_entry *)(void *)heap->data;
	guint at = heap->len - 1;
	for (; at > 0 && is_before(&one, &h[(at - 1) / 2]); at = (at - 1) / 2)
		h[at] = h[(at - 1) / 2];
	h[at] = one;
}

static struct heap_entry pop(GArray *heap)
{
	struct heap_entry *h = (struct heap_entry *)(void *)heap->data, first = h[0],
			  last = h[heap->len - 1];
	guint at = 0, count = heap->len - 1;
	for (guint child; (child = 2 * at + 1) < count; at = child) {
		child += child + 1 < count && is_before(&h[child + 1], &h[child]);
		if (!is_before(&h[child], &last))
			break;
		h[at] = h[child];
	}
	h[at] = last;
	g_array_set_size(heap, count);
	return first;
}

static uint32_t units_of(const scene_tree *t, uint32_t node)
{
	return 1u << scene_units_order(t->node[node].points);
}

/* Chunks cannot be finer; what is fine enough need not be. */
static void consider(scene_pager *p, const struct view *v, uint32_t node)
{
	const struct scene_node *n = &p->tree->node[node];
	if (!n->children)
		return;
	struct heap_entry one = { v->px, node };
	if (isfinite(v->px))
		one.sparse = p->page[node].apart_m * v->px /
			     (float)(v->parallel_m > 0
					     ? v->parallel_m
					     : fmax(away_m(v, n->centre_m, n->half_m), v->near_m));
	if (one.sparse > 1)
		push(p->heap, one);
}

/* Of a node's children in view. */
struct below {
	uint32_t node[SCENE_TREE_FAN], count, units, away;
};

static struct below look_below(const scene_pager *p, const struct view *v, uint32_t node)
{
	const scene_tree *t = p->tree;
	struct below b = { .count = 0 };
	for (uint32_t k = 0; k < t->node[node].children; k++) {
		uint32_t child = t->node[node].child + k;
		if (!is_in_view(v, &t->node[child]))
			continue;
		b.node[b.count++] = child;
		if (p->page[child].wanted != p->turn)
			b.units += units_of(t, child);
		b.away += !p->page[child].is_there;
	}
	return b;
}

static void want(scene_pager *p, uint32_t node)
{
	struct page *page = &p->page[node];
	if (page->wanted == p->turn)
		return;
	page->wanted = p->turn;
	p->wanted_units += units_of(p->tree, node);
	if (!page->is_there && !page->is_broken)
		g_array_append_val(p->wants, node);
}

static uint32_t units_most(const scene_pager *p)
{
	return (uint32_t)(WANTED_PART * scene_units_count(p->units));
}

static void consider_tops(scene_pager *p, const struct view *v, bool draws)
{
	const scene_tree *t = p->tree;
	for (uint32_t k = 0; k < t->bunches; k++) {
		const struct scene_bunch *b = &t->bunch[k];
		if (!box_is_in_view(v, b->centre_m, b->half_m))
			continue;
		for (uint32_t i = 0; i < b->count; i++) {
			uint32_t n = t->top[k * SCENE_TREE_BUNCH + i];
			if (!is_in_view(v, &t->node[n]))
				continue;
			if (draws)
				p->seen[n - scene_tree_top(t)] = p->turn;
			consider(p, v, n);
		}
	}
}

/* Refines what is in view; draws: for this turn's frame, not for later. */
static void refine(scene_pager *p, const struct view *v, bool draws)
{
	g_array_set_size(p->heap, 0);
	consider_tops(p, v, draws);
	while (p->heap->len) {
		struct heap_entry one = pop(p->heap);
		struct below b = look_below(p, v, one.node);
		if (p->wanted_units + b.units > units_most(p))
			break;
		for (uint32_t k = 0; k < b.count; k++)
			want(p, b.node[k]);
		if (b.away)
			continue;
		if (draws)
			p->page[one.node].split = p->turn;
		for (uint32_t k = 0; k < b.count; k++)
			consider(p, v, b.node[k]);
	}
}

/* ---- the chunks of the scene ---- */

static void add_chunk(scene_pager *p, uint32_t node, bool is_aside)
{
	scene *s = p->scene;
	if (s->chunks == p->room) {
		p->room = p->room * 2 + 64;
		s->chunk = g_renew(struct scene_chunk, s->chunk, p->room + 1);
	}
	s->chunk[s->chunks] = p->chunk[node];
	s->chunk[s->chunks++].is_aside = is_aside;
	uint64_t what = (uint64_t)node << 32 | s->chunk[s->chunks - 1].first << 1 | is_aside;
	p->choice = (p->choice ^ what) * 0x9E3779B97F4A7C15u;
	p->choice ^= p->choice >> 29;
}

static void add_node(scene_pager *p, const struct view *v, uint32_t node, struct scene_turned *sums)
{
	const struct scene_node *n = &p->tree->node[node];
	if (p->page[node].split != p->turn) {
		add_chunk(p, node, false);
		sums->points += n->points;
		sums->is_whole &= !n->children;
		return;
	}
	for (uint32_t k = 0; k < n->children; k++)
		if (is_in_view(v, &p->tree->node[n->child + k]))
			add_node(p, v, n->child + k, sums);
}

static void make_chunks(scene_pager *p, const struct view *v, struct scene_turned *sums)
{
	const scene_tree *t = p->tree;
	scene *s = p->scene;
	uint64_t all = 0, before = p->choice;
	s->chunks = 0;
	p->choice = 0;
	for (uint32_t n = scene_tree_top(t); n < scene_tree_end(t); n++)
		if (p->seen[n - scene_tree_top(t)] == p->turn)
			add_node(p, v, n, sums);
		else
			add_chunk(p, n, true);
	for (uint32_t n = 0; n < s->chunks; n++)
		all += s->chunk[n].count;
	s->count = (uint32_t)MIN(all, SCENE_POINTS_MOST);
	s->turn += p->choice != before;
}

/* ---- which view ---- */

/* Units that all in view needs. */
static uint64_t units_below(const scene_pager *p, const struct view *v, uint32_t node)
{
	const struct scene_node *n = &p->tree->node[node];
	uint64_t sum = 0;
	for (uint32_t k = 0; k < n->children; k++)
		if (is_in_view(v, &p->tree->node[n->child + k]))
			sum += units_of(p->tree, n->child + k) + units_below(p, v, n->child + k);
	return sum;
}

static bool fits(const scene_pager *p, const struct view *v)
{
	const scene_tree *t = p->tree;
	uint64_t sum = 0;
	for (uint32_t n = scene_tree_top(t); n < scene_tree_end(t) && sum <= units_most(p); n++)
		if (is_in_view(v, &t->node[n]))
			sum += units_below(p, v, n);
	return sum <= units_most(p);
}

void scene_refine(scene_pager *p, const struct scene_look *look, struct scene_turned *ret)
{
	struct view v = view_of(
		look->camera, look->ink_px, look->is_moving ? NEAR_MOVING_PX : NEAR_STILL_PX);
	if (!look->is_moving && fits(p, &v))
		v.px = INFINITY;
	*ret = (struct scene_turned){ .is_whole = true };
	p->turn++;
	p->wanted_units = 0;
	g_array_set_size(p->wants, 0);
	refine(p, &v, true);
	make_chunks(p, &v, ret);
	ret->missing = p->wants->len;
	for (guint n = 0; n < p->wants->len; n++)
		ret->points_missing += p->tree->node[g_array_index(p->wants, uint32_t, n)].points;
}

/* ---- ahead ---- */

static void see_motion(scene_pager *p, const struct camera *c)
{
	gint64 now_us = g_get_monotonic_time();
	double passed_s = 1e-6 * (double)(now_us - p->last.at_us);
	bool goes_on = p->last.is_known && passed_s > 1e-3 && passed_s < 1;
	for (int k = 0; k < 3; k++)
		p->last.speed_m_s[k] =
			goes_on ? (c->eye_m[k] - p->last.camera.eye_m[k]) / passed_s : 0;
	double turned = goes_on ? camera_heading_rad(c) - camera_heading_rad(&p->last.camera) : 0;
	p->last.turn_rad_s = goes_on ? remainder(turned, 2 * G_PI) / passed_s : 0;
	p->last.camera = *c;
	p->last.at_us = now_us;
	p->last.is_known = true;
}

void scene_refine_ahead(scene_pager *p, const struct scene_look *look)
{
	see_motion(p, look->camera);
	if (look->is_moving && p->wants->len > WANTS_ENOUGH)
		return;
	for (size_t n = 0; n < G_N_ELEMENTS(ahead_s) && look->is_moving; n++) {
		double turn =
			CLAMP(p->last.turn_rad_s * ahead_s[n], -AHEAD_TURN_MOST, AHEAD_TURN_MOST);
		struct camera c = camera_turned(look->camera, turn);
		for (int k = 0; k < 3; k++)
			c.eye_m[k] += p->last.speed_m_s[k] * ahead_s[n];
		struct view v = view_of(&c, look->ink_px, NEAR_MOVING_PX);
		refine(p, &v, false);
	}
	struct view around = view_of(look->camera, look->ink_px, NEAR_MOVING_PX * AROUND_COARSER);
	around.is_around = true;
	refine(p, &around, false);
}
