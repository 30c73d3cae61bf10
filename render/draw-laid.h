#ifndef RENDER_DRAW_LAID_H
#define RENDER_DRAW_LAID_H
/* Paint of a layer in a band, on what is below: which parts of its width have any, how thick it is, the light on it, and gaps between its
 * strokes. Internal to draw-lanes.c; all is inlined. */
#include "render/draw-lanes.h"
#include "render/paint-gaps.h"
#include "render/project-lanes.h"

/* Ink lies thicker on what stands up, as much thicker as it lies thinner in the hollows. */
INLINE vf on_relief(vf bare, vf relief, float tooth)
{
	vf cover = 1 - bare;
	return 1 - clamp01(cover * (1 + 4 * tooth * relief * bare));
}

/* Rows of strokes of paint: more than those of the band, where there are any. */
INLINE struct band laid_band(const struct band *b, uint32_t height)
{
	struct band e = *b;
	e.from = b->from ? b->from - BAND_AROUND : 0;
	e.rows = MIN(b->from + b->rows + BAND_AROUND, height) - e.from;
	return e;
}

/* ---- where there is any ---- */

/* Columns that vectors fit into. */
struct laid_run {
	int32_t from, end;
};

/* As wide as vectors are, at least. */
INLINE struct band_parts no_parts(const struct band *b, const struct frame_layer *l)
{
	struct band_parts p = { .shift = 4, .beside_px = l->paint->gap_px };
	while (b->width >> p.shift >= BAND_PARTS)
		p.shift++;
	return p;
}

/* Takes the next parts side by side off; false: there are no more. */
INLINE bool next_run(struct band_parts *p, const struct band *b, struct laid_run *ret)
{
	if (!p->in)
		return false;
	uint32_t first = (uint32_t)__builtin_ctzll(p->in);
	uint64_t other = ~(p->in >> first);
	uint32_t end = first + (other ? (uint32_t)__builtin_ctzll(other) : BAND_PARTS);
	p->in = end < BAND_PARTS ? p->in >> end << end : 0;
	*ret = (struct laid_run){ (int32_t)(first << p->shift),
		(int32_t)MIN(end << p->shift, b->width) };
	return true;
}

/* Nothing, all bare, as planes are between layers of paint. */
INLINE void clear_laid(const struct band *e, const struct band_ink *ink, struct laid_run run)
{
	float *sum[] = { ink->channel[0], ink->channel[1], ink->channel[2], ink->weight,
		ink->height };
	/* Vectors reach over the picture's edge. */
	int32_t end = run.end == (int32_t)e->width ? run.end + BAND_MARGIN : run.end;
	for (uint32_t y = e->from; y < e->from + e->rows; y++) {
		size_t bytes = (size_t)(end - run.from) * sizeof(float);
		for (size_t n = 0; n < G_N_ELEMENTS(sum); n++)
			memset(band_row(e, sum[n], y) + run.from, 0, bytes);
		float *bare = band_row(e, ink->bare, y);
		for (int32_t x = run.from; x < end; x += LANES)
			store(bare + x, all(1));
	}
}

/* ---- light ---- */

/* How thick paint lies in the mean, instead of its sum; beside the picture there is none. */
INLINE void find_thickness(const struct band *e, const struct band_ink *ink, struct laid_run run)
{
	for (uint32_t y = e->from; y < e->from + e->rows; y++) {
		float *height = band_row(e, ink->height, y);
		const float *weight = band_row(e, ink->weight, y),
			    *bare = band_row(e, ink->bare, y);
		for (int32_t x = run.from; x < run.end; x += LANES) {
			vf by = load(weight + x);
			store(height + x,
				where(by > 0, load(height + x) / by * (1 - load(bare + x))));
		}
		height[e->width] = 0;
	}
}

/* x^16 */
INLINE vf glint(vf x)
{
	x *= x;
	x *= x;
	x *= x;
	return x * x;
}

/* Of eight pixels; above and below: rows. What light does to paint: a factor, and what is added. */
INLINE void light_paint(const struct frame_layer *l, const float light[3], float px,
	const struct band_ink *ink, ptrdiff_t at, ptrdiff_t above, ptrdiff_t below, vf ret[2])
{
	const struct paint_step *step = &l->paint->step;
	float steep = 0.5f * step->thickness_px * px;
	vf n[2] = { steep * (load(ink->height + at - 1) - load(ink->height + at + 1)),
		steep * (load(ink->height + above) - load(ink->height + below)) };
	vf unit = 1 / root(n[0] * n[0] + n[1] * n[1] + 1);
	vf facing = (n[0] * light[0] + n[1] * light[1] + light[2]) * unit;
	ret[0] = 1 + PAINT_SHADE * (facing - light[2]);
	ret[1] = step->shine * glint(most(2 * facing * unit - light[2], all(0)));
}

/* ---- on what is below ---- */

INLINE void add_laid_row(const struct draw_job *j, const struct frame_layer *l,
	const struct band *b, const struct band *e, struct draw_desk *d, uint32_t y,
	struct laid_run run)
{
	const struct band_ink *ink = &d->ink;
	const int32_t *keys = j->mask->key + (size_t)y * j->mask->pitch;
	float light[3];
	frame_paint_light(j->f, light);
	uint32_t end = e->from + e->rows - 1;
	ptrdiff_t row = band_row(e, ink->weight, y) - ink->weight,
		  above = band_row(e, ink->weight, y > e->from ? y - 1 : y) - ink->weight,
		  below = band_row(e, ink->weight, MIN(y + 1, end)) - ink->weight,
		  out = band_row(b, d->relief, y) - d->relief;
	for (int32_t x = run.from; x < run.end; x += LANES) {
		vf weight = load(ink->weight + row + x), by[2], under[3];
		vf seen = load(ink->bare + row + x);
		for (int k = 0; k < 3; k++)
			under[k] = load(d->canvas[k] + out + x);
		if (l->paint->gap_px)
			gap_fill(l, ink, row, keys, x, (int32_t)b->width, seen, under);
		if (!any(weight > 0)) {
			for (int k = 0; k < 3; k++)
				store(d->canvas[k] + out + x, under[k]);
			continue;
		}
		light_paint(l, light, j->f->px, ink, row + x, above + x, below + x, by);
		vf bare = on_relief(seen, load(d->relief + out + x), l->ink.tooth);
		for (int k = 0; k < 3; k++) {
			vf paint = load(ink->channel[k] + row + x) / weight * by[0] + by[1];
			store(d->canvas[k] + out + x,
				choose(weight > 0, under[k] * bare + (1 - bare) * paint, under[k]));
		}
	}
}

/* In e there are its strokes (laid_band); clears them. */
INLINE void add_laid(const struct draw_job *j, const struct frame_layer *l, const struct band *b,
	const struct band *e, struct draw_desk *d)
{
	struct laid_run run;
	for (struct band_parts left = *d->ink.laid; next_run(&left, e, &run);)
		find_thickness(e, &d->ink, run);
	for (struct band_parts left = *d->ink.laid; next_run(&left, e, &run);)
		for (uint32_t y = b->from; y < b->from + b->rows; y++)
			add_laid_row(j, l, b, e, d, y, run);
	for (struct band_parts left = *d->ink.laid; next_run(&left, e, &run);)
		clear_laid(e, &d->ink, run);
}

#endif
