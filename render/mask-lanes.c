#define LANES_MAY_BE_WIDE
#include "render/mask-lanes.h"
#include "render/disc-lanes.h"
#include <math.h>
#include <string.h>

/* Of a disc's radius. */
#define SLANT 1.f

/* ---- discs ---- */

/* Eight discs. Where c is a column and r a row from the first pixel of its box on, a pixel is inside where
 * away + (along + flat c) c + (step + cross c) r + steep r (r - 1) <= 0, and depth_m + tilt . (c, r) deep there. */
struct discs {
	vf away, along, flat, step, cross, steep2, depth_m, tilt[2];
	vi at, columns, rows;
};

INLINE void find_discs(
	const struct mask_target *t, const struct disc_lanes *d, vf pushed_m, struct discs *ret)
{
	vi left = pixels_from(d->x - d->half[0], t->width),
	   top = pixels_from(d->y - d->half[1], t->height);
	vf x = __builtin_convertvector(left, vf) + 0.5f - d->x,
	   y = __builtin_convertvector(top, vf) + 0.5f - d->y;
	/* Squares and products of the normal on the screen. */
	vf flat = 1 + d->bend * d->aside[0] * d->aside[0],
	   steep = 1 + d->bend * d->aside[1] * d->aside[1],
	   cross = 2 * (d->bend * d->aside[0] * d->aside[1]);
	ret->flat = flat;
	ret->cross = cross;
	ret->steep2 = 2 * steep;
	ret->away = flat * x * x + cross * x * y + steep * y * y - d->radius * d->radius;
	ret->along = 2 * flat * x + cross * y;
	ret->step = cross * x + steep * (2 * y + 1);
	for (int k = 0; k < 2; k++)
		ret->tilt[k] = d->slope * d->aside[k];
	ret->depth_m = pushed_m + ret->tilt[0] * x + ret->tilt[1] * y;
	ret->at = top * (int32_t)t->pitch + left;
	ret->columns = pixels_from(d->x + d->half[0], t->width) - left;
	ret->rows = pixels_from(d->y + d->half[1], t->height) - top;
}

INLINE vi keys_of(vf depth_m, int32_t pipeline)
{
	return ((vi)depth_m & ~((1 << MASK_PIPELINE_BITS) - 1)) | pipeline;
}

/* Few discs are wider: so many columns are drawn at once, however many lanes there are. */
#define COLUMNS 8
typedef float cf __attribute__((vector_size(4 * COLUMNS)));
typedef int32_t ci __attribute__((vector_size(4 * COLUMNS)));
typedef int32_t ci_loose __attribute__((vector_size(4 * COLUMNS), aligned(4), may_alias));
static const cf column_number = { 0, 1, 2, 3, 4, 5, 6, 7 };

INLINE ci lower_columns(ci a, ci b)
{
	ci ret;
	for (int k = 0; k < COLUMNS; k++)
		ret[k] = (int32_t)MIN((uint32_t)a[k], (uint32_t)b[k]);
	return ret;
}

/* Columns of one disc, from column on, and so many rows; what is outside has the highest key. */
INLINE void draw_columns(const struct mask_target *t, const struct discs *d, int k, int column,
	int rows, int32_t pipeline)
{
	cf c = (float)column + column_number;
	cf away = d->away[k] + (d->along[k] + d->flat[k] * c) * c,
	   step = d->step[k] + d->cross[k] * c, depth_m = d->depth_m[k] + d->tilt[0][k] * c;
	int32_t *at = t->key + d->at[k] + column;
	for (; rows > 0; rows--, at += t->pitch) {
		ci key = ((ci)depth_m & ~((1 << MASK_PIPELINE_BITS) - 1)) | pipeline | (away > 0);
		*(ci_loose *)at = lower_columns(*(const ci_loose *)at, key);
		depth_m += d->tilt[1][k];
		away += step;
		step += d->steep2[k];
	}
}

/* ---- points ---- */

