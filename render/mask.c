#include "render/large.h"
#include "render/mask-lanes.h"
#include "render/plane-lanes.h"
#ifdef _OPENMP
#include <omp.h>
#endif

void visibility_mask_free(visibility_mask *m)
{
	if (!m)
		return;
	plane_views_free(m->planes);
	g_free(m->part);
	large_free(m->memory);
	g_free(m->deepest_m);
	g_free(m);
}

static size_t keys_of_picture(const visibility_mask *m)
{
	return (size_t)m->pitch * (m->height + 2 * MASK_MARGIN);
}

static visibility_mask *mask_alloc(const struct camera *c, uint32_t threads)
{
	visibility_mask *m = g_new0(visibility_mask, 1);
	m->width = c->width;
	m->height = c->height;
	m->pitch = (c->width + 2 * MASK_MARGIN + 7) / 8 * 8;
	size_t picture = keys_of_picture(m) * sizeof(int32_t);
	char *at = m->memory = large_new(threads * large_part(picture));
	m->threads = threads;
	m->part = g_new(int32_t *, threads);
	for (uint32_t n = 0; n < threads; n++)
		m->part[n] = large_take(&at, picture);
	m->key = mask_first_key(m, m->part[0]);
	m->tiles_across = (m->width + MASK_TILE - 1) / MASK_TILE;
	m->tiles_down = (m->height + MASK_TILE - 1) / MASK_TILE;
	m->deepest_m = g_new(float, (size_t)m->tiles_across * m->tiles_down);
	return m;
}

/* ---- tiles ---- */

static void set_up(struct mask_bench *b, const visibility_mask *m)
{
	b->memory = g_aligned_alloc(7 * (size_t)m->pitch, sizeof(int32_t), 64);
	for (int k = 0; k < 5; k++)
		b->row[k] = b->memory + (size_t)k * m->pitch + MASK_MARGIN;
	for (int k = 0; k < 2; k++)
		b->below[k] = b->row[4] + (size_t)(k + 1) * m->pitch;
	b->deepest = g_aligned_alloc0(m->tiles_across, sizeof(vi), 64);
}

static void clear_up(struct mask_bench *b)
{
	g_aligned_free(b->memory);
	g_aligned_free(b->deepest);
}

/* Around its box, with its discs. */
static bool tiles_of(
	const visibility_mask *m, const struct chunk_view *v, uint32_t low[2], uint32_t high[2])
{
	const float size[2] = { (float)m->width, (float)m->height };
	for (int k = 0; k < 2; k++) {
		float from = v->low_px[k] - v->margin_px, to = v->high_px[k] + v->margin_px;
		if (to < 0 || from >= size[k])
			return false;
		low[k] = (uint32_t)MAX(from, 0) / MASK_TILE;
		high[k] = (uint32_t)MIN(to, size[k] - 1) / MASK_TILE;
	}
	return true;
}

static bool hides(const visibility_mask *m, const struct chunk_view *v, float behind,
	const uint32_t low[2], const uint32_t high[2])
{
	for (uint32_t down = low[1]; down <= high[1]; down++)
		for (uint32_t across = low[0]; across <= high[0]; across++)
			if (m->deepest_m[down * m->tiles_across + across] * (1 + behind) >=
				v->nearest_m)
				return false;
	return true;
}

bool mask_hides(const visibility_mask *m, const struct chunk_view *v, float behind)
{
	uint32_t low[2], high[2];
	if (!tiles_of(m, v, low, high)) /* beside the picture; its strokes may reach into it */
		return false;
	return hides(m, v, behind, low, high);
}

/* Discs are held against keys, which are deeper than what tiles have by the bits of a pipeline. */
#define KEY_BEHIND 1e-4f

bool mask_may_show(
	const visibility_mask *m, const struct chunk_view *v, uint32_t from, uint32_t end)
{
	uint32_t low[2], high[2];
	if (!tiles_of(m, v, low, high))
		return false;
	low[1] = MAX(low[1], from / MASK_TILE);
	high[1] = MIN(high[1], (end - 1) / MASK_TILE);
	return !hides(m, v, KEY_BEHIND, low, high);
}

/* ---- all ---- */

/* Chunks with half of the points, from the nearest on. */
static uint32_t nearer_half(const struct chunk_view *views, uint32_t count)
{
	uint64_t all = 0, so_far = 0;
	uint32_t n = 0;
	for (uint32_t k = 0; k < count; k++)
		all += views[k].chunk->count;
	while (n < count && so_far < all / 2)
		so_far += views[n++].chunk->count;
	return n;
}

