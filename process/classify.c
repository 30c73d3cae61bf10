#include "process/classify.h"
#include "process/components.h"
#include <math.h>
#include <string.h>

/* Walls and roofs. */
#define WALL_UP_MOST  0.4 /* z of the normal */
#define WALL_AREA_M2  3.0
#define WALL_HEIGHT_M 1.8
#define TOP_LEAST_M   2.2 /* above the ground */
#define ROUGH_MOST    0.35f
/* What holds up ground. */
#define BEHIND_M      1.6
#define HOLDS_SHARE   0.25
#define HOLDS_AREA_M2 45.0
/* Foliage. */
#define FOLIAGE       0.5f
#define FOLIAGE_SURE  0.6f
#define GREEN_ZERO    0.05f
#define GREEN_WEIGHT  1.6f
#define NO_GREEN      -0.04f
#define CROWN_VOXELS  60u
#define LARGE_VOXELS  1000u
#define ERROR_FROM_M  0.010f
#define ERROR_VOXEL_M 0.15f
#define ERROR_FULL_M  0.030f
#define TRUNK_M       2.0
/* What is seen through an opening. */
#define THROUGH_M      4.0
#define THROUGH_FACING 0.35f
/* What lies against something. */
#define AGAINST_LINKS 2
#define BENCH_M       1.3f /* up to here things may stand against it that are none of it */

/* A porch, outside stairs, a dormer. */
#define PART_LINKS 40u
#define PART_M     2.5
#define SILL_LINKS 5u
#define FLOATS_M   2.8f /* nothing but a part of a house is so far above the ground */
#define TALL_M     5.5f
/* Kerbs and edgings lie; what stands goes on above this. */
#define LYING_M 0.3f

#define UNKNOWN 255

struct rules {
	const struct classify_input *in;
	const voxels *v;
	uint8_t *class; /* UNKNOWN: not yet */
	float *foliage; /* evidence of it, about 0..1 */
	float *green;   /* the part of it that colour tells, below 0: of another colour */
};

/* ---- walls, roofs, and what holds up ground ---- */

struct surface {
	double area_m2, up, height_high_m, height_mean_m, rough, foliage;
};

static bool ground_is_behind(const struct rules *r, uint32_t i)
{
	double at[3];
	voxel_point_m(r->v, i, at);
	for (int k = 0; k < 9; k++) {
		double beside[3] = { at[0] + BEHIND_M * (k % 3 - 1), at[1] + BEHIND_M * (k / 3 - 1),
			at[2] };
		float above = ground_above_m(r->in->ground, beside);
		if (above > 0.5f && above < 15)
			return true;
	}
	return false;
}

/* Above the highest ground beside it: a parapet is high above the river only. */
static double height_over_all_m(const struct rules *r, uint32_t i)
{
	double at[3], least = r->in->height_m[i];
	voxel_point_m(r->v, i, at);
	for (int k = 0; k < 9; k++) {
		double beside[3] = { at[0] + BEHIND_M * (k % 3 - 1), at[1] + BEHIND_M * (k / 3 - 1),
			at[2] };
		float height = ground_is_seen(r->in->ground, beside)
				       ? ground_height_m(r->in->ground, beside)
				       : NAN;
		if (height > -0.5f)
			least = fmin(least, height);
	}
	return least;
}

static struct surface *measure_regions(const struct rules *r, uint32_t **ret_holding)
{
	const smooth_regions *regions = r->in->regions;
	struct surface *s = g_new0(struct surface, regions->count + 1);
	uint32_t *holding = g_new0(uint32_t, regions->count + 1);
	for (uint32_t k = 0; k < regions->count; k++) {
		const struct smooth_region *region = &regions->region[k];
		const double *n = region->normal;
		double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		s[k] = (struct surface){ .area_m2 = region->voxels * r->v->size_m * r->v->size_m,
			.up = length > 0 ? n[2] / length : 0,
			.height_high_m = -INFINITY };
	}
	for (uint32_t i = 0; i < r->v->count; i++) {
		uint32_t k = regions->of[i];
		if (k == VOXEL_NONE)
			continue;
		double each = 1.0 / regions->region[k].voxels;
		s[k].height_mean_m += r->in->height_m[i] * each;
		s[k].rough += r->in->shape[i].rough * each;
		s[k].foliage += r->foliage[i] * each;
		if (s[k].area_m2 < WALL_AREA_M2)
			continue;
		s[k].height_high_m = fmax(s[k].height_high_m, height_over_all_m(r, i));
		holding[k] += ground_is_behind(r, i);
	}
	*ret_holding = holding;
	return s;
}

