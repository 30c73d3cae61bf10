#ifndef RENDER_PAINT_GAPS_H
#define RENDER_PAINT_GAPS_H
/* Paper that is seen through gaps between strokes of paint: where the layer has surface, and in the row there is paint beside on what is as
 * deep, the gap takes the colour of that. So a few broad strokes cover as well as many. Of eight pixels at a time; the same as
 * shaders/combine.frag.glsl. Internal to draw-lanes.c; all is inlined. */
#include "process/lanes.h"
#include "render/bands.h"

/* So many places are looked at on either side, as far as gaps are wide. */
#define GAP_PLACES 4
/* Where less of the paper is seen there is none; so much paint is as good as all; and what is so much deeper, as a part of the depth, is
 * not the same surface: more than strokes reach over. */
#define GAP_BARE  0.04f
#define GAP_FULL  0.98f
#define GAP_DEPTH 0.05f

struct gap_side {
	vf rgb[3], cover;
};

/* Eight of a row from x on, which has so many; beside it there is what is told. */
INLINE vf gap_load(const float *row, int32_t x, int32_t width, float beside)
{
	vf ret;
	if (x >= 0 && x + LANES <= width)
		return load(row + x);
	for (int k = 0; k < LANES; k++)
		ret[k] = x + k >= 0 && x + k < width ? row[x + k] : beside;
	return ret;
}

/* For those that are open. */
INLINE void gap_look(const struct band_ink *ink, ptrdiff_t row, const float *depths, int32_t x,
	int32_t width, vf depth, vf apart, vi open, struct gap_side *to)
{
	vf there = gap_load(depths, x, width, 0), weight = gap_load(ink->weight + row, x, width, 0);
	vf cover = where(open & (magnitude(there - depth) <= apart) & (weight > 0),
		(1 - to->cover) * (1 - gap_load(ink->bare + row, x, width, 1)));
	if (!any(cover > 0))
		return;
	vf by = cover / choose(weight > 0, weight, all(1));
	for (int k = 0; k < 3; k++)
		to->rgb[k] += by * gap_load(ink->channel[k] + row, x, width, 0);
	to->cover += cover;
}

/* What is below the layer's strokes at x of a row: row is that of its planes, keys of the mask. bare: what of it is seen. */
INLINE void gap_fill(const struct frame_layer *l, const struct band_ink *ink, ptrdiff_t row,
	const int32_t *keys, int32_t x, int32_t width, vf bare, vf under[3])
{
	vi key = *(const vi_loose *)(keys + x);
	vi gap = (key < MASK_EMPTY) & ((key & 255) == l->pipeline) & (bare > GAP_BARE);
	if (!any(gap))
		return;
	struct gap_side left, right;
	for (int k = 0; k < 3; k++)
		left.rgb[k] = right.rgb[k] = all(0);
	left.cover = right.cover = all(0);
	const float *depths = (const float *)(const void *)keys;
	vi open = gap;
	vf apart = (GAP_DEPTH + l->paint->behind - 1) * (vf)key;
	for (int n = 1; n <= GAP_PLACES && any(open); n++) {
		int32_t away = (n * l->paint->gap_px + GAP_PLACES - 1) / GAP_PLACES;
		gap_look(ink, row, depths, x - away, width, (vf)key, apart, open, &left);
		gap_look(ink, row, depths, x + away, width, (vf)key, apart, open, &right);
		open &= left.cover + right.cover < 2 * GAP_FULL;
	}
	vf both = left.cover + right.cover, part = where(gap, least(both, all(1)));
	if (!any(part > 0))
		return;
	for (int k = 0; k < 3; k++) {
		vf paint = (left.rgb[k] + right.rgb[k]) / most(both, all(1e-6f));
		under[k] += part * (paint - under[k]);
	}
}

#endif
