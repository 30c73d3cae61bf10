#ifndef RENDER_PLANE_LANES_H
#define RENDER_PLANE_LANES_H
/* Plane surfaces, eight pixels at a time: into the mask, as colours, as surface for filters. The rules of planes.glsl. Internal to mask.c,
 * splat.c and surface-pass.c. */
#include "render/mask-lanes.h"
#include "render/plane-view.h"
#include "render/surface-pass.h"

/* Number view of them, into a thread's picture of keys. */
LANES_DECLARE(void, plane_mask,
	(const frame *f, const struct mask_target *t, const plane_views *p, uint32_t view));
/* Where the mask has it, in a band: sums of light and weights as splat.h has them, and of surface-pass.h. */
LANES_DECLARE(void, plane_light,
	(const struct band *b, const visibility_mask *m, const plane_views *p, uint32_t view,
		const uint8_t (*texel)[4], float *const light[3], float *weight));
LANES_DECLARE(void, plane_surface,
	(const struct band *b, const visibility_mask *m, const plane_views *p, uint32_t view,
		const struct surface_desk *d));

#endif
