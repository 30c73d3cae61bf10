#ifndef RENDER_SPLAT_H
#define RENDER_SPLAT_H
/* Coloured points: what lies at the depth of the mask is mixed, each point by a soft disc of its own projected size, so that noise and
 * seams between scans even out (Botsch et al. 2005, "High-Quality Surface Splatting on Today's GPUs": two passes). */
#include "render/bands.h"

/* Sums of light and weights, of all chunks whose pipeline has a step "points". Planes must be 0 before. */
void splat_band(const struct band *b, const frame *f, const visibility_mask *m,
	const struct chunk_view *views, uint32_t count, float *const light[3], float *weight);
/* NULL: this pipeline shows none. */
const struct points_step *splat_step(const frame *f, uint8_t pipeline);

#endif