static void draw(visibility_mask *m, const frame *f, const struct chunk_view *views, uint32_t count)
{
	uint32_t half = nearer_half(views, count), hidden = 0;
#pragma omp parallel num_threads((int)m->threads)
	{
		struct mask_bench b;
		set_up(&b, m);
		/* All pictures, also when there are fewer threads than that. */
#pragma omp for schedule(static)
		for (uint32_t n = 0; n < m->threads; n++)
			mask_clear(m->part[n], keys_of_picture(m));
		int32_t *own = m->part[omp_get_thread_num()];
		struct mask_target t = { mask_first_key(m, own), (int32_t)m->width,
			(int32_t)m->height, (ptrdiff_t)m->pitch };
		if (m->planes)
#pragma omp for schedule(dynamic, 1)
			for (uint32_t n = 0; n < m->planes->count; n++)
				LANES_OF(f->lanes, plane_mask)(f, &t, m->planes, n);
#pragma omp for schedule(dynamic, 2)
		for (uint32_t n = 0; n < half; n++)
			LANES_OF(f->lanes, mask_draw)(f, &t, &views[n]);
#pragma omp for schedule(static)
		for (uint32_t down = 0; down < m->tiles_down; down++)
			LANES_OF(f->lanes, mask_look)(m, down, &b);
#pragma omp for schedule(dynamic, 2) reduction(+ : hidden)
		for (uint32_t n = half; n < count; n++)
			if (mask_hides(m, &views[n], 0))
				hidden++;
			else
				LANES_OF(f->lanes, mask_draw)(f, &t, &views[n]);
		uint32_t me = (uint32_t)omp_get_thread_num(), all = (uint32_t)omp_get_num_threads();
		uint32_t from = m->tiles_down * me / all, end = m->tiles_down * (me + 1) / all;
		LANES_OF(f->lanes, mask_look_around)(m, from, end, &b);
#pragma omp barrier
		LANES_OF(f->lanes, mask_finish)(m, from, end, &b);
		clear_up(&b);
	}
	m->chunks_hidden = hidden;
}

visibility_mask *visibility_mask_renew(
	visibility_mask *m, const frame *f, const struct chunk_view *views, uint32_t count)
{
	const struct camera *c = &f->camera;
	uint32_t threads = frame_threads(f);
	if (!m || m->width != c->width || m->height != c->height || m->threads != threads) {
		visibility_mask_free(m);
		m = mask_alloc(c, threads);
	}
	plane_views_free(m->planes);
	m->planes = plane_views_new(f, views, count);
	draw(m, f, views, count);
	return m;
}

visibility_mask *visibility_mask_new(const frame *f, const struct chunk_view *views, uint32_t count)
{
	return visibility_mask_renew(NULL, f, views, count);
}

/* ---- of several ---- */

static void join_tile(
	visibility_mask *m, const visibility_mask *add, uint32_t across, uint32_t down)
{
	uint32_t right = MIN((across + 1) * MASK_TILE, m->width),
		 below = MIN((down + 1) * MASK_TILE, m->height);
	int32_t deepest = 0;
	for (uint32_t y = down * MASK_TILE; y < below; y++)
		for (uint32_t x = across * MASK_TILE; x < right; x++) {
			int32_t *key = &m->key[(ptrdiff_t)y * m->pitch + x],
				other = mask_key(add, (int32_t)x, (int32_t)y);
			*key = MIN(*key, other);
			deepest = MAX(deepest, *key);
		}
	m->deepest_m[down * m->tiles_across + across] = mask_depth(deepest);
}

visibility_mask *visibility_mask_join(
	visibility_mask *m, const frame *f, const visibility_mask *add)
{
	const struct camera *c = &f->camera;
	if (!m || m->width != c->width || m->height != c->height) {
		visibility_mask_free(m);
		m = mask_alloc(c, 1);
	}
	if (!add) {
		mask_clear(m->part[0], keys_of_picture(m));
		for (uint32_t n = 0; n < m->tiles_across * m->tiles_down; n++)
			m->deepest_m[n] = mask_depth(MASK_EMPTY);
		return m;
	}
#pragma omp parallel for num_threads((int)frame_threads(f))
	for (uint32_t down = 0; down < m->tiles_down; down++)
		for (uint32_t across = 0; across < m->tiles_across; across++)
			join_tile(m, add, across, down);
	return m;
}
