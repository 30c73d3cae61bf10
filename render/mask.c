#include "render/mask.h"
#include "render/disc-lanes.h"
#include <math.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

/* Of a disc's radius. */
#define SLANT 1.f

struct target {
	int32_t *key;
	int32_t width, height;
	ptrdiff_t pitch;
};

void visibility_mask_free(visibility_mask *m)
{
	if (m) {
		g_aligned_free(m->memory);
		g_free(m->deepest_m);
		g_free(m);
	}
}

static size_t keys_of(const struct camera *c, uint32_t *ret_pitch)
{
	*ret_pitch = (c->width + 2 * MASK_MARGIN + 7) / 8 * 8;
	return (size_t)*ret_pitch * (c->height + 2 * MASK_MARGIN);
}

static visibility_mask *mask_alloc(const struct camera *c)
{
	visibility_mask *m = g_new0(visibility_mask, 1);
	size_t keys = keys_of(c, &m->pitch);
	m->width = c->width;
	m->height = c->height;
	m->memory = g_aligned_alloc(keys, sizeof *m->memory, 64);
	m->key = m->memory + (size_t)MASK_MARGIN * m->pitch + MASK_MARGIN;
	return m;
}

static void clear(visibility_mask *m)
{
	size_t keys = (size_t)m->pitch * (m->height + 2 * MASK_MARGIN);
	for (size_t i = 0; i < keys; i++)
		m->memory[i] = MASK_EMPTY;
}

/* ---- discs ---- */

INLINE vi lower(vi a, vi b)
{
	vi less = a < b;
	return (a & less) | (b & ~less);
}

/* One of the lanes. */
struct disc {
	float x, y, radius, squash[2], tilt[2];
	float depth_m; /* pushed back */
	int32_t pipeline;
};

INLINE vi keys_of_depths(vf depth_m, vi inside, int32_t pipeline)
{
	vi key = ((vi)depth_m & ~((1 << MASK_PIPELINE_BITS) - 1)) | pipeline;
	return (inside & key) | (~inside & MASK_EMPTY);
}

INLINE void put(int32_t *at, vi key)
{
	*(vi_loose *)at = lower(*(vi_loose *)at, key);
}

/* Up to eight pixels wide, well inside the picture. */
INLINE void draw_small(const struct target *t, const struct disc *d)
{
	int left = (int)(d->x - d->radius), top = (int)(d->y - d->radius),
	    bottom = (int)(d->y + d->radius);
	vf dx = (float)left + 0.5f - d->x + lane_number;
	/* dx^2 + dy^2 + (squash . d)^2, in powers of dy */
	vf flat = dx * dx * (1 + d->squash[0] * d->squash[0]),
	   cross = dx * (2 * d->squash[0] * d->squash[1]);
	vf depth_m = d->depth_m + d->tilt[0] * dx;
	float steep = 1 + d->squash[1] * d->squash[1], reach = d->radius * d->radius;
	int32_t *at = t->key + top * t->pitch + left;
	for (int row = top; row <= bottom; row++, at += t->pitch) {
		float down = (float)row + 0.5f - d->y;
		vi inside = flat + cross * down <= reach - steep * down * down;
		put(at, keys_of_depths(depth_m + d->tilt[1] * down, inside, d->pipeline));
	}
}

INLINE void draw_large(const struct target *t, const struct disc *d)
{
	int left = MAX((int)floorf(d->x - d->radius), 1 - LANES),
	    right = MIN((int)floorf(d->x + d->radius), t->width - 1),
	    top = MAX((int)floorf(d->y - d->radius), 0),
	    bottom = MIN((int)floorf(d->y + d->radius), t->height - 1);
	for (int row = top; row <= bottom; row++)
		for (int column = left; column <= right; column += LANES) {
			float down = (float)row + 0.5f - d->y;
			vf dx = (float)column + 0.5f - d->x + lane_number;
			vf across = d->squash[0] * dx + d->squash[1] * down;
			vi inside =
				dx * dx + down * down + across * across <= d->radius * d->radius;
			put(t->key + row * t->pitch + column,
				keys_of_depths(d->depth_m + d->tilt[0] * dx + d->tilt[1] * down,
					inside, d->pipeline));
		}
}

/* ---- points ---- */

/* Those of less than this are at most eight pixels wide. */
#define RADIUS_SMALL 3.4f

/* Eight discs, as lanes and one by one. */
struct batch {
	float x[LANES], y[LANES], radius[LANES], squash[2][LANES], tilt[2][LANES], depth_m[LANES];
	int32_t at[LANES], key[LANES]; /* of dots */
};

INLINE void draw_dots(const struct target *t, const struct batch *b, unsigned which)
{
	for (; which; which &= which - 1) {
		int k = __builtin_ctz(which);
		int32_t *at = t->key + b->at[k];
		*at = MIN(*at, b->key[k]);
	}
}

