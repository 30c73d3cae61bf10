#include "render/band-draw-lanes.h"
#include "render/band-lay.h"
#include "render/project-lanes.h"
#include <math.h>

/* ---- alpha of eight pixels in a row ---- */

INLINE vf gaussian(const struct pen *p, vf away2)
{
	vf e = 1 - away2 * (p->falloff / 256);
	for (int n = 0; n < 8; n++) /* (1 - x/256)^256 */
		e *= e;
	return e;
}

INLINE vf sprite_alpha(const struct pen *p, vf dx, float dy)
{
	vf away2 = dx * dx + dy * dy;
	return where(away2 <= p->half_length * p->half_length, gaussian(p, away2));
}

INLINE vf line_alpha(const struct pen *p, vf along, vf across)
{
	return clamp01(p->reach_along - magnitude(along)) *
	       clamp01(p->reach_across - magnitude(across));
}

/* ---- eight pixels ---- */

/* 1/depth */
INLINE vf plane_at(const struct pen *p, vf dx, float dy)
{
	return p->q + dx * p->slope[0] + dy * p->slope[1];
}

INLINE vi shows(const struct pen *p, const int32_t *keys, vf q)
{
	return q * (vf) * (const vi_loose *)keys >= p->shows_from;
}

INLINE void blend_at(const struct pen *p, enum band_blend blend, vf alpha,
	const struct band_ink *ink, ptrdiff_t at)
{
	if (blend == BAND_STRONGEST || blend == BAND_COVERING)
		store(ink->bare + at, least(load(ink->bare + at), 1 - alpha));
	else if (blend != BAND_COLOURED)
		store(ink->bare + at, load(ink->bare + at) * (1 - alpha));
	if (blend == BAND_COLOURED)
		for (int k = 0; k < 3; k++)
			store(ink->channel[k] + at,
				load(ink->channel[k] + at) * (1 - alpha * (1 - p->colour[k])));
	if (blend == BAND_PAINTED) {
		for (int k = 0; k < 3; k++)
			store(ink->channel[k] + at,
				load(ink->channel[k] + at) + alpha * p->colour[k]);
		store(ink->weight + at, load(ink->weight + at) + alpha);
	}
}

/* Pixels of row y from left on that are drawn at once, up to stop. */
struct spot {
	int y, left, stop;
};

/* What eight of them are multiplied by the pen's for; ret_q: 1/depth. */
INLINE vf alpha_at(const struct pen *p, enum kernel kernel, const struct spot *at, vf *ret_q)
{
	float dy = (float)at->y + 0.5f - p->y_px, first = (float)at->left + 0.5f - p->x_px;
	vf dx = first + lane_number;
	if (kernel == KERNEL_LINE) { /* as two_of_line() adds it up */
		float along = first * p->cosine + dy * p->sine,
		      across = dy * p->cosine - first * p->sine;
		*ret_q = p->q + first * p->slope[0] + dy * p->slope[1] + lane_number * p->slope[0];
		return line_alpha(
			p, along + lane_number * p->cosine, across - lane_number * p->sine);
	}
	*ret_q = plane_at(p, dx, dy);
	if (kernel == KERNEL_FEW_TEXELS)
		return where(lane_number < (float)(at->stop - at->left),
			eight_few(&p->few, p->texels, p->texel_shift, at->left, at->y));
	return kernel == KERNEL_SPRITE ? sprite_alpha(p, dx, dy) : texture_sum(p, dx, dy);
}

/* Eight of them; keys and at: of the row's first pixel. */
INLINE void draw_eight(const struct pen *p, const struct band_ink *ink, enum kernel kernel,
	enum band_blend blend, const int32_t *keys, ptrdiff_t at, const struct spot *spot)
{
	vf q, alpha = alpha_at(p, kernel, spot, &q) * p->alpha;
	if (keys)
		alpha = where(shows(p, keys + spot->left, q), alpha);
	blend_at(p, blend, alpha, ink, at + spot->left);
}

/* ---- sixteen pixels ---- */

#if defined __AVX512VBMI__

