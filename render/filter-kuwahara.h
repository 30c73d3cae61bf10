#ifndef RENDER_FILTER_KUWAHARA_H
#define RENDER_FILTER_KUWAHARA_H
/* Kuwahara's filter, rows at a time. Internal to filter-kuwahara.c. */
#include "render/filter.h"

struct kuwahara_pass {
	const struct filter_image *image;
	uint32_t radius;
	float softness;
};
/* Sums of squares stay below 2^31. */
#define KUWAHARA_RADIUS_MOST 100u
LANES_DECLARE(void, filter_kuwahara_rows, (const void *pass, uint32_t from, uint32_t end));

#endif
