#include "render/bench-coherence-private.h"
#include <math.h>

static const struct scene_chunk *chunk_of(const scene *s, uint32_t point)
{
	uint32_t low = 0, high = s->chunks;
	while (high - low > 1) {
		uint32_t middle = low + (high - low) / 2;
		if (s->chunk[middle].first <= point)
			low = middle;
		else
			high = middle;
	}
	return &s->chunk[low];
}

static void place_of(const scene *s, uint32_t point, double ret_m[3])
{
	const struct scene_chunk *c = chunk_of(s, point);
	scene_position(s, c, point - c->first, ret_m);
}

static void lay_out(const stroke_list *l, float *alpha_of_point, bool clear)
{
	for (uint32_t n = 0; n < l->count; n++)
		alpha_of_point[l->stroke[n].point] = clear ? 0 : l->stroke[n].alpha;
}

static void compare(struct stroke_tally *t, float before, float now)
{
	float step = fabsf(now - before);
	t->compared++;
	t->jumped += step > STEP_MOST;
	t->step_most = fmaxf(t->step_most, step);
}

void stroke_tally_add(struct stroke_tally *t, const scene *s, const struct shot *before,
	const struct shot *now, uint32_t layer, float *const scratch[2])
{
	const stroke_list *was = &before->lists[layer], *is = &now->lists[layer];
	lay_out(was, scratch[0], false);
	lay_out(is, scratch[1], false);
	for (uint32_t n = 0; n < was->count; n++) {
		uint32_t point = was->stroke[n].point;
		double place_m[3];
		place_of(s, point, place_m);
		if (!reproject_shows(&now->camera, now->mask, place_m))
			continue;
		t->shown++;
		t->kept += scratch[1][point] > 0;
		if (reproject_shows(&before->camera, before->mask, place_m))
			compare(t, was->stroke[n].alpha, scratch[1][point]);
	}
	for (uint32_t n = 0; n < is->count; n++) {
		uint32_t point = is->stroke[n].point;
		double place_m[3];
		if (scratch[0][point] > 0)
			continue;
		place_of(s, point, place_m);
		if (reproject_shows(&before->camera, before->mask, place_m) &&
			reproject_shows(&now->camera, now->mask, place_m))
			compare(t, 0, is->stroke[n].alpha);
	}
	lay_out(was, scratch[0], true);
	lay_out(is, scratch[1], true);
}
