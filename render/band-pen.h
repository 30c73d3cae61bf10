#ifndef RENDER_BAND_PEN_H
#define RENDER_BAND_PEN_H
/* A stroke as its rows are drawn. Internal to band-draw-lanes.c; all is inlined. */
#include "render/band-draw-few.h"
#include "render/bands.h"
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
	const struct stroke *s;
	float cosine, sine, half_length, half_width;
	float reach_along, reach_across;
	/* A row dy below the middle is inside from dy turn - reach to dy turn + reach: by its ends, and by its sides. */
	float turn[2], reach[2];
	float falloff;    /* of a sprite */
	float strength;   /* of a line */
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

/* Lines are drawn a pixel wider than they are, with soft edges, which makes those that are thinner than that too strong. */
INLINE float thinness(float half)
{
	return half < 0.5f ? 2 * half / ((half + 0.5f) * (half + 0.5f)) : 1;
}

/* The one that is sharp for its width. */
INLINE const struct paint_level *paint_level_of(const struct frame_layer *l, const struct stroke *s)
{
	uint32_t n = 0;
	for (float width = PAINT_SHARP * l->ink.width_px;
		n + 1 < PAINT_LEVELS && 2 * s->half_width_px < width; width /= 2)
		n++;
	return &l->paint->level[n];
}

INLINE void lay_pen(const struct frame_layer *l, struct pen *p)
{
	const struct frame_paint *paint = l->paint;
	p->lay = (float)p->s->lay * paint->octaves[0] -
		 0.5f * (paint->octaves[0] * (PAINT_LAYS - 1) + paint->octaves[1]);
	p->octaves = paint->octaves[1];
	p->dry = 1 - p->s->alpha;
	p->deep = stroke_paint_reach(paint, p->s);
	p->hole_px = paint->hole_px;
}

INLINE float unit_of(enum kernel kernel)
{
	if (kernel == KERNEL_FEW_TEXELS)
		return FEW_UNIT;
	return kernel == KERNEL_TEXTURE ? TEXTURE_UNIT : 1;
}

INLINE struct pen pen_of(const struct frame_layer *l, const struct stroke *s, enum kernel kernel)
{
	struct pen p = { .s = s,
		.cosine = s->along[0],
		.sine = s->along[1],
		.half_length = s->half_length_px,
		.half_width = s->half_width_px,
		.alpha = s->alpha * unit_of(kernel),
		.shows_from = stroke_shows_from(l, s) };
	float soft = kernel == KERNEL_LINE ? 0.5f : 0;
	p.reach_along = p.half_length + soft;
	p.reach_across = p.half_width + soft;
	p.strength = thinness(p.half_length) * thinness(p.half_width);
	if (kernel == KERNEL_SPRITE) {
		float sigma = 2 * p.half_length / SIGMAS;
		p.falloff = 1 / (2 * sigma * sigma);
	}
	if (kernel >= KERNEL_TEXTURE) {
		const struct paint_level *level = l->paint ? paint_level_of(l, s) : NULL;
		const stroke_texture *t = level ? level->texture : l->texture;
		uint32_t variant =
			(uint32_t)(stroke_chance(s->point, stroke_salt(s->copy, SALT_VARIANT)) *
				   (float)t->variants);
		p.texel_shift = level ? level->texel_shift : l->texel_shift;
		p.texels = (level ? level->texels : l->texels) +
			   frame_texels(t, p.texel_shift) * variant;
		float along = (float)t->length / (2 * p.half_length),
		      across = (float)t->width / (2 * p.half_width);
		p.texel_x[0] = p.cosine * along * (1 << TEXEL_BITS);
		p.texel_y[0] = p.sine * along * (1 << TEXEL_BITS);
		p.texel_x[1] = -p.sine * across * (1 << TEXEL_BITS);
		p.texel_y[1] = p.cosine * across * (1 << TEXEL_BITS);
		p.texel_end[0] = (float)(t->length + 1) * (1 << TEXEL_BITS);
		p.texel_end[1] = (float)(t->width + 1) * (1 << TEXEL_BITS);
		for (int k = 0; k < 2; k++)
			p.texel_middle[k] = p.texel_end[k] / 2;
		if (kernel == KERNEL_FEW_TEXELS)
			p.few = few_of(t, l->few_texels + FRAME_FEW_TEXELS * variant,
				(float[]){ s->x_px, s->y_px },
				(float[]){ p.cosine * along, -p.sine * across },
				(float[]){ p.sine * along, p.cosine * across });
		/* Half a texel: from the last one to nothing. */
		p.reach_along += 0.5f / along;
		p.reach_across += 0.5f / across;
	}
	bool has_ends = fabsf(p.cosine) > COSINE_LEAST, has_sides = fabsf(p.sine) > COSINE_LEAST;
	float by_cosine = has_ends ? 1 / p.cosine : 0, by_sine = has_sides ? 1 / p.sine : 0;
	if (l->paint)
		lay_pen(l, &p);
	p.turn[0] = -p.sine * by_cosine;
	p.turn[1] = p.cosine * by_sine;
	p.reach[0] = has_ends ? p.reach_along * fabsf(by_cosine) + ROUNDING : REACH_MOST;
	p.reach[1] = has_sides ? p.reach_across * fabsf(by_sine) + ROUNDING : REACH_MOST;
	return p;
}

#endif
