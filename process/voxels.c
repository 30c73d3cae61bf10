#include "process/voxels.h"
#include "process/morton.h"
#include <math.h>
#include <string.h>

#define ROOM_FIRST 4096u

/* What one scan shows of a voxel's surface. */
struct voxel_area {
	float m2;
	uint32_t scan;
};

voxels *voxels_new(double size_m)
{
	voxels *v = g_new0(voxels, 1);
	v->size_m = size_m;
	v->room = ROOM_FIRST;
	v->voxel = g_new(struct voxel, v->room);
	v->area = g_new(struct voxel_area, v->room);
	v->slots = 2 * v->room;
	v->slot = g_malloc(v->slots * sizeof *v->slot);
	memset(v->slot, 0xFF, v->slots * sizeof *v->slot);
	return v;
}

void voxels_free(voxels *v)
{
	if (!v)
		return;
	g_free(v->voxel);
	g_free(v->area);
	g_free(v->first_link);
	g_free(v->link);
	g_free(v->slot);
	g_free(v);
}

/* ---- where a voxel is ---- */

static bool is_at(const struct voxel *v, const int32_t at[3])
{
	return v->at[0] == at[0] && v->at[1] == at[1] && v->at[2] == at[2];
}

/* The slot of a place: that of its voxel, or the empty one that it would get. */
static uint32_t find_slot(const voxels *v, const int32_t at[3])
{
	uint32_t s = voxel_hash(at) & (v->slots - 1);
	while (v->slot[s] != VOXEL_NONE && !is_at(&v->voxel[v->slot[s]], at))
		s = (s + 1) & (v->slots - 1);
	return s;
}

uint32_t voxels_find(const voxels *v, const int32_t at[3])
{
	return v->slot[find_slot(v, at)];
}

static bool place_of(const voxels *v, const double at_m[3], int32_t ret[3], float ret_place[3])
{
	for (int k = 0; k < 3; k++) {
		double at = at_m[k] / v->size_m, cell = floor(at);
		if (!(cell >= -MORTON_HALF && cell < MORTON_HALF))
			return false;
		ret[k] = (int32_t)cell;
		ret_place[k] = (float)(at - cell);
	}
	return true;
}

uint32_t voxels_find_point_after(const voxels *v, const double at_m[3], uint32_t last)
{
	int32_t at[3];
	float place[3];
	if (!place_of(v, at_m, at, place))
		return VOXEL_NONE;
	return last < v->count && is_at(&v->voxel[last], at) ? last : voxels_find(v, at);
}

uint32_t voxels_find_point(const voxels *v, const double at_m[3])
{
	return voxels_find_point_after(v, at_m, VOXEL_NONE);
}

static void fill_slots(voxels *v)
{
	memset(v->slot, 0xFF, v->slots * sizeof *v->slot);
	for (uint32_t i = 0; i < v->count; i++)
		v->slot[find_slot(v, v->voxel[i].at)] = i;
}

static void grow(voxels *v)
{
	v->room *= 2;
	v->slots *= 2;
	v->voxel = g_renew(struct voxel, v->voxel, v->room);
	v->area = g_renew(struct voxel_area, v->area, v->room);
	v->slot = g_renew(uint32_t, v->slot, v->slots);
	fill_slots(v);
}

/* ---- sums ---- */

static void add(struct voxel *to, const struct voxel_point *p, const float place[3])
{
	for (int k = 0; k < 3; k++) {
		to->place[k] += place[k];
		to->normal[k] += p->normal[k];
		to->towards[k] += p->towards[k];
		to->rgb[k] += p->rgb ? p->rgb[k] : 0;
	}
	to->points++;
	to->error_m += p->error_m;
	to->size_m = to->points == 1 ? p->size_m : fminf(to->size_m, p->size_m);
	to->coloured += p->rgb != NULL;
	to->intensity += p->intensity;
	to->late += p->is_late;
}

