#include "render/gles-views.h"
#include "render/disc-lanes.h"
#include "render/splat.h"
#include "render/stroke.h"
#include <math.h>
#include <string.h>

_Static_assert(FEATURE_KINDS == 4, "one in each place of a vector");

struct place {
	uint32_t key, view; /* pipeline and slab; of the views from near to far */
};

static int by_key(const void *a, const void *b)
{
	const struct place *x = a, *y = b;
	return x->key != y->key ? (x->key < y->key ? -1 : 1)
				: (x->view > y->view) - (x->view < y->view);
}

static struct place *sort(const gles_scene *g, const struct chunk_view *views, uint32_t count)
{
	struct place *p = g_new(struct place, count + 1);
	for (uint32_t n = 0; n < count; n++) {
		uint32_t slab = gles_scene_slab(g, views[n].chunk);
		p[n] = (struct place){ views[n].pipeline * g->slabs + slab, n };
	}
	qsort(p, count, sizeof *p, by_key);
	return p;
}

static void describe_paint(const frame *f, const struct scene_chunk *c, struct gles_view *ret)
{
	const struct scene_paint_chunk *seen =
		scene_paint_chunk_of(scene_paint_of(f->scene), f->scene, c);
	frame_paint_crown(f, c, ret->crown);
	ret->crown[3] = seen->is_leafy ? -seen->cell_m : seen->cell_m;
	memcpy(&ret->paint[0], seen->rgba, sizeof ret->paint[0]);
}

/* How many of the first points may be drawn as discs, the last bit: those on planes are not. */
static uint32_t disc_end(const frame *f, const struct lens *l, const struct chunk_view *v)
{
	bool has_planes = frame_has_planes(f, v->pipeline);
	if (has_planes && v->chunk->on_planes == v->chunk->count)
		return 0;
	return disc_prefix(l, v) | (has_planes ? GLES_VIEW_PLANES : 0);
}

static void describe(const frame *f, const struct lens *l, const struct gles_slab *slab,
	const struct chunk_view *v, struct gles_view *ret)
{
	const struct scene_chunk *c = v->chunk;
	const struct mask_step *mask = &frame_pipeline(f, v->pipeline)->mask;
	const struct points_step *points = splat_step(f, v->pipeline);
	*ret = (struct gles_view){ .mask = { mask->disc, mask->offset_m, mask->offset_relative,
					   mask->backs == BACKS_HIDDEN },
		.splat = { 0, 0, c->spacing_most_m, c->disc_most_m },
		.at = { c->first - slab->first, scene_id(f->scene, c->first), c->count,
			disc_end(f, l, v) },
		.pipeline = { v->pipeline, (uint32_t)(c - f->scene->chunk), c->leaf } };
	memcpy(&ret->pipeline[3], &c->part, sizeof c->part);
	memcpy(ret->base, v->base, sizeof v->base);
	ret->base[3] = v->near_m;
	for (int k = 0; k < 3; k++)
		memcpy(ret->axis[k], v->axis[k], sizeof v->axis[k]);
	memcpy(ret->spacing_most_m, c->list_spacing_most_m, sizeof ret->spacing_most_m);
	memcpy(ret->kind_end, c->kind_end, sizeof ret->kind_end);
	if (f->is_painted)
		describe_paint(f, c, ret);
	if (points) {
		ret->splat[0] = points->size;
		ret->splat[1] = fmaxf(points->least_px * f->px / 2, DISC_RADIUS_LEAST);
	}
}

static void add_to_runs(
	gles_views *v, const frame *f, uint32_t at, uint32_t slab, const struct chunk_view *view)
{
	uint8_t pipeline = view->pipeline;
	struct gles_run *last =
		v->runs->len ? &g_array_index(v->runs, struct gles_run, v->runs->len - 1) : NULL;
	if (last && last->slab == slab && last->pipeline == pipeline) {
		last->count++;
		return;
	}
	struct gles_run next = { slab, at, 1, pipeline, splat_step(f, pipeline) != NULL };
	g_array_append_val(v->runs, next);
}

bool gles_views_fill(const gles_context *c, gles_views *v, const frame *f, const gles_scene *g,
	const struct chunk_view *views, uint32_t count, GError **error)
{
	v->view = views;
	v->count = count;
	g_autofree struct place *place = sort(g, views, v->count);
	g_autofree struct gles_view *block = g_new(struct gles_view, v->count + 1);
	if (!v->runs)
		v->runs = g_array_new(FALSE, FALSE, sizeof(struct gles_run));
	g_array_set_size(v->runs, 0);
	v->points = 0;
	struct lens lens = lens_of(&f->camera);
	for (uint32_t n = 0; n < v->count; n++) {
		const struct chunk_view *view = &views[place[n].view];
		uint32_t slab = place[n].key % g->slabs;
		describe(f, &lens, &g->slab[slab], view, &block[n]);
		add_to_runs(v, f, n, slab, view);
		v->points += view->chunk->count;
	}
	GLsizeiptr bytes = (GLsizeiptr)(v->count * sizeof *block);
	return gles_buffer_put(c, &v->buffer, block, bytes, "the chunks in view", error);
}

void gles_views_clear(const gles_context *c, gles_views *v)
{
	gles_buffer_clear(c, &v->buffer);
	if (v->runs)
		g_array_unref(v->runs);
	v->runs = NULL;
}
