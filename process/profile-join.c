#include "process/profile-join.h"
#include "process/profile-places.h"
#include <math.h>
#include <string.h>

/* Pieces side by side are one when they are so near, and half a spacing; those longer than LONG_M when their directions agree the better. */
#define BESIDE_M        0.012
#define BESIDE_SPACINGS 0.5
#define BESIDE_GUESSED  1.2 /* spacings, where beams do not tell ends any better */
#define LONG_M          0.5
#define SAME_LONG_COS   0.9945 /* 6 degrees */
#define SAME_SHORT_COS  0.978  /* 12 */
/* One behind the other they are one when what is between is shorter. */
#define BETWEEN_M 0.2
/* What makes one longer by so much moves it; but they are parts of something that is bent when they lie so far off one line, root mean square. */
#define LONGER_M 0.1
#define BENT_M   0.003
/* What grew in feature points is explained by edges that are so near, and go the same way, along this part of it. */
#define EXPLAINS_M             0.02
#define EXPLAINS_SPACINGS      0.8
#define EXPLAINS_COS           0.966 /* 15 degrees */
#define EXPLAINS_SHARE         0.75
#define EXPLAINS_STEP_M        0.1
#define EXPLAINS_EDGE_M        0.008
#define EXPLAINS_MARK_M        0.06 /* feature points of edges, grown askew */
#define EXPLAINS_EDGE_SPACINGS 0.3

/* ---- twice, or in parts ---- */

struct profile_joiner {
	struct profile_options options;
	GArray *pieces; /* of struct profile_piece: those that stay */
	GArray *sums;   /* of struct line_sums, of each: all that became part of it */
	struct places places;
};

profile_joiner *profile_joiner_new(const struct profile_options *options)
{
	profile_joiner *j = g_new0(profile_joiner, 1);
	j->options = *options;
	j->pieces = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	j->sums = g_array_new(FALSE, FALSE, sizeof(struct line_sums));
	places_init(&j->places);
	return j;
}

void profile_joiner_free(profile_joiner *j)
{
	if (!j)
		return;
	g_array_unref(j->pieces);
	g_array_unref(j->sums);
	places_clear(&j->places);
	g_free(j);
}

static struct profile_piece *piece_at(const GArray *pieces, uint32_t i)
{
	return &g_array_index(pieces, struct profile_piece, i);
}

static double cosine_of(const struct profile_piece *a, const struct profile_piece *b)
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += a->line.along[k] * b->line.along[k];
	return sum;
}

static bool is_parallel(const struct profile_piece *a, const struct profile_piece *b)
{
	double shorter = fmin(profile_piece_length(a), profile_piece_length(b));
	return fabs(cosine_of(a, b)) > (shorter > LONG_M ? SAME_LONG_COS : SAME_SHORT_COS);
}

static struct line_sums sums_of(const struct profile_piece *p)
{
	struct line_sums sums = { 0 };
	for (int n = 0; n < 3; n++) {
		double at[3];
		straight_place(&p->line, p->from_m + n * profile_piece_length(p) / 2, at);
		line_sums_add(&sums, at, pow(profile_piece_length(p), 3) * (double)p->support);
	}
	return sums;
}

static struct line_sums sums_with(
	const profile_joiner *j, uint32_t number, const struct profile_piece *p)
{
	struct line_sums all = g_array_index(j->sums, struct line_sums, number);
	const struct line_sums more = sums_of(p);
	all.weight += more.weight;
	for (int k = 0; k < 6; k++) {
		all.product[k] += more.product[k];
		if (k < 3)
			all.sum[k] += more.sum[k];
	}
	return all;
}

static bool is_bent_with(const profile_joiner *j, uint32_t number, const struct profile_piece *p)
{
	const struct line_sums all = sums_with(j, number, p);
	struct straight line;
	double off_m;
	return line_sums_fit(&all, &line, &off_m) && off_m > BENT_M;
}

/* With one more part, the line is the one that is nearest to all of them. */
static void fit_anew(profile_joiner *j, uint32_t number, const struct profile_piece *p)
{
	struct profile_piece *q = piece_at(j->pieces, number);
	struct line_sums *all = &g_array_index(j->sums, struct line_sums, number);
	struct straight line;
	double from[3], to[3];
	*all = sums_with(j, number, p);
	if (!line_sums_fit(all, &line, NULL))
		return;
	straight_place(&q->line, q->from_m, from);
	straight_place(&q->line, q->to_m, to);
	q->line = line;
	q->from_m = straight_along(&line, from);
	q->to_m = straight_along(&line, to);
	if (q->from_m > q->to_m) {
		for (int k = 0; k < 3; k++)
			q->line.along[k] = -q->line.along[k];
		q->from_m = -q->from_m;
		q->to_m = -q->to_m;
	}
}

/* Of p, whose ends are at these places along q, what lies beyond the end of q that it lies beyond the farthest. */
static void leave_past(struct profile_piece *p, const double at[2], const struct profile_piece *q)
{
	double before = q->from_m - fmin(at[0], at[1]), behind = fmax(at[0], at[1]) - q->to_m,
	       cut = fmax(profile_piece_length(p) - fmax(before, behind), 0);
	if ((before > behind) == (at[0] < at[1]))
		p->to_m -= cut;
	else
		p->from_m += cut;
}

