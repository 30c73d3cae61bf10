#include "render/large.h"
#include "render/profile-strokes.h"
#include "render/stipple.h"
#include "render/stroke-brush.h"
#include "render/stroke-span-lanes.h"
#include <string.h>

/* Chunks to a task, so that the order of strokes does not depend on threads. */
#define TASK_CHUNKS 16

float stroke_growth(float need)
{
	float half = need / 2, mean = 1;
	if (need <= 1)
		return 1;
	if (need < 2) /* the mean of stroke_fade over all ranks */
		mean = half + (1 - half) * (log2f(need) + 1 / (float)G_LN2) + half * log2f(half);
	return sqrtf(need * STROKE_FADE_MEAN / mean);
}

/* ---- room ---- */

/* Blocks that are made at once: a large page of them. */
#define SLAB 543
/* When less than half of them is wanted so often in a row, what is not goes back to the system: another style has other strokes. */
#define SPARED_MOST 8

struct stroke_room {
	enum lanes_path lanes; /* of the frame */
	GMutex lock;
	GPtrArray *slabs;
	guint taken;  /* blocks of them */
	guint spared; /* how often in a row less than half of them was wanted */
	struct stroke_blocks of_layer[FRAME_LAYERS_MAX];
	stipple *stipple[FRAME_LAYERS_MAX]; /* of layers that had one */
};

stroke_room *stroke_room_new(void)
{
	stroke_room *r = g_new0(stroke_room, 1);
	g_mutex_init(&r->lock);
	r->slabs = g_ptr_array_new_with_free_func(large_free);
	return r;
}

void stroke_room_free(stroke_room *r)
{
	if (!r)
		return;
	for (uint32_t l = 0; l < FRAME_LAYERS_MAX; l++) {
		g_free(r->of_layer[l].block);
		stipple_free(r->stipple[l]);
	}
	g_ptr_array_unref(r->slabs);
	g_mutex_clear(&r->lock);
	g_free(r);
}

static struct stroke_block *take_block(stroke_room *r)
{
	g_mutex_lock(&r->lock);
	guint n = r->taken++;
	if (n / SLAB == r->slabs->len)
		g_ptr_array_add(r->slabs, large_new(SLAB * sizeof(struct stroke_block)));
	struct stroke_block *slab = g_ptr_array_index(r->slabs, n / SLAB);
	g_mutex_unlock(&r->lock);
	return slab + n % SLAB;
}

/* Of its last block, while that is at hand. */
static void find_spans(const struct stroke_chain *c)
{
	if (c->last)
		LANES_OF(c->room->lanes, stroke_find_spans)(c->last);
}

static void give_back(stroke_room *r)
{
	guint used = (r->taken + SLAB - 1) / SLAB;
	r->spared = 2 * used < r->slabs->len ? r->spared + 1 : 0;
	if (r->spared < SPARED_MOST)
		return;
	g_ptr_array_set_size(r->slabs, (gint)used);
	r->spared = 0;
}

void stroke_chain_grow(struct stroke_chain *c)
{
	struct stroke_block *b = take_block(c->room);
	find_spans(c);
	b->next = NULL;
	b->count = 0;
	if (c->last)
		c->last->next = b;
	else
		c->first = b;
	c->last = b;
}

/* ---- a chunk ---- */

static struct brush brush_of(const frame *f, const visibility_mask *m, const struct chunk_view *v,
	const struct frame_layer *l)
{
	const struct camera *c = &f->camera;
	struct brush b = { f, l, v, m, lens_of(c) };
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		for (int n = 0; n < 3; n++)
			b.turn[k][n] = (float)row[k][n];
	b.ray_most = frame_ray_most(f, l);
	if (l->paint)
		frame_paint_crown(f, v->chunk, b.crown_m);
	return b;
}

/* All its points as surface. */
static void choose_whole(struct brush *b, struct stroke_chain *to)
{
	b->kind = FEATURE_NONE;
	b->list_count = b->view->chunk->count;
	b->wanted_most = b->layer->wanted_most[FEATURE_NONE] * b->ray_most;
	b->copies = frame_copies(b->layer);
	b->moved_m = stroke_moved_most_m(b->view->chunk, b->layer->ink.scatter, b->copies > 1);
	if (b->layer->hatch)
		LANES_OF(b->f->lanes, stroke_hatch)(b, to);
	else if (b->layer->is_cut)
		LANES_OF(b->f->lanes, stroke_cut)(b, to);
	else if (b->layer->paint)
		LANES_OF(b->f->lanes, stroke_paint)(b, to);
	else
		LANES_OF(b->f->lanes, stroke_contours)(b, to);
}

static void choose_kinds(struct brush *b, struct stroke_chain *to)
{
	for (b->kind = 0; b->kind < FEATURE_KINDS; b->kind++) {
		b->list_count = b->view->chunk->kind_end[b->kind] -
				(b->kind ? b->view->chunk->kind_end[b->kind - 1] : 0);
		if (!(b->layer->kinds >> b->kind & 1) || !b->list_count)
			continue;
		b->dither_m = b->kind == FEATURE_DITHER
				      ? frame_dither_m(b->f->scene, b->layer, b->view->chunk)
				      : 0;
		bool has_surface = frame_layer_has_surface(b->layer, b->kind);
		b->copies = has_surface ? frame_copies(b->layer) : 1;
		if (b->kind == FEATURE_UNDIRECTED)
			b->copies = MIN(b->copies, LEAVES_COPIES);
		b->moved_m = has_surface ? stroke_moved_most_m(b->view->chunk,
						   b->layer->ink.scatter, b->copies > 1)
					 : 0;
		LANES_OF(b->f->lanes, stroke_choose)(b, to);
	}
}

