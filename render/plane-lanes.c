#include "render/plane-lanes.h"
#include "process/lanes.h"
#include "render/disc-lanes.h"
#include "render/light.h"
#include <math.h>

/* What tells how deep a row of pixels is. */
struct plane_row {
	const struct plane_view *v;
	struct lens lens;
	float per_px, down;
};

INLINE struct plane_row row_of(const plane_views *p, const struct plane_view *v, int32_t row)
{
	float per_px = 1 / p->lens.focal_px;
	return (struct plane_row){ v, p->lens, per_px,
		((float)row + 0.5f - p->lens.middle_y) * per_px };
}

INLINE vf right_of(const struct plane_row *r, int32_t column)
{
	return ((float)column + 0.5f + lane_number - r->lens.middle_x) * r->per_px;
}

/* *ret_steep: by how much more depth grows than what one goes off the plane. */
INLINE vf depth_of(const struct plane_row *r, vf right, vf *ret_steep)
{
	vf slant = r->v->normal[0] * right + r->v->normal[1] * r->down;
	vf straight = r->lens.fan * slant + r->v->normal[2];
	*ret_steep = 1 / magnitude(straight);
	return (r->v->along - r->lens.parallel_m * slant) / straight;
}

/* ---- the mask ---- */

INLINE void mask_span(const struct mask_target *t, const struct plane_row *r,
	const struct mask_step *step, const struct plane_span *s)
{
	for (int32_t x = s->from; x < s->end; x += LANES) {
		vf steep, depth_m = depth_of(r, right_of(r, x), &steep);
		vf back_m = least(r->v->back_m * steep, PLANE_BACK_MOST * depth_m);
		depth_m = (depth_m + back_m) * (1 + step->offset_relative) + step->offset_m;
		vi key = ((vi)depth_m & ~((1 << MASK_PIPELINE_BITS) - 1)) | r->v->pipeline;
		vi beyond = lane_number >= (float)(s->end - x);
		int32_t *at = t->key + (ptrdiff_t)s->row * t->pitch + x;
		store_mask(at, lower_unsigned(load_mask(at), key | beyond));
	}
}

void LANES_NAME(plane_mask)(
	const frame *f, const struct mask_target *t, const plane_views *p, uint32_t view)
{
	const struct plane_view *v = &p->view[view];
	const struct mask_step *step = &frame_pipeline(f, v->pipeline)->mask;
	const struct plane_span *s = p->span + v->first_span;
	for (int32_t y = v->top; y < v->bottom; y++) {
		struct plane_row r = row_of(p, v, y);
		for (uint32_t n = v->row[y - v->top]; n < v->row[y - v->top + 1]; n++)
			mask_span(t, &r, step, &s[n]);
	}
}

/* ---- colours ---- */

INLINE void add_texel(const struct scene_plane_level *l, const uint8_t (*texel)[4], int x, int y,
	float part, const float *linear, float ret[3])
{
	x = MIN(MAX(x, 0), (int)l->width - 1);
	y = MIN(MAX(y, 0), (int)l->height - 1);
	const uint8_t *at = texel[l->first + (uint32_t)y * l->width + (uint32_t)x];
	for (int k = 0; k < 3; k++)
		ret[k] += part * linear[at[k]];
}

/* u and v in texels of level 0. */
INLINE void add_level(const struct scene_plane *p, uint32_t level, const uint8_t (*texel)[4],
	float u, float v, float part, const float *linear, float ret[3])
{
	const struct scene_plane_level *l = &p->level[level];
	float smaller = 1.f / (float)(1u << level);
	float x = u * smaller - 0.5f, y = v * smaller - 0.5f, left = floorf(x), low = floorf(y);
	float right = x - left, up = y - low;
	add_texel(l, texel, (int)left, (int)low, part * (1 - right) * (1 - up), linear, ret);
	add_texel(l, texel, (int)left + 1, (int)low, part * right * (1 - up), linear, ret);
	add_texel(l, texel, (int)left, (int)low + 1, part * (1 - right) * up, linear, ret);
	add_texel(l, texel, (int)left + 1, (int)low + 1, part * right * up, linear, ret);
}

/* size: of a pixel there, in texels. */
INLINE void find_light(const struct plane_view *p, const uint8_t (*texel)[4], float u, float v,
	float size, const float *linear, float ret[3])
{
	float level = fminf(fmaxf(log2f(size), 0), (float)(p->plane->levels - 1));
	uint32_t below = (uint32_t)level;
	float part = level - (float)below;
	ret[0] = ret[1] = ret[2] = 0;
	add_level(p->plane, below, texel, u, v, p->lit * (1 - part), linear, ret);
	if (part > 0)
		add_level(p->plane, below + 1, texel, u, v, p->lit * part, linear, ret);
}

