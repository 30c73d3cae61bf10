#include "process/plane-inside.h"
#include <math.h>
#include <string.h>

#define STRIPE_M     0.2f
#define STRIPES_MOST 4096

struct side {
	float a[2], b[2];
	bool is_met; /* another plane is beside it */
};

struct plane_inside {
	float low, stripe_m, within_m;
	uint32_t stripes;
	uint32_t *first; /* of each stripe, and of the end */
	struct side *side;
};

static bool is_met(const struct plane_draft *d, uint32_t a, uint32_t b)
{
	if (!d->met->len)
		return false;
	const struct plane_met *x = &g_array_index(d->met, struct plane_met, a),
			       *y = &g_array_index(d->met, struct plane_met, b);
	for (int n = 0; n < 4; n++)
		if (x->with[n & 1] && x->with[n & 1] == y->with[n >> 1])
			return true;
	return false;
}

static void each_side(const struct plane_draft *d,
	void (*take)(plane_inside *i, const struct side *s), plane_inside *i)
{
	for (guint n = 0; n < d->ring->len; n++) {
		const struct plane_ring *r = &g_array_index(d->ring, struct plane_ring, n);
		const float(*p)[2] =
			(const void *)((float(*)[2])(void *)d->vertex->data + r->first);
		for (uint32_t k = 0; k < r->count; k++) {
			struct side s;
			s.is_met = is_met(d, r->first + k, r->first + (k + 1) % r->count);
			memcpy(s.a, p[k], sizeof s.a);
			memcpy(s.b, p[(k + 1) % r->count], sizeof s.b);
			take(i, &s);
		}
	}
}

static uint32_t stripe_of(const plane_inside *i, float v)
{
	float n = (v - i->low) / i->stripe_m;
	return (uint32_t)fminf(fmaxf(n, 0), (float)(i->stripes - 1));
}

/* Those stripes that it may be near to. */
static void span(const plane_inside *i, const struct side *s, uint32_t *ret_from, uint32_t *ret_to)
{
	*ret_from = stripe_of(i, fminf(s->a[1], s->b[1]) - i->within_m);
	*ret_to = stripe_of(i, fmaxf(s->a[1], s->b[1]) + i->within_m);
}

static void count_side(plane_inside *i, const struct side *s)
{
	uint32_t from, to;
	span(i, s, &from, &to);
	for (uint32_t n = from; n <= to; n++)
		i->first[n + 1]++;
}

/* first[n + 1] is where the next side of the stripe goes, while they are put. */
static void put_side(plane_inside *i, const struct side *s)
{
	uint32_t from, to;
	span(i, s, &from, &to);
	for (uint32_t n = from; n <= to; n++)
		i->side[i->first[n + 1]++] = *s;
}

plane_inside *plane_inside_new(const struct plane_draft *d)
{
	plane_inside *i = g_new0(plane_inside, 1);
	float low = INFINITY, high = -INFINITY;
	for (guint n = 0; n < d->vertex->len; n++) {
		float v = ((float(*)[2])(void *)d->vertex->data)[n][1];
		low = fminf(low, v);
		high = fmaxf(high, v);
	}
	if (!d->vertex->len)
		low = high = 0;
	i->within_m = fmaxf(PLANE_INSIDE_WITHIN_M, PLANE_INSIDE_SPACINGS * d->spacing_m);
	i->low = low - i->within_m;
	i->stripe_m = fmaxf(STRIPE_M, (high - low + 2 * i->within_m) / (STRIPES_MOST - 1));
	i->stripes = (uint32_t)((high - low + 2 * i->within_m) / i->stripe_m) + 1;
	i->first = g_new0(uint32_t, i->stripes + 2);
	each_side(d, count_side, i);
	uint32_t sum = 0;
	for (uint32_t n = 1; n <= i->stripes; n++) {
		uint32_t many = i->first[n];
		i->first[n] = sum;
		sum += many;
	}
	i->side = g_new(struct side, sum + 1);
	each_side(d, put_side, i);
	return i;
}

void plane_inside_free(plane_inside *i)
{
	if (!i)
		return;
	g_free(i->first);
	g_free(i->side);
	g_free(i);
}

static float away_from(const struct side *s, const float at[2])
{
	float way[2] = { s->b[0] - s->a[0], s->b[1] - s->a[1] },
	      from[2] = { at[0] - s->a[0], at[1] - s->a[1] };
	float length2 = way[0] * way[0] + way[1] * way[1];
	float part = length2 > 0 ? (way[0] * from[0] + way[1] * from[1]) / length2 : 0;
	part = fminf(fmaxf(part, 0), 1);
	return hypotf(from[0] - part * way[0], from[1] - part * way[1]);
}

bool plane_inside_near(const plane_inside *i, const float at[2], float within_m)
{
	float n = (at[1] - i->low) / i->stripe_m;
	bool is_inside = false;
	within_m = fminf(within_m, i->within_m);
	if (!(n >= 0 && n < (float)i->stripes))
		return false;
	uint32_t stripe = (uint32_t)n;
	for (uint32_t k = i->first[stripe]; k < i->first[stripe + 1]; k++) {
		const struct side *s = &i->side[k];
		if ((s->a[1] <= at[1]) != (s->b[1] <= at[1])) {
			float part = (at[1] - s->a[1]) / (s->b[1] - s->a[1]);
			if (s->a[0] + part * (s->b[0] - s->a[0]) > at[0])
				is_inside = !is_inside;
		}
		if (within_m > 0 && away_from(s, at) <= within_m)
			return true;
	}
	return is_inside;
}

bool plane_inside_is_border(const plane_inside *i, const float at[2], float within_m)
{
	float n = (at[1] - i->low) / i->stripe_m;
	within_m = fminf(within_m, i->within_m);
	if (!(n >= 0 && n < (float)i->stripes))
		return false;
	uint32_t stripe = (uint32_t)n;
	for (uint32_t k = i->first[stripe]; k < i->first[stripe + 1]; k++)
		if (!i->side[k].is_met && away_from(&i->side[k], at) <= within_m)
			return true;
	return false;
}
