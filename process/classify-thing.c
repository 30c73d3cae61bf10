#include "process/classify-thing.h"

#define NO_GREEN     -0.04f
#define LARGE_VOXELS 1000u
#define TRUNK_M      2.0
#define AMID_LINKS   3u /* of each voxel to foliage: limbs inside a crown */
/* A porch, outside stairs, a dormer. */
#define PART_LINKS 40u
#define PART_M     2.5
#define SILL_LINKS 5u
#define FLOATS_M   2.8f /* nothing but a part of a house is so far above the ground */
#define TALL_M     5.5f

bool classify_may_be_plant(const struct component *c, float green)
{
	return c->voxels >= LARGE_VOXELS || green > NO_GREEN;
}

/* Seen from one side, it has no depth. */
static bool is_person(const struct thing *t)
{
	return t->high_m > 1.0f && t->high_m < 2.1f && t->length_m > 0.3 && t->length_m < 1.3 &&
	       t->width_m > 0.1 && t->width_m < 0.9 && t->low_m < 0.6f;
}

/* Of one that stands behind others, the roof alone may be seen; of one in a row, its front or its rear. */
static bool is_car(const struct thing *t)
{
	bool is_end = t->high_m > 1.2f && t->high_m < 2.2f && t->length_m > 1.3 &&
		      t->length_m < 2 && t->width_m < 0.5 && t->low_m < 0.6f && !t->near_building &&
		      !t->contacts[CLASS_STRUCTURE];
	if (is_end)
		return true;
	return t->high_m > 1.1f && t->high_m < 2.6f && t->length_m > 1.7 && t->length_m < 6.5 &&
	       t->width_m > 0.7 && t->width_m < 2.6 && t->low_m < 1.3f;
}

/* A parasol, an awning that stands free: its legs are too thin to tie it to the ground. */
static bool is_canopy(const struct thing *t)
{
	return t->low_m > 1.6f && t->high_m < 3.3f && t->length_m > 1.2 && t->length_m < 5;
}

/* One that was seen in few points, or from far aside. */
static bool is_wall(const struct thing *t)
{
	bool is_sheet = t->high_m > CLASSIFY_TOP_LEAST_M && t->width_m < 0.1 && t->length_m > 0.6;
	bool is_long = t->near_building && t->high_m > CLASSIFY_BENCH_M && t->length_m > PART_M &&
		       (t->width_m < 1 || t->high_m > 3.5f);
	return (t->high_m > TALL_M && t->length_m > 1.2) ||
	       ((is_sheet || is_long) && !t->contacts[CLASS_STRUCTURE]);
}

static bool is_plant(const struct thing *t, const struct component *c)
{
	const uint32_t *contacts = t->contacts;
	bool is_trunk = contacts[CLASS_VEGETATION] > contacts[CLASS_BUILDING] &&
			contacts[CLASS_VEGETATION] > contacts[CLASS_STRUCTURE] &&
			t->length_m < TRUNK_M && t->width_m < TRUNK_M / 2;
	bool is_amid = contacts[CLASS_VEGETATION] > AMID_LINKS * c->voxels;
	return is_trunk || is_amid ||
	       (t->foliage >= CLASSIFY_FOLIAGE && classify_may_be_plant(c, t->green));
}

static bool is_part_of_house(const struct thing *t, const struct component *c)
{
	const uint32_t *contacts = t->contacts;
	if (contacts[CLASS_BUILDING] >= PART_LINKS &&
		contacts[CLASS_BUILDING] > contacts[CLASS_STRUCTURE] &&
		(t->low_m > CLASSIFY_TOP_LEAST_M || t->length_m > PART_M))
		return true;
	if (is_plant(t, c))
		return t->near_building && t->low_m > 0.6f;
	bool is_thin = t->width_m < 0.3 ||
		       (t->width_m < 0.4 && (t->length_m > PART_M || t->high_m > CLASSIFY_BENCH_M));
	bool is_bench = t->low_m < 0.6f && t->high_m < CLASSIFY_BENCH_M && t->length_m > 0.8 &&
			t->length_m < PART_M && t->width_m > 0.15;
	bool is_sill = contacts[CLASS_BUILDING] > SILL_LINKS * c->voxels;
	return (contacts[CLASS_BUILDING] > c->voxels / 2 && (is_sill || !is_bench) &&
		       (t->low_m > 0.4f || is_thin)) ||
	       (t->near_building && t->low_m > 0.6f) || t->low_m > FLOATS_M || is_wall(t);
}

uint8_t classify_thing(const struct thing *t, const struct component *c)
{
	if (t->contacts[CLASS_VEGETATION] && is_plant(t, c))
		return CLASS_VEGETATION;
	if (is_part_of_house(t, c))
		return CLASS_BUILDING;
	if (is_plant(t, c))
		return CLASS_VEGETATION;
	if (is_person(t) || is_car(t) || is_canopy(t))
		return CLASS_OTHER;
	bool is_front = t->in_line && t->high_m > CLASSIFY_BENCH_M && !t->contacts[CLASS_STRUCTURE];
	return is_front ? CLASS_BUILDING : CLASS_STRUCTURE;
}