static int class_of_region(
	const struct surface *s, const struct smooth_region *region, double holding)
{
	if (s->area_m2 < WALL_AREA_M2 || s->rough > ROUGH_MOST || s->foliage > FOLIAGE)
		return UNKNOWN;
	if (holding > HOLDS_SHARE)
		return s->area_m2 >= HOLDS_AREA_M2 ? CLASS_STRUCTURE : UNKNOWN;
	bool is_wall = fabs(s->up) < WALL_UP_MOST && s->height_high_m >= TOP_LEAST_M &&
		       region->high_m[2] - region->low_m[2] >= WALL_HEIGHT_M;
	bool is_roof = fabs(s->up) >= WALL_UP_MOST && s->height_mean_m >= TOP_LEAST_M;
	return is_wall || is_roof ? CLASS_BUILDING : UNKNOWN;
}

static void find_walls(struct rules *r)
{
	const smooth_regions *regions = r->in->regions;
	g_autofree uint32_t *holding = NULL;
	g_autofree struct surface *s = measure_regions(r, &holding);
	g_autofree uint8_t *class = g_new(uint8_t, regions->count + 1);
	for (uint32_t k = 0; k < regions->count; k++)
		class[k] = (uint8_t)class_of_region(
			&s[k], &regions->region[k], (double)holding[k] / regions->region[k].voxels);
	for (uint32_t i = 0; i < r->v->count; i++)
		if (regions->of[i] != VOXEL_NONE)
			r->class[i] = class[regions->of[i]];
}

/* ---- foliage ---- */

static void weigh_foliage(struct rules *r)
{
	/* planes are fitted over more where points are sparser, and leave more */
	float scale = sqrtf(fmaxf((float)r->v->size_m / ERROR_VOXEL_M, 1));
	for (uint32_t i = 0; i < r->v->count; i++) {
		const struct voxel *v = &r->v->voxel[i];
		float green = v->rgb[1] - 0.5f * (v->rgb[0] + v->rgb[2]) - GREEN_ZERO;
		r->green[i] = v->coloured * GREEN_WEIGHT * fminf(fmaxf(green, -0.08f), 0.2f);
		float error = (r->in->shape[i].error_m / scale - ERROR_FROM_M) /
			      (ERROR_FULL_M - ERROR_FROM_M);
		r->foliage[i] = 0.55f * r->in->shape[i].rough + 0.45f * fminf(fmaxf(error, 0), 1) +
				r->green[i] + 0.3f * v->late;
	}
}

/* Means of a voxel quantity over components. */
static float *component_means(const struct rules *r, const components *c, const float *quantity)
{
	float *mean = g_new0(float, c->count + 1);
	for (uint32_t i = 0; i < r->v->count; i++)
		if (c->of[i] != VOXEL_NONE)
			mean[c->of[i]] += quantity[i] / (float)c->component[c->of[i]].voxels;
	return mean;
}

/* Links of each component to walls. */
static uint32_t *wall_contacts(const struct rules *r, const components *c)
{
	uint32_t *contacts = g_new0(uint32_t, c->count + 1);
	for (uint32_t i = 0; i < r->v->count; i++)
		for (uint32_t l = r->v->first_link[i];
			c->of[i] != VOXEL_NONE && l < r->v->first_link[i + 1]; l++)
			contacts[c->of[i]] += r->class[r->v->link[l]] == CLASS_BUILDING;
	return contacts;
}

