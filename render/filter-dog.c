#include "render/filter-solid.h"
#include "render/filter-tables.h"
#include "render/filter-trace.h"
#include <math.h>

struct dog_pass {
	const struct filter_job *j;
	const struct dog_step *step;
	const float *lightness;
	const float *fine, *coarse; /* Gaussian means */
	const float *difference;    /* along the flow, instead of them */
	struct filter_solid solid;
};

static float combined(const struct dog_step *s, float fine, float coarse)
{
	return s->sharpness > 0 ? (1 + s->sharpness) * fine - s->sharpness * coarse : fine - coarse;
}

/* Along the flow (Kang et al. 2007): differences across it, in one dimension alone, whose means along it are the lines. */
static float *along_flow(struct filter_job *j, struct dog_pass *p, float sigma)
{
	const struct dog_step *k = p->step;
	size_t bytes = filter_pixels(&j->image) * sizeof(float);
	struct filter_trace t = {
		.j = j, .by = TRACE_MEAN, .is_across = true, .from = p->lightness
	};
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
		fine[at] = combined(k, fine[at], coarse[at]);
	t.is_across = false;
	t.from = fine;
	t.to = coarse;
	filter_trace_weigh(&t, fmaxf(k->flow_px * j->px, 0.5f));
	filter_trace_run(&t);
	return coarse;
}

/* ---- lines ---- */

/* 0..1: how dark the line is. */
static float line_at(const struct dog_pass *p, uint32_t x, uint32_t y)
{
	size_t at = (size_t)y * p->j->image.width + x;
	float d = p->difference ? p->difference[at] : combined(p->step, p->fine[at], p->coarse[at]);
	float over = d - p->step->threshold;
	if (over >= 0)
		return 0;
	return -tanhf(p->step->contrast * over) * filter_solid_at(&p->solid, x, y);
}

static void draw_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct dog_pass *p = data;
	const struct filter_image *i = &p->j->image;
	const struct dog_step *s = p->step;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			const uint8_t *below = s->alone ? i->paper : i->rgba[at];
			float part = line_at(p, x, y) * s->opacity, rgb[3];
			if (part > 0 && !s->alone)
				part *= filter_weight(p->j, s->where, at);
			if (!(part > 0)) {
				memcpy(i->spare[at], below, 4);
				continue;
			}
			for (int k = 0; k < 3; k++)
				rgb[k] = (float)below[k] +
					 part * ((float)s->colour[k] - (float)below[k]);
			filter_put(i->spare[at], rgb);
		}
}

void filter_dog(struct filter_job *j, const struct step *s)
{
	const struct dog_step *k = &s->dog;
	const struct filter_image *i = &j->image;
	size_t bytes = filter_pixels(i) * sizeof(float);
	float sigma = fmaxf(k->sigma_px * j->px, 0.3f),
	      *plane = filter_room_part(j->room, 4, bytes);
	struct dog_pass p = { .j = j, .step = k, .lightness = plane };
	p.solid = filter_solidity(j, 6);
	filter_lightness_plane(j, plane);
	if (k->flow_px > 0) {
		p.difference = along_flow(j, &p, sigma);
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
	filter_each_rows(j, draw_rows, &p, i->height, 16);
	if (k->alone)
		filter_finish(j, k->where);
	else
		filter_swap(&j->image);
}