/* How far the mask lies behind them: by what the style says, and by the disc's own size, for it is not quite where its neighbours are. */
INLINE vf push(const struct mask_step *s, const struct lens *l, const struct disc_lanes *d)
{
	return d->depth_m * (1 + s->offset_relative) + s->offset_m +
	       SLANT * d->radius * LENS_SCALE_M(l, d->depth_m) * (1 / l->focal_px);
}

/* Points that wait, some at a time, for what is next done to them, side by side: few of a vector are wide, and how many rows these have is
 * hard to foresee, so that nothing which takes long should wait for it. */
#define SHEET (256 / LANES)
enum { LOW, MIDDLE, HIGH, SIZES };
/* Those of few rows are drawn as if they had a few more. */
#define ROWS_LOW    2
#define ROWS_MIDDLE 4

struct sheet {
	/* Of dots the pixel and its key; some more are written than dots, as in the other lists. */
	int32_t dot_at[SHEET * LANES + LANES], dot_key[SHEET * LANES + LANES];
	uint32_t dots;
	/* Wider ones, before they are tilted. */
	float x[SHEET * LANES + LANES], y[SHEET * LANES + LANES], depth_m[SHEET * LANES + LANES],
		radius[SHEET * LANES + LANES];
	int32_t normal[SHEET * LANES + LANES];
	uint32_t wide;
	struct discs discs[SHEET];
	/* Of each size: places in the sheet. */
	uint16_t place[SIZES][SHEET * LANES + LANES];
	uint32_t count[SIZES];
};

INLINE void put_dots(const struct mask_target *t, const struct disc_lanes *d, vf pushed_m,
	int32_t pipeline, struct sheet *to)
{
	vi inside =
		(d->x >= 0) & (d->y >= 0) & (d->x < (float)t->width) & (d->y < (float)t->height);
	vi column = __builtin_convertvector(where(inside, d->x), vi),
	   row = __builtin_convertvector(where(inside, d->y), vi);
	vf depth_m = pushed_m +
		     d->slope * d->aside[0] * (__builtin_convertvector(column, vf) + 0.5f - d->x) +
		     d->slope * d->aside[1] * (__builtin_convertvector(row, vf) + 0.5f - d->y);
	unsigned which = bits(d->drawn & inside);
	vi order = order_of(which), at = row * (int32_t)t->pitch + column,
	   key = keys_of(depth_m, pipeline);
	store_mask(to->dot_at + to->dots, (vi)put_in_order((vf)at, order));
	store_mask(to->dot_key + to->dots, (vi)put_in_order((vf)key, order));
	to->dots += (uint32_t)__builtin_popcount(which);
}

INLINE void put_wide(const struct disc_lanes *d, vi wide, vi normal, struct sheet *to)
{
	unsigned which = bits(wide);
	vi order = order_of(which);
	store(to->x + to->wide, put_in_order(d->x, order));
	store(to->y + to->wide, put_in_order(d->y, order));
	store(to->depth_m + to->wide, put_in_order(d->depth_m, order));
	store(to->radius + to->wide, put_in_order(d->radius, order));
	store_mask(to->normal + to->wide, (vi)put_in_order((vf)normal, order));
	to->wide += (uint32_t)__builtin_popcount(which);
}

INLINE void lay_out(const struct mask_step *step, const scene *s, const struct mask_target *t,
	const struct chunk_view *v, const struct disc_pass *p, uint32_t i, struct sheet *to)
{
	struct disc_lanes d;
	if (!disc_lanes_place(s, p, v, i, &d))
		return;
	vi normal = disc_normals(s, v, i), dots = d.drawn & (d.radius < MASK_DOT_RADIUS);
	/* Also where there is none: whether there is one is hard to foresee. */
	put_wide(&d, d.drawn & ~dots, normal, to);
	if (!any(dots))
		return;
	d.drawn = dots;
	tilt_lanes(p, normal, MASK_DOT_RADIUS, &d);
	put_dots(t, &d, push(step, &p->lens, &d), v->pipeline, to);
}

/* Of each set of four lanes the members, in front. */
typedef uint16_t four __attribute__((vector_size(8)));
static const four members[16] = { { 0 }, { 0 }, { 1 }, { 0, 1 }, { 2 }, { 0, 2 }, { 1, 2 },
	{ 0, 1, 2 }, { 3 }, { 0, 3 }, { 1, 3 }, { 0, 1, 3 }, { 2, 3 }, { 0, 2, 3 }, { 1, 2, 3 },
	{ 0, 1, 2, 3 } };