/* draw_eight() of few texels */
INLINE void draw_sixteen(const struct pen *p, const struct band_ink *ink, enum band_blend blend,
	const int32_t *keys, ptrdiff_t at, const struct spot *spot)
{
	__mmask16 drawn =
		(__mmask16)_bzhi_u32(0xffff, (uint32_t)MIN(spot->stop - spot->left, FEW_WIDE));
	wf alpha = wide_few(&p->few, spot->left, spot->y) * p->alpha;
	if (keys) {
		float dy = (float)spot->y + 0.5f - p->y_px;
		wf dx = (float)spot->left + 0.5f - p->x_px + wide_number;
		wf q = p->q + dx * p->slope[0] + dy * p->slope[1];
		wf depth = wide_load((const float *)(keys + spot->left));
		drawn = _mm512_mask_cmp_ps_mask(
			drawn, q * depth, p->shows_from + (wf){ 0 }, _CMP_GE_OQ);
	}
	wide_blend(p, blend, _mm512_maskz_mov_ps(drawn, alpha), ink,
		(ptrdiff_t[]){ at + spot->left, at + spot->left + LANES }, false);
}

#endif

/* ---- columns and rows ---- */

/* Sprites with less than this have eight columns and rows at most. */
#define SPRITE_SMALL 3.4f

/* The Gaussian kernel is that of its columns times that of its rows. */
INLINE void draw_small_sprite(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink, enum band_blend blend)
{
	int left = MAX((int)(p->x_px - p->half_length), 0),
	    top = MAX((int)floorf(p->y_px - p->half_length), (int)b->from),
	    end = MIN((int)(p->y_px + p->half_length) + 1, (int)(b->from + b->rows));
	if (p->x_px + p->half_length < 0 || p->x_px - p->half_length >= (float)b->width)
		return;
	vf dx = (float)left + 0.5f - p->x_px + lane_number,
	   dy = (float)top + 0.5f - p->y_px + lane_number;
	vf dx2 = dx * dx, reach2 = p->half_length * p->half_length - dx2,
	   across = gaussian(p, dx2) * p->alpha;
	float down[LANES], down2[LANES];
	store(down, gaussian(p, dy * dy));
	store(down2, dy * dy);
	ptrdiff_t at = (ptrdiff_t)(top - (int)b->from) * b->pitch + BAND_MARGIN + left;
	for (int k = 0; top + k < end; k++, at += b->pitch) {
		vf alpha = where(reach2 >= down2[k], across * down[k]);
		if (m)
			alpha = where(shows(p, m->key + (ptrdiff_t)(top + k) * m->pitch + left,
					      plane_at(p, dx, (float)(top + k) + 0.5f - p->y_px)),
				alpha);
		blend_at(p, blend, alpha, ink, at);
	}
}

/* Rows of what has fewer pixels side by side are looked through before any of them is drawn: how many vectors a row has is hard to foresee,
 * and what is drawn should not wait for it. */
#define SPOTS_ROW  4
#define SPOTS_MOST (SPOTS_ROW * (BAND_ROWS + 2 * BAND_AROUND) + SPOTS_ROW)

/* So many at once, 2 to this. */
INLINE int spot_bits(enum kernel kernel)
{
#if defined __AVX512VBMI__
	if (kernel == KERNEL_FEW_TEXELS)
		return 4;
#endif
	(void)kernel;
	return 3;
}

/* Where the stroke's rows begin and end, of eight from y on. */
INLINE void find_rows(const struct pen *p, const struct band *b, int y, vi *ret_left, vi *ret_right)
{
	vf dy = (float)y + 0.5f - p->middle_y + lane_number;
	vf low = most(dy * p->turn[0] - p->reach[0], dy * p->turn[1] - p->reach[1]),
	   high = least(dy * p->turn[0] + p->reach[0], dy * p->turn[1] + p->reach[1]);
	*ret_left = pixels_from(p->middle_x + low, (int32_t)b->width);
	*ret_right = pixels_from(p->middle_x + high, (int32_t)b->width);
}

/* Rows have so many vectors at most. */
INLINE uint32_t find_spots(
	const struct pen *p, const struct band *b, int shift, int vectors, struct spot *ret)
{
	uint32_t count = 0;
	for (int y = p->top; y < p->end; y += LANES) {
		vi first, stop;
		find_rows(p, b, y, &first, &stop);
		int32_t left[LANES], right[LANES], vector[LANES];
		store_mask(left, first);
		store_mask(right, stop);
		store_mask(vector, (stop - first + (1 << shift) - 1) >> shift);
		for (int k = 0; k < MIN(LANES, p->end - y); k++) {
			for (int n = 0; n < vectors; n++)
				ret[count + (uint32_t)n] =
					(struct spot){ y + k, left[k] + (n << shift), right[k] };
			count += (uint32_t)CLAMP(vector[k], 0, vectors);
		}
	}
	return count;
}

