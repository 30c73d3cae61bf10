#include "process/smooth-regions.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEVELS 256 /* of the residual, to sort by */

void smooth_regions_free(smooth_regions *r)
{
	if (!r)
		return;
	g_free(r->region);
	g_free(r->of);
	g_free(r);
}

static float agreement(const struct voxel *v)
{
	return sqrtf(v->normal[0] * v->normal[0] + v->normal[1] * v->normal[1] +
		     v->normal[2] * v->normal[2]);
}

/* Indices of the voxels, those with the least residual first. */
static uint32_t *sort_by_residual(const voxels *v)
{
	uint32_t first[LEVELS + 1] = { 0 };
	uint32_t *order = g_new(uint32_t, v->count + 1);
	g_autofree uint8_t *level = g_new(uint8_t, v->count + 1);
	for (uint32_t i = 0; i < v->count; i++) {
		float residual = 1 - agreement(&v->voxel[i]);
		level[i] = (uint8_t)fminf(fmaxf(residual, 0) * LEVELS, LEVELS - 1);
		first[level[i] + 1]++;
	}
	for (int k = 0; k < LEVELS; k++)
		first[k + 1] += first[k];
	for (uint32_t i = 0; i < v->count; i++)
		order[first[level[i]]++] = i;
	return order;
}

static bool is_same_surface(const struct voxel *a, const struct voxel *b, float cosine)
{
	float dot = a->normal[0] * b->normal[0] + a->normal[1] * b->normal[1] +
		    a->normal[2] * b->normal[2];
	return dot > cosine * agreement(a) * agreement(b) && agreement(b) > 0.5f;
}

static void grow_one(const voxels *v, const uint8_t *skip, uint32_t seed, float cosine,
	float residual, smooth_regions *r, GArray *queue)
{
	uint32_t region = r->count;
	g_array_set_size(queue, 0);
	g_array_append_val(queue, seed);
	r->of[seed] = region;
	for (guint k = 0; k < queue->len; k++) {
		uint32_t i = g_array_index(queue, uint32_t, k);
		if (1 - agreement(&v->voxel[i]) > residual)
			continue;
		for (uint32_t l = v->first_link[i]; l < v->first_link[i + 1]; l++) {
			uint32_t j = v->link[l];
			if (r->of[j] != VOXEL_NONE || (skip && skip[j]) ||
				!is_same_surface(&v->voxel[i], &v->voxel[j], cosine))
				continue;
			r->of[j] = region;
			g_array_append_val(queue, j);
		}
	}
	r->count++;
}

static void sum_up(const voxels *v, smooth_regions *r)
{
	r->region = g_new0(struct smooth_region, r->count + 1);
	for (uint32_t i = 0; i < r->count; i++)
		for (int k = 0; k < 3; k++) {
			r->region[i].low_m[k] = INFINITY;
			r->region[i].high_m[k] = -INFINITY;
		}
	for (uint32_t i = 0; i < v->count; i++) {
		double at[3];
		if (r->of[i] == VOXEL_NONE)
			continue;
		struct smooth_region *s = &r->region[r->of[i]];
		voxel_point_m(v, i, at);
		s->voxels++;
		s->points += v->voxel[i].points;
		for (int k = 0, n = 0; k < 3; k++) {
			s->centre_m[k] += at[k];
			s->normal[k] += v->voxel[i].normal[k];
			s->low_m[k] = fmin(s->low_m[k], at[k]);
			s->high_m[k] = fmax(s->high_m[k], at[k]);
			for (int j = k; j < 3; j++)
				s->covariance_m2[n++] += at[k] * at[j];
		}
	}
	for (uint32_t i = 0; i < r->count; i++) {
		struct smooth_region *s = &r->region[i];
		for (int k = 0; k < 3; k++) {
			s->centre_m[k] /= s->voxels;
			s->normal[k] /= s->voxels;
		}
		for (int k = 0, n = 0; k < 3; k++)
			for (int j = k; j < 3; j++, n++)
				s->covariance_m2[n] = s->covariance_m2[n] / s->voxels -
						      s->centre_m[k] * s->centre_m[j];
	}
}

smooth_regions *smooth_regions_grow(
	const voxels *v, const uint8_t *skip, const struct smooth_options *options)
{
	float angle_deg = options && options->angle_deg ? options->angle_deg : 12,
	      residual = options && options->residual ? options->residual : 0.1f;
	smooth_regions *r = g_new0(smooth_regions, 1);
	g_autofree uint32_t *order = sort_by_residual(v);
	g_autoptr(GArray) queue = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	r->of = g_new(uint32_t, v->count + 1);
	memset(r->of, 0xFF, v->count * sizeof *r->of);
	for (uint32_t k = 0; k < v->count; k++) {
		uint32_t i = order[k];
		if (1 - agreement(&v->voxel[i]) > residual)
			break;
		if (r->of[i] == VOXEL_NONE && !(skip && skip[i]))
			grow_one(v, skip, i, cosf(angle_deg * (float)G_PI / 180), residual, r,
				queue);
	}
	sum_up(v, r);
	return r;
}
