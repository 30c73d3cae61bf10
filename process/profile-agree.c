#include "process/profile-agree.h"
#include "process/profile-places.h"
#include <math.h>
#include <string.h>

/* Pieces tell of the same edge where they are so near, and in spacings, and go the same way. */
#define SAME_M        0.006
#define SAME_SPACINGS 0.2
#define SAME_COS      0.985 /* 10 degrees */
#define PAST_M        0.05
#define STEP_M        0.05
/* More looks than this, on the mean along it, show what stays. */
#define LOOKS_LEAST 2
/* And those so near are of one edge if no look shows both. */
#define RIVAL_M        0.02
#define RIVAL_SPACINGS 0.7
#define RIVAL_SHARE    0.5

struct shown {
	struct profile_piece piece;
	uint32_t look;       /* its own */
	uint8_t looks;       /* a bit of each that shows most of it */
	double mean;         /* how many do along it */
	double from_m, to_m; /* of the piece: the part that is not its own look's alone */
};

struct agreeing {
	GArray *all; /* of struct shown */
	struct places places;
};

static struct shown *shown_at(const struct agreeing *a, uint32_t i)
{
	return &g_array_index(a->all, struct shown, i);
}

static bool goes_along(const struct profile_piece *p, const struct profile_piece *q)
{
	double cosine = 0;
	for (int k = 0; k < 3; k++)
		cosine += p->line.along[k] * q->line.along[k];
	return fabs(cosine) > SAME_COS;
}

static bool passes(const struct profile_piece *q, const double at[3], double within_m)
{
	double along = straight_along(&q->line, at);
	return along > q->from_m - PAST_M && along < q->to_m + PAST_M &&
	       straight_off(&q->line, at) < within_m;
}

/* A bit of each look that has a piece at this place of the piece. */
static uint8_t looks_at(
	const struct agreeing *a, const struct shown *s, const GArray *near, double along_m)
{
	uint8_t looks = (uint8_t)(1u << s->look);
	double at[3];
	straight_place(&s->piece.line, along_m, at);
	for (guint n = 0; n < near->len; n++) {
		const struct shown *other = shown_at(a, g_array_index(near, uint32_t, n));
		if (!(looks >> other->look & 1) && goes_along(&s->piece, &other->piece) &&
			passes(&other->piece, at,
				SAME_M + SAME_SPACINGS * (double)s->piece.spacing_m))
			looks |= (uint8_t)(1u << other->look);
	}
	return looks;
}

/* Cuts off what only its own look shows at either end, and counts those that show the rest. */
static void count_looks(const struct agreeing *a, struct shown *s)
{
	struct profile_piece *p = &s->piece;
	g_autoptr(GArray) near = places_near(&a->places, a->all->len, p, 0);
	double length = profile_piece_length(p), from_m = p->from_m;
	uint32_t steps = MAX((uint32_t)(length / STEP_M), 1), count[PROFILE_AGREE_LOOKS] = { 0 },
		 sum = 0, first = steps, end = 0;
	g_autofree uint8_t *looks = g_malloc(steps);
	for (uint32_t n = 0; n < steps; n++) {
		looks[n] = looks_at(a, s, near, from_m + (n + 0.5) * length / steps);
		if (looks[n] != 1u << s->look) {
			first = MIN(first, n);
			end = n + 1;
		}
	}
	for (uint32_t n = first; n < end; n++)
		for (uint32_t look = 0; look < PROFILE_AGREE_LOOKS; look++) {
			count[look] += looks[n] >> look & 1;
			sum += looks[n] >> look & 1;
		}
	if (first >= end)
		return;
	s->from_m = from_m + first * length / steps;
	s->to_m = from_m + end * length / steps;
	s->mean = (double)sum / (end - first);
	for (uint32_t look = 0; look < PROFILE_AGREE_LOOKS; look++)
		if (2 * count[look] > end - first)
			s->looks |= (uint8_t)(1u << look);
}

static void cut_all(struct agreeing *a)
{
	for (uint32_t i = 0; i < a->all->len; i++) {
		struct shown *s = shown_at(a, i);
		s->piece.from_m = s->from_m;
		s->piece.to_m = s->to_m;
	}
}

static int by_looks(const void *a, const void *b)
{
	const struct shown *x = a, *y = b;
	int count[2] = { (int)lrint(2 * x->mean), (int)lrint(2 * y->mean) };
	if (count[0] != count[1])
		return count[1] - count[0];
	int by = profile_piece_by_worth(&x->piece, &y->piece);
	return by ? by : (x->look > y->look) - (x->look < y->look);
}

/* How much of the piece runs beside the other. */
static double shared_m(const struct profile_piece *p, const struct profile_piece *q)
{
	double at[2], end[3];
	for (int e = 0; e < 2; e++) {
		straight_place(&p->line, e ? p->to_m : p->from_m, end);
		at[e] = straight_along(&q->line, end);
	}
	return fmax(fmin(fmax(at[0], at[1]), q->to_m) - fmax(fmin(at[0], at[1]), q->from_m), 0);
}

/* Whether what more looks show, and that is kept already, tells of the same edge. kept: numbers of these, which places know. */
static bool has_rival(const struct agreeing *a, const struct places *places, const GArray *kept,
	const struct shown *s)
{
	const struct profile_piece *p = &s->piece;
	g_autoptr(GArray) near = places_near(places, kept->len, p, 0);
	double middle[3], sum = 0;
	straight_place(&p->line, (p->from_m + p->to_m) / 2, middle);
	for (guint n = 0; n < near->len; n++) {
		const struct shown *other = shown_at(
			a, g_array_index(kept, uint32_t, g_array_index(near, uint32_t, n)));
		if (!(other->looks & s->looks) && goes_along(p, &other->piece) &&
			straight_off(&other->piece.line, middle) <
				RIVAL_M + RIVAL_SPACINGS * (double)p->spacing_m)
			sum += shared_m(p, &other->piece);
	}
	return sum > RIVAL_SHARE * profile_piece_length(p);
}

static GArray *keep(const struct agreeing *a)
{
	GArray *ret = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	g_autoptr(GArray) kept = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	struct places places;
	places_init(&places);
	for (uint32_t i = 0; i < a->all->len; i++) {
		const struct shown *s = shown_at(a, i);
		if (s->mean <= LOOKS_LEAST || has_rival(a, &places, kept, s))
			continue;
		places_add(&places, &s->piece, s->piece.from_m, s->piece.to_m, kept->len);
		g_array_append_val(kept, i);
		g_array_append_val(ret, s->piece);
	}
	places_clear(&places);
	return ret;
}

GArray *profile_agree(GArray *const *found, uint32_t looks, bool single_thread)
{
	struct agreeing a = { .all = g_array_new(FALSE, FALSE, sizeof(struct shown)) };
	places_init(&a.places);
	for (uint32_t look = 0; look < looks; look++)
		for (guint n = 0; n < found[look]->len; n++) {
			struct shown s = { .piece = g_array_index(
						   found[look], struct profile_piece, n),
				.look = look };
			places_add(&a.places, &s.piece, s.piece.from_m, s.piece.to_m, a.all->len);
			g_array_append_val(a.all, s);
		}
#pragma omp parallel for schedule(dynamic, 64) if (!single_thread)
	for (uint32_t i = 0; i < a.all->len; i++)
		count_looks(&a, shown_at(&a, i));
	cut_all(&a);
	g_array_sort(a.all, by_looks);
	GArray *ret = keep(&a);
	places_clear(&a.places);
	g_array_unref(a.all);
	return ret;
}
