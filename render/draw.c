#include "render/draw-private.h"
#include "render/large.h"
#include "render/splat.h"
#ifdef _OPENMP
#include <omp.h>
#endif

draw_room *draw_room_new(void)
{
	return g_new0(draw_room, 1);
}

/* ---- desks ---- */

static void desk_clear(struct draw_desk *d)
{
	large_free(d->memory);
	large_free(d->points_memory);
}

static void desk_set_up_points(struct draw_desk *d, uint32_t pitch)
{
	size_t plane = (size_t)pitch * BAND_ROWS * POINTS_BANDS * sizeof(float);
	char *at = d->points_memory = large_new(4 * large_part(plane));
	for (int k = 0; k < 3; k++)
		d->light[k] = large_take(&at, plane);
	d->weight = large_take(&at, plane);
}

static void desk_set_up(struct draw_desk *d, uint32_t pitch)
{
	size_t plane = (size_t)pitch * (BAND_ROWS + 2 * BAND_AROUND) * sizeof(float);
	float **all[] = { &d->canvas[0], &d->canvas[1], &d->canvas[2], &d->ink.bare,
		&d->ink.channel[0], &d->ink.channel[1], &d->ink.channel[2], &d->ink.weight,
		&d->ink.height, &d->relief };
	char *at = d->memory = large_new(G_N_ELEMENTS(all) * large_part(plane));
	for (size_t n = 0; n < G_N_ELEMENTS(all); n++)
		*all[n] = large_take(&at, plane);
	for (size_t i = 0; i < plane / sizeof(float); i++)
		d->ink.bare[i] = 1;
}

static void clear_desks(draw_room *r)
{
	for (uint32_t n = 0; n < r->desks; n++)
		desk_clear(&r->desk[n]);
	g_clear_pointer(&r->desk, g_free);
	r->desks = 0;
}

static void set_up_desks(draw_room *r, uint32_t threads, uint32_t pitch)
{
	if (r->desks == threads && r->pitch == pitch)
		return;
	clear_desks(r);
	r->desks = threads;
	r->pitch = pitch;
	r->desk = g_new0(struct draw_desk, threads);
}

static void clear_room(draw_room *r)
{
	visibility_mask_free(r->mask);
	visibility_mask_free(r->joined);
	filter_room_clear(&r->filters);
	filter_room_clear(&r->pictures);
	stroke_room_free(r->strokes);
	band_lists_clear(&r->lists);
	clear_desks(r);
}

void draw_room_free(draw_room *r)
{
	if (!r)
		return;
	clear_room(r);
	g_free(r);
}

/* ---- bands ---- */

static bool has_points(const struct draw_job *j)
{
	for (uint32_t n = 0; n < j->count && !j->ground; n++)
		if (splat_step(j->f, j->views[n].pipeline))
			return true;
	return false;
}

void draw_bands(draw_room *r, const struct draw_job *j)
{
	bool points = has_points(j);
	uint32_t width = j->to->width, height = j->to->height;
	uint32_t rows = points ? POINTS_BANDS * BAND_ROWS : BAND_ROWS;
	uint32_t end_row = j->end_row ? j->end_row : height;
	struct band b = { width, 0, rows, (width + 2 * BAND_MARGIN + 7) / 8 * 8 };
	set_up_desks(r, frame_threads(j->f), b.pitch);
#pragma omp parallel num_threads((int)r->desks)
	{
		struct draw_desk *d = &r->desk[omp_get_thread_num()];
		d->together = b;
		d->has_points = points;
		if (!d->memory)
			desk_set_up(d, b.pitch);
		if (points && !d->points_memory)
			desk_set_up_points(d, b.pitch);
#pragma omp for schedule(dynamic, 1)
		for (uint32_t from = 0; from < height; from += rows) {
			if (frame_is_stopped(j->f) || from >= end_row ||
				from + rows <= j->first_row)
				continue;
			d->together.from = from;
			d->together.rows = MIN(rows, height - from);
			LANES_OF(j->f->lanes, draw_together)(j, d);
		}
	}
}