/* Takes p into q as far as they are one; true: nothing is left of p. */
static bool absorb(profile_joiner *j, uint32_t number, struct profile_piece *p)
{
	struct profile_piece *q = piece_at(j->pieces, number);
	double spacings = p->is_guessed && q->is_guessed ? BESIDE_GUESSED : BESIDE_SPACINGS,
	       beside_m = BESIDE_M + spacings * (double)fmaxf(p->spacing_m, q->spacing_m);
	double end[2][3], at[2], off[2];
	if (!is_parallel(p, q))
		return false;
	for (int e = 0; e < 2; e++) {
		straight_place(&p->line, e ? p->to_m : p->from_m, end[e]);
		at[e] = straight_along(&q->line, end[e]);
		off[e] = straight_off(&q->line, end[e]);
	}
	double from = fmin(at[0], at[1]), to = fmax(at[0], at[1]);
	if (from > q->to_m + BETWEEN_M || to < q->from_m - BETWEEN_M)
		return false;
	if (off[0] <= beside_m && off[1] <= beside_m) {
		double whole = fmax(to, q->to_m) - fmin(from, q->from_m);
		bool extends = whole > LONGER_M + profile_piece_length(q);
		if (extends && is_bent_with(j, number, p)) {
			leave_past(p, at, q);
			return false;
		}
		places_add(&j->places, q, from, fmin(to, q->from_m), number);
		places_add(&j->places, q, fmax(from, q->to_m), to, number);
		double both = profile_piece_length(p) * (double)p->support +
			      profile_piece_length(q) * (double)q->support;
		double shared = fmax(fmin(to, q->to_m) - fmax(from, q->from_m), 0);
		q->support = fmaxf(q->support * (float)(profile_piece_length(q) / whole),
			(float)fmin((both - shared) / whole, 1));
		q->from_m = fmin(q->from_m, from);
		q->to_m = fmax(q->to_m, to);
		/* What lies beside it all along may be another edge: the longer one is known better. */
		if (extends)
			fit_anew(j, number, p);
		return true;
	}
	/* They part, or meet, at a small angle: what lies beside the other goes. */
	int near = off[0] < off[1] ? 0 : 1;
	if (off[near] > beside_m)
		return false;
	double past_m = near ? fmax(q->from_m - at[1], at[1] - q->to_m)
			     : fmax(q->from_m - at[0], at[0] - q->to_m);
	if (past_m > 0)
		return false;
	double other = at[1 - near] > at[near] ? q->to_m : q->from_m;
	double share = fabs(at[1 - near] - at[near]) > 1e-6
			       ? (other - at[near]) / (at[1 - near] - at[near])
			       : 1;
	double part = (beside_m - off[near]) / (off[1 - near] - off[near]);
	double cut = fmin(share, part) * profile_piece_length(p);
	if (near)
		p->to_m -= cut;
	else
		p->from_m += cut;
	return false;
}

/* All that may have to do with it, in order; caller unrefs. */
static GArray *pieces_near(const profile_joiner *j, const struct profile_piece *p, double reach_m)
{
	return places_near(&j->places, j->pieces->len, p, reach_m);
}

/* Whether the place is on the piece, as exactly as feature points tell it. */
static bool is_on(const struct profile_piece *q, const struct profile_piece *p, bool is_edge,
	const double at[3])
{
	double along = straight_along(&q->line, at), within_m = is_edge && p->kind > PROFILE_END
									? EXPLAINS_MARK_M
								: is_edge ? EXPLAINS_EDGE_M
									  : EXPLAINS_M;
	return along > q->from_m - BETWEEN_M / 2 && along < q->to_m + BETWEEN_M / 2 &&
	       straight_off(&q->line, at) <
		       within_m + (is_edge ? EXPLAINS_EDGE_SPACINGS : EXPLAINS_SPACINGS) *
					  (double)fmaxf(p->spacing_m, q->spacing_m);
}

/* Those that do not go its way are none that explain it. */
static void leave_out_crossing(
	const profile_joiner *j, const struct profile_piece *p, GArray *numbers)
{
	guint kept = 0;
	for (guint n = 0; n < numbers->len; n++) {
		uint32_t number = g_array_index(numbers, uint32_t, n);
		if (fabs(cosine_of(p, piece_at(j->pieces, number))) > EXPLAINS_COS)
			g_array_index(numbers, uint32_t, kept++) = number;
	}
	g_array_set_size(numbers, kept);
}

bool profile_joiner_explains(const profile_joiner *j, const struct profile_piece *p, bool is_edge)
{
	g_autoptr(GArray) near = pieces_near(j, p, 0);
	uint32_t steps = (uint32_t)ceil(profile_piece_length(p) / EXPLAINS_STEP_M), some = 0;
	leave_out_crossing(j, p, near);
	for (uint32_t s = 0; s <= steps && near->len; s++) {
		double at[3];
		straight_place(&p->line, p->from_m + (p->to_m - p->from_m) * s / MAX(steps, 1), at);
		for (guint n = 0; n < near->len; n++)
			if (is_on(piece_at(j->pieces, g_array_index(near, uint32_t, n)), p, is_edge,
				    at)) {
				some++;
				break;
			}
	}
	return some >= EXPLAINS_SHARE * (steps + 1);
}

void profile_joiner_add(profile_joiner *j, const struct profile_piece *piece)
{
	struct profile_piece p = *piece;
	g_autoptr(GArray) near = pieces_near(j, &p, BETWEEN_M);
	for (guint n = 0; n < near->len; n++)
		if (absorb(j, g_array_index(near, uint32_t, n), &p) ||
			profile_piece_length(&p) < (double)j->options.length_least_m / 2)
			return;
	if (profile_joiner_explains(j, &p, true))
		return;
	places_add(&j->places, &p, p.from_m, p.to_m, j->pieces->len);
	struct line_sums sums = sums_of(&p);
	g_array_append_val(j->pieces, p);
	g_array_append_val(j->sums, sums);
}

GArray *profile_joiner_pieces(const profile_joiner *j)
{
	return g_array_ref(j->pieces);
}
