#include "render/mask.h"
#include "render/disc-lanes.h"
#include <math.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

/* Of a disc's radius. */
#define SLANT 1.f

/* One thread's picture of keys. */
struct target {
	int32_t *key; /* of pixel 0 0 */
	int32_t width, height;
	ptrdiff_t pitch;
};

void visibility_mask_free(visibility_mask *m)
{
	if (!m)
		return;
	for (uint32_t n = 0; n < m->threads; n++)
		g_aligned_free(m->part[n]);
	g_free(m->part);
	g_aligned_free(m->memory);
	g_free(m->deepest_m);
	g_free(m);
}

static size_t keys_of_picture(const visibility_mask *m)
{
	return (size_t)m->pitch * (m->height + 2 * MASK_MARGIN);
}

static int32_t *picture_new(const visibility_mask *m)
{
	return g_aligned_alloc(keys_of_picture(m), sizeof(int32_t), 64);
}

static int32_t *first_key(const visibility_mask *m, int32_t *memory)
{
	return memory + (size_t)MASK_MARGIN * m->pitch + MASK_MARGIN;
}

static void clear(int32_t *keys, size_t count)
{
	for (size_t i = 0; i < count; i++)
		keys[i] = MASK_EMPTY;
}

static visibility_mask *mask_alloc(const struct camera *c, uint32_t threads)
{
	visibility_mask *m = g_new0(visibility_mask, 1);
	m->width = c->width;
	m->height = c->height;
	m->pitch = (c->width + 2 * MASK_MARGIN + 7) / 8 * 8;
	m->memory = picture_new(m);
	m->key = first_key(m, m->memory);
	m->threads = threads;
	m->part = g_new(int32_t *, threads);
	for (uint32_t n = 0; n < threads; n++)
		m->part[n] = picture_new(m);
	m->tiles_across = (m->width + MASK_TILE - 1) / MASK_TILE;
	m->tiles_down = (m->height + MASK_TILE - 1) / MASK_TILE;
	m->deepest_m = g_new(float, (size_t)m->tiles_across * m->tiles_down);
	clear(m->memory, keys_of_picture(m)); /* its margins */
	return m;
}

/* ---- discs ---- */

/* Eight discs. Where c is a column and r a row from the first pixel of its box on, a pixel is inside where
 * away + (along + flat c) c + (step + cross c) r + steep r (r - 1) <= 0, and depth_m + tilt . (c, r) deep there. */
struct discs {
	vf away, along, flat, step, cross, steep2, depth_m, tilt[2];
	vi at, columns, rows;
};

/* The first pixel from 0 to end whose middle is not before x: also of those that are not drawn, which may be anywhere. */
INLINE vi pixel_from(vf x, int32_t end)
{
	return __builtin_convertvector(least(most(x, all(0)), all((float)end)) + 0.5f, vi);
}

INLINE void find_discs(
	const struct target *t, const struct disc_lanes *d, vf pushed_m, struct discs *ret)
{
	vi left = pixel_from(d->x - d->half[0], t->width),
	   top = pixel_from(d->y - d->half[1], t->height);
	vf x = __builtin_convertvector(left, vf) + 0.5f - d->x,
	   y = __builtin_convertvector(top, vf) + 0.5f - d->y;
	vf flat = 1 + d->squash[0] * d->squash[0], steep = 1 + d->squash[1] * d->squash[1],
	   cross = 2 * d->squash[0] * d->squash[1];
	ret->flat = flat;
	ret->cross = cross;
	ret->steep2 = 2 * steep;
	ret->away = flat * x * x + cross * x * y + steep * y * y - d->radius * d->radius;
	ret->along = 2 * flat * x + cross * y;
	ret->step = cross * x + steep * (2 * y + 1);
	ret->depth_m = pushed_m + d->tilt[0] * x + d->tilt[1] * y;
	ret->tilt[0] = d->tilt[0];
	ret->tilt[1] = d->tilt[1];
	ret->at = top * (int32_t)t->pitch + left;
	ret->columns = pixel_from(d->x + d->half[0], t->width) - left;
	ret->rows = pixel_from(d->y + d->half[1], t->height) - top;
}

INLINE vi keys_of(vf depth_m, int32_t pipeline)
{
	return ((vi)depth_m & ~((1 << MASK_PIPELINE_BITS) - 1)) | pipeline;
}