/* ---- all ---- */

double draw_lap(int64_t *since_us)
{
	int64_t now_us = g_get_monotonic_time();
	double s = (double)(now_us - *since_us) * 1e-6;
	*since_us = now_us;
	return s;
}

/* What hides what, and which points become strokes; false: stopped in between. */
static bool choose(
	draw_room *r, struct draw_job *j, uint64_t layers, struct draw_times *t, int64_t *since_us)
{
	struct chunk_view *views = chunk_views_new(j->f, &j->count);
	j->views = views;
	t->cull_s = draw_lap(since_us);
	j->mask = r->mask = visibility_mask_renew(r->mask, j->f, j->views, j->count);
	t->mask_s = draw_lap(since_us);
	if (frame_is_stopped(j->f))
		return false;
	if (!r->strokes)
		r->strokes = stroke_room_new();
	r->of_layer = stroke_room_fill_some(r->strokes, j->f, j->mask, j->views, j->count, layers);
	t->choose_s = draw_lap(since_us);
	return true;
}

static void count(const draw_room *r, const struct draw_job *j, struct draw_times *t)
{
	t->chunks_in_view = j->count;
	t->chunks_hidden = j->mask->chunks_hidden;
	for (uint32_t n = 0; n < j->count; n++)
		t->points_in_view += j->views[n].chunk->count;
	for (uint32_t n = 0; n < j->f->layers; n++)
		t->strokes += r->of_layer[n].count;
}

void draw_frame(
	draw_room *room, const frame *f, struct picture_buffer *to, struct draw_times *ret_times)
{
	draw_room own = { 0 };
	struct draw_times t = { 0 };
	int64_t since_us = g_get_monotonic_time(), begin_us = since_us;
	struct draw_job j = { .f = f, .to = to };
	draw_room *r = room ? room : &own;
	if (f->is_filtered) {
		draw_sheets(r, f, true, to, ret_times);
		clear_room(&own);
		return;
	}
	if (!choose(r, &j, UINT64_MAX, &t, &since_us)) {
		g_free((void *)j.views);
		clear_room(&own);
		return;
	}
	band_lists_fill(&r->lists, f, r->of_layer, to->height);
	j.lists = &r->lists;
	j.of_layer = r->of_layer;
	t.bin_s = draw_lap(&since_us);
	draw_bands(r, &j);
	t.draw_s = draw_lap(&since_us);
	count(r, &j, &t);
	g_free((void *)j.views);
	clear_room(&own);
	t.all_s = (double)(g_get_monotonic_time() - begin_us) * 1e-6;
	if (ret_times)
		*ret_times = t;
}

/* ---- in two parts ---- */

struct draw_chosen draw_choose(draw_room *room, const frame *f, struct draw_times *ret_times)
{
	struct draw_times t = { 0 };
	int64_t since_us = g_get_monotonic_time(), begin_us = since_us;
	struct draw_job j = { .f = f };
	choose(room, &j, f->is_filtered ? frame_layers_over(f, true) : UINT64_MAX, &t, &since_us);
	count(room, &j, &t);
	g_free((void *)j.views);
	t.all_s = (double)(since_us - begin_us) * 1e-6;
	if (ret_times)
		*ret_times = t;
	return (struct draw_chosen){ room->mask, room->of_layer };
}

void draw_below_strokes(draw_room *room, const frame *f, struct picture_buffer *to)
{
	struct draw_job j = { .f = f, .to = to };
	if (f->is_filtered) {
		draw_sheets(room, f, false, to, NULL);
		return;
	}
	g_autofree struct chunk_view *views = chunk_views_new(f, &j.count);
	j.views = views;
	j.mask = room->mask = visibility_mask_renew(room->mask, f, views, j.count);
	draw_bands(room, &j);
}