INLINE struct disc disc_of(const struct batch *b, int k, int32_t pipeline)
{
	return (struct disc){ b->x[k], b->y[k], b->radius[k], { b->squash[0][k], b->squash[1][k] },
		{ b->tilt[0][k], b->tilt[1][k] }, b->depth_m[k], pipeline };
}

INLINE void draw_lanes(
	const struct target *t, const struct disc_lanes *d, vf pushed_m, int32_t pipeline)
{
	struct batch b;
	vi inside =
		(d->x >= 0) & (d->y >= 0) & (d->x < (float)t->width) & (d->y < (float)t->height);
	vi column = __builtin_convertvector(where(inside, d->x), vi),
	   row = __builtin_convertvector(where(inside, d->y), vi);
	vi clear_of_edges = (d->x >= d->radius) & (d->y >= d->radius) & (d->x < (float)t->width) &
			    (d->y + d->radius < (float)t->height);
	unsigned dots = bits(inside & (d->radius < MASK_DOT_RADIUS)) & d->drawn,
		 small = bits(clear_of_edges & (d->radius >= MASK_DOT_RADIUS) &
				 (d->radius < RADIUS_SMALL)) &
			 d->drawn;
	store_mask(b.at, row * (int32_t)t->pitch + column);
	vf centre_m = pushed_m + d->tilt[0] * (__builtin_convertvector(column, vf) + 0.5f - d->x) +
		      d->tilt[1] * (__builtin_convertvector(row, vf) + 0.5f - d->y);
	store_mask(b.key, keys_of_depths(centre_m, inside, pipeline));
	draw_dots(t, &b, dots);
	if (d->drawn == dots)
		return;
	store(b.x, d->x);
	store(b.y, d->y);
	store(b.radius, d->radius);
	store(b.depth_m, pushed_m);
	for (int k = 0; k < 2; k++) {
		store(b.squash[k], d->squash[k]);
		store(b.tilt[k], d->tilt[k]);
	}
	for (unsigned left = small; left; left &= left - 1) {
		struct disc one = disc_of(&b, __builtin_ctz(left), pipeline);
		draw_small(t, &one);
	}
	for (unsigned left = d->drawn & ~small & ~dots; left; left &= left - 1) {
		struct disc one = disc_of(&b, __builtin_ctz(left), pipeline);
		draw_large(t, &one);
	}
}

INLINE void draw_chunk(const frame *f, const struct target *t, const struct chunk_view *v)
{
	const struct mask_step *step = &frame_pipeline(f, v->pipeline)->mask;
	struct disc_pass p =
		disc_pass_of(f, step->disc, DISC_RADIUS_LEAST, step->backs == BACKS_HIDDEN);
	uint32_t end = disc_prefix(&p, v);
	for (uint32_t i = 0; i < end; i += LANES) {
		struct disc_lanes d = disc_lanes_of(f->scene, &p, v, i, end);
		if (!d.drawn)
			continue;
		/* By what the style says, and by the disc's own size, for it is not quite where its neighbours are. */
		vf pushed_m = d.depth_m * (1 + step->offset_relative) + step->offset_m +
			      SLANT * d.radius * d.depth_m * (1 / p.focal_px);
		draw_lanes(t, &d, pushed_m, v->pipeline);
	}
}

static void draw_portable(const frame *f, const struct target *t, const struct chunk_view *v)
{
	draw_chunk(f, t, v);
}

#if defined __x86_64__
__attribute__((target("avx2"))) static void draw_avx2(
	const frame *f, const struct target *t, const struct chunk_view *v)
{
	draw_chunk(f, t, v);
}
#else
#define draw_avx2 draw_portable
#endif

/* ---- holes ---- */

INLINE vi farther(vi a, vi b)
{
	vi less = a < b;
	return (b & less) | (a & ~less);
}

INLINE vi keys_at(const int32_t *const rows[5], int down, int x)
{
	return *(const vi_loose *)(rows[down + 2] + x);
}

/* A pixel between two that are nearer, one or two pixels wide, belongs to them. */
INLINE vi filled(const int32_t *const rows[5], int x)
{
	static const int pairs[8][4] = { { -1, 0, 1, 0 }, { 0, -1, 0, 1 }, { -1, -1, 1, 1 },
		{ 1, -1, -1, 1 }, { -2, 0, 1, 0 }, { -1, 0, 2, 0 }, { 0, -2, 0, 1 },
		{ 0, -1, 0, 2 } };
	vi own = keys_at(rows, 0, x), between = own;
	for (int n = 0; n < 8; n++)
		between = lower(between, farther(keys_at(rows, pairs[n][1], x + pairs[n][0]),
						 keys_at(rows, pairs[n][3], x + pairs[n][2])));
	vi is_hole = (vf)between * MASK_HOLE < (vf)own;
	return (between & is_hole) | (own & ~is_hole);
}

INLINE void fill_row(const visibility_mask *from, visibility_mask *to, int y)
{
	const int32_t *rows[5];
	for (int k = 0; k < 5; k++)
		rows[k] = from->key + (ptrdiff_t)(y + k - 2) * from->pitch;
	for (int x = 0; x < (int)from->width; x += LANES)
		*(vi_loose *)(to->key + (ptrdiff_t)y * to->pitch + x) = filled(rows, x);
}

