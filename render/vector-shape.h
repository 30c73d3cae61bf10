#ifndef RENDER_VECTOR_SHAPE_H
#define RENDER_VECTOR_SHAPE_H
/* What strokes look like as shapes: sprites become dots, line segments lines, and strokes with a texture areas, as broad along the
 * stroke as its texture has ink there. Each leaves as much ink as what the painter draws in pixels: it is moved together, so that
 * edges are sharp at any size. Where the mask hides a stroke, its shape ends; but not where that is for so short a way that nobody sees
 * it on the page, and of what is seen for as short a way some are longer and the others not there.
 *
 * Const once made; any number of threads may ask. */
#include "render/stroke.h"

enum vector_form { VECTOR_DOTS, VECTOR_LINES, VECTOR_AREAS };

/* Across a stroke's axis, from end to end. */
#define VECTOR_STATIONS 12
struct vector_profile {
	/* In half widths of the stroke: middle and half of what is inked there. */
	float middle[VECTOR_STATIONS], half[VECTOR_STATIONS];
	float opacity; /* of the ink */
};

struct vector_shaper {
	const struct frame_layer *layer;
	const visibility_mask *mask; /* NULL: nothing is hidden */
	uint32_t width, height;      /* of the picture */
	float fine_px;               /* shorter than that nobody sees on the page */
	float edge_px;               /* edges of areas lie no farther from where they should */
	enum vector_form form;
	struct vector_profile profile[STROKE_TEXTURE_VARIANTS]; /* of areas */
	float disc; /* above 0: strokes are round whatever they lie on, and dots of so many of their half lengths */
};
struct vector_shaper vector_shaper_of(const struct frame_layer *l, const visibility_mask *m,
	uint32_t width, uint32_t height, float fine_px);

/* Of a dot its middle, of a line both ends, of an area what goes around it; in pixels of the picture. */
#define VECTOR_CORNERS_MOST (2 * (VECTOR_STATIONS + 2))
struct vector_shape {
	uint32_t corners;
	float corner[VECTOR_CORNERS_MOST][2];
};
/* A stroke that something stands before comes in parts: at most so many. */
#define VECTOR_PARTS_MOST 6
/* How many there are; 0: nothing of it is seen. */
uint32_t vector_shapes_of(const struct vector_shaper *v, const struct stroke *s,
	struct vector_shape ret[VECTOR_PARTS_MOST]);

/* What the shapes of a stroke are drawn with. */
float vector_width_px(const struct vector_shaper *v, const struct stroke *s); /* areas: 0 */
float vector_alpha(const struct vector_shaper *v, const struct stroke *s);

#endif