/* Which of eight pixels the mask has of it. */
INLINE vi shown(const visibility_mask *m, const struct plane_view *v, const struct plane_span *s,
	int32_t x, vf depth_m)
{
	vi key = *(const vi_loose *)(m->key + (ptrdiff_t)s->row * m->pitch + x);
	return disc_one_shows(key, v->pipeline, depth_m) & (lane_number < (float)(s->end - x));
}

/* Between what it is across and along where it is met aslant. */
INLINE vf size_of(const struct plane_row *r, vf depth_m, vf steep, vf right)
{
	vf ray2 = r->lens.fan * (right * right + r->down * r->down) + 1;
	return LENS_SCALE_M(&r->lens, depth_m) * r->per_px * root(root(ray2) * steep) *
	       (1 / r->v->plane->region->texel_m);
}

INLINE void light_span(const struct band *b, const visibility_mask *m, const struct plane_row *r,
	const struct plane_span *s, const uint8_t (*texel)[4], float *const light[3], float *weight)
{
	const float *linear = light_of_bytes();
	const struct plane_view *v = r->v;
	for (int32_t x = s->from; x < s->end; x += LANES) {
		vf right = right_of(r, x), steep, depth_m = depth_of(r, right, &steep);
		vi is_there = shown(m, v, s, x, depth_m);
		if (!any(is_there))
			continue;
		vf scale_m = LENS_SCALE_M(&r->lens, depth_m),
		   size = size_of(r, depth_m, steep, right);
		vf at_x = right * scale_m, at_y = r->down * scale_m;
		vf tu = v->u[0] * at_x + v->u[1] * at_y + v->u[2] * depth_m + v->u[3],
		   tv = v->v[0] * at_x + v->v[1] * at_y + v->v[2] * depth_m + v->v[3];
		size_t at =
			(size_t)(s->row - (int32_t)b->from) * b->pitch + BAND_MARGIN + (size_t)x;
		for (unsigned left = bits(is_there); left; left &= left - 1) {
			int k = __builtin_ctz(left);
			float rgb[3];
			find_light(v, texel, tu[k], tv[k], size[k], linear, rgb);
			for (int c = 0; c < 3; c++)
				light[c][at + (size_t)k] += PLANE_WEIGHT * rgb[c];
			weight[at + (size_t)k] += PLANE_WEIGHT;
		}
	}
}

/* Those rows of a view that a band has. */
INLINE int32_t first_row(const struct band *b, const struct plane_view *v)
{
	return MAX(v->top, (int32_t)b->from);
}

INLINE int32_t end_row(const struct band *b, const struct plane_view *v)
{
	return MIN(v->bottom, (int32_t)(b->from + b->rows));
}

void LANES_NAME(plane_light)(const struct band *b, const visibility_mask *m, const plane_views *p,
	uint32_t view, const uint8_t (*texel)[4], float *const light[3], float *weight)
{
	const struct plane_view *v = &p->view[view];
	const struct plane_span *s = p->span + v->first_span;
	for (int32_t y = first_row(b, v); y < end_row(b, v); y++) {
		struct plane_row r = row_of(p, v, y);
		for (uint32_t n = v->row[y - v->top]; n < v->row[y - v->top + 1]; n++)
			light_span(b, m, &r, &s[n], texel, light, weight);
	}
}

/* ---- surface ---- */

INLINE void surface_span(const struct band *b, const visibility_mask *m, const struct plane_row *r,
	const struct plane_span *s, const struct surface_desk *d)
{
	const struct plane_view *v = r->v;
	for (int32_t x = s->from; x < s->end; x += LANES) {
		vf steep, depth_m = depth_of(r, right_of(r, x), &steep);
		vi is_there = shown(m, v, s, x, depth_m);
		if (!any(is_there))
			continue;
		ptrdiff_t at = (ptrdiff_t)(s->row - (int32_t)b->from) * b->pitch + BAND_MARGIN + x;
		vf w = where(is_there, all(PLANE_WEIGHT));
		for (int k = 0; k < 3; k++)
			store(d->normal[k] + at, load(d->normal[k] + at) + w * v->normal[k]);
		vi nearer = is_there & (depth_m < load(d->nearest_m + at));
		store(d->nearest_m + at, choose(nearer, depth_m, load(d->nearest_m + at)));
		store(d->leaf + at, choose(nearer, all((float)v->leaf), load(d->leaf + at)));
	}
}

void LANES_NAME(plane_surface)(const struct band *b, const visibility_mask *m, const plane_views *p,
	uint32_t view, const struct surface_desk *d)
{
	const struct plane_view *v = &p->view[view];
	const struct plane_span *s = p->span + v->first_span;
	for (int32_t y = first_row(b, v); y < end_row(b, v); y++) {
		struct plane_row r = row_of(p, v, y);
		for (uint32_t n = v->row[y - v->top]; n < v->row[y - v->top + 1]; n++)
			surface_span(b, m, &r, &s[n], d);
	}
}