INLINE void draw_spot(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink, enum kernel kernel, enum band_blend blend,
	const struct spot *at)
{
	ptrdiff_t row = (ptrdiff_t)(at->y - (int)b->from) * b->pitch + BAND_MARGIN;
	const int32_t *keys = m ? m->key + (ptrdiff_t)at->y * m->pitch : NULL;
#if defined __AVX512VBMI__
	if (kernel == KERNEL_FEW_TEXELS) {
		draw_sixteen(p, ink, blend, keys, row, at);
		return;
	}
#endif
	if (blend == BAND_LAID)
		lay_eight(p, ink, m, row, at->y, (float)at->y + 0.5f - p->y_px, at->left);
	else
		draw_eight(p, ink, kernel, blend, keys, row, at);
}

INLINE void draw_wide_rows(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink, enum kernel kernel, enum band_blend blend)
{
	for (int y = p->top; y < p->end; y += LANES) {
		vi first, stop;
		find_rows(p, b, y, &first, &stop);
		for (int k = 0; k < MIN(LANES, p->end - y); k++)
			for (int left = first[k]; left < stop[k]; left += 1 << spot_bits(kernel))
				draw_spot(p, b, m, ink, kernel, blend,
					&(struct spot){ y + k, left, stop[k] });
	}
}

/* Of a line whose rows have eight pixels at most. There may be none in the first and last rows, nor in the one behind them: then nothing is
 * drawn there. */
INLINE void draw_short_rows(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink, enum band_blend blend)
{
	for (int y = p->top; y < p->end; y += LANES) {
		vi first, stop;
		int k = 0, rows = MIN(LANES, p->end - y);
		struct short_rows r = { .y = y };
		find_rows(p, b, y, &first, &stop);
		store_mask(r.left, first);
#if defined __AVX512VBMI__
		vf dx = __builtin_convertvector(first, vf) + 0.5f - p->x_px,
		   dy = (float)y + lane_number + 0.5f - p->y_px;
		r.along = dx * p->cosine + dy * p->sine;
		r.across = dy * p->cosine - dx * p->sine;
		r.q = p->q + dx * p->slope[0] + dy * p->slope[1];
		for (; k < rows && y + k + 1 < (int)(b->from + b->rows); k += 2)
			two_of_line(p, b, m, ink, blend, &r, k);
#endif
		for (; k < rows; k++)
			draw_spot(p, b, m, ink, KERNEL_LINE, blend,
				&(struct spot){ y + k, r.left[k], stop[k] });
	}
}

#if defined __AVX512VBMI__

/* Of a row, SPOTS_ROW. */
_Static_assert(SPOTS_ROW == 4, "one vector of them");
typedef int32_t four_loose __attribute__((vector_size(16), aligned(4), may_alias));

/* So many of a row, SPOTS_ROW at most. */
INLINE void put_eights(struct eights *e, int y, int32_t left, int count, const struct pen *p,
	const struct band *b, const visibility_mask *m, const struct band_ink *ink)
{
	*(four_loose *)(e->y + e->count) = y + (four_loose){ 0 };
	*(four_loose *)(e->left + e->count) = left + (four_loose){ 0, LANES, 2 * LANES, 3 * LANES };
	e->count += (uint32_t)count & ~1u;
	e->odd_y[e->odd] = y;
	e->odd_left[e->odd] = left + LANES * (count & ~1);
	e->odd += (uint32_t)count & 1;
	if (e->count + e->odd > EIGHTS_ROOM - SPOTS_ROW - 1)
		lay_eights(p, b, m, ink, e);
}

/* A stroke of paint. */
INLINE void lay_stroke(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink)
{
	struct eights e;
	int most = (p->across + LANES - 1) / LANES;
	e.count = e.odd = 0;
	for (int y = p->top; y < p->end; y += LANES) {
		vi first, stop;
		int32_t left[LANES], vectors[LANES];
		find_rows(p, b, y, &first, &stop);
		store_mask(left, first);
		store_mask(vectors, (stop - first + LANES - 1) >> 3);
		for (int k = 0; k < MIN(LANES, p->end - y); k++) {
			int count = CLAMP(vectors[k], 0, most), n = 0;
			for (; count > SPOTS_ROW; count -= SPOTS_ROW, n += SPOTS_ROW)
				put_eights(&e, y + k, left[k] + LANES * n, SPOTS_ROW, p, b, m, ink);
			put_eights(&e, y + k, left[k] + LANES * n, count, p, b, m, ink);
		}
	}
	lay_eights(p, b, m, ink, &e);
}

