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

/* Eight pixels in a row; those outside are MASK_EMPTY. */
INLINE vi disc_row(const struct disc *d, float left, float down)
{
	vf dx = left - d->x + lane_number;
	vf across = d->squash[0] * dx + d->squash[1] * down;
	vi inside = dx * dx + down * down + across * across <= d->radius * d->radius;
	vf depth_m = d->depth_m + d->tilt[0] * dx + d->tilt[1] * down;
	vi key = ((vi)depth_m & ~((1 << MASK_PIPELINE_BITS) - 1)) | d->pipeline;
	return (inside & key) | (~inside & MASK_EMPTY);
}

INLINE void draw_disc(const struct target *t, const struct disc *d)
{
	int left = MAX((int)floorf(d->x - d->radius), 1 - LANES),
	    right = MIN((int)floorf(d->x + d->radius), t->width - 1),
	    top = MAX((int)floorf(d->y - d->radius), 0),
	    bottom = MIN((int)floorf(d->y + d->radius), t->height - 1);
	for (int row = top; row <= bottom; row++)
		for (int column = left; column <= right; column += LANES) {
			vi_loose *at = (vi_loose *)(t->key + row * t->pitch + column);
			*at = lower(
				*at, disc_row(d, (float)column + 0.5f, (float)row + 0.5f - d->y));
		}
}

/* ---- points ---- */

INLINE void draw_chunk(const frame *f, const struct target *t, const struct chunk_view *v)
{
	const struct mask_step *step = &frame_pipeline(f, v->pipeline)->mask;
	struct disc_pass p =
		disc_pass_of(f, step->disc, DISC_RADIUS_LEAST, step->backs == BACKS_HIDDEN);
	uint32_t end = disc_prefix(&p, v);
	for (uint32_t i = 0; i < end; i += LANES) {
		struct disc_lanes d = disc_lanes_of(f->scene, &p, v, i, end);
		/* By what the style says, and by the disc's own size, for it is not quite where its neighbours are. */
		vf pushed_m = d.depth_m * (1 + step->offset_relative) + step->offset_m +
			      SLANT * d.radius * d.depth_m * (1 / p.focal_px);
		for (unsigned left = d.drawn; left; left &= left - 1) {
			int k = __builtin_ctz(left);
			struct disc one = { d.x[k], d.y[k], d.radius[k],
				{ d.squash[0][k], d.squash[1][k] }, { d.tilt[0][k], d.tilt[1][k] },
				pushed_m[k], v->pipeline };
			draw_disc(t, &one);
		}
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

/* What lies deeper than its neighbours by more than this factor is seen through a hole between them. */
#define HOLE 1.05f

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
	vi is_hole = (vf)between * HOLE < (vf)own;
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

/* ---- threads ---- */

static void merge_rows(visibility_mask *const *part, int parts, uint32_t from, uint32_t to)
{
	visibility_mask *m = part[0];
	for (int n = 1; n < parts; n++)
		for (uint32_t y = from; y < to; y++) {
			int32_t *a = m->key + (size_t)y * m->pitch;
			const int32_t *b = part[n]->key + (size_t)y * m->pitch;
			for (int x = -MASK_MARGIN; x < (int)m->width + MASK_MARGIN; x++)
				a[x] = MIN(a[x], b[x]);
		}
}

visibility_mask *visibility_mask_new(const frame *f, const struct chunk_view *views, uint32_t count)
{
	bool wide = !f->portable && vectors_have_avx2();
	int threads = f->single_thread ? 1 : omp_get_max_threads();
	g_autofree visibility_mask **part = g_new0(visibility_mask *, threads + 1);
	part[threads] = mask_alloc(&f->camera);
#pragma omp parallel num_threads(threads)
	{
		visibility_mask *own = mask_alloc(&f->camera);
		part[omp_get_thread_num()] = own;
		clear(own);
#pragma omp single nowait
		clear(part[threads]);
		struct target t = { own->key, (int32_t)own->width, (int32_t)own->height,
			(ptrdiff_t)own->pitch };
#pragma omp for schedule(dynamic, 4)
		for (uint32_t n = 0; n < count; n++)
			(wide ? draw_avx2 : draw_portable)(f, &t, &views[n]);
#pragma omp for schedule(static)
		for (uint32_t row = 0; row < own->height; row += 16)
			merge_rows(part, omp_get_num_threads(), row, MIN(row + 16, own->height));
#pragma omp for schedule(static)
		for (int y = 0; y < (int)own->height; y++)
			(wide ? fill_avx2 : fill_portable)(part[0], part[threads], y);
	}
	for (int n = 0; n < threads; n++)
		visibility_mask_free(part[n]);
	return part[threads];
}