/* Eight columns of one disc, from column on; those outside have the highest key. */
INLINE void draw_columns(
	const struct target *t, const struct discs *d, int k, int column, int32_t pipeline)
{
	vf c = (float)column + lane_number;
	vf away = d->away[k] + (d->along[k] + d->flat[k] * c) * c,
	   step = d->step[k] + d->cross[k] * c, depth_m = d->depth_m[k] + d->tilt[0][k] * c;
	int32_t *at = t->key + d->at[k] + column;
	for (int rows = d->rows[k]; rows > 0; rows--, at += t->pitch) {
		store_mask(
			at, lower_unsigned(load_mask(at), keys_of(depth_m, pipeline) | (away > 0)));
		depth_m += d->tilt[1][k];
		away += step;
		step += d->steep2[k];
	}
}

/* ---- points ---- */

/* Discs are reckoned some at a time before they are drawn: how many rows one has is hard to foresee, and nothing that takes long
 * should wait for it. */
#define SHEET 32

struct sheet {
	struct discs discs[SHEET];
	vi dot_at[SHEET], dot_key[SHEET];
	uint8_t dots[SHEET], wide[SHEET];
};

/* Which of them to draw. */
INLINE unsigned place_dots(const struct target *t, const struct disc_lanes *d, vf pushed_m,
	int32_t pipeline, vi *ret_at, vi *ret_key)
{
	vi inside =
		(d->x >= 0) & (d->y >= 0) & (d->x < (float)t->width) & (d->y < (float)t->height);
	vi column = __builtin_convertvector(where(inside, d->x), vi),
	   row = __builtin_convertvector(where(inside, d->y), vi);
	vf depth_m = pushed_m + d->tilt[0] * (__builtin_convertvector(column, vf) + 0.5f - d->x) +
		     d->tilt[1] * (__builtin_convertvector(row, vf) + 0.5f - d->y);
	*ret_at = row * (int32_t)t->pitch + column;
	*ret_key = keys_of(depth_m, pipeline);
	return bits(inside);
}

INLINE void lay_out(const frame *f, const struct target *t, const struct chunk_view *v,
	const struct disc_pass *p, uint32_t i, struct sheet *to, uint32_t n)
{
	const struct mask_step *step = &frame_pipeline(f, v->pipeline)->mask;
	struct disc_lanes d;
	disc_lanes_find(f->scene, p, v, i, MASK_DOT_RADIUS, &d);
	to->dots[n] = to->wide[n] = 0;
	if (!d.drawn)
		return;
	unsigned dots = bits(d.radius < MASK_DOT_RADIUS) & d.drawn, wide = d.drawn & ~dots;
	/* By what the style says, and by the disc's own size, for it is not quite where its neighbours are. */
	vf pushed_m = d.depth_m * (1 + step->offset_relative) + step->offset_m +
		      SLANT * d.radius * d.depth_m * (1 / p->focal_px);
	if (dots)
		dots &= place_dots(t, &d, pushed_m, v->pipeline, &to->dot_at[n], &to->dot_key[n]);
	if (wide) {
		find_discs(t, &d, pushed_m, &to->discs[n]);
		wide &= bits((to->discs[n].columns > 0) & (to->discs[n].rows > 0));
	}
	to->dots[n] = (uint8_t)dots;
	to->wide[n] = (uint8_t)wide;
}

INLINE void draw_sheet(
	const struct target *t, const struct sheet *s, uint32_t count, int32_t pipeline)
{
	for (uint32_t n = 0; n < count; n++)
		for (unsigned left = s->dots[n]; left; left &= left - 1) {
			int k = __builtin_ctz(left);
			int32_t *at = t->key + s->dot_at[n][k];
			*at = MIN(*at, s->dot_key[n][k]);
		}
	for (uint32_t n = 0; n < count; n++)
		for (unsigned left = s->wide[n]; left; left &= left - 1) {
			int k = __builtin_ctz(left);
			for (int column = 0; column < s->discs[n].columns[k]; column += LANES)
				draw_columns(t, &s->discs[n], k, column, pipeline);
		}
}

