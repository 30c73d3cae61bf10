#include "process/pose.h"
#include <math.h>
#include <string.h>

typedef double matrix[3][3];

static void multiply(const matrix a, const matrix b, matrix ret)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ret[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

void pose_rotate(const struct pose *p, const double direction[3], double ret[3])
{
	double v[3] = { direction[0], direction[1], direction[2] };
	for (int i = 0; i < 3; i++)
		ret[i] = p->rotation[i][0] * v[0] + p->rotation[i][1] * v[1] +
			 p->rotation[i][2] * v[2];
}

void pose_apply(const struct pose *p, const double point_m[3], double ret_m[3])
{
	pose_rotate(p, point_m, ret_m);
	for (int i = 0; i < 3; i++)
		ret_m[i] += p->translation_m[i];
}

struct pose pose_compose(const struct pose *second, const struct pose *first)
{
	struct pose p;
	multiply(second->rotation, first->rotation, p.rotation);
	pose_apply(second, first->translation_m, p.translation_m);
	return p;
}

struct pose pose_inverse(const struct pose *p)
{
	struct pose inverse;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			inverse.rotation[i][j] = p->rotation[j][i];
	double back[3] = { -p->translation_m[0], -p->translation_m[1], -p->translation_m[2] };
	pose_rotate(&inverse, back, inverse.translation_m);
	return inverse;
}

struct pose pose_between(const struct pose *from, const struct pose *to)
{
	struct pose back = pose_inverse(from);
	return pose_compose(&back, to);
}

/* Twice the sine of the angle, along the axis. */
static void skew_part(const matrix r, double ret[3])
{
	ret[0] = r[2][1] - r[1][2];
	ret[1] = r[0][2] - r[2][0];
	ret[2] = r[1][0] - r[0][1];
}

static double length(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double pose_angle_rad(const struct pose *p)
{
	double skew[3];
	skew_part(p->rotation, skew);
	return atan2(length(skew) / 2,
		(p->rotation[0][0] + p->rotation[1][1] + p->rotation[2][2] - 1) / 2);
}

double pose_distance_m(const struct pose *p)
{
	return length(p->translation_m);
}

double pose_yaw_rad(const struct pose *p)
{
	/* Where the frame's y axis points; clockwise from y. */
	return atan2(p->rotation[0][1], p->rotation[1][1]);
}

struct pose pose_from_yaw(double yaw_rad, const double translation_m[3])
{
	double c = cos(yaw_rad), s = sin(yaw_rad);
	struct pose p = { { { c, s, 0 }, { -s, c, 0 }, { 0, 0, 1 } }, { 0 } };
	memcpy(p.translation_m, translation_m, sizeof p.translation_m);
	return p;
}

/* Rodrigues. */
static void rotation_from_vector(const double w[3], matrix ret)
{
	double angle = length(w), a, b;
	if (angle < 1e-6) { /* series: the quotients lose their digits */
		a = 1 - angle * angle / 6;
		b = 0.5 - angle * angle / 24;
	} else {
		a = sin(angle) / angle;
		b = (1 - cos(angle)) / (angle * angle);
	}
	matrix k = { { 0, -w[2], w[1] }, { w[2], 0, -w[0] }, { -w[1], w[0], 0 } }, kk;
	multiply(k, k, kk);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ret[i][j] = (i == j) + a * k[i][j] + b * kk[i][j];
}

/* Near half a turn the skew part vanishes; the axis then comes from the symmetric part. */
static void axis_near_half_turn(const matrix r, double cosine, double ret[3])
{
	int i = 0;
	for (int j = 1; j < 3; j++)
		if (r[j][j] > r[i][i])
			i = j;
	for (int j = 0; j < 3; j++)
		ret[j] = (r[i][j] + r[j][i]) / 2 - (i == j) * cosine;
	double n = length(ret);
	for (int j = 0; j < 3; j++)
		ret[j] /= n;
}

static void vector_from_rotation(const struct pose *p, double ret[3])
{
	double angle = pose_angle_rad(p), skew[3];
	skew_part(p->rotation, skew);
	double sine = length(skew) / 2;
	if (angle < 3.1) {
		double scale = sine < 1e-9 ? 0.5 : angle / (2 * sine);
		for (int i = 0; i < 3; i++)
			ret[i] = skew[i] * scale;
		return;
	}
	axis_near_half_turn(p->rotation, cos(angle), ret);
	double along = ret[0] * skew[0] + ret[1] * skew[1] + ret[2] * skew[2];
	for (int i = 0; i < 3; i++)
		ret[i] *= along < 0 ? -angle : angle;
}

struct pose pose_perturb(const struct pose *p, const double twist[6])
{
	matrix turn;
	rotation_from_vector(twist, turn);
	struct pose q;
	multiply(turn, p->rotation, q.rotation);
	for (int i = 0; i < 3; i++)
		q.translation_m[i] = turn[i][0] * p->translation_m[0] +
				     turn[i][1] * p->translation_m[1] +
				     turn[i][2] * p->translation_m[2] + twist[3 + i];
	return q;
}

void pose_difference(const struct pose *from, const struct pose *to, double ret_twist[6])
{
	/* to = turn * from: turn = to * inverse(from). */
	struct pose back = pose_inverse(from), turn = pose_compose(to, &back);
	vector_from_rotation(&turn, ret_twist);
	memcpy(ret_twist + 3, turn.translation_m, sizeof turn.translation_m);
}

void pose_orthonormalise(struct pose *p)
{
	/* Newton's iteration for the nearest rotation: R <- R (3 I - R^T R) / 2. Quadratic, for a
	 * matrix that is a rotation but for rounding. */
	for (int pass = 0; pass < 3; pass++) {
		matrix square, next;
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++) {
				double dot = 0;
				for (int k = 0; k < 3; k++)
					dot += p->rotation[k][i] * p->rotation[k][j];
				square[i][j] = (i == j ? 1.5 : 0) - 0.5 * dot;
			}
		multiply(p->rotation, square, next);
		memcpy(p->rotation, next, sizeof next);
	}
}

bool pose_is_rigid(const struct pose *p, double tolerance)
{
	const double(*r)[3] = p->rotation;
	for (int i = 0; i < 3; i++) {
		if (!isfinite(p->translation_m[i]))
			return false;
		for (int j = 0; j < 3; j++) {
			double dot = r[0][i] * r[0][j] + r[1][i] * r[1][j] + r[2][i] * r[2][j];
			if (!(fabs(dot - (i == j)) <= tolerance))
				return false;
		}
	}
	double determinant = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
			     r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
			     r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
	return determinant > 0;
}
