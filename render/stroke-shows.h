#ifndef RENDER_STROKE_SHOWS_H
#define RENDER_STROKE_SHOWS_H
/* How far strokes are to be seen: what the mask hides of them, backs, opacity; and where they are kept. For eight points at a time.
 * Internal to stroke-lanes.c and hatch-lanes.c; all is inlined. */
#include "render/stroke-need.h"

/* What is fainter is not drawn. */
#define ALPHA_LEAST (1 / 255.f)
/* Surface whose back is hidden begins to fade at this cosine. */
#define TURNED_AWAY 0.1f

/* ---- hidden or not ---- */

INLINE vf shows(const struct brush *b, vi key, vf depth_m)
{
	vf mask_m = (vf)(key & ~((1 << MASK_PIPELINE_BITS) - 1));
	vf behind = (depth_m / mask_m - 1) * LENS_STRETCH(&b->lens, depth_m);
	return clamp01(1 - behind * (1 / HIDDEN_BEHIND));
}

/* Of two pixels side by side, between them by u; at whole places, or the nearest that the mask has. */
INLINE vf shows_beside(const struct brush *b, vi column, vf y, vf u, vf depth_m)
{
	const visibility_mask *m = b->mask;
	vi row = __builtin_convertvector(least(most(y, all(0)), all((float)m->height - 1)), vi);
	vi left, right;
	gather_pairs(m->key, row * (int32_t)m->pitch + column, sizeof *m->key, &left, &right);
	return (1 - u) * shows(b, left, depth_m) + u * shows(b, right, depth_m);
}

/* How far it is not hidden in the four pixels around. */
INLINE vf visibility(const struct brush *b, const struct lane_candidates *c)
{
	if (!b->mask)
		return all(1);
	vf x = c->x_px - 0.5f, y = c->y_px - 0.5f, x0 = floor_of(x), y0 = floor_of(y);
	/* Beside the picture both are its last one: there is nothing to read beyond it. */
	float last = (float)b->mask->width - 2;
	vf u = choose(x0 > last, all(last < 0 ? 0 : 1), where(x0 >= 0, x - x0)), v = y - y0;
	vi column = __builtin_convertvector(most(least(x0, all(last)), all(0)), vi);
	return (1 - v) * shows_beside(b, column, y0, u, c->depth_m) +
	       v * shows_beside(b, column, y0 + 1, u, c->depth_m);
}

INLINE bool hides_backs(const struct brush *b)
{
	return frame_pipeline(b->f, b->layer->pipeline)->mask.backs == BACKS_HIDDEN;
}

/* How far it is drawn where backs are hidden: surface that turns away fades, but what has no normal. */
INLINE vf facing(const struct brush *b, const struct lane_candidates *c)
{
	if (!hides_backs(b))
		return all(1);
	float whole = b->layer->hatch ? HATCH_TURNED_AWAY : TURNED_AWAY;
	return choose(has_no_normal(c), all(1), clamp01(along_of(b, c) * (-1 / whole)));
}

/* Of what is drawn whole. */
INLINE vf opacity_of(const struct brush *b, const struct lane_candidates *c)
{
	const struct ink_step *ink = &b->layer->ink;
	vf alpha = visibility(b, c) * facing(b, c) * ink->opacity;
	if (b->f->focus.is_there)
		alpha *= 1 - b->f->focus.amount * c->away;
	if (ink->opacity_variation > 0)
		alpha *= 1 - ink->opacity_variation *
				     lanes_chance(c->id, stroke_salt(c->copy, SALT_OPACITY));
	if (ink->degree > 0)
		alpha *= 1 -
			 ink->degree * (1 - gather_u8(b->f->scene->degree, c->point) * (1 / 255.f));
	for (int k = 0; k < LANES && ink->fade_m > 0; k++)
		alpha[k] *= exp2f((b->lens.begin_m - c->depth_m[k]) / ink->fade_m);
	return alpha;
}

/* ---- candidates ---- */

/* Those of eight that may be drawn, by what is quickly told. */
INLINE unsigned promising(
	const struct brush *b, const struct lane_points *l, const struct lane_candidates *c)
{
	vf nearest_m = nearest_of(b, l->depth_m), octaves = octaves_of(nearest_m);
	vf px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, nearest_m),
	   scale = c->spacing_m * px_per_m;
	/* What moves ahead moves aside too, where it is seen aslant. */
	vf reach = b->layer->ink.length_px / 2 + b->moved_m * b->ray_most * px_per_m;
	vf need = is_on_edge(b)
			  ? scale * (b->ray_most / (b->layer->ink.spacing_px * STROKE_FADE_MEAN))
			  : scale * scale * b->wanted_most;
	vf before = least(b->before_per_m2 * c->spacing_m * c->spacing_m, all(1));
	return bits((l->depth_m > b->lens.near_m) & (l->depth_m <= b->lens.far_m) &
		    (l->x_px >= -reach) & (l->y_px >= -reach) & (l->x_px < b->lens.width + reach) &
		    (l->y_px < b->lens.height + reach) &
		    (before + c->rank * (1 - before) < need * STROKE_FADE_MORE(octaves)));
}

/* The nearest pixels of the mask are far away. */
INLINE void fetch(const struct brush *b, const struct lane_candidates *c)
{
	const visibility_mask *m = b->mask;
	for (unsigned left = m ? c->left : 0; left; left &= left - 1) {
		int k = __builtin_ctz(left);
		int x = CLAMP((int)(c->x_px[k] - 0.5f), 0, (int)m->width - 1),
		    y = CLAMP((int)(c->y_px[k] - 0.5f), 0, (int)m->height - 1);
		const int32_t *at = &m->key[(ptrdiff_t)y * m->pitch + x];
		__builtin_prefetch(at);
		__builtin_prefetch(at + m->pitch);
	}
}

INLINE struct candidate candidate_of(const struct lane_candidates *l, int k)
{
	return (struct candidate){ (uint32_t)l->point[k], l->rank[k], l->spacing_m[k], l->x_px[k],
		l->y_px[k], l->depth_m[k] };
}

/* How much larger their strokes are where points are too few. */
INLINE vf growth_of(const struct brush *b, const struct lane_candidates *c)
{
	vf short_of = c->need / (c->last * copies_of(b, c));
	vf ret = all(1);
	for (unsigned left = bits(short_of > 1) & c->left; left; left &= left - 1) {
		int k = __builtin_ctz(left);
		ret[k] = MIN(stroke_growth(short_of[k]), b->layer->ink.grow);
	}
	return ret;
}

/* A block with room for so many. */
INLINE struct stroke_block *block_of(struct stroke_chain *to, uint32_t strokes)
{
	if (!to->last || to->last->count + strokes > STROKE_BLOCK)
		stroke_chain_grow(to);
	return to->last;
}

#endif
