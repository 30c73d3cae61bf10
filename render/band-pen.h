#ifndef RENDER_BAND_PEN_H
#define RENDER_BAND_PEN_H
/* A stroke as its rows are drawn. Internal to band-draw-lanes.c; all is inlined. */
#include "render/band-draw-few.h"
#include "render/bands.h"
#include "render/light.h"
#include "render/stroke-pack-lanes.h"
#include "render/stroke.h"
#include <math.h>

/* Of a sprite's Gaussian kernel: its diameter is so many sigmas. */
#define SIGMAS 5.f

/* Sides at a lower cosine to the rows than this bound none of them. */
#define COSINE_LEAST 1e-3f
#define REACH_MOST   1e5f
/* Between texels there are so many places, either way. */
#define TEXEL_BITS 7
/* What weights of texels, which are 127 together, make of one that is opaque. */
#define TEXTURE_UNIT (1.f / (255 * ((1 << TEXEL_BITS) - 1)))
/* Pixels, for what floats are rounded by. */
#define ROUNDING 1e-3f
/* And places in a picture of 16,384. */
#define ROUNDING_PICTURE 0.01f

/* KERNEL_TEXTURE of few texels. */
#define KERNEL_FEW_TEXELS (KERNEL_TEXTURE + 1)

/* A stroke with what its rows share. */
struct pen {
	float x_px, y_px, q, slope[2]; /* struct stroke */
	float cosine, sine, half_length, half_width;
	float reach_along, reach_across;
	/* The middle of what of it is drawn: of paint that is dry, not all is. */
	float middle_x, middle_y;
	/* A row dy below that is inside from dy turn - reach to dy turn + reach: by its ends, and by its sides. */
	float turn[2], reach[2];
	/* Rows that it may touch, from the first to before the end; pixels of each at most. */
	int32_t top, end, across;
	float falloff;    /* of a sprite */
	float alpha;      /* what the kernel gives is multiplied by */
	float shows_from; /* stroke_shows_from() */
	/* Of a texture: the variant, and where a pixel is in it, along and across, in parts of texels: x dx + y dy + middle. */
	const uint32_t *texels;
	uint32_t texel_shift;
	struct few few; /* of few texels, instead of what comes now */
	float texel_x[2], texel_y[2], texel_middle[2], texel_end[2];
	float colour[3];
	/* Of paint: octaves that it lies higher by, of its place and by what is thick; how thick it must be to cover; depths that it
	 * reaches, as parts of that of its plane. */
	float lay, octaves, dry;
	struct stroke_reach deep;
	int32_t hole_px;
};

/* ---- eight at once ---- */

/* The texture of each. */
struct pen_textures {
	const struct paint_level *level[LANES]; /* of paint */
	const stroke_texture *texture[LANES];
	const uint32_t *texels[LANES];
	uint32_t shift[LANES], variant[LANES];
	vf length, width;
};

/* As stroke_unpack() gives them. What a pen has, but for textures of few texels, paint, and what is in the strokes alone. */
struct pens {
	const struct stroke_packed *from[LANES];
	vi rgb;
	vf x_px, y_px, q, slope[2], cosine, sine, half_length, half_width;
	vf reach_along, reach_across, middle_x, middle_y, turn[2], reach[2];
	vi top, end, across;
	vf falloff, alpha, shows_from;
	struct pen_textures texture;
};

