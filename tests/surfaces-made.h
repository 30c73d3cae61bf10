#ifndef TESTS_SURFACES_MADE_H
#define TESTS_SURFACES_MADE_H
/* Surfaces made of points that lie evenly on them, as voxels and the ground take them. Where scanners stood is not known. */
#include "process/voxels.h"
#include <math.h>
#include <string.h>

typedef void (*made_take)(const struct voxel_point *p, void *to);

static inline void made_into_voxels(const struct voxel_point *p, void *to)
{
	voxels_add(to, p);
}

static inline void made_cross(const double a[3], const double b[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static inline double made_length(const double a[3])
{
	return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static inline void made_point(
	const double at_m[3], const double normal[3], double apart_m, made_take take, void *to)
{
	struct voxel_point p = {
		.error_m = 0.002f, .size_m = (float)apart_m, .area_m2 = (float)(apart_m * apart_m)
	};
	memcpy(p.at_m, at_m, sizeof p.at_m);
	for (int k = 0; k < 3; k++)
		p.normal[k] = (float)normal[k];
	take(&p, to);
}

/* A parallelogram that faces along a x b. */
static inline void made_patch(const double corner_m[3], const double a_m[3], const double b_m[3],
	double apart_m, made_take take, void *to)
{
	double normal[3];
	made_cross(a_m, b_m, normal);
	double length = made_length(normal);
	for (int k = 0; k < 3; k++)
		normal[k] /= length;
	int n = (int)round(made_length(a_m) / apart_m), m = (int)round(made_length(b_m) / apart_m);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < m; j++) {
			double at[3], u = (i + 0.5) / n, v = (j + 0.5) / m;
			for (int k = 0; k < 3; k++)
				at[k] = corner_m[k] + u * a_m[k] + v * b_m[k];
			made_point(at, normal, apart_m, take, to);
		}
}

/* A level floor over low..high, at a height. */
static inline void made_floor(const double low_m[2], const double high_m[2], double z_m,
	double apart_m, made_take take, void *to)
{
	double corner[3] = { low_m[0], low_m[1], z_m }, a[3] = { high_m[0] - low_m[0], 0, 0 },
	       b[3] = { 0, high_m[1] - low_m[1], 0 };
	made_patch(corner, a, b, apart_m, take, to);
}

/* All six faces of a box, outwards. */
static inline void made_box(
	const double low_m[3], const double high_m[3], double apart_m, made_take take, void *to)
{
	for (int k = 0; k < 3; k++) {
		int j = (k + 1) % 3, l = (k + 2) % 3;
		double a[3] = { 0 }, b[3] = { 0 }, far[3] = { low_m[0], low_m[1], low_m[2] };
		a[j] = high_m[j] - low_m[j];
		b[l] = high_m[l] - low_m[l];
		far[k] = high_m[k];
		made_patch(low_m, b, a, apart_m, take, to);
		made_patch(far, a, b, apart_m, take, to);
	}
}

/* A spiral from pole to pole. */
static inline void made_ball(
	const double centre_m[3], double radius_m, double apart_m, made_take take, void *to)
{
	int n = (int)(4 * M_PI * radius_m * radius_m / (apart_m * apart_m));
	for (int i = 0; i < n; i++) {
		double z = 1 - (2 * i + 1.0) / n, level = sqrt(1 - z * z),
		       turn = i * M_PI * (3 - sqrt(5));
		double normal[3] = { level * cos(turn), level * sin(turn), z }, at[3];
		for (int k = 0; k < 3; k++)
			at[k] = centre_m[k] + radius_m * normal[k];
		made_point(at, normal, apart_m, take, to);
	}
}

#endif