/* The voxel at a place, which is made where there is none. */
static uint32_t get(voxels *v, const int32_t at[3], uint32_t scan)
{
	/* points that come one after another often lie in the same */
	if (v->last < v->count && is_at(&v->voxel[v->last], at))
		return v->last;
	uint32_t s = find_slot(v, at), i = v->slot[s];
	if (i != VOXEL_NONE)
		return v->last = i;
	if (v->count == v->room) {
		grow(v);
		s = find_slot(v, at);
	}
	i = v->last = v->slot[s] = v->count++;
	v->voxel[i] = (struct voxel){ .at = { at[0], at[1], at[2] } };
	v->area[i] = (struct voxel_area){ 0, scan };
	return i;
}

static void add_area(voxels *v, uint32_t i, struct voxel_area area)
{
	if (v->area[i].scan != area.scan)
		v->area[i] = (struct voxel_area){ 0, area.scan };
	v->area[i].m2 += area.m2;
	v->voxel[i].area_m2 = fmaxf(v->voxel[i].area_m2, v->area[i].m2);
}

uint32_t voxels_add(voxels *v, const struct voxel_point *p)
{
	int32_t at[3];
	float place[3];
	if (!place_of(v, p->at_m, at, place))
		return VOXEL_NONE;
	uint32_t i = get(v, at, p->scan);
	add(&v->voxel[i], p, place);
	add_area(v, i, (struct voxel_area){ p->area_m2, p->scan });
	return i;
}

static void add_sums(struct voxel *to, const struct voxel *from)
{
	for (int k = 0; k < 3; k++) {
		to->place[k] += from->place[k];
		to->normal[k] += from->normal[k];
		to->towards[k] += from->towards[k];
		to->rgb[k] += from->rgb[k];
	}
	to->size_m = to->points ? fminf(to->size_m, from->size_m) : from->size_m;
	to->points += from->points;
	to->error_m += from->error_m;
	to->coloured += from->coloured;
	to->intensity += from->intensity;
	to->late += from->late;
}

void voxels_merge(voxels *v, const voxels *from)
{
	for (uint32_t k = 0; k < from->count; k++) {
		uint32_t i = get(v, from->voxel[k].at, from->area[k].scan);
		add_sums(&v->voxel[i], &from->voxel[k]);
		add_area(v, i, from->area[k]);
	}
}

static void sum_to_mean(struct voxel *v)
{
	float each = 1 / (float)v->points, colour = v->coloured > 0 ? 1 / (255 * v->coloured) : 0;
	for (int k = 0; k < 3; k++) {
		v->place[k] *= each;
		v->normal[k] *= each;
		v->towards[k] *= each;
		v->rgb[k] *= colour;
	}
	v->error_m *= each;
	v->coloured *= each;
	v->intensity *= each;
	v->late *= each;
}

struct ordered {
	uint64_t code;
	uint32_t index;
};

static int by_code(const void *a, const void *b)
{
	uint64_t x = ((const struct ordered *)a)->code, y = ((const struct ordered *)b)->code;
	return (x > y) - (x < y);
}

void voxels_finish(voxels *v)
{
	g_autofree struct ordered *order = g_new(struct ordered, v->count + 1);
	struct voxel *sorted = g_new(struct voxel, v->count + 1);
	for (uint32_t i = 0; i < v->count; i++) {
		uint64_t code = 0;
		for (int k = 0; k < 3; k++)
			code |= morton_spread((uint64_t)(v->voxel[i].at[k] + MORTON_HALF)) << k;
		order[i] = (struct ordered){ code, i };
	}
	qsort(order, v->count, sizeof *order, by_code);
	for (uint32_t i = 0; i < v->count; i++) {
		sorted[i] = v->voxel[order[i].index];
		sum_to_mean(&sorted[i]);
	}
	g_free(v->voxel);
	g_clear_pointer(&v->area, g_free);
	v->voxel = sorted;
	v->room = v->count + 1;
	fill_slots(v);
}