INLINE void draw_chunk(const frame *f, const struct target *t, const struct chunk_view *v)
{
	struct disc_pass p =
		disc_pass_of(f, v, frame_pipeline(f, v->pipeline)->mask.disc, DISC_RADIUS_LEAST);
	struct sheet sheet;
	uint32_t n = 0;
	for (uint32_t i = 0; i < p.end; i += LANES) {
		lay_out(f, t, v, &p, i, &sheet, n);
		if (++n < SHEET && i + LANES < p.end)
			continue;
		draw_sheet(t, &sheet, n, v->pipeline);
		n = 0;
	}
}

/* ---- holes ---- */

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
		between = lower(between, higher(keys_at(rows, pairs[n][1], x + pairs[n][0]),
						 keys_at(rows, pairs[n][3], x + pairs[n][2])));
	vi is_hole = (vf)between * MASK_HOLE < (vf)own;
	return (between & is_hole) | (own & ~is_hole);
}

INLINE void fill_row(const int32_t *const rows[5], int32_t *to, uint32_t width)
{
	for (int x = 0; x < (int)width; x += LANES)
		store_mask(to + x, filled(rows, x));
}

/* ---- threads' pictures together ---- */

/* Nothing beyond the picture's edges, whatever discs there left, and nothing above and below. */
INLINE void merge_row(const visibility_mask *m, int y, int32_t *to)
{
	const int32_t *row[MASK_THREADS_MOST];
	if (y < 0 || y >= (int)m->height) {
		clear(to - MASK_MARGIN, m->pitch);
		return;
	}
	for (uint32_t n = 0; n < m->threads; n++)
		row[n] = first_key(m, m->part[n]) + (ptrdiff_t)y * m->pitch;
	for (int x = 0; x < (int)m->width; x += LANES) {
		vi key = load_mask(row[0] + x);
		for (uint32_t n = 1; n < m->threads; n++)
			key = lower(key, load_mask(row[n] + x));
		store_mask(to + x, key);
	}
	for (int x = 0; x < MASK_MARGIN; x++)
		to[-1 - x] = to[(int)m->width + x] = MASK_EMPTY;
}

/* ---- tiles ---- */

/* Keys of the deepest pixels so far of a row of tiles. */
INLINE void deepen(const int32_t *row, uint32_t width, vi *deepest)
{
	vi column = __builtin_convertvector(lane_number, vi);
	for (uint32_t x = 0; x < width; x += LANES)
		deepest[x / MASK_TILE] = higher(deepest[x / MASK_TILE],
			load_mask(row + x) & (column + (int32_t)x < (int32_t)width));
}

INLINE void put_tiles(visibility_mask *m, uint32_t down, vi *deepest)
{
	for (uint32_t across = 0; across < m->tiles_across; across++) {
		int32_t most = 0;
		for (int k = 0; k < LANES; k++)
			most = MAX(most, deepest[across][k]);
		m->deepest_m[down * m->tiles_across + across] = mask_depth(most);
		deepest[across] = (vi){ 0 };
	}
}

/* What a thread needs for rows of tiles. */
struct bench {
	int32_t *memory, *row[5]; /* merged */
	vi *deepest;
};

static void set_up(struct bench *b, const visibility_mask *m)
{
	b->memory = g_aligned_alloc(5 * (size_t)m->pitch, sizeof(int32_t), 64);
	for (int k = 0; k < 5; k++)
		b->row[k] = b->memory + (size_t)k * m->pitch + MASK_MARGIN;
	b->deepest = g_aligned_alloc0(m->tiles_across, sizeof(vi), 64);
}

static void clear_up(struct bench *b)
{
	g_aligned_free(b->memory);
	g_aligned_free(b->deepest);
}

/* A row of tiles of what was drawn so far. */
INLINE void look_at_tiles(visibility_mask *m, uint32_t down, struct bench *b)
{
	uint32_t end = MIN((down + 1) * MASK_TILE, m->height);
	for (uint32_t y = down * MASK_TILE; y < end; y++) {
		merge_row(m, (int)y, b->row[0]);
		deepen(b->row[0], m->width, b->deepest);
	}
	put_tiles(m, down, b->deepest);
}

