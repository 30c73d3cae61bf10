#include "process/line-fit.h"
#include "process/normal-equations.h"
#include <math.h>
#include <string.h>

void line_sums_add(struct line_sums *s, const double at[3], double weight)
{
	int p = 0;
	s->weight += weight;
	for (int j = 0; j < 3; j++) {
		s->sum[j] += weight * at[j];
		for (int k = j; k < 3; k++)
			s->product[p++] += weight * at[j] * at[k];
	}
}

bool line_sums_fit(const struct line_sums *s, struct straight *ret, double *ret_off_m)
{
	static const int place[9] = { 0, 1, 2, 1, 3, 4, 2, 4, 5 };
	double matrix[9], value[3], vector[9], mean[3];
	if (!(s->weight > 0))
		return false;
	for (int k = 0; k < 3; k++)
		mean[k] = s->sum[k] / s->weight;
	for (int n = 0; n < 9; n++)
		matrix[n] = s->product[place[n]] / s->weight - mean[n / 3] * mean[n % 3];
	normal_equations_eigen(matrix, 3, value, vector);
	if (!(value[0] > 1e-12))
		return false;
	memcpy(ret->at, mean, sizeof mean);
	memcpy(ret->along, vector, sizeof ret->along);
	if (ret_off_m)
		*ret_off_m = sqrt(fmax(value[1] + value[2], 0));
	return true;
}

double straight_along(const struct straight *l, const double at[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (at[k] - l->at[k]) * l->along[k];
	return sum;
}

double straight_off(const struct straight *l, const double at[3])
{
	double along = straight_along(l, at), square = 0;
	for (int k = 0; k < 3; k++) {
		double off = at[k] - l->at[k] - along * l->along[k];
		square += off * off;
	}
	return sqrt(square);
}

void straight_place(const struct straight *l, double along_m, double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = l->at[k] + along_m * l->along[k];
}

bool straight_nearest(const double p[3], const double along[3], const double q[3],
	const double way[3], double sine2_least, double ret[2])
{
	double cosine = 0, a = 0, b = 0;
	for (int k = 0; k < 3; k++) {
		cosine += along[k] * way[k];
		a += (q[k] - p[k]) * along[k];
		b += (p[k] - q[k]) * way[k];
	}
	double sine2 = 1 - cosine * cosine;
	ret[0] = (a + cosine * b) / sine2;
	ret[1] = (b + cosine * a) / sine2;
	return sine2 > sine2_least;
}
