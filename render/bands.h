#ifndef RENDER_BANDS_H
#define RENDER_BANDS_H
/* A picture is put together in bands of rows, each by one thread, with planes of floats that stay in its cache. */
#include "render/stroke.h"

#define BAND_ROWS 32
#define BAND_AROUND                                                                                \
	1 /* rows above and below that strokes of paint are drawn in, for the light that falls on them */
#define BAND_MARGIN 16 /* columns on either side, that vectors may reach into */

struct band {
	uint32_t width, from, rows; /* of the picture */
	uint32_t pitch;
};
static inline float *band_row(const struct band *b, float *plane, uint32_t y)
{
	return plane + (size_t)(y - b->from) * b->pitch + BAND_MARGIN;
}

/* Which strokes of each layer touch which band, or where light falls on them the row above or below, in their order. */
typedef struct band_lists band_lists;
/* Zero at first; clear it in the end. */
struct band_lists {
	uint32_t bands;
	uint32_t *end;   /* layer by layer, of each band's part of which */
	uint32_t *which; /* band_stroke() */
	size_t room;     /* for so many in which */
};
/* Of all layers of the frame. */
void band_lists_fill(
	band_lists *b, const frame *f, const struct stroke_blocks *of_layer, uint32_t height);
void band_lists_clear(band_lists *b);

/* Those of one layer in one band: so many, and where they are. */
struct band_strokes {
	const uint32_t *which;
	uint32_t count;
	struct stroke_block *const *block;
};
struct band_strokes band_strokes_of(
	const band_lists *b, const struct stroke_blocks *of_layer, uint32_t layer, uint32_t band);
/* The number of the stroke's block in its layer, and that of the stroke in it. */
#define BAND_STROKE_BITS 7
_Static_assert(STROKE_BLOCK <= 1u << BAND_STROKE_BITS, "a number in a block");
static inline const struct stroke_packed *band_stroke(const struct band_strokes *s, uint32_t n)
{
	uint32_t which = s->which[n];
	return &s->block[which >> BAND_STROKE_BITS]->stroke[which & ((1u << BAND_STROKE_BITS) - 1)];
}

/* What strokes of a layer are drawn with. */
enum kernel { KERNEL_SPRITE, KERNEL_LINE, KERNEL_TEXTURE };
enum kernel band_kernel_of(const struct frame_layer *l);

/* What strokes of one layer leave in a band. */
enum band_blend {
	BAND_INKED,     /* BLEND_MULTIPLY in one ink: bare alone */
	BAND_STRONGEST, /* the same, of strokes that lie on each other the strongest counts */
	BAND_COVERING,  /* and the same of BLEND_PAINT */
	BAND_COLOURED,  /* BLEND_MULTIPLY in the points' colours: channel alone */
	BAND_PAINTED,   /* BLEND_PAINT: all of them but height */
	BAND_LAID       /* of a step "paint": all of them */
};
#define BAND_BLENDS (BAND_LAID + 1)
enum band_blend band_blend_of(const struct frame_layer *l);

/* Parts of a band's width, a bit each, side by side. */
#define BAND_PARTS 64
struct band_parts {
	uint64_t in;
	uint32_t shift;    /* of the columns */
	int32_t beside_px; /* so far beside what is in them they are in too */
};
static inline void band_parts_add(struct band_parts *p, float from_x, float to_x, uint32_t width)
{
	int32_t first = (int32_t)CLAMP(from_x - (float)p->beside_px, 0, (float)(width - 1)) >>
			p->shift,
		last = (int32_t)CLAMP(to_x + (float)p->beside_px, 0, (float)(width - 1)) >>
		       p->shift;
	p->in |= (2ull << last) - (1ull << first);
}

struct band_ink {
	float *bare;       /* product of 1 - alpha; or the least of them */
	float *channel[3]; /* product of 1 - alpha (1 - colour); or sum of alpha * colour */
	float *weight;     /* sum of alpha */
	/* Of strokes that lie on each other weights have a factor of two to the octaves that they lie higher by (frame-paint.h), which makes
	 * sums those of what lies highest, whatever came first. Sum of weight * how thick its paint is, 0..1. */
	float *height;
	struct band_parts *laid; /* strokes of BAND_LAID add where they are; else not looked at */
};
/* Draws strokes of the layer over the planes. m may be NULL. */
void band_draw(const struct band *b, const frame *f, const struct frame_layer *l,
	const struct band_strokes *strokes, const visibility_mask *m, const struct band_ink *ink);

#endif