/* Together, without holes. */
INLINE void finish_tiles(visibility_mask *m, uint32_t down, struct bench *b)
{
	int from = (int)(down * MASK_TILE), end = (int)MIN((down + 1) * MASK_TILE, m->height);
	for (int k = 0; k < 4; k++)
		merge_row(m, from - 2 + k, b->row[k]);
	for (int y = from; y < end; y++) {
		int32_t *to = m->key + (ptrdiff_t)y * m->pitch, *first = b->row[0];
		merge_row(m, y + 2, b->row[4]);
		fill_row((const int32_t *const *)b->row, to, m->width);
		deepen(to, m->width, b->deepest);
		memmove(b->row, b->row + 1, 4 * sizeof *b->row);
		b->row[4] = first;
	}
	put_tiles(m, down, b->deepest);
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

bool mask_hides(const visibility_mask *m, const struct chunk_view *v, float behind)
{
	uint32_t low[2], high[2];
	if (!tiles_of(m, v, low, high)) /* beside the picture; its strokes may reach into it */
		return false;
	for (uint32_t down = low[1]; down <= high[1]; down++)
		for (uint32_t across = low[0]; across <= high[0]; across++)
			if (m->deepest_m[down * m->tiles_across + across] * (1 + behind) >=
				v->nearest_m)
				return false;
	return true;
}

/* ---- paths ---- */

struct path {
	void (*draw)(const frame *f, const struct target *t, const struct chunk_view *v);
	void (*look)(visibility_mask *m, uint32_t down, struct bench *b);
	void (*finish)(visibility_mask *m, uint32_t down, struct bench *b);
};

#define PATH(name, attributes)                                                                     \
	attributes static void draw_##name(                                                        \
		const frame *f, const struct target *t, const struct chunk_view *v)                \
	{                                                                                          \
		draw_chunk(f, t, v);                                                               \
	}                                                                                          \
	attributes static void look_##name(visibility_mask *m, uint32_t down, struct bench *b)     \
	{                                                                                          \
		look_at_tiles(m, down, b);                                                         \
	}                                                                                          \
	attributes static void finish_##name(visibility_mask *m, uint32_t down, struct bench *b)   \
	{                                                                                          \
		finish_tiles(m, down, b);                                                          \
	}                                                                                          \
	static const struct path path_##name = { draw_##name, look_##name, finish_##name };
PATH(portable, )
#if defined __x86_64__
PATH(avx2, __attribute__((target("avx2"))))
#else
#define path_avx2 path_portable
#endif

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
	bool wide = !f->portable && vectors_have_avx2();
	const struct path *path = wide ? &path_avx2 : &path_portable;
	uint32_t half = nearer_half(views, count), hidden = 0;
#pragma omp parallel num_threads((int)m->threads)
	{
		struct bench b;
		set_up(&b, m);
		/* All pictures, also when there are fewer threads than that. */
#pragma omp for schedule(static)
		for (uint32_t n = 0; n < m->threads; n++)
			clear(m->part[n], keys_of_picture(m));
		int32_t *own = m->part[omp_get_thread_num()];
		struct target t = { first_key(m, own), (int32_t)m->width, (int32_t)m->height,
			(ptrdiff_t)m->pitch };
#pragma omp for schedule(dynamic, 2)
		for (uint32_t n = 0; n < half; n++)
			path->draw(f, &t, &views[n]);
#pragma omp for schedule(static)
		for (uint32_t down = 0; down < m->tiles_down; down++)
			path->look(m, down, &b);
#pragma omp for schedule(dynamic, 2) reduction(+ : hidden)
		for (uint32_t n = half; n < count; n++)
			if (mask_hides(m, &views[n], 0))
				hidden++;
			else
				path->draw(f, &t, &views[n]);
#pragma omp for schedule(static)
		for (uint32_t down = 0; down < m->tiles_down; down++)
			path->finish(m, down, &b);
		clear_up(&b);
	}
	m->chunks_hidden = hidden;
}

visibility_mask *visibility_mask_renew(
	visibility_mask *m, const frame *f, const struct chunk_view *views, uint32_t count)
{
	const struct camera *c = &f->camera;
	int most = f->single_thread ? 1 : omp_get_max_threads();
	uint32_t threads = (uint32_t)CLAMP(most, 1, MASK_THREADS_MOST);
	if (!m || m->width != c->width || m->height != c->height || m->threads != threads) {
		visibility_mask_free(m);
		m = mask_alloc(c, threads);
	}
	draw(m, f, views, count);
	return m;
}

visibility_mask *visibility_mask_new(const frame *f, const struct chunk_view *views, uint32_t count)
{
	return visibility_mask_renew(NULL, f, views, count);
}
