#include "render/stroke-brush.h"
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

static struct brush brush_of(const frame *f, const visibility_mask *m, const struct chunk_view *v,
	const struct frame_layer *l)
{
	const struct camera *c = &f->camera;
	struct brush b = { f, l, v, m, (float)c->focal_px, (float)c->width / 2,
		(float)c->height / 2, (float)c->near_m };
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		for (int n = 0; n < 3; n++)
			b.turn[k][n] = (float)row[k][n];
	b.ray_most = frame_ray_most(f, l);
	return b;
}

static void choose_kinds(struct brush *b, GArray *to)
{
	for (b->kind = 0; b->kind < FEATURE_KINDS; b->kind++) {
		b->list_from = b->kind ? b->view->chunk->kind_end[b->kind - 1] : 0;
		b->list_count = b->view->chunk->kind_end[b->kind] - b->list_from;
		if (!(b->layer->kinds >> b->kind & 1) || !b->list_count)
			continue;
		b->wanted_most = b->layer->wanted_most[b->kind] * b->ray_most;
		b->copies = b->kind < FEATURE_UNDIRECTED ? frame_copies(b->layer) : 1;
		b->moved_m = b->kind < FEATURE_UNDIRECTED
				     ? stroke_moved_most_m(
					       b->view->chunk, b->layer->ink.scatter, b->copies > 1)
				     : 0;
		LANES_OF(b->f->lanes, stroke_choose)(b, to);
	}
}

/* ---- all ---- */

struct task {
	GArray *of_layer[FRAME_LAYERS_MAX];
	uint32_t first[FRAME_LAYERS_MAX];
};

static void run_task(const frame *f, const visibility_mask *m, const struct chunk_view *views,
	uint32_t count, struct task *t)
{
	for (uint32_t n = 0; n < count; n++) {
		if (m && mask_hides(m, &views[n], HIDDEN_BEHIND))
			continue;
		for (uint32_t l = 0; l < f->layers; l++) {
			if (f->layer[l].pipeline != views[n].pipeline)
				continue;
			struct brush b = brush_of(f, m, &views[n], &f->layer[l]);
			if (!t->of_layer[l])
				t->of_layer[l] = g_array_new(FALSE, FALSE, sizeof(struct stroke));
			choose_kinds(&b, t->of_layer[l]);
		}
	}
}

/* Where a task's strokes of a layer go, behind those of the tasks before it. */
static void join(struct task *t, uint32_t layer, stroke_list *to)
{
	GArray *a = t->of_layer[layer];
	if (!a)
		return;
	memcpy(to->stroke + t->first[layer], a->data, a->len * sizeof(struct stroke));
	g_array_unref(a);
}

stroke_list *stroke_lists_new(
	const frame *f, const visibility_mask *m, const struct chunk_view *views, uint32_t count)
{
	uint32_t tasks = (count + TASK_CHUNKS - 1) / TASK_CHUNKS;
	g_autofree struct task *task = g_new0(struct task, tasks + 1);
	stroke_list *lists = g_new0(stroke_list, f->layers + 1);
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t n = 0; n < tasks; n++)
		run_task(f, m, views + n * TASK_CHUNKS, MIN(TASK_CHUNKS, count - n * TASK_CHUNKS),
			&task[n]);
	for (uint32_t l = 0; l < f->layers; l++) {
		for (uint32_t n = 0; n < tasks; n++) {
			task[n].first[l] = lists[l].count;
			lists[l].count += task[n].of_layer[l] ? task[n].of_layer[l]->len : 0;
		}
		lists[l].stroke = g_new(struct stroke, lists[l].count + 1);
	}
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t n = 0; n < tasks; n++)
		for (uint32_t l = 0; l < f->layers; l++)
			join(&task[n], l, &lists[l]);
	return lists;
}

void stroke_lists_free(stroke_list *lists, uint32_t layers)
{
	for (uint32_t l = 0; lists && l < layers; l++)
		g_free(lists[l].stroke);
	g_free(lists);
}