/* Rows to columns. */
INLINE void transpose_eight(vi r[LANES])
{
	vi two[LANES], four[LANES];
	for (int n = 0; n < LANES; n += 2) {
		two[n] = __builtin_shufflevector(r[n], r[n + 1], 0, 8, 1, 9, 4, 12, 5, 13);
		two[n + 1] = __builtin_shufflevector(r[n], r[n + 1], 2, 10, 3, 11, 6, 14, 7, 15);
	}
	for (int n = 0; n < LANES; n += 4)
		for (int k = 0; k < 2; k++) {
			four[n + 2 * k] = __builtin_shufflevector(
				two[n + k], two[n + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
			four[n + 2 * k + 1] = __builtin_shufflevector(
				two[n + k], two[n + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
		}
	for (int n = 0; n < 4; n++) {
		r[n] = __builtin_shufflevector(four[n], four[n + 4], 0, 1, 2, 3, 8, 9, 10, 11);
		r[n + 4] =
			__builtin_shufflevector(four[n], four[n + 4], 4, 5, 6, 7, 12, 13, 14, 15);
	}
}

/* stroke_unpack() */
INLINE void unpack_pens(struct pens *p)
{
	_Static_assert(STROKE_POINT == LANES, "all words before it are looked at here");
	vi word[LANES];
	for (int k = 0; k < LANES; k++)
		word[k] = *(const vi_loose *)(const void *)p->from[k]->word;
	transpose_eight(word);
	p->x_px = (vf)word[STROKE_X];
	p->y_px = (vf)word[STROKE_Y];
	p->cosine = first_along(word[STROKE_ALONG_BOTH]) * (1 / STROKE_ALONG);
	p->sine = second_along(word[STROKE_ALONG_BOTH]) * (1 / STROKE_ALONG);
	p->half_length = first_length(word[STROKE_HALVES]);
	p->half_width = second_length(word[STROKE_HALVES]);
	p->q = (vf)word[STROKE_Q];
	p->slope[0] = (vf)(word[STROKE_SLOPES] << 16);
	p->slope[1] = (vf)(word[STROKE_SLOPES] & (int32_t)0xffff0000);
	p->rgb = word[STROKE_RGB_COPY];
	p->alpha = __builtin_convertvector(word[STROKE_ALPHA_LAY_ASLANT] & 0xffff, vf) *
		   (1 / STROKE_ALPHA);
}

/* Lines are drawn a pixel wider than they are, with soft edges, which makes those that are thinner than that too strong. */
INLINE vf thinness(vf half)
{
	return choose(half < 0.5f, 2 * half / ((half + 0.5f) * (half + 0.5f)), all(1));
}

/* The one that is sharp for its width. */
INLINE const struct paint_level *paint_level_of(const struct frame_layer *l, float half_width_px)
{
	uint32_t n = 0;
	for (float width = PAINT_SHARP * l->ink.width_px;
		n + 1 < PAINT_LEVELS && 2 * half_width_px < width; width /= 2)
		n++;
	return &l->paint->level[n];
}

INLINE void find_textures(const struct frame_layer *l, struct pens *p)
{
	struct pen_textures *to = &p->texture;
	for (int k = 0; k < LANES; k++) {
		const struct paint_level *level = to->level[k] =
			l->paint ? paint_level_of(l, p->half_width[k]) : NULL;
		const stroke_texture *t = to->texture[k] = level ? level->texture : l->texture;
		uint32_t point = p->from[k]->word[STROKE_POINT], copy = (uint32_t)p->rgb[k] >> 24;
		to->variant[k] = (uint32_t)(stroke_chance(point, stroke_salt(copy, SALT_VARIANT)) *
					    (float)t->variants);
		to->shift[k] = level ? level->texel_shift : l->texel_shift;
		to->texels[k] = (level ? level->texels : l->texels) +
				frame_texels(t, to->shift[k]) * to->variant[k];
		to->length[k] = (float)t->length;
		to->width[k] = (float)t->width;
	}
}

/* The pixel at the middle of which x is or the next one, or 0. */
INLINE vi pixel_lanes(vf x)
{
	return __builtin_convertvector(most(x, all(0)) + 0.5f, vi);
}

/* Where its rows are. */
INLINE void bound_pens(const struct band *b, struct pens *p)
{
	vi has_ends = magnitude(p->cosine) > COSINE_LEAST,
	   has_sides = magnitude(p->sine) > COSINE_LEAST;
	vf by_cosine = where(has_ends, 1 / p->cosine), by_sine = where(has_sides, 1 / p->sine);
	p->turn[0] = -p->sine * by_cosine;
	p->turn[1] = p->cosine * by_sine;
	p->reach[0] =
		choose(has_ends, p->reach_along * magnitude(by_cosine) + ROUNDING, all(REACH_MOST));
	p->reach[1] =
		choose(has_sides, p->reach_across * magnitude(by_sine) + ROUNDING, all(REACH_MOST));
	vf down = magnitude(p->sine) * p->reach_along + magnitude(p->cosine) * p->reach_across +
		  ROUNDING;
	p->top = higher(pixel_lanes(p->middle_y - down), (vi)all(0) + (int32_t)b->from);
	p->end = lower(pixel_lanes(p->middle_y + down), (vi)all(0) + (int32_t)(b->from + b->rows));
	/* A row has a pixel more than it is long at most, rounded as its ends are in the picture. */
	vf across =
		least(2 * least(p->reach[0], p->reach[1]) + ROUNDING_PICTURE, all((float)b->width));
	p->across = __builtin_convertvector(across, vi) + 1;
}

/* What of paint is as thick as it must be to be drawn: the texture's extents instead of the whole. */
INLINE void bound_paint(struct pens *p)
{
	float middle[2][LANES], reach[2][LANES];
	for (int k = 0; k < LANES; k++) {
		float dry = PAINT_DRY(p->alpha[k]) * PAINT_DRY_STEPS;
		const struct paint_extent *e = &p->texture.level[k]->extent[p->texture.variant[k]][(
			uint32_t)CLAMP(dry, 0, PAINT_DRY_STEPS - 1)];
		for (int n = 0; n < 2; n++) {
			middle[n][k] = e->middle[n];
			reach[n][k] = e->reach[n];
		}
	}
	vf along = load(middle[0]) * p->half_length, across = load(middle[1]) * p->half_width;
	p->reach_along = load(reach[0]) * p->half_length;
	p->reach_across = load(reach[1]) * p->half_width;
	p->middle_x += along * p->cosine - across * p->sine;
	p->middle_y += along * p->sine + across * p->cosine;
}

/* Of those in from. */
INLINE void find_pens(
	const struct band *b, const struct frame_layer *l, enum kernel kernel, struct pens *p)
{
	unpack_pens(p);
	p->shows_from = 1 - least(l->ink.reach_m * p->q, all(STROKE_REACH_MOST));
	p->reach_along = p->half_length;
	p->reach_across = p->half_width;
	p->middle_x = p->x_px;
	p->middle_y = p->y_px;
	if (kernel == KERNEL_SPRITE) {
		vf sigma = 2 * p->half_length / SIGMAS;
		p->falloff = 1 / (2 * sigma * sigma);
	}
	if (kernel == KERNEL_LINE) {
		p->reach_along += 0.5f;
		p->reach_across += 0.5f;
		p->alpha *= thinness(p->half_length) * thinness(p->half_width);
	}
	if (kernel >= KERNEL_TEXTURE) {
		find_textures(l, p);
		/* Half a texel: from the last one to nothing. */
		p->reach_along += p->half_length / p->texture.length;
		p->reach_across += p->half_width / p->texture.width;
		if (l->paint)
			bound_paint(p);
		p->alpha *= kernel == KERNEL_TEXTURE ? TEXTURE_UNIT : FEW_UNIT;
	}
	bound_pens(b, p);
}

/* ---- one of them ---- */

INLINE void lay_pen(const struct frame_layer *l, const struct stroke_packed *from, struct pen *p)
{
	const struct frame_paint *paint = l->paint;
	struct stroke s = stroke_unpack(from);
	p->lay = (float)s.lay * paint->octaves[0] -
		 0.5f * (paint->octaves[0] * (PAINT_LAYS - 1) + paint->octaves[1]);
	p->octaves = paint->octaves[1];
	p->dry = PAINT_DRY(s.alpha);
	p->deep = stroke_paint_reach(paint, &s);
	p->hole_px = paint->hole_px;
}

INLINE void texture_pen(const struct frame_layer *l, const struct pens *all, int k,
	enum kernel kernel, struct pen *p)
{
	const stroke_texture *t = all->texture.texture[k];
	float along = (float)t->length / (2 * p->half_length),
	      across = (float)t->width / (2 * p->half_width);
	p->texel_shift = all->texture.shift[k];
	p->texels = all->texture.texels[k];
	p->texel_x[0] = p->cosine * along * (1 << TEXEL_BITS);
	p->texel_y[0] = p->sine * along * (1 << TEXEL_BITS);
	p->texel_x[1] = -p->sine * across * (1 << TEXEL_BITS);
	p->texel_y[1] = p->cosine * across * (1 << TEXEL_BITS);
	p->texel_end[0] = (float)(t->length + 1) * (1 << TEXEL_BITS);
	p->texel_end[1] = (float)(t->width + 1) * (1 << TEXEL_BITS);
	for (int n = 0; n < 2; n++)
		p->texel_middle[n] = p->texel_end[n] / 2;
	if (kernel == KERNEL_FEW_TEXELS)
		p->few = few_of(t, l->few_texels + FRAME_FEW_TEXELS * all->texture.variant[k],
			(float[]){ p->x_px, p->y_px },
			(float[]){ p->cosine * along, -p->sine * across },
			(float[]){ p->sine * along, p->cosine * across });
}

INLINE struct pen pen_of(
	const struct frame_layer *l, const struct pens *all, int k, enum kernel kernel)
{
	const float *light = light_of_bytes();
	struct pen p = { .x_px = all->x_px[k],
		.y_px = all->y_px[k],
		.q = all->q[k],
		.slope = { all->slope[0][k], all->slope[1][k] },
		.cosine = all->cosine[k],
		.sine = all->sine[k],
		.half_length = all->half_length[k],
		.half_width = all->half_width[k],
		.reach_along = all->reach_along[k],
		.reach_across = all->reach_across[k],
		.middle_x = all->middle_x[k],
		.middle_y = all->middle_y[k],
		.turn = { all->turn[0][k], all->turn[1][k] },
		.reach = { all->reach[0][k], all->reach[1][k] },
		.top = all->top[k],
		.end = all->end[k],
		.across = all->across[k],
		.falloff = kernel == KERNEL_SPRITE ? all->falloff[k] : 0,
		.alpha = all->alpha[k],
		.shows_from = all->shows_from[k] };
	for (int n = 0; n < 3; n++)
		p.colour[n] = light[all->rgb[k] >> 8 * n & 255];
	if (kernel >= KERNEL_TEXTURE)
		texture_pen(l, all, k, kernel, &p);
	if (l->paint)
		lay_pen(l, all->from[k], &p);
	return p;
}

#endif