/* Those of the vector n that are of this size. */
INLINE void sort_in(struct sheet *to, uint32_t n, int size, vi are)
{
	unsigned which = bits(are);
	for (uint32_t k = 0; k < LANES; k += 4, which >>= 4) {
		four places = members[which & 15] + (uint16_t)(n * LANES + k);
		memcpy(&to->place[size][to->count[size]], &places, sizeof places);
		to->count[size] += (uint32_t)__builtin_popcount(which & 15);
	}
}

/* Wide ones of the vector n. */
INLINE void lay_out_wide(const struct mask_step *step, const struct mask_target *t,
	const struct disc_pass *p, uint32_t n, struct sheet *to)
{
	uint32_t at = n * LANES;
	struct disc_lanes d = { .x = load(to->x + at),
		.y = load(to->y + at),
		.depth_m = load(to->depth_m + at),
		.radius = load(to->radius + at),
		.drawn = lane_number < (float)(to->wide - at) };
	tilt_lanes(p, load_mask(to->normal + at), MASK_DOT_RADIUS, &d);
	struct discs *w = &to->discs[n];
	find_discs(t, &d, push(step, &p->lens, &d), w);
	vi wide = d.drawn & (w->columns > 0) & (w->rows > 0);
	vi narrow = w->columns <= COLUMNS;
	vi low = narrow & (w->rows <= ROWS_LOW), middle = narrow & (w->rows <= ROWS_MIDDLE);
	sort_in(to, n, LOW, wide & low);
	sort_in(to, n, MIDDLE, wide & middle & ~low);
	sort_in(to, n, HIGH, wide & ~middle);
}

INLINE void draw_size(
	const struct mask_target *t, const struct sheet *s, int size, int rows, int32_t pipeline)
{
	for (uint32_t i = 0; i < s->count[size]; i++) {
		const struct discs *d = &s->discs[s->place[size][i] / LANES];
		int k = s->place[size][i] % LANES;
		if (rows)
			draw_columns(t, d, k, 0, rows, pipeline);
		else
			for (int column = 0; column < d->columns[k]; column += COLUMNS)
				draw_columns(t, d, k, column, d->rows[k], pipeline);
	}
}

INLINE void draw_dots(const struct mask_target *t, struct sheet *s)
{
	for (uint32_t i = 0; i < s->dots; i++) {
		int32_t *at = t->key + s->dot_at[i];
		*at = MIN(*at, s->dot_key[i]);
	}
	s->dots = 0;
}

INLINE void draw_wide(const struct mask_step *step, const struct mask_target *t,
	const struct disc_pass *p, int32_t pipeline, struct sheet *s)
{
	memset(s->count, 0, sizeof s->count);
	for (uint32_t n = 0; n * LANES < s->wide; n++)
		lay_out_wide(step, t, p, n, s);
	s->wide = 0;
	draw_size(t, s, LOW, ROWS_LOW, pipeline);
	draw_size(t, s, MIDDLE, ROWS_MIDDLE, pipeline);
	draw_size(t, s, HIGH, 0, pipeline);
}

void LANES_NAME(mask_draw)(const frame *f, const struct mask_target *t, const struct chunk_view *v)
{
	const struct mask_step *step = &frame_pipeline(f, v->pipeline)->mask;
	struct disc_pass p = disc_pass_of(f, v, step->disc, DISC_RADIUS_LEAST);
	struct sheet sheet;
	sheet.dots = sheet.wide = 0;
	for (uint32_t i = 0; i < p.end; i += LANES) {
		bool is_last = i + LANES >= p.end;
		lay_out(step, f->scene, t, v, &p, i, &sheet);
		if (sheet.dots > (SHEET - 1) * LANES || is_last)
			draw_dots(t, &sheet);
		if (sheet.wide > (SHEET - 1) * LANES || is_last)
			draw_wide(step, t, &p, v->pipeline, &sheet);
	}
}
