#include "render/plane-lanes.h"
#include "render/splat-lanes.h"

const struct points_step *splat_step(const frame *f, uint8_t pipeline)
{
	const struct step *step = frame_step(f, pipeline, "points");
	return step ? &step->points : NULL;
}

static void add_planes(const struct band *b, const frame *f, const visibility_mask *m,
	float *const light[3], float *weight)
{
	uint32_t count = m->planes ? m->planes->count : 0;
	for (uint32_t n = 0; n < count; n++) {
		const void *texel = f->scene->planes->texel;
		if (splat_step(f, m->planes->view[n].pipeline))
			LANES_OF(f->lanes, plane_light)(b, m, m->planes, n, texel, light, weight);
	}
}

void splat_band(const struct band *b, const frame *f, const visibility_mask *m,
	const struct chunk_view *views, uint32_t count, float *const light[3], float *weight)
{
	add_planes(b, f, m, light, weight);
	for (uint32_t n = 0; n < count; n++) {
		const struct points_step *step = splat_step(f, views[n].pipeline);
		if (step && mask_may_show(m, &views[n], b->from, b->from + b->rows))
			LANES_OF(f->lanes, splat_chunk)(b, f, m, &views[n], step, light, weight);
	}
}
