#include "process/voxel-shape.h"
#include <glib.h>
#include <math.h>

/* Scatter and spread of foliage. */
#define SCATTER_FULL 0.18f
#define SPREAD_FULL  0.7f
/* Fewer neighbours than this say nothing. */
#define NEIGHBOURS_MIN 4

void symmetric_eigenvalues(const double m[6], double ret[3])
{
	double off = m[1] * m[1] + m[2] * m[2] + m[4] * m[4], mean = (m[0] + m[3] + m[5]) / 3;
	double a = m[0] - mean, b = m[3] - mean, c = m[5] - mean;
	double scale = sqrt((a * a + b * b + c * c + 2 * off) / 6);
	ret[0] = ret[1] = ret[2] = mean;
	if (!(scale > 1e-30))
		return;
	double det = a * (b * c - m[4] * m[4]) - m[1] * (m[1] * c - m[4] * m[2]) +
		     m[2] * (m[1] * m[4] - b * m[2]);
	double angle = acos(fmin(fmax(det / (2 * scale * scale * scale), -1), 1)) / 3;
	ret[0] = mean + 2 * scale * cos(angle);
	ret[2] = mean + 2 * scale * cos(angle + 2 * G_PI / 3);
	ret[1] = 3 * mean - ret[0] - ret[2];
}

struct sums {
	double n, mean[3], products[6];
	double normal[3], normals, error_m;
};

static void add(struct sums *s, const voxels *v, uint32_t i, const double origin_m[3])
{
	double at[3];
	const float *normal = v->voxel[i].normal;
	float length = sqrtf(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
	voxel_point_m(v, i, at);
	s->n++;
	for (int k = 0, p = 0; k < 3; k++) {
		s->mean[k] += at[k] - origin_m[k];
		for (int j = k; j < 3; j++)
			s->products[p++] += (at[k] - origin_m[k]) * (at[j] - origin_m[j]);
		s->normal[k] += normal[k];
	}
	s->error_m += v->voxel[i].error_m;
	/* a voxel's own normals may disagree already */
	s->normals += length > 0 ? 1 : 0;
}

static struct voxel_shape shape_of(const voxels *v, uint32_t i)
{
	struct sums s = { 0 };
	double origin[3], e[3];
	voxel_point_m(v, i, origin);
	add(&s, v, i, origin);
	for (uint32_t l = v->first_link[i]; l < v->first_link[i + 1]; l++)
		add(&s, v, v->link[l], origin);
	for (int k = 0, p = 0; k < 3; k++)
		for (int j = k; j < 3; j++, p++)
			s.products[p] = s.products[p] / s.n - s.mean[k] * s.mean[j] / (s.n * s.n);
	symmetric_eigenvalues(s.products, e);
	double sum = e[0] + e[1] + e[2];
	double mean = sqrt(
		s.normal[0] * s.normal[0] + s.normal[1] * s.normal[1] + s.normal[2] * s.normal[2]);
	struct voxel_shape shape = { .spread = s.normals > 0 ? (float)(1 - mean / s.normals) : 1,
		.error_m = (float)(s.error_m / s.n) };
	if (s.n < NEIGHBOURS_MIN || !(sum > 0))
		return shape;
	shape.scatter = (float)fmax(e[2] / sum, 0);
	shape.linear = (float)fmax((e[0] - e[1]) / e[0], 0);
	return shape;
}

static float own_rough(const struct voxel_shape *s)
{
	return 0.5f * fminf(s->scatter / SCATTER_FULL, 1) +
	       0.5f * fminf(s->spread / SPREAD_FULL, 1);
}

struct voxel_shape *voxel_shapes(const voxels *v)
{
	struct voxel_shape *shape = g_new(struct voxel_shape, v->count + 1);
#pragma omp parallel for schedule(dynamic, 1024)
	for (uint32_t i = 0; i < v->count; i++)
		shape[i] = shape_of(v, i);
#pragma omp parallel for schedule(dynamic, 1024)
	for (uint32_t i = 0; i < v->count; i++) {
		float sum = own_rough(&shape[i]);
		uint32_t n = v->first_link[i + 1] - v->first_link[i];
		for (uint32_t l = v->first_link[i]; l < v->first_link[i + 1]; l++)
			sum += own_rough(&shape[v->link[l]]);
		shape[i].rough = sum / (float)(n + 1);
	}
	return shape;
}
