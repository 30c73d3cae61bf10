#include "render/bench-coherence-private.h"
#include <math.h>

/* Where it is drawn. */
static void place_of(const struct camera *c, const struct stroke *s, double ret_m[3])
{
	const double px[2] = { s->x_px, s->y_px };
	camera_place(c, px, 1 / (double)s->q, ret_m);
}

/* Of one copy of each point. */
static void lay_out(const stroke_list *l, uint32_t copy, float *alpha_of_point, bool clear)
{
	for (uint32_t n = 0; n < l->count; n++)
		if (l->stroke[n].copy == copy)
			alpha_of_point[l->stroke[n].point] = clear ? 0 : l->stroke[n].alpha;
}

void stroke_tally_compare(struct stroke_tally *t, float before, float now)
{
	float step = fabsf(now - before);
	t->compared++;
	t->jumped += step > STEP_MOST;
	t->step_most = fmaxf(t->step_most, step);
}

static void add_copy(struct stroke_tally *t, const struct shot *before, const struct shot *now,
	uint32_t layer, uint32_t copy, float *const scratch[2])
{
	const stroke_list *was = &before->lists[layer], *is = &now->lists[layer];
	double place_m[3];
	lay_out(was, copy, scratch[0], false);
	lay_out(is, copy, scratch[1], false);
	for (uint32_t n = 0; n < was->count; n++) {
		const struct stroke *s = &was->stroke[n];
		if (s->copy != copy)
			continue;
		place_of(&before->camera, s, place_m);
		if (!reproject_shows(&now->camera, now->mask, place_m))
			continue;
		t->shown++;
		t->kept += scratch[1][s->point] > 0;
		if (reproject_shows(&before->camera, before->mask, place_m))
			stroke_tally_compare(t, s->alpha, scratch[1][s->point]);
	}
	for (uint32_t n = 0; n < is->count; n++) {
		const struct stroke *s = &is->stroke[n];
		if (s->copy != copy || scratch[0][s->point] > 0)
			continue;
		place_of(&now->camera, s, place_m);
		if (reproject_shows(&before->camera, before->mask, place_m) &&
			reproject_shows(&now->camera, now->mask, place_m))
			stroke_tally_compare(t, 0, s->alpha);
	}
	lay_out(was, copy, scratch[0], true);
	lay_out(is, copy, scratch[1], true);
}

static uint32_t copies_of(const stroke_list *l)
{
	uint32_t most = 0;
	for (uint32_t n = 0; n < l->count; n++)
		most = MAX(most, l->stroke[n].copy + 1u);
	return most;
}

void stroke_tally_add(struct stroke_tally *t, const struct shot *before, const struct shot *now,
	uint32_t layer, float *const scratch[2])
{
	uint32_t copies = MAX(copies_of(&before->lists[layer]), copies_of(&now->lists[layer]));
	for (uint32_t copy = 0; copy < copies; copy++)
		add_copy(t, before, now, layer, copy, scratch);
}