static void fill_portable(const visibility_mask *from, visibility_mask *to, int y)
{
	fill_row(from, to, y);
}

#if defined __x86_64__
__attribute__((target("avx2"))) static void fill_avx2(
	const visibility_mask *from, visibility_mask *to, int y)
{
	fill_row(from, to, y);
}
#else
#define fill_avx2 fill_portable
#endif

/* ---- tiles ---- */

static float deepest_of(const visibility_mask *m, uint32_t across, uint32_t down)
{
	int32_t deepest = 0;
	for (uint32_t y = down * MASK_TILE; y < MIN((down + 1) * MASK_TILE, m->height); y++)
		for (uint32_t x = across * MASK_TILE; x < MIN((across + 1) * MASK_TILE, m->width);
			x++)
			deepest = MAX(deepest, mask_key(m, (int32_t)x, (int32_t)y));
	return mask_depth(deepest);
}

static void make_tiles(visibility_mask *m)
{
	m->tiles_across = (m->width + MASK_TILE - 1) / MASK_TILE;
	m->tiles_down = (m->height + MASK_TILE - 1) / MASK_TILE;
	m->deepest_m = g_new(float, (size_t)m->tiles_across * m->tiles_down);
}

/* A row of tiles of m, as they are in from. */
static void tiles_from(const visibility_mask *from, visibility_mask *m, uint32_t down)
{
	for (uint32_t across = 0; across < m->tiles_across; across++)
		m->deepest_m[down * m->tiles_across + across] = deepest_of(from, across, down);
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

bool mask_hides(const visibility_mask *m, const struct chunk_view *v)
{
	uint32_t low[2], high[2];
	if (!tiles_of(m, v, low, high)) /* beside the picture; its strokes may reach into it */
		return false;
	for (uint32_t down = low[1]; down <= high[1]; down++)
		for (uint32_t across = low[0]; across <= high[0]; across++)
			if (m->deepest_m[down * m->tiles_across + across] >= v->nearest_m)
				return false;
	return true;
}

/* ---- threads ---- */

static void merge_row(visibility_mask *const *part, int parts, uint32_t y)
{
	int32_t *a = part[0]->key + (size_t)y * part[0]->pitch;
	int width = (int)part[0]->width;
	for (int n = 1; n < parts; n++) {
		const int32_t *b = part[n]->key + (size_t)y * part[n]->pitch;
		for (int x = 0; x < width; x++)
			a[x] = MIN(a[x], b[x]);
	}
	/* What discs at the edge left beyond it is nothing that holes are filled by. */
	for (int x = 0; x < MASK_MARGIN; x++)
		a[-1 - x] = a[width + x] = MASK_EMPTY;
}

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

visibility_mask *visibility_mask_new(const frame *f, const struct chunk_view *views, uint32_t count)
{
	bool wide = !f->portable && vectors_have_avx2();
	void (*draw)(const frame *, const struct target *, const struct chunk_view *) =
		wide ? draw_avx2 : draw_portable;
	int threads = f->single_thread ? 1 : omp_get_max_threads();
	uint32_t half = nearer_half(views, count), hidden = 0;
	g_autofree visibility_mask **part = g_new0(visibility_mask *, threads);
	visibility_mask *whole = mask_alloc(&f->camera);
	clear(whole);
	make_tiles(whole);
#pragma omp parallel num_threads(threads)
	{
		visibility_mask *own = mask_alloc(&f->camera);
		part[omp_get_thread_num()] = own;
		clear(own);
		struct target t = { own->key, (int32_t)own->width, (int32_t)own->height,
			(ptrdiff_t)own->pitch };
#pragma omp for schedule(dynamic, 4)
		for (uint32_t n = 0; n < half; n++)
			draw(f, &t, &views[n]);
#pragma omp for schedule(static)
		for (uint32_t y = 0; y < own->height; y++)
			merge_row(part, omp_get_num_threads(), y);
#pragma omp for schedule(static)
		for (uint32_t down = 0; down < whole->tiles_down; down++)
			tiles_from(part[0], whole, down);
#pragma omp for schedule(dynamic, 4) reduction(+ : hidden)
		for (uint32_t n = half; n < count; n++)
			if (mask_hides(whole, &views[n]))
				hidden++;
			else
				draw(f, &t, &views[n]);
#pragma omp for schedule(static)
		for (uint32_t y = 0; y < own->height; y++)
			merge_row(part, omp_get_num_threads(), y);
#pragma omp for schedule(static)
		for (int y = 0; y < (int)own->height; y++)
			(wide ? fill_avx2 : fill_portable)(part[0], whole, y);
#pragma omp for schedule(static)
		for (uint32_t down = 0; down < whole->tiles_down; down++)
			tiles_from(whole, whole, down);
	}
	whole->chunks_hidden = hidden;
	for (int n = 0; n < threads; n++)
		visibility_mask_free(part[n]);
	return whole;
}
