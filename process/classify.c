#include "process/classify.h"
#include "process/classify-thing.h"
#include <math.h>
#include <string.h>

/* Walls and roofs. */
#define WALL_UP_MOST  0.4 /* z of the normal */
#define WALL_AREA_M2  3.0
#define WALL_HEIGHT_M 1.8
#define ROUGH_MOST    0.35f
/* What holds up ground. */
#define BEHIND_M      1.6
#define HOLDS_SHARE   0.25
#define HOLDS_AREA_M2 45.0
/* Foliage. */
#define FOLIAGE_SURE  0.6f
#define GREEN_ZERO    0.05f
#define GREEN_WEIGHT  1.6f
#define CROWN_VOXELS  60u
#define ERROR_FROM_M  0.010f
#define ERROR_VOXEL_M 0.15f
#define ERROR_FULL_M  0.030f
/* Ivy: of a colour that walls do not have, all of it together of a plant's. */
#define CLIMBER_GREEN      -0.03f
#define CLIMBER_GREEN_MEAN 0.02f
#define CLIMBER_VOXELS     200u
/* What is seen through an opening. */
#define THROUGH_M      4.0
#define THROUGH_FACING 0.35f
/* What lies against something. */
#define AGAINST_LINKS 2

/* Kerbs and edgings lie; what stands goes on above this. */
#define LYING_M 0.3f

/* Further along a front, where few beams meet it. */
#define IN_LINE_M       0.4 /* off its plane */
#define IN_LINE_FAR_M   20.0
#define IN_LINE_FLAT_M  0.5
#define IN_LINE_MOST_M2 1.5

#define UNKNOWN 255

struct rules {
	const struct classify_input *in;
	const voxels *v;
	uint8_t *class;  /* UNKNOWN: not yet */
	uint8_t *region; /* class of each smooth region, UNKNOWN: it is none of these */
	float *foliage;  /* evidence of it, about 0..1 */
	float *green;    /* the part of it that colour tells, below 0: of another colour */
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
	if (s->area_m2 < WALL_AREA_M2 || s->rough > ROUGH_MOST || s->foliage > CLASSIFY_FOLIAGE)
		return UNKNOWN;
	if (holding > HOLDS_SHARE)
		return s->area_m2 >= HOLDS_AREA_M2 ? CLASS_STRUCTURE : UNKNOWN;
	bool is_wall = fabs(s->up) < WALL_UP_MOST && s->height_high_m >= CLASSIFY_TOP_LEAST_M &&
		       region->high_m[2] - region->low_m[2] >= WALL_HEIGHT_M;
	bool is_roof = fabs(s->up) >= WALL_UP_MOST && s->height_mean_m >= CLASSIFY_TOP_LEAST_M;
	return is_wall || is_roof ? CLASS_BUILDING : UNKNOWN;
}

static void find_walls(struct rules *r)
{
	const smooth_regions *regions = r->in->regions;
	g_autofree uint32_t *holding = NULL;
	g_autofree struct surface *s = measure_regions(r, &holding);
	for (uint32_t k = 0; k < regions->count; k++)
		r->region[k] = (uint8_t)class_of_region(
			&s[k], &regions->region[k], (double)holding[k] / regions->region[k].voxels);
	for (uint32_t i = 0; i < r->v->count; i++)
		if (regions->of[i] != VOXEL_NONE)
			r->class[i] = r->region[regions->of[i]];
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

/* Crowns and shrubs: foliage all through, and enough of it; but not what is all along a roof. */
static void find_crowns(struct rules *r)
{
	g_autofree uint8_t *kind = g_new0(uint8_t, r->v->count + 1);
	for (uint32_t i = 0; i < r->v->count; i++)
		kind[i] = r->class[i] == UNKNOWN && r->foliage[i] >= CLASSIFY_FOLIAGE;
	g_autoptr(components) c = components_find(r->v, kind, 0);
	g_autofree float *mean = component_means(r, c, r->foliage);
	g_autofree float *green = component_means(r, c, r->green);
	g_autofree uint32_t *contacts = wall_contacts(r, c);
	for (uint32_t i = 0; i < r->v->count; i++) {
		uint32_t k = c->of[i];
		if (k != VOXEL_NONE && c->component[k].voxels >= CROWN_VOXELS &&
			mean[k] >= FOLIAGE_SURE &&
			classify_may_be_plant(&c->component[k], green[k]) &&
			contacts[k] < c->component[k].voxels)
			r->class[i] = CLASS_VEGETATION;
	}
}

/* What climbs a wall lies in its plane and grew into one with it, but is rough and green. */
static void find_climbers(struct rules *r)
{
	g_autofree uint8_t *kind = g_new0(uint8_t, r->v->count + 1);
	for (uint32_t i = 0; i < r->v->count; i++)
		kind[i] = (r->class[i] == UNKNOWN || r->class[i] == CLASS_BUILDING) &&
			  r->foliage[i] >= CLASSIFY_FOLIAGE && r->green[i] > CLIMBER_GREEN;
	g_autoptr(components) c = components_find(r->v, kind, 0);
	g_autofree float *mean = component_means(r, c, r->foliage);
	g_autofree float *green = component_means(r, c, r->green);
	g_autofree uint32_t *of_walls = g_new0(uint32_t, c->count + 1);
	for (uint32_t i = 0; i < r->v->count; i++)
		if (c->of[i] != VOXEL_NONE)
			of_walls[c->of[i]] += r->class[i] == CLASS_BUILDING;
	for (uint32_t i = 0; i < r->v->count; i++) {
		uint32_t k = c->of[i];
		if (k != VOXEL_NONE && c->component[k].voxels >= CLIMBER_VOXELS &&
			2 * of_walls[k] > c->component[k].voxels && mean[k] >= FOLIAGE_SURE &&
			green[k] >= CLIMBER_GREEN_MEAN)
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
				if (r->class[j] != UNKNOWN || r->in->height_m[j] < CLASSIFY_BENCH_M)
					continue;
				r->class[j] = class;
				g_array_append_val(queue, j);
			}
		}
	}
}

