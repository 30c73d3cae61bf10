#include "render/filter-trace.h"
#include "render/project-lanes.h"

/* Eight pixels of a row, on their way. */
struct walkers {
	vf x, y, way[2];
	vi going;
};

struct walk_sum {
	vf of[3], weight, weight2;
};

INLINE vi nearest(vf at, uint32_t count)
{
	return __builtin_convertvector(least(most(at, all(0)), all((float)(count - 1))) + 0.5f, vi);
}

INLINE void directions_at(const struct filter_trace *t, vf x, vf y, vf ret[2])
{
	const struct filter_image *i = &t->j->image;
	vi at = ((nearest(y, i->height) >> 1) * (int32_t)t->flow.width +
			(nearest(x, i->width) >> 1)) *
		3;
	_Static_assert(sizeof(struct filter_flow) == 3 * sizeof(float), "as it is gathered");
	for (int k = 0; k < 2; k++)
		ret[k] = (vf)gather(&t->flow.at->along[k], at, 4);
}

INLINE void add(
	const struct filter_trace *t, const struct walkers *w, float weight, struct walk_sum *s)
{
	const struct filter_image *i = &t->j->image;
	int32_t width = (int32_t)i->width;
	vf by = where(w->going, all(weight));
	s->weight += by;
	s->weight2 += by * by;
	if (t->from_rgba) {
		vi p = gather(t->from_rgba,
			nearest(w->y, i->height) * width + nearest(w->x, i->width), 4);
		for (int k = 0; k < 3; k++)
			s->of[k] += by * __builtin_convertvector(p >> 8 * k & 255, vf);
		return;
	}
	vf x = least(most(w->x, all(0)), all((float)(i->width - 1))),
	   y = least(most(w->y, all(0)), all((float)(i->height - 1)));
	vi left = __builtin_convertvector(x, vi), top = __builtin_convertvector(y, vi);
	vf u = x - __builtin_convertvector(left, vf), v = y - __builtin_convertvector(top, vf);
	vi right = lower(left + 1, (vi){ 0 } + width - 1),
	   below = lower(top + 1, (vi){ 0 } + (int32_t)i->height - 1);
	vf a = (vf)gather(t->from, top * width + left, 4),
	   b = (vf)gather(t->from, top * width + right, 4),
	   c = (vf)gather(t->from, below * width + left, 4),
	   d = (vf)gather(t->from, below * width + right, 4);
	vf upper = a + u * (b - a), under = c + u * (d - c);
	s->of[0] += by * (upper + v * (under - upper));
}

INLINE void walk(const struct filter_trace *t, struct walkers *w, struct walk_sum *s)
{
	const struct filter_image *i = &t->j->image;
	for (int n = 1; n <= t->steps; n++) {
		if (!t->is_across && n > 1) {
			vf next[2];
			directions_at(t, w->x, w->y, next);
			/* Directions have no sign of their own. */
			vi turned = (vi)(next[0] * w->way[0] + next[1] * w->way[1]) & INT32_MIN;
			for (int k = 0; k < 2; k++)
				w->way[k] = (vf)((vi)next[k] ^ turned);
		}
		w->x += w->way[0];
		w->y += w->way[1];
		w->going &= (w->x >= 0) & (w->y >= 0) & (w->x <= (float)(i->width - 1)) &
			    (w->y <= (float)(i->height - 1));
		if (!any(w->going))
			break;
		add(t, w, t->weight[n], s);
	}
}

INLINE void put(const struct filter_trace *t, size_t at, uint32_t count, const struct walk_sum *s)
{
	vf by = all(1);
	if (t->by == TRACE_MEAN)
		by = 1 / s->weight;
	if (t->by == TRACE_NOISE)
		by = 1 / root(s->weight2);
	if (!t->from_rgba) {
		vf x = s->of[0] * by;
		memcpy(t->to + at, &x, count * sizeof(float));
		return;
	}
	vi packed = (vi){ 0 } + (int32_t)0xff000000;
	for (int k = 0; k < 3; k++)
		packed |= __builtin_convertvector(least(s->of[k] * by, all(255)) + 0.5f, vi)
			  << 8 * k;
	memcpy(t->to_rgba[at], &packed, 4 * count);
}

void LANES_NAME(filter_trace_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_trace *t = data;
	uint32_t width = t->j->image.width;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < width; x += LANES) {
			struct walk_sum s = { 0 };
			struct walkers first = { (float)x + lane_number, all((float)y), { { 0 } },
				lane_number < (float)(width - x) };
			directions_at(t, first.x, first.y, first.way);
			if (t->is_across) {
				vf along = first.way[0];
				first.way[0] = -first.way[1];
				first.way[1] = along;
			}
			add(t, &first, t->weight[0], &s);
			struct walkers one = first, other = first;
			for (int k = 0; k < 2; k++)
				other.way[k] = -first.way[k];
			walk(t, &one, &s);
			walk(t, &other, &s);
			put(t, (size_t)y * width + x, MIN(LANES, width - x), &s);
		}
}