/* What is little larger than the voxels that roughness is told from is rough, whatever it is: its colour tells, if it has one. */
static bool may_be_plant(const struct component *c, float green)
{
	return c->voxels >= LARGE_VOXELS || green > NO_GREEN;
}

/* Crowns and shrubs: foliage all through, and enough of it; but not what is all along a roof. */
static void find_crowns(struct rules *r)
{
	g_autofree uint8_t *kind = g_new0(uint8_t, r->v->count + 1);
	for (uint32_t i = 0; i < r->v->count; i++)
		kind[i] = r->class[i] == UNKNOWN && r->foliage[i] >= FOLIAGE;
	g_autoptr(components) c = components_find(r->v, kind, 0);
	g_autofree float *mean = component_means(r, c, r->foliage);
	g_autofree float *green = component_means(r, c, r->green);
	g_autofree uint32_t *contacts = wall_contacts(r, c);
	for (uint32_t i = 0; i < r->v->count; i++) {
		uint32_t k = c->of[i];
		if (k != VOXEL_NONE && c->component[k].voxels >= CROWN_VOXELS &&
			mean[k] >= FOLIAGE_SURE && may_be_plant(&c->component[k], green[k]) &&
			contacts[k] < c->component[k].voxels)
			r->class[i] = CLASS_VEGETATION;
	}
}

/* ---- what lies against something ---- */

static void take_what_lies_against(struct rules *r, uint8_t class, int links)
{
	g_autoptr(GArray) queue = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	for (uint32_t i = 0; i < r->v->count; i++)
		if (r->class[i] == class)
			g_array_append_val(queue, i);
	guint from = 0;
	for (int far = 0; far < links; far++) {
		guint to = queue->len;
		for (; from < to; from++) {
			uint32_t i = g_array_index(queue, uint32_t, from);
			for (uint32_t l = r->v->first_link[i]; l < r->v->first_link[i + 1]; l++) {
				uint32_t j = r->v->link[l];
				if (r->class[j] != UNKNOWN || r->in->height_m[j] < BENCH_M)
					continue;
				r->class[j] = class;
				g_array_append_val(queue, j);
			}
		}
	}
}

/* ---- what stands alone ---- */

struct thing {
	float foliage, green;
	float low_m, high_m;                /* above the ground */
	double length_m, width_m;           /* upright box along its longer side */
	uint32_t contacts[SEGMENT_CLASSES]; /* links to voxels of a class */
	bool near_building;
};

static void measure_box(const struct component *c, struct thing *t)
{
	double xx = c->covariance_m2[0], xy = c->covariance_m2[1], yy = c->covariance_m2[3];
	double mean = (xx + yy) / 2, off = hypot((xx - yy) / 2, xy);
	/* of something evenly filled */
	t->length_m = sqrt(12 * (mean + off));
	t->width_m = sqrt(12 * fmax(mean - off, 0));
}

/* Blocks of a metre with walls in them. */
static voxels *building_blocks(const struct rules *r)
{
	voxels *blocks = voxels_new(1);
	for (uint32_t i = 0; i < r->v->count; i++) {
		struct voxel_point p = { 0 };
		if (r->class[i] != CLASS_BUILDING)
			continue;
		voxel_point_m(r->v, i, p.at_m);
		memcpy(p.normal, r->v->voxel[i].normal, sizeof p.normal);
		voxels_add(blocks, &p);
	}
	voxels_finish(blocks);
	return blocks;
}

static bool is_near(const voxels *blocks, const double at_m[3])
{
	for (int k = 0; k < 125; k++) {
		double at[3] = { at_m[0] + k % 5 - 2, at_m[1] + k / 5 % 5 - 2,
			at_m[2] + k / 25 - 2 };
		if (voxels_find_point(blocks, at) != VOXEL_NONE)
			return true;
	}
	return false;
}