/* ---- all ---- */

struct task {
	struct stroke_chain of_layer[FRAME_LAYERS_MAX];
};

static void run_task(const stroke_room *r, const frame *f, const visibility_mask *m,
	const struct chunk_view *views, uint32_t count, uint64_t which, struct task *t)
{
	for (uint32_t n = 0; n < count; n++) {
		bool is_hidden = m && mask_hides(m, &views[n], HIDDEN_BEHIND);
		for (uint32_t l = 0; l < f->layers; l++) {
			if (f->layer[l].pipeline != views[n].pipeline || !(which >> l & 1) ||
				f->layer[l].is_profile)
				continue;
			if (f->layer[l].stipple)
				stipple_draw(r->stipple[l], f, &views[n], &t->of_layer[l]);
			if (is_hidden || f->layer[l].stipple)
				continue;
			struct brush b = brush_of(f, m, &views[n], &f->layer[l]);
			if (frame_layer_is_whole(&f->layer[l]))
				choose_whole(&b, &t->of_layer[l]);
			else
				choose_kinds(&b, &t->of_layer[l]);
		}
	}
	for (uint32_t l = 0; l < f->layers; l++)
		find_spans(&t->of_layer[l]);
}

/* Puts the blocks of all tasks behind each other. */
static void join(const struct task *task, uint32_t tasks, uint32_t layer, struct stroke_blocks *to)
{
	g_autoptr(GPtrArray) all = g_ptr_array_new();
	to->count = 0;
	for (uint32_t n = 0; n < tasks; n++)
		for (struct stroke_block *b = task[n].of_layer[layer].first; b; b = b->next) {
			b->first = to->count;
			to->count += b->count;
			g_ptr_array_add(all, b);
		}
	g_free(to->block);
	to->blocks = all->len;
	to->block = (struct stroke_block **)g_ptr_array_steal(all, NULL);
}

static void look_for_stipple(stroke_room *r, const frame *f, const struct chunk_view *views,
	uint32_t count, uint64_t which)
{
	for (uint32_t l = 0; l < f->layers; l++) {
		if (!f->layer[l].stipple || !(which >> l & 1))
			continue;
		if (!r->stipple[l])
			r->stipple[l] = stipple_new();
		stipple_look(r->stipple[l], f, l, views, count);
	}
}

/* Of what is no part of the picture, or of its sheet, no lines are drawn either. */
static bool is_in_view(const struct frame_layer *l, const struct chunk_view *views, uint32_t count)
{
	for (uint32_t n = 0; n < count; n++)
		if (views[n].pipeline == l->pipeline)
			return true;
	return false;
}

/* They are of no chunk. */
static void draw_profiles(const frame *f, const visibility_mask *m, const struct chunk_view *views,
	uint32_t count, uint64_t which, struct task *to)
{
	for (uint32_t l = 0; l < f->layers; l++)
		if (f->layer[l].is_profile && which >> l & 1 &&
			is_in_view(&f->layer[l], views, count)) {
			profile_strokes(f, &f->layer[l], m, &to->of_layer[l]);
			find_spans(&to->of_layer[l]);
		}
}

const struct stroke_blocks *stroke_room_fill(stroke_room *r, const frame *f,
	const visibility_mask *m, const struct chunk_view *views, uint32_t count)
{
	return stroke_room_fill_some(r, f, m, views, count, UINT64_MAX);
}

const struct stroke_blocks *stroke_room_fill_some(stroke_room *r, const frame *f,
	const visibility_mask *m, const struct chunk_view *views, uint32_t count, uint64_t which)
{
	uint32_t tasks = (count + TASK_CHUNKS - 1) / TASK_CHUNKS;
	g_autofree struct task *task = g_new0(struct task, tasks + 1);
	r->taken = 0;
	r->lanes = f->lanes;
	look_for_stipple(r, f, views, count, which);
	for (uint32_t n = 0; n <= tasks; n++)
		for (uint32_t l = 0; l < f->layers; l++)
			task[n].of_layer[l].room = r;
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t n = 0; n <= tasks; n++) {
		uint32_t first = (n - 1) * TASK_CHUNKS;
		if (n == 0) /* all of them, while others do the chunks */
			draw_profiles(f, m, views, count, which, &task[tasks]);
		else
			run_task(r, f, m, views + first, MIN(TASK_CHUNKS, count - first), which,
				&task[n - 1]);
	}
	for (uint32_t l = 0; l < f->layers; l++)
		join(task, tasks + 1, l, &r->of_layer[l]);
	give_back(r);
	return r->of_layer;
}

stroke_list *stroke_lists_new(
	const frame *f, const visibility_mask *m, const struct chunk_view *views, uint32_t count)
{
	g_autoptr(stroke_room) r = stroke_room_new();
	const struct stroke_blocks *all = stroke_room_fill(r, f, m, views, count);
	stroke_list *lists = g_new0(stroke_list, f->layers + 1);
	for (uint32_t l = 0; l < f->layers; l++) {
		lists[l].count = all[l].count;
		lists[l].stroke = g_new(struct stroke, all[l].count + 1);
		for (uint32_t n = 0; n < all[l].blocks; n++) {
			const struct stroke_block *b = all[l].block[n];
			for (uint32_t k = 0; k < b->count; k++)
				lists[l].stroke[b->first + k] = stroke_unpack(&b->stroke[k]);
		}
	}
	return lists;
}

void stroke_lists_free(stroke_list *lists, uint32_t layers)
{
	for (uint32_t l = 0; lists && l < layers; l++)
		g_free(lists[l].stroke);
	g_free(lists);
}
