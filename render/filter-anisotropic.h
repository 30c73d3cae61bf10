#ifndef RENDER_FILTER_ANISOTROPIC_H
#define RENDER_FILTER_ANISOTROPIC_H
/* The anisotropic Kuwahara filter (step-filters.h), rows at a time. Internal to filter-anisotropic.c.
 *
 * Weights of places in an ellipse depend on its direction and length alone. They are made once, for even steps of both, sector by sector:
 * a pixel then only adds up products. Of the eight sectors four are listed; the others are their mirror images. */
#include "render/filter-planes.h"

#define ANISOTROPIC_WAYS       48 /* directions, half around */
#define ANISOTROPIC_LENGTHS    8  /* steps of anisotropy, 0 to 1 */
#define ANISOTROPIC_SECTORS    4
#define ANISOTROPIC_REACH_MOST 64

struct anisotropic_tap {
	int32_t offset; /* of a pixel, in pixels of the wide picture */
	float weight;   /* those of a sector sum up to 1 */
};
struct anisotropic_pass {
	const struct filter_image *image;
	struct filter_flow_plane flow;
	uint16_t *ellipse; /* for each place of flow */
	float stretch, sharpness;
	/* The picture as red, green, blue, and the sum of their squares, with its last pixels going on around it. */
	float (*wide)[4];
	uint32_t pitch, reach;
	struct anisotropic_tap *tap;
	/* Of each ellipse and sector: where its taps begin; one more at the end. */
	uint32_t first[ANISOTROPIC_WAYS * ANISOTROPIC_LENGTHS * ANISOTROPIC_SECTORS + 1];
};
LANES_DECLARE(void, filter_anisotropic_widen, (const void *pass, uint32_t from, uint32_t end));
LANES_DECLARE(void, filter_anisotropic_rows, (const void *pass, uint32_t from, uint32_t end));

/* The ellipse for what runs along a place. */
static inline uint32_t anisotropic_ellipse(const struct filter_flow *flow, float stretch)
{
	float turn = atan2f(flow->along[1], flow->along[0]) * (float)(1 / G_PI),
	      length = CLAMP(flow->anisotropy * stretch, 0, 1) * (ANISOTROPIC_LENGTHS - 1);
	int way = (int)lrintf(turn * ANISOTROPIC_WAYS) + ANISOTROPIC_WAYS;
	return (uint32_t)way % ANISOTROPIC_WAYS * ANISOTROPIC_LENGTHS + (uint32_t)lrintf(length);
}

#endif
