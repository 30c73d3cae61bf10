#include "render/gles-views.h"
#include "render/disc-lanes.h"
#include "render/splat.h"
#include "render/stroke.h"
#include <math.h>
#include <string.h>

_Static_assert(FEATURE_KINDS == 4, "one in each place of a vector");

/* Views that are not worth more threads. */
#define FEW 256u

/* Which view is at which place: by pipelines, then by slabs, then as they are. Each has a bin of its own. */
static void sort(const gles_scene *g, const struct chunk_view *views, uint32_t count,
	const uint32_t *slab, uint32_t *ret_view)
{
	uint32_t bins = (UINT8_MAX + 1) * MAX(g->slabs, 1), sum = 0;
	g_autofree uint32_t *begin = g_new0(uint32_t, bins);
	for (uint32_t n = 0; n < count; n++)
		begin[views[n].pipeline * g->slabs + slab[n]]++;
	for (uint32_t k = 0; k < bins; k++) {
		uint32_t own = begin[k];
		begin[k] = sum;
		sum += own;
	}
	for (uint32_t n = 0; n < count; n++)
		ret_view[begin[views[n].pipeline * g->slabs + slab[n]]++] = n;
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

static uint8_t slices_of(const struct gles_view *v)
{
	uint32_t discs = v->at[3] & ~GLES_VIEW_PLANES;
	_Static_assert(MODEL_CHUNK_POINTS / GLES_SLICE <= UINT8_MAX, "in a byte");
	return (uint8_t)((discs + GLES_SLICE - 1) / GLES_SLICE);
}

static void add_to_runs(
	gles_views *v, const frame *f, uint32_t at, uint32_t slab, uint32_t pipeline)
{
	struct gles_run *last =
		v->runs->len ? &g_array_index(v->runs, struct gles_run, v->runs->len - 1) : NULL;
	if (last && last->slab == slab && last->pipeline == pipeline) {
		last->count++;
		return;
	}
	struct gles_run next = { slab, at, 1, (uint8_t)pipeline, splat_step(f, pipeline) != NULL };
	g_array_append_val(v->runs, next);
}

bool gles_views_fill(const gles_context *c, gles_views *v, const frame *f, const gles_scene *g,
	const struct chunk_view *views, uint32_t count, GError **error)
{
	v->view = views;
	v->count = count;
	g_autofree uint32_t *slab = g_new(uint32_t, count + 1), *order = g_new(uint32_t, count + 1);
	g_autofree struct gles_view *block = g_new(struct gles_view, count + 1);
	bool alone = f->single_thread || count < FEW;
#pragma omp parallel for schedule(static) if (!alone)
	for (uint32_t n = 0; n < count; n++)
		slab[n] = gles_scene_slab(g, views[n].chunk);
	sort(g, views, count, slab, order);
	if (!v->runs) {
		v->runs = g_array_new(FALSE, FALSE, sizeof(struct gles_run));
		v->slices = g_byte_array_new();
	}
	g_byte_array_set_size(v->slices, count);
	g_array_set_size(v->runs, 0);
	v->points = 0;
	v->leaf = count ? (int32_t)views[0].chunk->leaf : -1;
	struct lens lens = lens_of(&f->camera);
#pragma omp parallel for schedule(static) if (!alone)
	for (uint32_t n = 0; n < count; n++)
		describe(f, &lens, &g->slab[slab[order[n]]], &views[order[n]], &block[n]);
	for (uint32_t n = 0; n < count; n++) {
		add_to_runs(v, f, n, slab[order[n]], block[n].pipeline[0]);
		v->points += block[n].at[2];
		v->slices->data[n] = slices_of(&block[n]);
		if ((int32_t)views[n].chunk->leaf != v->leaf)
			v->leaf = -1;
	}
	GLsizeiptr bytes = (GLsizeiptr)(v->count * sizeof *block);
	return gles_buffer_put(c, &v->buffer, block, bytes, "the chunks in view", error);
}

void gles_views_clear(const gles_context *c, gles_views *v)
{
	gles_buffer_clear(c, &v->buffer);
	g_clear_pointer(&v->runs, g_array_unref);
	g_clear_pointer(&v->slices, g_byte_array_unref);
}
