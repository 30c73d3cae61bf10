#include "process/profile-cross.h"
#include "process/profile-places.h"
#include <math.h>

/* They cross where they pass each other so near, and go on on either side farther than anybody could mistake the one for the other: what ends
 * before that is a corner, or part of a round edge. */
#define NEAR_M        0.05
#define NEAR_SPACINGS 1.0
#define CROSS_SINE2   0.0975 /* 18 degrees */

/* Whether it goes on farther than that to either side of a place along it. */
static bool goes_on(const struct profile_piece *p, double along_m, double past_m)
{
	return along_m >= p->from_m + past_m && along_m <= p->to_m - past_m;
}

/* How far along p, where they cross. */
static bool cross(const struct profile_piece *p, const struct profile_piece *q, double *ret_along_m)
{
	double at[2], cosine = 0, place[3], spacing_m = (double)fmaxf(p->spacing_m, q->spacing_m);
	if (!straight_nearest(
		    p->line.at, p->line.along, q->line.at, q->line.along, CROSS_SINE2, at))
		return false;
	for (int k = 0; k < 3; k++)
		cosine += p->line.along[k] * q->line.along[k];
	double past_m = profile_piece_off_m(spacing_m) / sqrt(1 - cosine * cosine);
	straight_place(&p->line, at[0], place);
	*ret_along_m = at[0];
	return goes_on(p, at[0], past_m) && goes_on(q, at[1], past_m) &&
	       straight_off(&q->line, place) < NEAR_M + NEAR_SPACINGS * spacing_m;
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
	double along_m;
	if (may_cross(p, q) || !cross(p, q, &along_m))
		return;
	if (along_m - p->from_m > p->to_m - along_m)
		p->to_m = along_m;
	else
		p->from_m = along_m;
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
