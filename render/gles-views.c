#include "render/gles-views.h"
#include "render/disc-lanes.h"
#include "render/splat.h"
#include "render/stroke.h"
#include <math.h>
#include <string.h>

_Static_assert(FEATURE_KINDS == 4, "one in each place of a vector");
_Static_assert(sizeof(struct gles_view) == 4 * 52 && offsetof(struct gles_view, at[3]) == 4 * 43,
	"as chunks.glsl has them");

/* Views that are not worth more threads. */
#define FEW 256u

/* Where views of a pipeline and a slab stand: runs are in the order of bins. */
static uint32_t bin_of(const gles_scene *g, const struct chunk_view *v)
{
	return v->pipeline * g->slabs + gles_scene_slab(g, v->chunk);
}

/* Which view is at which place: by bins, then as they are. */
static void sort(const gles_scene *g, uint32_t count, const uint32_t *bin, uint32_t *ret_view)
{
	uint32_t bins = (UINT8_MAX + 1) * MAX(g->slabs, 1), sum = 0;
	g_autofree uint32_t *begin = g_new0(uint32_t, bins);
	for (uint32_t n = 0; n < count; n++)
		begin[bin[n]]++;
	for (uint32_t k = 0; k < bins; k++) {
		uint32_t own = begin[k];
		begin[k] = sum;
		sum += own;
	}
	for (uint32_t n = 0; n < count; n++)
		ret_view[begin[bin[n]]++] = n;
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
	ret->axis[0][3] = v->nearest_m;
	for (int k = 0; k < 2; k++) {
		ret->box[k] = v->low_px[k] - v->margin_px;
		ret->box[2 + k] = v->high_px[k] + v->margin_px;
	}
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

/* bin: of the views as they came, whose order it is. */
static void find_runs(gles_views *v, const frame *f, const gles_scene *g, const uint32_t *bin,
	const uint32_t *order)
{
	g_array_set_size(v->runs, 0);
	for (uint32_t n = 0, end; n < v->count; n = end) {
		uint32_t slab = bin[order[n]] % g->slabs, pipeline = bin[order[n]] / g->slabs;
		for (end = n + 1; end < v->count && bin[order[end]] == bin[order[n]];)
			end++;
		struct gles_run next = { slab, n, end - n, (uint8_t)pipeline,
			splat_step(f, pipeline) != NULL };
		g_array_append_val(v->runs, next);
	}
}

bool gles_views_fill(const gles_context *c, gles_views *v, const frame *f, const gles_scene *g,
	const struct chunk_view *views, uint32_t count, GError **error)
{
	v->view = views;
	v->count = count;
	g_autofree uint32_t *bin = g_new(uint32_t, count + 1), *order = g_new(uint32_t, count + 1);
	g_autofree struct gles_view *block = g_new(struct gles_view, count + 1);
	bool alone = f->single_thread || count < FEW;
#pragma omp parallel for schedule(static) if (!alone)
	for (uint32_t n = 0; n < count; n++)
		bin[n] = bin_of(g, &views[n]);
	sort(g, count, bin, order);
	if (!v->runs) {
		v->runs = g_array_new(FALSE, FALSE, sizeof(struct gles_run));
		v->slices = g_byte_array_new();
	}
	g_byte_array_set_size(v->slices, count);
	find_runs(v, f, g, bin, order);
	struct lens lens = lens_of(&f->camera);
	uint64_t points = 0;
	uint32_t first_leaf = count ? views[0].chunk->leaf : 0, others = 0;
	/* What is asked of all is asked here, where they are at hand. */
#pragma omp parallel for schedule(static) reduction(+ : points, others) if (!alone)
	for (uint32_t n = 0; n < count; n++) {
		const struct chunk_view *one = &views[order[n]];
		describe(f, &lens, &g->slab[bin[order[n]] % g->slabs], one, &block[n]);
		v->slices->data[n] = slices_of(&block[n]);
		points += one->chunk->count;
		others += one->chunk->leaf != first_leaf;
	}
	v->points = points;
	v->leaf = count && !others ? (int32_t)first_leaf : -1;
	GLsizeiptr bytes = (GLsizeiptr)(v->count * sizeof *block);
	return gles_buffer_put(c, &v->buffer, block, bytes, "the chunks in view", error);
}

void gles_views_clear(const gles_context *c, gles_views *v)
{
	gles_buffer_clear(c, &v->buffer);
	g_clear_pointer(&v->runs, g_array_unref);
	g_clear_pointer(&v->slices, g_byte_array_unref);
}
