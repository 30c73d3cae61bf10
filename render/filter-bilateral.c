#include "render/filter-bilateral.h"
#include "render/filter-tables.h"
#include <math.h>

uint32_t bilateral_weigh(float sigma_px, float ret[BILATERAL_RADIUS_MOST + 1])
{
	uint32_t radius = MIN((uint32_t)ceilf(2 * sigma_px), BILATERAL_RADIUS_MOST);
	for (uint32_t k = 0; k <= radius; k++)
		ret[k] = expf(-0.5f * (float)(k * k) / (sigma_px * sigma_px));
	return radius;
}

void filter_bilateral(struct filter_job *j, const struct step *s)
{
	const struct bilateral_step *k = &s->bilateral;
	size_t bytes = filter_pixels(&j->image) * 3 * sizeof(float);
	/* A pixel more, for vectors of four. */
	float(*one)[3] = filter_room_part(j->room, 0, bytes + 4),
	(*other)[3] = filter_room_part(j->room, 1, bytes + 4);
	struct bilateral_pass p = { .width = j->image.width,
		.height = j->image.height,
		.per_tone = 0.5f / (k->sigma_tone * k->sigma_tone) };
	p.radius = bilateral_weigh(fmaxf(k->sigma_px * j->px, 0.5f), p.weight);
	filter_to_lab(j, one);
	for (int n = 0; n < (int)k->passes && !frame_is_stopped(j->f); n++)
		for (int down = 0; down < 2; down++) {
			p.is_down = down;
			p.from = (const float(*)[3])(down ? other : one);
			p.to = down ? one : other;
			filter_each_rows(
				j, LANES_OF(j->lanes, filter_bilateral_rows), &p, p.height, 16);
		}
	filter_of_lab(j, (const float(*)[3])one, j->image.spare);
	filter_finish(j, k->where);
}
