#ifndef RENDER_STROKE_TEXTURE_H
#define RENDER_STROKE_TEXTURE_H
/* A stroke texture says how much ink one stroke of a medium leaves where: the alpha textures of Xu
 * and Chen 2004, section 6.2 and figure 4. It is laid over the quad of a point (u along its
 * direction, v across), and dst *= 1 - alpha draws it in black.
 *
 * They are made here, of noise with constant seeds: the same bytes on every run. Each has
 * variants, so that neighbouring strokes differ; who draws chooses one by the point's id.
 *
 * The border texels are 0, and so is what is beyond: a rotated stroke that is sampled so,
 * between texels, has no cut edges.
 *
 * Const once made; then any thread may read it. */
#include "render/texels.h"

enum {
	STROKE_TEXTURE_LENGTH = 256, /* texels along */
	STROKE_TEXTURE_WIDTH = 32,   /* and across */
	STROKE_TEXTURE_VARIANTS = 4,
};

/* The first three are not of a hand: their variants are all the same. */
enum stroke_kind {
	STROKE_GAUSSIAN, /* a point sprite's kernel (figure 4a): lay it over a square */
	STROKE_LINE,     /* even, with soft edges */
	STROKE_DOT,      /* as round as its quad */
	STROKE_PENCIL,   /* grain of the paper's tooth, pressure, tapered ends, graphite streaks */
	STROKE_INK_PEN,  /* crisp and nearly opaque; swells a little, tapers fast */
	STROKE_CHARCOAL, /* broad, granular, over its own dust; broken edges and streaks */
	STROKE_BRUSH,    /* begins wet, ends dry, in streaks of bristles */
	STROKE_CHALK,    /* only on the heights of the tooth; blunt ends */
	STROKE_BRISTLES, /* how thick a flat brush leaves paint, hair by hair */
	STROKE_DAB,      /* and a round one that is only set down */
	STROKE_KINDS
};

/* A place on a stroke: the middle of a texel. */
struct stroke_place {
	float x, y;   /* in texels: 0..LENGTH along, 0..WIDTH across */
	float along;  /* 0..1 */
	float across; /* -1..1, 0 the middle */
};

struct stroke_texture_kind {
	const char *name, *title; /* in files and command lines; for people */
	float (*make)(const struct stroke_place *at, uint32_t seed); /* alpha there; clamped */
};
extern const struct stroke_texture_kind stroke_texture_kinds[STROKE_KINDS];

typedef struct stroke_texture stroke_texture;
struct stroke_texture {
	char *name;             /* as asked for */
	uint32_t length, width; /* texels of one variant */
	uint32_t variants;      /* below each other: a plane of length x (width * variants) */
	uint8_t *alpha;         /* 255: opaque */
	/* 0..1: of its area, how much a stroke leaves covered with ink. */
	double mean_alpha[STROKE_TEXTURE_VARIANTS];
};

/* A kind by its name, or a PNG by its path: a name with a '/' or ending in ".png". Of a PNG the
 * ink is darkness times opacity; it is fitted into the texture inside the border, and its variants
 * are the picture and its mirror images.
 * NULL: one sentence (G_FILE_ERROR): there is no such kind, listing those there are; the file is
 * missing, not a PNG, above 4096 pixels a side, or without any ink. */
stroke_texture *stroke_texture_new(const char *name, GError **error);
/* All variants reduced to length x width texels, each at least 1, by an area filter: what is sharp
 * for a stroke of so many pixels on the screen. Mean alpha stays, the border is 0 no more (what is
 * beyond it still is). */
stroke_texture *stroke_texture_scaled(const stroke_texture *t, uint32_t length, uint32_t width);
void stroke_texture_free(stroke_texture *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(stroke_texture, stroke_texture_free)

/* The first texel of a variant. */
static inline const uint8_t *stroke_texture_variant(const stroke_texture *t, uint32_t variant)
{
	return t->alpha + (size_t)variant * t->length * t->width;
}

#endif
