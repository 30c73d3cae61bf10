#ifndef RENDER_FRAME_PAINT_H
#define RENDER_FRAME_PAINT_H
/* A layer of paint as it is drawn: what its strokes leave at each of their sizes, and what of it is known before the camera is. */
#include "render/pencil-box.h"
#include "render/scene-paint.h"
#include "render/step.h"
#include "render/stroke-texture.h"

/* The texture of the broadest strokes, and each time half of it: a stroke takes the one that is sharp for its width. As long and as
 * wide, with a border of a texel, as the levels of a GPU's texture. */
#define PAINT_LEVELS 4u
#define PAINT_SHARP  0.7f /* down to this part of its width */

/* A stroke's place in the pile, in so many steps: finer ones lie higher, those that come in rise, and else chance tells. So
 * what comes in is hidden at first by most of what it will lie on, and is seen where that is thin before it is elsewhere. */
#define PAINT_LAYS     64u
#define PAINT_LAY_RISE 0.32f /* part of them that strokes rise by while they come in */
#define PAINT_LAY_FINE 0.6f  /* part of the others that size has */
/* A stroke hides those below by its weight, which has a factor of two to each octave: of its place, and of how thick its own paint is.
 * All of it within what floats can add; a GPU that has but half floats gets so much less, and paint that is wetter. */
#define PAINT_OCTAVES_LAY   44.f
#define PAINT_OCTAVES_PAINT 10.f
#define PAINT_OCTAVES_HALF  24.f
/* Paint that is thicker than this part of the thickest covers; a faint stroke leaves paint where it is thick alone. */
#define PAINT_COVERS 0.25f
/* How thick that is at least. alpha: 0..1, of the stroke. */
#define PAINT_DRY(alpha) ((1 - (alpha)) * (1 - (alpha)) * (1 - (alpha)))

/* Of strokes that are so much smaller there are (1 / size)^(1 / PAINT_POWER) times as many: with 0.5 all sizes would cover as much as the
 * broadest; what lies on these needs less. */
#define PAINT_POWER 0.75f
/* Of leaves so many fewer give strokes, for some of those show that others hide (measured). */
#define PAINT_LEAVES 0.8f
/* How much smaller than the broadest, on the way to the finest, strokes of details are at most. */
#define PAINT_DETAIL_SMALLER 0.8f
/* Of the diameter of a point's disc in the mask, what half its stroke's size is at least. */
#define PAINT_DISC 0.5f
/* What is left of the lengths of strokes, and of what they cover, at least, where surface is seen aslant. */
#define PAINT_NARROWEST 0.3f

/* Planes are not so sure: the part of what depth changes by from a stroke's middle to its end that it may be wrong by, and how much of
 * the depth at most. */
#define PAINT_PLANE_ROUGH 0.6f
#define PAINT_ROUGH_MOST  0.06f

/* Of a style's pixels. */
#define PAINT_HOLE_PX 8.f

/* Where a texture is thicker than so many parts of the thickest. */
#define PAINT_DRY_STEPS 32u
/* Along and across, from the middle, in halves of the stroke's length and width; reaches of 0 where none of it is. */
struct paint_extent {
	float middle[2], reach[2];
};

struct frame_paint {
	struct paint_step step;
	const scene *scene;
	const scene_paint *seen; /* held */
	pencil_box palette;
	float exposure; /* scene_exposed() */
	struct paint_level {
		stroke_texture *texture;
		uint32_t *texels, texel_shift; /* as those of frame_layer */
		struct paint_extent extent[STROKE_TEXTURE_VARIANTS][PAINT_DRY_STEPS];
	} level[PAINT_LEVELS];
	/* By detail: of all strokes the part that is there. The broad ones are the first. */
	float part[256];
	float broad; /* the part of them that the broadest are */
	float wanted_per_px; /* strokes, the finest and all others, of surface that is seen from the front */
	float octaves[2]; /* of places, of paint: less where it is wet */
	/* Holes in what was scanned, so far from their middle to what is around them, are painted over; pixels. */
	int32_t hole_px;
	int32_t gap_px; /* so far from paint gaps between strokes take its colour; 0: paper shows */
	/* What a pixel's depth may be more than the stroke's: factor, and metres. */
	float behind, behind_m;
};

/* How much darker paint is that faces away from the light. */
#define PAINT_SHADE 0.6f

struct frame_layer;
/* Of a layer whose lengths are known; takes nothing. texture: whole. */
/* px: of the picture, to one of the style. */
struct frame_paint *frame_paint_new(const struct frame_layer *l, const scene *s,
	const struct mask_step *mask, float px, const stroke_texture *texture);
void frame_paint_free(struct frame_paint *p); /* NULL is fine */

#endif
