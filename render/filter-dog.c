#include "render/filter-dog.h"
#include "render/filter-tables.h"
#include "render/filter-trace.h"
#include <math.h>

/* Along the flow (Kang et al. 2007): differences across it, in one dimension alone, whose means along it are the lines. */
static float *along_flow(
	struct filter_job *j, const struct dog_step *k, const float *lightness, float sigma)
{
	size_t bytes = filter_pixels(&j->image) * sizeof(float);
	struct filter_trace t = { .j = j, .by = TRACE_MEAN, .is_across = true, .from = lightness };
	t.flow = filter_flow_find(j, dog_tensor_px(k));
	float *fine = filter_room_part(j->room, 3, bytes),
	      *coarse = filter_room_part(j->room, 5, bytes);
	t.to = fine;
	filter_trace_weigh(&t, sigma);
	filter_trace_run(&t);
	t.to = coarse;
	filter_trace_weigh(&t, sigma * k->ratio);
	filter_trace_run(&t);
	for (size_t at = 0; at < filter_pixels(&j->image); at++)
		fine[at] = DOG_COMBINED(k, fine[at], coarse[at]);
	t.is_across = false;
	t.from = fine;
	t.to = coarse;
	filter_trace_weigh(&t, fmaxf(k->flow_px * j->px, 0.5f));
	filter_trace_run(&t);
	return coarse;
}

void filter_dog(struct filter_job *j, const struct step *s)
{
	const struct dog_step *k = &s->dog;
	const struct filter_image *i = &j->image;
	size_t bytes = filter_pixels(i) * sizeof(float);
	float sigma = fmaxf(k->sigma_px * j->px, 0.3f),
	      *plane = filter_room_part(j->room, 4, bytes);
	struct dog_pass p = { .j = j, .step = k, .solid = filter_solidity(j, 6) };
	filter_lightness_plane(j, plane);
	if (k->flow_px > 0) {
		p.difference = along_flow(j, k, plane, sigma);
	} else {
		float *fine = filter_room_part(j->room, 0, bytes),
		      *coarse = filter_room_part(j->room, 1, bytes);
		struct filter_blur b = { plane, fine, false, i->width, i->height, 1, 0, NULL };
		filter_blur_run(j, &b, sigma);
		b.to = coarse;
		filter_blur_run(j, &b, sigma * k->ratio);
		p.fine = fine;
		p.coarse = coarse;
	}
	filter_each_rows(j, LANES_OF(j->lanes, filter_dog_rows), &p, i->height, 16);
	if (k->alone)
		filter_finish(j, k->where);
	else
		filter_swap(&j->image);
}
