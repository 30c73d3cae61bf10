#ifndef RENDER_LENS_H
#define RENDER_LENS_H
/* A camera as points, strokes and pixels are reckoned with it, in floats, one at a time or eight. What is written here with macros takes
 * both. With a pinhole camera all of it is to the last bit what is plainly said without them: a product with 1, a sum with 0.
 *
 * On the screen a place is (px - middle) / focal_px right and down, at the depth of 1 as a pinhole camera has it. */
#include "render/camera.h"
#include <math.h>

struct lens {
	float focal_px, middle_x, middle_y, near_m;
	float width, height; /* of the picture, or the window */
	float far_m; /* of a parallel camera nothing is drawn beyond it, to the point; else INFINITY: chunks alone tell */
	float fan;   /* 1: rays fan out from the eye; 0: they are parallel */
	float parallel_m;  /* of struct camera */
	float by_parallel; /* 1 / parallel_m; 0 of a pinhole camera */
	float begin_m; /* where depths begin that styles speak of: at the eye, or where a parallel camera begins to draw */
};

static inline struct lens lens_of(const struct camera *c)
{
	bool is_parallel = c->parallel_m > 0;
	return (struct lens){ .focal_px = (float)c->focal_px,
		.middle_x = (float)camera_middle_x(c),
		.middle_y = (float)camera_middle_y(c),
		.width = (float)c->width,
		.height = (float)c->height,
		.near_m = (float)c->near_m,
		.far_m = is_parallel ? (float)c->far_m : INFINITY,
		.fan = is_parallel ? 0 : 1,
		.parallel_m = is_parallel ? (float)c->parallel_m : 0,
		.by_parallel = is_parallel ? 1 / (float)c->parallel_m : 0,
		.begin_m = is_parallel ? (float)c->near_m : 0 };
}

/* camera_scale_m(): what lies at this depth is focal_px / that pixels a metre. */
#define LENS_SCALE_M(lens, depth_m) ((depth_m) * (lens)->fan + (lens)->parallel_m)
/* So much of that is the depth. */
#define LENS_STRETCH(lens, depth_m) ((lens)->fan + (depth_m) * (lens)->by_parallel)

#endif