/* Whether the scanner saw it past a wall that faces the scanner: it lies behind a window or in a doorway. */
static bool is_behind(
	const voxels *blocks, const double at_m[3], const double on_m[3], const float towards[3])
{
	uint32_t b = voxels_find_point(blocks, on_m);
	if (b == VOXEL_NONE)
		return false;
	const float *normal = blocks->voxel[b].normal;
	double wall[3], facing = 0, before = 0;
	voxel_point_m(blocks, b, wall);
	for (int k = 0; k < 3; k++) {
		facing += normal[k] * towards[k];
		before += normal[k] * (at_m[k] - wall[k]);
	}
	return facing > THROUGH_FACING && before < -0.1;
}

static bool is_seen_through(const struct rules *r, const voxels *blocks, uint32_t i)
{
	/* the middle of a large window is further from the wall */
	static const double aside[5][2] = { { 0, 0 }, { 0.7, 0 }, { -0.7, 0 }, { 0, 0.7 },
		{ 0, -0.7 } };
	const float *towards = r->v->voxel[i].towards;
	int ways = r->in->height_m[i] > 0.6f ? 5 : 1;
	double at[3];
	voxel_point_m(r->v, i, at);
	for (double far = 0; far < THROUGH_M; far += 0.5)
		for (int k = 0; k < ways; k++) {
			double on[3] = { at[0] + far * towards[0] + aside[k][0],
				at[1] + far * towards[1] + aside[k][1], at[2] + far * towards[2] };
			if (is_behind(blocks, at, on, towards))
				return true;
		}
	return false;
}

static struct thing *measure_things(const struct rules *r, const components *c)
{
	g_autoptr(voxels) blocks = building_blocks(r);
	struct thing *thing = g_new0(struct thing, c->count + 1);
	g_autofree float *foliage = component_means(r, c, r->foliage);
	g_autofree float *green = component_means(r, c, r->green);
	for (uint32_t k = 0; k < c->count; k++) {
		thing[k].foliage = foliage[k];
		thing[k].green = green[k];
		thing[k].low_m = INFINITY;
		thing[k].high_m = -INFINITY;
		measure_box(&c->component[k], &thing[k]);
		thing[k].near_building = is_near(blocks, c->component[k].centre_m);
	}
	for (uint32_t i = 0; i < r->v->count; i++) {
		if (c->of[i] == VOXEL_NONE)
			continue;
		struct thing *t = &thing[c->of[i]];
		t->low_m = fminf(t->low_m, r->in->height_m[i]);
		t->high_m = fmaxf(t->high_m, r->in->height_m[i]);
		for (uint32_t l = r->v->first_link[i]; l < r->v->first_link[i + 1]; l++)
			if (r->class[r->v->link[l]] < SEGMENT_CLASSES)
				t->contacts[r->class[r->v->link[l]]]++;
	}
	return thing;
}

/* Seen from one side, it has no depth. */
static bool is_person(const struct thing *t)
{
	return t->high_m > 1.0f && t->high_m < 2.1f && t->length_m > 0.3 && t->length_m < 1.3 &&
	       t->width_m > 0.1 && t->width_m < 0.9 && t->low_m < 0.6f;
}

/* Of one that stands behind others, the roof alone may be seen. */
static bool is_car(const struct thing *t)
{
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
	bool is_sheet = t->high_m > TOP_LEAST_M && t->width_m < 0.1 && t->length_m > 0.6;
	bool is_long = t->near_building && t->high_m > BENCH_M && t->length_m > PART_M &&
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
	return is_trunk || (t->foliage >= FOLIAGE && may_be_plant(c, t->green));
}

