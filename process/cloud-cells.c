#include "process/cloud-cells.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void position(const struct cloud_view *v, size_t i, double ret[3])
{
	memcpy(ret, cloud_view_at(v, i), 3 * sizeof *ret);
}

static uint64_t key_of(const int64_t at[3])
{
	return ((uint64_t)at[0] & 0x1fffff) | ((uint64_t)at[1] & 0x1fffff) << 21 |
	       ((uint64_t)at[2] & 0x1fffff) << 42;
}

static void cell_at(const struct cloud_cells *c, const double p[3], int64_t ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = (int64_t)floor(p[k] / c->side_m);
}

static int by_key(const void *a, const void *b)
{
	const struct cloud_keyed *x = a, *y = b;
	return x->key != y->key ? (x->key > y->key) - (x->key < y->key)
				: (x->point > y->point) - (x->point < y->point);
}

void cloud_keyed_sort(struct cloud_keyed *k, size_t count)
{
	qsort(k, count, sizeof *k, by_key);
}

/* The slot of a cell, or the one where it would be. */
static uint32_t slot_of(const struct cloud_cells *c, uint64_t key)
{
	uint32_t h = (uint32_t)(key * 0x9e3779b97f4a7c15U >> 32) & (c->slots - 1);
	while (c->slot[h] && c->key[c->slot[h] - 1] != key)
		h = (h + 1) & (c->slots - 1);
	return h;
}

/* The points that are used, sorted; caller frees. */
static struct cloud_keyed *keyed_points(
	const struct cloud_cells *c, const uint8_t *use, uint32_t *ret_count)
{
	struct cloud_keyed *all = g_new(struct cloud_keyed, c->view->count + 1);
	uint32_t count = 0;
	for (size_t i = 0; i < c->view->count; i++) {
		double p[3];
		int64_t at[3];
		if (use && !use[i])
			continue;
		position(c->view, i, p);
		cell_at(c, p, at);
		all[count++] = (struct cloud_keyed){ key_of(at), (uint32_t)i };
	}
	cloud_keyed_sort(all, count);
	*ret_count = count;
	return all;
}

void cloud_cells_init(
	struct cloud_cells *c, const struct cloud_view *v, float side_m, const uint8_t *use)
{
	*c = (struct cloud_cells){ .view = v, .side_m = side_m, .slots = 64 };
	uint32_t count;
	g_autofree struct cloud_keyed *all = keyed_points(c, use, &count);
	for (uint32_t i = 0; i < count; i++)
		c->count += i == 0 || all[i].key != all[i - 1].key;
	while (c->slots < 2 * c->count)
		c->slots *= 2;
	c->order = g_new(uint32_t, count + 1);
	c->first = g_new(uint32_t, c->count + 1);
	c->key = g_new(uint64_t, c->count + 1);
	c->slot = g_new0(uint32_t, c->slots);
	uint32_t cell = 0;
	for (uint32_t i = 0; i < count; i++) {
		c->order[i] = all[i].point;
		if (i && all[i].key == all[i - 1].key)
			continue;
		c->first[cell] = i;
		c->key[cell] = all[i].key;
		c->slot[slot_of(c, all[i].key)] = ++cell;
	}
	c->first[cell] = count;
}

void cloud_cells_clear(struct cloud_cells *c)
{
	g_free(c->order);
	g_free(c->first);
	g_free(c->key);
	g_free(c->slot);
}

void cloud_cells_visit(const struct cloud_cells *c, const double at[3], float radius_m,
	uint32_t most, void (*visit)(uint32_t point, const float off[3], void *data), void *data)
{
	int64_t middle[3];
	cell_at(c, at, middle);
	for (int n = 0; n < 27; n++) {
		int64_t there[3] = { middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1,
			middle[2] + n / 9 - 1 };
		uint32_t cell = c->slot[slot_of(c, key_of(there))];
		if (!cell)
			continue;
		uint32_t first = c->first[cell - 1], end = c->first[cell];
		uint32_t stride = (end - first) / most + 1;
		for (uint32_t i = first; i < end; i += stride) {
			double p[3];
			position(c->view, c->order[i], p);
			float off[3] = { (float)(p[0] - at[0]), (float)(p[1] - at[1]),
				(float)(p[2] - at[2]) };
			if (off[0] * off[0] + off[1] * off[1] + off[2] * off[2] <=
				radius_m * radius_m)
				visit(c->order[i], off, data);
		}
	}
}
