#include "process/components.h"
#include <math.h>
#include <string.h>

#define LEVEL_MAX 21u

void components_free(components *c)
{
	if (!c)
		return;
	g_free(c->component);
	g_free(c->of);
	g_free(c);
}

static void add(struct component *c, const voxels *v, uint32_t i)
{
	double at[3];
	voxel_point_m(v, i, at);
	for (int k = 0, p = 0; k < 3; k++) {
		c->low_m[k] = c->voxels ? fmin(c->low_m[k], at[k]) : at[k];
		c->high_m[k] = c->voxels ? fmax(c->high_m[k], at[k]) : at[k];
		c->centre_m[k] += at[k];
		for (int j = k; j < 3; j++)
			c->covariance_m2[p++] += at[k] * at[j];
	}
	c->voxels++;
	c->points += v->voxel[i].points;
}

static void finish(struct component *c)
{
	for (int k = 0; k < 3; k++)
		c->centre_m[k] /= c->voxels;
	for (int k = 0, p = 0; k < 3; k++)
		for (int j = k; j < 3; j++, p++)
			c->covariance_m2[p] =
				c->covariance_m2[p] / c->voxels - c->centre_m[k] * c->centre_m[j];
}

/* All that is tied to the first of queue; they are marked as component `as`. */
static void spread(const voxels *v, const uint8_t *kind, uint32_t *of, uint32_t as, GArray *queue)
{
	for (guint k = 0; k < queue->len; k++) {
		uint32_t i = g_array_index(queue, uint32_t, k);
		for (uint32_t l = v->first_link[i]; l < v->first_link[i + 1]; l++) {
			uint32_t j = v->link[l];
			if (of[j] != VOXEL_NONE || (kind && kind[j] != kind[i]))
				continue;
			of[j] = as;
			g_array_append_val(queue, j);
		}
	}
}

#define DROPPED (VOXEL_NONE - 1)

components *components_find(const voxels *v, const uint8_t *kind, uint32_t points_min)
{
	components *c = g_new0(components, 1);
	g_autoptr(GArray) queue = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g_autoptr(GArray) found = g_array_new(FALSE, FALSE, sizeof(struct component));
	c->of = g_new(uint32_t, v->count + 1);
	memset(c->of, 0xFF, v->count * sizeof *c->of);
	for (uint32_t i = 0; i < v->count; i++) {
		struct component component = { 0 };
		if (c->of[i] != VOXEL_NONE || (kind && !kind[i]))
			continue;
		g_array_set_size(queue, 0);
		g_array_append_val(queue, i);
		c->of[i] = found->len;
		spread(v, kind, c->of, found->len, queue);
		for (guint k = 0; k < queue->len; k++)
			add(&component, v, g_array_index(queue, uint32_t, k));
		if (component.points >= points_min) {
			finish(&component);
			g_array_append_val(found, component);
			continue;
		}
		for (guint k = 0; k < queue->len; k++)
			c->of[g_array_index(queue, uint32_t, k)] = DROPPED;
	}
	for (uint32_t i = 0; i < v->count; i++)
		if (c->of[i] == DROPPED)
			c->of[i] = VOXEL_NONE;
	c->count = found->len;
	c->component = (struct component *)g_array_free(g_steal_pointer(&found), FALSE);
	return c;
}

double octree_cell_m(double whole_m, unsigned level)
{
	return ldexp(whole_m, -(int)MIN(level, LEVEL_MAX));
}

unsigned octree_level(double whole_m, double gap_m)
{
	double level = round(log2(whole_m / gap_m));
	return (unsigned)fmin(fmax(level, 0), LEVEL_MAX);
}
