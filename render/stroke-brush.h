#ifndef RENDER_STROKE_BRUSH_H
#define RENDER_STROKE_BRUSH_H
/* A layer as one chunk draws it, and what a point's surface looks like from the camera: where it goes on the screen, at what angle it
 * is seen, along what its edge runs. Internal to stroke.c and stroke-lanes.c; all is inlined. */
#include "process/lanes.h"
#include "process/vector3.h"
#include "render/lens.h"
#include "render/stroke.h"
#include <math.h>

/* Blocks of one layer, as they are filled by one thread. */
struct stroke_chain {
	stroke_room *room;
	struct stroke_block *first, *last;
};
/* Another block at its end. */
void stroke_chain_grow(struct stroke_chain *c);
static inline void stroke_chain_add(struct stroke_chain *c, const struct stroke *s)
{
	if (!c->last || c->last->count == STROKE_BLOCK)
		stroke_chain_grow(c);
	c->last->stroke[c->last->count++] = stroke_pack(s);
}

/* A layer as one chunk draws it. */
struct brush {
	const frame *f;
	const struct frame_layer *layer;
	const struct chunk_view *view;
	const visibility_mask *mask;
	struct lens lens;
	float turn[3][3]; /* site to camera: rows right, down, forward */
	float ray_most;   /* length of the longest ray of depth 1 */
	int kind;
	float wanted_most; /* need is this * (px_per_m * spacing)^2 at most, of points on surface */
	float before_per_m2; /* where a tone is shown: dithering points that come before any of these, at least */
	uint32_t list_count; /* of the kind in the chunk */
	float dither_m; /* of dithering points without all others on surface: how far apart black ones are; else 0 */
	uint32_t copies;  /* that points may give, with themselves */
	float moved_m;    /* how far from their points strokes are at most */
	float crown_m[3]; /* of paint: the middle of the chunk's leaf, as the camera sees it */
};

/* A point that may become a stroke. */
struct candidate {
	uint32_t point; /* of the scene */
	float rank, spacing_m;
	float x_px, y_px, depth_m;
};

/* Part of the depth from which on what is behind the mask is gone. On the way there it fades: the mask is as rough as the points are,
 * and strokes must not come and go with it. What they may not cover they are kept from at each pixel. */
#define HIDDEN_BEHIND 0.03f
/* Of the kind of the brush, in its chunk. */
LANES_DECLARE(void, stroke_choose, (const struct brush *b, struct stroke_chain *to));
/* The same of hatching, of all kinds of points. */
LANES_DECLARE(void, stroke_hatch, (const struct brush *b, struct stroke_chain *to));
/* And of paint. */
LANES_DECLARE(void, stroke_paint, (const struct brush *b, struct stroke_chain *to));
/* And of contours. */
LANES_DECLARE(void, stroke_contours, (const struct brush *b, struct stroke_chain *to));
/* And of cuts. */
LANES_DECLARE(void, stroke_cut, (const struct brush *b, struct stroke_chain *to));

/* How thick is cut, in spacings of the points, and in metres at least and at most; lines are drawn where the sine of the angle between
 * surface and cut is more than the first of these, and from the second on whole. */
#define CUT_SPACINGS    3.f
#define CUT_LEAST_M     0.01f
#define CUT_MOST_M      0.1f
#define CUT_SLANT_LEAST 0.3f
#define CUT_SLANT_SURE  0.5f
/* What lies on the cut is before all else: its 1/depth on the screen is so many times what it is. */
#define CUT_BEFORE 2.f

/* -1 .. 1 */
INLINE float around_zero(uint32_t point, uint32_t salt)
{
	return 2 * stroke_chance(point, salt) - 1;
}

INLINE void to_camera(const struct brush *b, const int16_t packed[2], float ret[3])
{
	float v[3];
	model_unpack_normal(packed, v);
	for (int k = 0; k < 3; k++)
		ret[k] = vector3_dot(b->turn[k], v);
}

/* The ray at a place on the screen, of depth 1. */
INLINE void ray_of(const struct brush *b, const struct candidate *c, float ret[3])
{
	ret[0] = (c->x_px - b->lens.middle_x) / b->lens.focal_px * b->lens.fan;
	ret[1] = (c->y_px - b->lens.middle_y) / b->lens.focal_px * b->lens.fan;
	ret[2] = 1;
}

/* The line through the point on the screen: unit, and pixels to a metre of it; 1/depth along it. */
struct line {
	float along[2], px_per_m, slope;
};

INLINE bool line_of(const struct brush *b, const struct candidate *c, struct line *ret)
{
	float d[3], ray[3];
	const int16_t *packed = b->f->scene->direction[c->point];
	if (packed[0] == MODEL_NORMAL_NONE)
		return false;
	to_camera(b, packed, d);
	ray_of(b, c, ray);
	float scale = b->lens.focal_px / LENS_SCALE_M(&b->lens, c->depth_m);
	float x = (d[0] - ray[0] * d[2]) * scale, y = (d[1] - ray[1] * d[2]) * scale;
	float length = sqrtf(x * x + y * y);
	if (!(length > 1e-3f * scale))
		return false;
	ret->along[0] = x / length;
	ret->along[1] = y / length;
	ret->px_per_m = length;
	ret->slope = -d[2] / (c->depth_m * c->depth_m * length);
	return true;
}

#endif
