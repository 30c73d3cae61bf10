#include "render/bench-coherence-private.h"
#include <math.h>

/* The same place of a line in another picture is no farther than this from a link there: links begin anywhere. */
#define APART_PX 4.0

/* The links of a line, which follow each other. */
static const struct stroke *links_of(const stroke_list *l, uint32_t line, uint32_t *ret_count)
{
	uint32_t low = 0, high = l->count, end;
	while (low < high) {
		uint32_t middle = (low + high) / 2;
		if (l->stroke[middle].point < line)
			low = middle + 1;
		else
			high = middle;
	}
	for (end = low; end < l->count && l->stroke[end].point == line;)
		end++;
	*ret_count = end - low;
	return l->stroke + low;
}

/* How dark the line is at a place of the picture; 0: it is not drawn there. */
static float alpha_at(const stroke_list *l, uint32_t line, const double px[2])
{
	uint32_t count;
	const struct stroke *link = links_of(l, line, &count);
	double nearest = INFINITY;
	float alpha = 0;
	for (uint32_t n = 0; n < count; n++) {
		double away = hypot((double)link[n].x_px - px[0], (double)link[n].y_px - px[1]) -
			      (double)link[n].half_length_px;
		if (away < nearest) {
			nearest = away;
			alpha = link[n].alpha;
		}
	}
	return nearest <= APART_PX ? alpha : 0;
}

/* Where a link of one shot is in the other one; false: it is not to be seen there, or was hidden itself. */
static bool find_in(const struct shot *from, const struct stroke *s, const struct shot *to,
	double ret_px[2], bool *ret_own)
{
	double px[2] = { (double)s->x_px, (double)s->y_px }, depth_m = 1 / (double)s->q, place_m[3],
	       deep;
	camera_place(&from->camera, px, depth_m, place_m);
	*ret_own = reproject_shows(&from->camera, from->mask, place_m);
	return reproject_shows(&to->camera, to->mask, place_m) &&
	       reproject_place(&from->camera, px, depth_m, &to->camera, ret_px, &deep);
}

void line_tally_add(
	struct stroke_tally *t, const struct shot *before, const struct shot *now, uint32_t layer)
{
	const stroke_list *was = &before->lists[layer], *is = &now->lists[layer];
	double px[2];
	bool own;
	for (uint32_t n = 0; n < was->count; n++) {
		if (!find_in(before, &was->stroke[n], now, px, &own))
			continue;
		float alpha = alpha_at(is, was->stroke[n].point, px);
		t->shown++;
		t->kept += alpha > 0;
		if (own)
			stroke_tally_compare(t, was->stroke[n].alpha, alpha);
	}
	for (uint32_t n = 0; n < is->count; n++)
		if (find_in(now, &is->stroke[n], before, px, &own) && own &&
			!(alpha_at(was, is->stroke[n].point, px) > 0))
			stroke_tally_compare(t, 0, is->stroke[n].alpha);
}
