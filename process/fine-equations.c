#include "process/fine-equations.h"
#include <math.h>
#include <string.h>

void equations_mirror(struct equations *e)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < i; j++) {
			e->matrix[i][j] = e->matrix[j][i];
			e->slope[i][j] = e->slope[j][i];
		}
}

static bool factor(const double matrix[6][6], double ret[6][6])
{
	memset(ret, 0, sizeof(double[6][6]));
	for (int j = 0; j < 6; j++) {
		double d = matrix[j][j];
		for (int k = 0; k < j; k++)
			d -= ret[j][k] * ret[j][k];
		if (!(d > 1e-12 * matrix[j][j]) || !isfinite(d))
			return false;
		ret[j][j] = sqrt(d);
		for (int i = j + 1; i < 6; i++) {
			double s = matrix[i][j];
			for (int k = 0; k < j; k++)
				s -= ret[i][k] * ret[j][k];
			ret[i][j] = s / ret[j][j];
		}
	}
	return true;
}

static void substitute(const double l[6][6], const double right[6], double ret[6])
{
	for (int i = 0; i < 6; i++) {
		double s = right[i];
		for (int k = 0; k < i; k++)
			s -= l[i][k] * ret[k];
		ret[i] = s / l[i][i];
	}
	for (int i = 5; i >= 0; i--) {
		double s = ret[i];
		for (int k = i + 1; k < 6; k++)
			s -= l[k][i] * ret[k];
		ret[i] = s / l[i][i];
	}
}

bool equations_solve(const double matrix[6][6], const double right[6], double ret[6])
{
	double l[6][6];
	if (!factor(matrix, l))
		return false;
	substitute(l, right, ret);
	return true;
}

bool equations_invert(const double matrix[6][6], double ret[6][6])
{
	double l[6][6];
	if (!factor(matrix, l))
		return false;
	for (int i = 0; i < 6; i++) {
		double unit[6] = { 0 };
		unit[i] = 1;
		substitute(l, unit, ret[i]); /* symmetric: a column is a row */
	}
	return true;
}

static void turn(double m[6][6], int p, int q)
{
	if (fabs(m[p][q]) < 1e-300)
		return;
	double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
	double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
	double c = 1 / sqrt(t * t + 1), s = t * c;
	for (int k = 0; k < 6; k++) {
		double a = m[k][p], b = m[k][q];
		m[k][p] = c * a - s * b;
		m[k][q] = s * a + c * b;
	}
	for (int k = 0; k < 6; k++) {
		double a = m[p][k], b = m[q][k];
		m[p][k] = c * a - s * b;
		m[q][k] = s * a + c * b;
	}
}

void equations_eigenvalues(const double matrix[6][6], double ret[6])
{
	double m[6][6];
	memcpy(m, matrix, sizeof m);
	for (int sweep = 0; sweep < 12; sweep++)
		for (int p = 0; p < 5; p++)
			for (int q = p + 1; q < 6; q++)
				turn(m, p, q);
	for (int i = 0; i < 6; i++) {
		int at = i;
		for (; at > 0 && ret[at - 1] > m[i][i]; at--)
			ret[at] = ret[at - 1];
		ret[at] = m[i][i];
	}
}

void equations_scale(const struct equations *e, double ret[6][6])
{
	double w = e->weight > 0 ? e->weight : 1, c[3], distance2 = e->square_m2 / w;
	for (int k = 0; k < 3; k++) {
		c[k] = e->point_m[k] / w;
		distance2 -= c[k] * c[k];
	}
	double unit = 1 / sqrt(fmax(distance2, 1e-6));
	/* A turn by w about c moves the origin by -w x c: twist = t * scaled twist. */
	double t[6][6] = { 0 }, half[6][6];
	for (int k = 0; k < 3; k++) {
		t[k][k] = unit;
		t[3 + k][3 + k] = 1;
		t[3 + k][(k + 1) % 3] = -unit * c[(k + 2) % 3];
		t[3 + k][(k + 2) % 3] = unit * c[(k + 1) % 3];
	}
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++) {
			half[i][j] = 0;
			for (int k = 0; k < 6; k++)
				half[i][j] += e->matrix[i][k] * t[k][j] / w;
		}
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++) {
			ret[i][j] = 0;
			for (int k = 0; k < 6; k++)
				ret[i][j] += t[k][i] * half[k][j];
		}
}