/* ---- what stands alone ---- */

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

/* Whether it is flat in the plane of the wall, and not far aside of it. */
static bool goes_on(const struct smooth_region *wall, const struct component *c)
{
	const double length = hypot(wall->normal[0], wall->normal[1]);
	if (!(length > 0))
		return false;
	const double n[2] = { wall->normal[0] / length, wall->normal[1] / length };
	const double off[2] = { c->centre_m[0] - wall->centre_m[0],
		c->centre_m[1] - wall->centre_m[1] };
	const double half_m = 0.5 * (fabs(n[1]) * (wall->high_m[0] - wall->low_m[0]) +
					    fabs(n[0]) * (wall->high_m[1] - wall->low_m[1]));
	const double *q = c->covariance_m2;
	const double flat_m2 =
		12 * (n[0] * n[0] * q[0] + 2 * n[0] * n[1] * q[1] + n[1] * n[1] * q[3]);
	return fabs(n[0] * off[0] + n[1] * off[1]) < IN_LINE_M &&
	       fabs(n[0] * off[1] - n[1] * off[0]) < half_m + IN_LINE_FAR_M &&
	       flat_m2 < IN_LINE_FLAT_M * IN_LINE_FLAT_M;
}

/* Regions that are walls, of struct smooth_region *. */
static GPtrArray *list_walls(const struct rules *r)
{
	const smooth_regions *regions = r->in->regions;
	GPtrArray *ret = g_ptr_array_new();
	for (uint32_t k = 0; k < regions->count; k++) {
		struct smooth_region *wall = &regions->region[k];
		if (r->region[k] == CLASS_BUILDING &&
			fabs(wall->normal[2]) <
				WALL_UP_MOST * hypot(wall->normal[0], wall->normal[1]))
			g_ptr_array_add(ret, wall);
	}
	return ret;
}

static bool is_in_line(const GPtrArray *walls, const struct component *c)
{
	for (guint k = 0; k < walls->len; k++)
		if (goes_on(walls->pdata[k], c))
			return true;
	return false;
}

static struct thing *measure_things(const struct rules *r, const components *c)
{
	g_autoptr(voxels) blocks = building_blocks(r);
	g_autoptr(GPtrArray) walls = list_walls(r);
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
		thing[k].in_line =
			c->component[k].voxels * r->v->size_m * r->v->size_m < IN_LINE_MOST_M2 &&
			is_in_line(walls, &c->component[k]);
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
			r->class[i] = classify_thing(&thing[c->of[i]], &c->component[c->of[i]]);
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
	return r->foliage[i] >= CLASSIFY_FOLIAGE ? CLASS_VEGETATION : CLASS_TERRAIN;
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
	g_autofree uint8_t *region = g_new(uint8_t, in->regions->count + 1);
	struct rules r = { in, in->voxels, g_new(uint8_t, in->voxels->count + 1), region, foliage,
		green };
	memset(r.class, UNKNOWN, in->voxels->count);
	weigh_foliage(&r);
	find_walls(&r);
	find_climbers(&r);
	find_crowns(&r);
	take_what_lies_against(&r, CLASS_BUILDING, AGAINST_LINKS);
	take_what_lies_against(&r, CLASS_STRUCTURE, AGAINST_LINKS);
	find_rooms(&r);
	tell_standing(&r);
	tell_lying(&r);
	return r.class;
}
