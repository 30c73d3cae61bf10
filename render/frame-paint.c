#include "render/frame-paint.h"
#include "render/frame.h"
#include "render/stroke.h"
#include <math.h>
#include <string.h>

/* What a stroke covers of its box. */
static float covered_part(const stroke_texture *t)
{
	double sum = 0;
	size_t texels = (size_t)t->length * t->width * t->variants;
	for (size_t n = 0; n < texels; n++)
		sum += fmin(t->alpha[n] / (255.0 * PAINT_COVERS), 1);
	return (float)fmax(sum / (double)texels, 0.05);
}

/* Halves of the whole, as a GPU's levels are. */
static uint32_t inner(uint32_t whole, uint32_t level)
{
	return MAX(whole >> level, 3) - 2;
}

/* Of texels first to last, with what is between them and their neighbours; of 1 to size. */
static void extent_along(
	uint32_t first, uint32_t last, uint32_t size, float *ret_middle, float *ret_reach)
{
	*ret_middle = ((float)(first + last) - (float)(size + 1)) / (float)size;
	*ret_reach = (float)(last - first + 2) / (float)size;
}

/* Of what is thicker than this. */
static struct paint_extent extent_of(const stroke_texture *t, uint32_t variant, float dry)
{
	struct paint_extent e = { 0 };
	const uint8_t *texel = stroke_texture_variant(t, variant);
	uint32_t first[2] = { UINT32_MAX, UINT32_MAX }, last[2] = { 0, 0 };
	for (uint32_t y = 1; y <= t->width; y++)
		for (uint32_t x = 1; x <= t->length; x++, texel++)
			if (*texel > 0 && *texel >= dry * 255 - 0.5f) {
				uint32_t at[] = { x, y };
				for (int k = 0; k < 2; k++) {
					first[k] = MIN(first[k], at[k]);
					last[k] = MAX(last[k], at[k]);
				}
			}
	for (int k = 0; k < 2 && last[k]; k++)
		extent_along(
			first[k], last[k], k ? t->width : t->length, &e.middle[k], &e.reach[k]);
	return e;
}

static void make_levels(
	struct frame_paint *p, const struct frame_layer *l, const stroke_texture *texture)
{
	uint32_t length = MAX((uint32_t)(l->ink.length_px + 0.5f), 30) + 2,
		 width = MAX((uint32_t)(l->ink.width_px + 0.5f), 30) + 2;
	for (uint32_t n = 0; n < PAINT_LEVELS; n++) {
		struct paint_level *v = &p->level[n];
		v->texture = stroke_texture_scaled(texture, inner(length, n), inner(width, n));
		v->texels = frame_pack_texels(v->texture, &v->texel_shift);
		for (uint32_t k = 0; k < v->texture->variants; k++)
			for (uint32_t d = 0; d < PAINT_DRY_STEPS; d++)
				v->extent[k][d] =
					extent_of(v->texture, k, (float)d / PAINT_DRY_STEPS);
	}
}

struct frame_paint *frame_paint_new(const struct frame_layer *l, const scene *s,
	const struct mask_step *mask, float px, const stroke_texture *texture)
{
	struct frame_paint *p = g_new0(struct frame_paint, 1);
	const struct paint_step *step = &l->step->paint;
	p->step = *step;
	p->scene = s;
	p->seen = scene_paint_hold(s);
	p->palette = pencil_box_of(step->palette);
	p->exposure = scene_exposure_of(s, step->exposure);
	make_levels(p, l, texture);
	float area_px = l->ink.length_px * l->ink.width_px * covered_part(p->level[0].texture);
	p->broad = powf(step->fine, 1 / PAINT_POWER);
	p->wanted_per_px = step->cover / (area_px * p->broad);
	for (int n = 0; n < 256; n++)
		p->part[n] = powf(p->broad, step->detail * (1 - (float)n / 255));
	p->octaves[0] = (1 - step->wet) * PAINT_OCTAVES_LAY / (PAINT_LAYS - 1);
	p->octaves[1] = (1 - step->wet) * PAINT_OCTAVES_PAINT;
	p->hole_px = (int32_t)(PAINT_HOLE_PX * px + 0.5f);
	p->gap_px = (int32_t)ceilf(step->gap_px * px);
	p->behind = (1 + step->spill) * (1 + mask->offset_relative);
	p->behind_m = (1 + step->spill) * mask->offset_m;
	return p;
}

void frame_paint_free(struct frame_paint *p)
{
	if (!p)
		return;
	for (uint32_t n = 0; n < PAINT_LEVELS; n++) {
		stroke_texture_free(p->level[n].texture);
		g_free(p->level[n].texels);
	}
	scene_paint_release(p->scene);
	g_free(p);
}

void frame_paint_crown(const frame *f, const struct scene_chunk *c, float ret_m[3])
{
	const float *middle_m =
		scene_paint_chunk_of(scene_paint_of(f->scene), f->scene, c)->middle_m;
	const double *row[3] = { f->camera.right, f->camera.down, f->camera.forward };
	for (int k = 0; k < 3; k++) {
		double at_m = 0;
		for (int n = 0; n < 3; n++)
			at_m += row[k][n] * ((double)middle_m[n] - f->eye_m[n]);
		ret_m[k] = (float)at_m;
	}
}

void frame_paint_light(const frame *f, float ret[3])
{
	static const float left_above[3] = { -0.45f, -0.55f, 0.70f };
	const float *from = f->light.from;
	float aside = sqrtf(from[0] * from[0] + from[1] * from[1]);
	memcpy(ret, left_above, sizeof left_above);
	for (int k = 0; k < 2 && f->light.amount > 0 && aside > 0.05f; k++)
		ret[k] = from[k] / aside * sqrtf(1 - ret[2] * ret[2]);
}
