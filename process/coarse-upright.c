#include "process/coarse-upright.h"
#include <stdlib.h>
#include <string.h>

#define DIRECTIONS   1200  /* over the sphere: 6 degrees apart */
#define FACES        0.98f /* cosine; 11 degrees */
#define ALONG        0.12f /* sine; 7 degrees */
#define HEIGHT_MIN_M (-6.0f)
#define HEIGHT_MAX_M (-0.2f)
#define HEIGHT_BIN_M 0.25f
#define HEIGHTS      23
#define BELOW_M      1.0f
#define APART        0.94 /* cosine; 20 degrees */
#define STEPS        5

static void spiral(int i, double ret[3])
{
	double z = 1 - (2 * i + 1.0) / DIRECTIONS, level = sqrt(1 - z * z);
	double azimuth = i * G_PI * (3 - sqrt(5));
	ret[0] = level * cos(azimuth);
	ret[1] = level * sin(azimuth);
	ret[2] = z;
}

static float dot(const float a[3], const double b[3])
{
	return a[0] * (float)b[0] + a[1] * (float)b[1] + a[2] * (float)b[2];
}

/* Counts of one direction taken for up. */
struct census {
	float ground, ground_m; /* in the fullest bins of height; there */
	float upright, below;
};

static struct census take_census(
	const struct coarse_sample *sample, size_t count, const double up[3])
{
	struct census c = { 0 };
	float bin[HEIGHTS + 1] = { 0 };
	for (size_t i = 0; i < count; i++) {
		float facing = dot(sample[i].normal, up), height = dot(sample[i].point_m, up);
		c.upright += fabsf(facing) < ALONG;
		if (facing > FACES && height > HEIGHT_MIN_M && height < HEIGHT_MAX_M)
			bin[(int)((height - HEIGHT_MIN_M) / HEIGHT_BIN_M)]++;
	}
	for (int i = 0; i < HEIGHTS; i++)
		if (bin[i] + bin[i + 1] > c.ground) {
			c.ground = bin[i] + bin[i + 1];
			c.ground_m = HEIGHT_MIN_M + (i + 1) * HEIGHT_BIN_M;
		}
	for (size_t i = 0; i < count; i++)
		c.below += dot(sample[i].point_m, up) < c.ground_m - BELOW_M;
	return c;
}

static double score_of(const struct coarse_sample *sample, size_t count, const double up[3])
{
	struct census c = take_census(sample, count, up);
	double n = count + 1;
	return (c.ground / n + 0.02) * (c.upright / n + 0.1) * exp(-5 * c.below / n);
}

static void basis_of(const double up[3], double ret[2][3])
{
	int least = fabs(up[0]) < fabs(up[1]) ? 0 : 1;
	least = fabs(up[least]) < fabs(up[2]) ? least : 2;
	double length = sqrt(1 - up[least] * up[least]);
	for (int i = 0; i < 3; i++)
		ret[0][i] = ((i == least) - up[least] * up[i]) / length;
	for (int i = 0; i < 3; i++)
		ret[1][i] = up[(i + 1) % 3] * ret[0][(i + 2) % 3] -
			    up[(i + 2) % 3] * ret[0][(i + 1) % 3];
}

/* One step towards the direction that upright surfaces stand along and the ground faces. */
static void straighten(const struct coarse_sample *sample, size_t count, float along, double up[3])
{
	double basis[2][3], h[3] = { 1e-6, 0, 1e-6 }, g[2] = { 0 };
	basis_of(up, basis);
	for (size_t i = 0; i < count; i++) {
		const float *n = sample[i].normal;
		float facing = dot(n, up), x = dot(n, basis[0]), y = dot(n, basis[1]);
		if (fabsf(facing) < along) {
			double w = 1 - pow(facing / along, 2);
			h[0] += w * x * x;
			h[1] += w * x * y;
			h[2] += w * y * y;
			g[0] -= w * facing * x;
			g[1] -= w * facing * y;
		} else if (facing > 0 && x * x + y * y < along * along) {
			double w = 0.3 * (1 - (x * x + y * y) / (along * along));
			h[0] += w;
			h[2] += w;
			g[0] += w * x;
			g[1] += w * y;
		}
	}
	double determinant = h[0] * h[2] - h[1] * h[1];
	if (!(determinant > 1e-9 * (h[0] + h[2]) * (h[0] + h[2])))
		return;
	double step[2] = { (h[2] * g[0] - h[1] * g[1]) / determinant,
		(h[0] * g[1] - h[1] * g[0]) / determinant },
	       length = 0;
	for (int i = 0; i < 3; i++) {
		up[i] += step[0] * basis[0][i] + step[1] * basis[1][i];
		length += up[i] * up[i];
	}
	for (int i = 0; i < 3; i++)
		up[i] /= sqrt(length);
}

struct direction {
	double up[3], score;
};

static int by_score(const void *a, const void *b)
{
	const struct direction *x = a, *y = b;
	return x->score != y->score ? (x->score < y->score ? 1 : -1)
				    : (x->up[2] < y->up[2]) - (x->up[2] > y->up[2]);
}

struct pose coarse_upright_pose(const double up[3])
{
	if (up[2] < -1 + 1e-9)
		return (struct pose){ { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } }, { 0 } };
	double k = 1 / (1 + up[2]);
	return (struct pose){ { { 1 - k * up[0] * up[0], -k * up[0] * up[1], -up[0] },
				      { -k * up[0] * up[1], 1 - k * up[1] * up[1], -up[1] },
				      { up[0], up[1], up[2] } },
		{ 0 } };
}

static bool is_known(const struct direction *d, size_t count, const double up[3])
{
	for (size_t i = 0; i < count; i++)
		if (d[i].up[0] * up[0] + d[i].up[1] * up[1] + d[i].up[2] * up[2] > APART)
			return true;
	return false;
}

size_t coarse_upright_find(
	const struct coarse_sample *sample, size_t count, struct coarse_upright *ret, size_t max)
{
	g_autofree struct direction *d = g_new(struct direction, DIRECTIONS);
	for (int i = 0; i < DIRECTIONS; i++) {
		spiral(i, d[i].up);
		d[i].score = score_of(sample, count, d[i].up);
	}
	qsort(d, DIRECTIONS, sizeof *d, by_score);
	size_t kept = 0;
	for (size_t i = 0; i < DIRECTIONS && kept < 4 * max; i++)
		if (!is_known(d, kept, d[i].up))
			d[kept++] = d[i];
	for (size_t i = 0; i < kept; i++) {
		for (int step = 0; step < STEPS; step++)
			straighten(sample, count, 0.25f / (1 + step), d[i].up);
		d[i].score = score_of(sample, count, d[i].up);
	}
	qsort(d, kept, sizeof *d, by_score);
	size_t found = 0;
	for (size_t i = 0; i < kept && found < max; i++)
		if (!is_known(d, i, d[i].up))
			ret[found++] =
				(struct coarse_upright){ coarse_upright_pose(d[i].up), d[i].score };
	return found;
}