#endif

INLINE void draw_stroke(const struct pen *p, const struct band *b, const visibility_mask *m,
	const struct band_ink *ink, enum kernel kernel, enum band_blend blend)
{
	if (kernel == KERNEL_SPRITE && p->half_length < SPRITE_SMALL) {
		draw_small_sprite(p, b, m, ink, blend);
		return;
	}
#if defined __AVX512VBMI__
	if (blend == BAND_LAID) {
		lay_stroke(p, b, m, ink);
		return;
	}
#endif
	int vectors = (p->across + (1 << spot_bits(kernel)) - 1) >> spot_bits(kernel);
	if (kernel == KERNEL_LINE && vectors == 1) {
		draw_short_rows(p, b, m, ink, blend);
		return;
	}
	if (vectors > SPOTS_ROW) {
		draw_wide_rows(p, b, m, ink, kernel, blend);
		return;
	}
	struct spot spot[SPOTS_MOST];
	uint32_t count = find_spots(p, b, spot_bits(kernel), vectors, spot);
	for (uint32_t n = 0; n < count; n++)
		draw_spot(p, b, m, ink, kernel, blend, &spot[n]);
}

INLINE void draw_all(const struct band *b, const struct frame_layer *l,
	const struct band_strokes *strokes, const visibility_mask *m, const struct band_ink *ink,
	enum kernel kernel, enum band_blend blend)
{
	for (uint32_t n = 0; n < strokes->count; n += LANES) {
		struct pens all;
		for (uint32_t k = 0; k < LANES; k++) {
			/* They lie about in memory: the next ones are fetched. */
			__builtin_prefetch(
				band_stroke(strokes, MIN(n + LANES + k, strokes->count - 1)));
			all.from[k] = band_stroke(strokes, MIN(n + k, strokes->count - 1));
		}
		find_pens(b, l, kernel, &all);
		for (uint32_t k = 0; k < MIN(LANES, strokes->count - n); k++) {
			struct pen p = pen_of(l, &all, (int)k, kernel);
			if (blend == BAND_LAID && p.top < p.end) {
				float aside = fabsf(p.cosine) * p.reach_along +
					      fabsf(p.sine) * p.reach_across + 1;
				band_parts_add(ink->laid, p.middle_x - aside, p.middle_x + aside,
					b->width);
			}
			draw_stroke(&p, b, m, ink, kernel, blend);
		}
	}
}

/* ---- which of them ---- */

/* So that each kernel and way of blending has loops of its own. */
#define WITH_BLEND(kernel)                                                                         \
	switch (blend) {                                                                           \
	case BAND_INKED: draw_all(b, l, strokes, m, ink, kernel, BAND_INKED); break;               \
	case BAND_COLOURED: draw_all(b, l, strokes, m, ink, kernel, BAND_COLOURED); break;         \
	case BAND_PAINTED: draw_all(b, l, strokes, m, ink, kernel, BAND_PAINTED); break;           \
	case BAND_STRONGEST:                                                                       \
	case BAND_COVERING: draw_all(b, l, strokes, m, ink, kernel, BAND_STRONGEST); break;        \
	case BAND_LAID: break; /* has a texture */                                                 \
	}

void LANES_NAME(band_draw)(const struct band *b, const struct frame_layer *l,
	const struct band_strokes *strokes, const visibility_mask *m, const struct band_ink *ink,
	enum kernel kernel, enum band_blend blend)
{
	switch (kernel) {
	case KERNEL_SPRITE: WITH_BLEND(KERNEL_SPRITE); break;
	case KERNEL_LINE: WITH_BLEND(KERNEL_LINE); break;
	case KERNEL_TEXTURE:
		if (blend == BAND_LAID) {
			draw_all(b, l, strokes, m, ink, KERNEL_TEXTURE, BAND_LAID);
			break;
		}
		if (l->few_texels) {
			WITH_BLEND(KERNEL_FEW_TEXELS);
			break;
		}
		WITH_BLEND(KERNEL_TEXTURE);
	}
}
