#ifndef RENDER_FILTER_BILATERAL_H
#define RENDER_FILTER_BILATERAL_H
/* The bilateral filter along one axis, rows at a time. Internal to filter-bilateral.c. */
#include "render/filter-planes.h"

#define BILATERAL_RADIUS_MOST 64u
struct bilateral_pass {
	const float (*from)[3]; /* CIELab */
	float (*to)[3];
	uint32_t width, height, radius;
	bool is_down;
	float per_tone; /* 1 / (2 sigma^2) of colours */
	float weight[BILATERAL_RADIUS_MOST + 1];
};
LANES_DECLARE(void, filter_bilateral_rows, (const void *pass, uint32_t from, uint32_t end));

#endif