static bool is_part_of_house(const struct thing *t, const struct component *c)
{
	const uint32_t *contacts = t->contacts;
	if (contacts[CLASS_BUILDING] >= PART_LINKS &&
		contacts[CLASS_BUILDING] > contacts[CLASS_STRUCTURE] &&
		(t->low_m > TOP_LEAST_M || t->length_m > PART_M))
		return true;
	if (is_plant(t, c))
		return t->near_building && t->low_m > 0.6f;
	bool is_thin = t->width_m < 0.3 ||
		       (t->width_m < 0.4 && (t->length_m > PART_M || t->high_m > BENCH_M));
	bool is_bench = t->low_m < 0.6f && t->high_m < BENCH_M && t->length_m > 0.8 &&
			t->length_m < PART_M && t->width_m > 0.15;
	bool is_sill = contacts[CLASS_BUILDING] > SILL_LINKS * c->voxels;
	return (contacts[CLASS_BUILDING] > c->voxels / 2 && (is_sill || !is_bench) &&
		       (t->low_m > 0.4f || is_thin)) ||
	       (t->near_building && t->low_m > 0.6f) || t->low_m > FLOATS_M || is_wall(t);
}

static uint8_t class_of_thing(const struct thing *t, const struct component *c)
{
	if (t->contacts[CLASS_VEGETATION] && is_plant(t, c))
		return CLASS_VEGETATION;
	if (is_part_of_house(t, c))
		return CLASS_BUILDING;
	if (is_plant(t, c))
		return CLASS_VEGETATION;
	return is_person(t) || is_car(t) || is_canopy(t) ? CLASS_OTHER : CLASS_STRUCTURE;
}

/* Rooms behind windows and doorways, as far as they were seen. */
static void find_rooms(struct rules *r)
{
	g_autoptr(voxels) blocks = building_blocks(r);
#pragma omp parallel for schedule(dynamic, 1024)
	for (uint32_t i = 0; i < r->v->count; i++)
		if (r->class[i] == UNKNOWN && is_seen_through(r, blocks, i))
			r->class[i] = CLASS_BUILDING;
}

static void tell_standing(struct rules *r)
{
	g_autofree uint8_t *kind = g_new0(uint8_t, r->v->count + 1);
	for (uint32_t i = 0; i < r->v->count; i++)
		kind[i] = r->class[i] == UNKNOWN && r->in->height_m[i] >= LYING_M;
	g_autoptr(components) c = components_find(r->v, kind, 0);
	g_autofree struct thing *thing = measure_things(r, c);
	for (uint32_t i = 0; i < r->v->count; i++)
		if (c->of[i] != VOXEL_NONE)
			r->class[i] = class_of_thing(&thing[c->of[i]], &c->component[c->of[i]]);
}

/* What stands above it, or it lies on the ground and is part of it. */
static uint8_t class_of_lying(const struct rules *r, uint32_t i)
{
	const struct voxel *v = &r->v->voxel[i];
	for (int up = 1; up <= (int)ceil(LYING_M / r->v->size_m) + 1; up++) {
		int32_t at[3] = { v->at[0], v->at[1], v->at[2] + up };
		uint32_t above = voxels_find(r->v, at);
		if (above != VOXEL_NONE && r->class[above] != UNKNOWN)
			return r->class[above];
	}
	return r->foliage[i] >= FOLIAGE ? CLASS_VEGETATION : CLASS_TERRAIN;
}

static void tell_lying(struct rules *r)
{
	for (uint32_t i = r->v->count; i--;)
		if (r->class[i] == UNKNOWN)
			r->class[i] = class_of_lying(r, i);
}

uint8_t *classify(const struct classify_input *in)
{
	g_autofree float *foliage = g_new(float, in->voxels->count + 1);
	g_autofree float *green = g_new(float, in->voxels->count + 1);
	struct rules r = { in, in->voxels, g_new(uint8_t, in->voxels->count + 1), foliage, green };
	memset(r.class, UNKNOWN, in->voxels->count);
	weigh_foliage(&r);
	find_walls(&r);
	find_crowns(&r);
	take_what_lies_against(&r, CLASS_BUILDING, AGAINST_LINKS);
	take_what_lies_against(&r, CLASS_STRUCTURE, AGAINST_LINKS);
	find_rooms(&r);
	tell_standing(&r);
	tell_lying(&r);
	return r.class;
}
