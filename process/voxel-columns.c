#include "process/voxel-columns.h"
#include <string.h>

/* The slot of a place: that of its column, or the empty one that it would get. */
static uint32_t find_slot(const voxel_columns *c, int32_t x, int32_t y)
{
	uint32_t s = voxel_hash((const int32_t[3]){ x, y, 0 }) & (c->slots - 1);
	while (c->slot[s] != VOXEL_NONE &&
		(c->column[c->slot[s]].x != x || c->column[c->slot[s]].y != y))
		s = (s + 1) & (c->slots - 1);
	return s;
}

/* ret_of: the column of each voxel. Columns count in `end`. */
static void count_voxels(voxel_columns *c, uint32_t *ret_of)
{
	for (uint32_t i = 0; i < c->v->count; i++) {
		const int32_t *at = c->v->voxel[i].at;
		const uint32_t s = find_slot(c, at[0], at[1]);
		if (c->slot[s] == VOXEL_NONE) {
			c->slot[s] = c->count;
			c->column[c->count++] = (struct voxel_column){ at[0], at[1], 0, 0 };
		}
		ret_of[i] = c->slot[s];
		c->column[ret_of[i]].end++;
	}
}

/* A column's end goes on with its voxels. */
static void put(voxel_columns *c, struct voxel_column *to, uint32_t i)
{
	const int32_t z = c->v->voxel[i].at[2];
	uint32_t k = to->end++;
	for (; k > to->first && c->v->voxel[c->voxel[k - 1]].at[2] > z; k--)
		c->voxel[k] = c->voxel[k - 1];
	c->voxel[k] = i;
}

voxel_columns *voxel_columns_new(const voxels *v)
{
	voxel_columns *c = g_new0(voxel_columns, 1);
	g_autofree uint32_t *of = g_new(uint32_t, v->count + 1);
	c->v = v;
	c->column = g_new(struct voxel_column, v->count + 1);
	c->voxel = g_new(uint32_t, v->count + 1);
	for (c->slots = 2; c->slots < 2 * (size_t)v->count; c->slots *= 2)
		;
	c->slot = g_malloc(c->slots * sizeof *c->slot);
	memset(c->slot, 0xFF, c->slots * sizeof *c->slot);
	count_voxels(c, of);
	for (uint32_t k = 0, first = 0; k < c->count; k++) {
		const uint32_t count = c->column[k].end;
		c->column[k].first = c->column[k].end = first;
		first += count;
	}
	for (uint32_t i = 0; i < v->count; i++)
		put(c, &c->column[of[i]], i);
	return c;
}

void voxel_columns_free(voxel_columns *c)
{
	if (!c)
		return;
	g_free(c->column);
	g_free(c->voxel);
	g_free(c->slot);
	g_free(c);
}

uint32_t voxel_columns_find(const voxel_columns *c, int32_t x, int32_t y, int32_t low, int32_t high,
	const uint32_t **ret)
{
	const uint32_t column = c->slot[find_slot(c, x, y)];
	if (column == VOXEL_NONE)
		return 0;
	uint32_t first = c->column[column].first, end = c->column[column].end;
	while (first < end && c->v->voxel[c->voxel[first]].at[2] < low)
		first++;
	while (first < end && c->v->voxel[c->voxel[end - 1]].at[2] > high)
		end--;
	*ret = c->voxel + first;
	return end - first;
}
