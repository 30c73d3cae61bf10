#include "process/profile-cross.h"
#include "process/profile-places.h"
#include <math.h>

/* They cross where they pass each other so near, and go on on either side farther than anybody could mistake the one for the other: what ends
 * before that is a corner, or part of a round edge. */
#define NEAR_M        0.05
#define NEAR_SPACINGS 1.0
#define CROSS_COS     0.95 /* 18 degrees */

/* How far along both they come nearest to each other, where they cross. */
static bool cross(const struct profile_piece *p, const struct profile_piece *q, double ret[2])
{
	double cosine = 0, a = 0, b = 0, spacing_m = (double)fmaxf(p->spacing_m, q->spacing_m),
	       square = 0;
	for (int k = 0; k < 3; k++) {
		cosine += p->line.along[k] * q->line.along[k];
		a += (q->line.at[k] - p->line.at[k]) * p->line.along[k];
		b += (p->line.at[k] - q->line.at[k]) * q->line.along[k];
	}
	if (fabs(cosine) > CROSS_COS)
		return false;
	double past_m = profile_piece_off_m(spacing_m) / sqrt(1 - cosine * cosine);
	ret[0] = (a + cosine * b) / (1 - cosine * cosine);
	ret[1] = (b + cosine * a) / (1 - cosine * cosine);
	if (ret[0] < p->from_m + past_m || ret[0] > p->to_m - past_m ||
		ret[1] < q->from_m + past_m || ret[1] > q->to_m - past_m)
		return false;
	double at[2][3];
	straight_place(&p->line, ret[0], at[0]);
	straight_place(&q->line, ret[1], at[1]);
	for (int k = 0; k < 3; k++)
		square += (at[0][k] - at[1][k]) * (at[0][k] - at[1][k]);
	return sqrt(square) < NEAR_M + NEAR_SPACINGS * spacing_m;
}

/* Rails do, and colours. */
static bool may_cross(const struct profile_piece *p, const struct profile_piece *q)
{
	return p->kind == q->kind && p->kind > PROFILE_END;
}

static bool is_of_building(const struct profile_piece *p, const struct profile_options *o)
{
	return o->leaf_class && o->leaf_class[p->leaf] == CLASS_BUILDING;
}

static void cut(struct profile_piece *p, const struct profile_piece *q)
{
	double at[2];
	if (may_cross(p, q) || !cross(p, q, at))
		return;
	if (at[0] - p->from_m > p->to_m - at[0])
		p->to_m = at[0];
	else
		p->from_m = at[0];
}

void profile_cross_cut(GArray *pieces, const struct profile_options *o)
{
	struct places places;
	guint kept = 0;
	places_init(&places);
	for (guint n = 0; n < pieces->len; n++) {
		struct profile_piece p = g_array_index(pieces, struct profile_piece, n);
		double was_m = profile_piece_length(&p);
		g_autoptr(GArray) near = places_near(&places, kept, &p, 0);
		for (guint k = 0; k < near->len && !is_of_building(&p, o); k++)
			cut(&p, &g_array_index(pieces, struct profile_piece,
					g_array_index(near, uint32_t, k)));
		bool is_cut = profile_piece_length(&p) < was_m;
		if (is_cut && profile_piece_length(&p) < (double)o->length_least_m)
			continue;
		places_add(&places, &p, p.from_m, p.to_m, kept);
		g_array_index(pieces, struct profile_piece, kept++) = p;
	}
	g_array_set_size(pieces, kept);
	places_clear(&places);
}
