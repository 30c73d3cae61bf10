#ifndef RENDER_SPLAT_LANES_H
#define RENDER_SPLAT_LANES_H
/* Coloured points of one chunk, eight at a time. Internal to splat.c. */
#include "render/splat.h"

LANES_DECLARE(void, splat_chunk,
	(const struct band *b, const frame *f, const visibility_mask *m, const struct chunk_view *v,
		const struct points_step *step, float *const light[3], float *weight));

#endif
