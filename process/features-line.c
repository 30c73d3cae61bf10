#include "process/features-private.h"
#include "process/model.h"
#include "process/vector3.h"
#include <string.h>

/* Points so far off the line are on it, in what is explained. */
#define ON_LINE 2.0f
/* What lies along the line is so much more than what lies along any other through the point, on average: leaves have as much. */
#define STANDS_OUT 2.1f
#define OTHERS     6
#define ERROR_MOST 1.2f
/* The direction's own error, from how far the points are off the line, 1 sigma. */
#define CERTAIN_RAD  0.024f
#define LONG_ENOUGH  0.27f /* standard deviation along it, in the radius */
#define POINTS_LEAST 6
/* Of so many parts of a line's length. */
#define PARTS        16
#define FILLED_LEAST 0.7f
/* Directions of the halves of a line are apart by less, in rad. */
#define HALVES_APART 0.1f
/* Cuts of planes along a crease: the cosine of what they may be apart, how many, how far they are off their mean. */
#define SAME_CUT        0.966f
#define CUTS_LEAST      4
#define CUT_CERTAIN_RAD 0.12f
#define ROUNDS          3
#define TUBE            1.5f
/* Lines that are tried first, to points in this part of the radius. */
#define STARTS      16
#define START_SHARE 0.4f
#define OWN_WEIGHT  2.0f

void feature_keep_point(struct feature_around *a, const float at[3], const float cut[3],
	float weight, uint8_t frame)
{
	if (a->count ==
		FEATURE_POINTS_MOST) { /* a window wider than it must be: half of them are enough */
		for (uint32_t i = 0; i < FEATURE_POINTS_MOST / 2; i++) {
			a->x[i] = a->x[2 * i];
			a->y[i] = a->y[2 * i];
			a->z[i] = a->z[2 * i];
			a->weight[i] = 2 * a->weight[2 * i];
			memcpy(a->cut[i], a->cut[2 * i], sizeof a->cut[i]);
			a->frame[i] = a->frame[2 * i];
		}
		a->count = FEATURE_POINTS_MOST / 2;
	}
	a->x[a->count] = at[0];
	a->y[a->count] = at[1];
	a->z[a->count] = at[2];
	for (int k = 0; k < 3; k++)
		a->cut[a->count][k] = cut ? cut[k] : 0;
	a->frame[a->count] = frame;
	a->weight[a->count++] = weight;
}

struct moments {
	float n, s[3], m[6];
};

/* Of the points, each weighed by how near the line it is (tube_m: a quarter is left). */
static struct moments sum_moments(
	const struct feature_around *a, const struct feature_line *l, float tube_m)
{
	float n = OWN_WEIGHT, sx = 0, sy = 0, sz = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0,
	      zz = 0;
	const float per = 1 / (tube_m * tube_m), ux = l->direction[0], uy = l->direction[1],
		    uz = l->direction[2];
	const float ox = l->middle[0], oy = l->middle[1], oz = l->middle[2];
#pragma omp simd reduction(+ : n, sx, sy, sz, xx, xy, xz, yy, yz, zz)
	for (uint32_t i = 0; i < a->count; i++) {
		float x = a->x[i], y = a->y[i], z = a->z[i], dx = x - ox, dy = y - oy, dz = z - oz;
		float along = dx * ux + dy * uy + dz * uz;
		float off = 1 + (dx * dx + dy * dy + dz * dz - along * along) * per;
		float w = a->weight[i] / (off * off);
		n += w;
		sx += w * x;
		sy += w * y;
		sz += w * z;
		xx += w * x * x;
		xy += w * x * y;
		xz += w * x * z;
		yy += w * y * y;
		yz += w * y * z;
		zz += w * z * z;
	}
	return (struct moments){ n, { sx, sy, sz }, { xx, xy, xz, yy, yz, zz } };
}

/* The smallest eigenvalue of their M' = sigma I - M is the largest of M: by its powers, from the direction before. */
static void fit_round(struct feature_line *l, const struct feature_around *a, float tube_m)
{
	struct moments t = sum_moments(a, l, tube_m);
	float c[3][3] = { { t.m[0], t.m[1], t.m[2] }, { t.m[1], t.m[3], t.m[4] },
		{ t.m[2], t.m[4], t.m[5] } };
	float *v = l->direction;
	for (int p = 0; p < 3; p++)
		l->middle[p] = t.s[p] / t.n;
	for (int p = 0; p < 3; p++)
		for (int q = 0; q < 3; q++)
			c[p][q] = c[p][q] / t.n - l->middle[p] * l->middle[q];
	for (int k = 0; k < 3; k++) {
		float next[3], length = 0;
		for (int p = 0; p < 3; p++) {
			next[p] = c[p][0] * v[0] + c[p][1] * v[1] + c[p][2] * v[2];
			length += next[p] * next[p];
		}
		length = sqrtf(length);
		if (!(length > 1e-12f))
			return;
		for (int p = 0; p < 3; p++)
			v[p] = next[p] / length;
	}
}

/* How much lies about the line from the point itself that way. */
static float weight_along(const struct feature_around *a, const float u[3], float tube_m)
{
	const float ux = u[0], uy = u[1], uz = u[2], most = tube_m * tube_m;
	float sum = 0;
#pragma omp simd reduction(+ : sum)
	for (uint32_t i = 0; i < a->count; i++) {
		float along = a->x[i] * ux + a->y[i] * uy + a->z[i] * uz;
		float off2 =
			a->x[i] * a->x[i] + a->y[i] * a->y[i] + a->z[i] * a->z[i] - along * along;
		float w = a->weight[i];
		sum += off2 < most ? w : 0;
	}
	return sum;
}

/* Of the lines to points far enough off, the one that has most about it: where several edges meet, their common axis is none. */
static bool find_start(
	struct feature_line *l, const struct feature_around *a, float radius_m, float tube_m)
{
	float best = 0;
	uint32_t stride = MAX(a->count / STARTS, 1);
	for (uint32_t i = stride / 2; i < a->count; i += stride) {
		float u[3] = { a->x[i], a->y[i], a->z[i] },
		      length = sqrtf(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
		if (length < START_SHARE * radius_m)
			continue;
		for (int k = 0; k < 3; k++)
			u[k] /= length;
		float weight = weight_along(a, u, tube_m);
		if (weight > best) {
			best = weight;
			memcpy(l->direction, u, sizeof u);
		}
	}
	return best > 0;
}

/* What lies along lines through the point in the picture's plane, on average; ahead: where the scanner looks. */
static float weight_of_others(const struct feature_around *a, const float ahead[3], float tube_m)
{
	const float level = fmaxf(hypotf(ahead[0], ahead[1]), 1e-6f);
	const float right[3] = { ahead[1] / level, -ahead[0] / level, 0 };
	const float up[3] = { ahead[2] * right[1], -ahead[2] * right[0], level };
	float sum = 0;
	for (int k = 0; k < OTHERS; k++) {
		float c = cosf((float)G_PI * (float)k / OTHERS),
		      s = sinf((float)G_PI * (float)k / OTHERS), u[3];
		for (int d = 0; d < 3; d++)
			u[d] = c * right[d] + s * up[d];
		sum += weight_along(a, u, tube_m);
	}
	return sum / OTHERS;
}

/* Measures what lies on the line; 0: nothing, or not the point itself; else how many points, if all had the same weight. */
static float measure_line(
	const struct feature_around *a, struct feature_line *l, float on_m2, float *ret_on)
{
	const float ux = l->direction[0], uy = l->direction[1], uz = l->direction[2],
		    ox = l->middle[0], oy = l->middle[1], oz = l->middle[2];
	float on = 0, on2 = 0, error = 0, along2 = 0, mean = 0;
#pragma omp simd reduction(+ : on, on2, error, along2, mean)
	for (uint32_t i = 0; i < a->count; i++) {
		float dx = a->x[i] - ox, dy = a->y[i] - oy, dz = a->z[i] - oz,
		      along = dx * ux + dy * uy + dz * uz;
		float off2 = dx * dx + dy * dy + dz * dz - along * along;
		float w = a->weight[i];
		w = off2 < on_m2 ? w : 0;
		on += w;
		on2 += w * w;
		error += w * off2;
		mean += w * along;
		along2 += w * along * along;
	}
	float own = ox * ux + oy * uy + oz * uz, own2 = ox * ox + oy * oy + oz * oz - own * own;
	*ret_on = on;
	if (!(on > 0))
		return 0;
	l->error_m = sqrtf(fmaxf(error / on, 0));
	l->spread_m = sqrtf(fmaxf(along2 / on - mean * mean / (on * on), 0));
	return own2 < on_m2 ? on * on / on2 : 0;
}

/* By how much the directions of the two halves of a line differ, as the sine. */
static float halves_apart(const struct feature_around *a, const struct feature_line *l, float on_m2)
{
	float n[2] = { 0 }, t[2] = { 0 }, tt[2] = { 0 }, p[2][3] = { { 0 } }, tp[2][3] = { { 0 } };
	const float *u = l->direction, *o = l->middle;
	for (uint32_t i = 0; i < a->count; i++) {
		float d[3] = { a->x[i] - o[0], a->y[i] - o[1], a->z[i] - o[2] },
		      along = d[0] * u[0] + d[1] * u[1] + d[2] * u[2], off2 = 0;
		for (int k = 0; k < 3; k++) {
			d[k] -= along * u[k];
			off2 += d[k] * d[k];
		}
		if (off2 >= on_m2)
			continue;
		int h = along > 0;
		float w = a->weight[i];
		n[h] += w;
		t[h] += w * along;
		tt[h] += w * along * along;
		for (int k = 0; k < 3; k++) {
			p[h][k] += w * d[k];
			tp[h][k] += w * along * d[k];
		}
	}
	float apart2 = 0;
	for (int k = 0; k < 3; k++) {
		float slope[2];
		for (int h = 0; h < 2; h++)
			slope[h] =
				(tp[h][k] - t[h] * p[h][k] / n[h]) / (tt[h] - t[h] * t[h] / n[h]);
		apart2 += (slope[0] - slope[1]) * (slope[0] - slope[1]);
	}
	return isfinite(apart2) ? sqrtf(apart2) : INFINITY;
}

/* Of the parts of the line between the first and the last that have points, the share that has some: what lies across the bars of a
 * railing is no line. */
static float share_filled(
	const struct feature_around *a, const struct feature_line *l, float on_m2, float radius_m)
{
	const float *u = l->direction, *o = l->middle, per = PARTS / (2 * radius_m);
	uint32_t filled = 0;
	for (uint32_t i = 0; i < a->count; i++) {
		const float off[3] = { a->x[i] - o[0], a->y[i] - o[1], a->z[i] - o[2] },
			    along = vector3_dot(off, u);
		const float part = along * per + PARTS / 2.f;
		if (vector3_dot(off, off) - along * along < on_m2 && part >= 0 && part < PARTS)
			filled |= 1u << (int)part;
	}
	if (!filled)
		return 0;
	const int span = 32 - __builtin_clz(filled) - __builtin_ctz(filled);
	return (float)__builtin_popcount(filled) / (float)span;
}

/* Whether it is one: it stands out, without gaps, its direction is certain, and the point itself is on it. */
static bool is_line(const struct feature_around *a, struct feature_line *l, const float ahead[3],
	float explained_m, float radius_m)
{
	const float on_m2 = ON_LINE * ON_LINE * explained_m * explained_m;
	float on, count = measure_line(a, l, on_m2, &on);
	return count > 0 && l->error_m <= ERROR_MOST * explained_m &&
	       l->error_m <= CERTAIN_RAD * l->spread_m * sqrtf(count) &&
	       l->spread_m >= LONG_ENOUGH * radius_m && halves_apart(a, l, on_m2) <= HALVES_APART &&
	       share_filled(a, l, on_m2, radius_m) >= FILLED_LEAST &&
	       on >= STANDS_OUT * weight_of_others(a, ahead, ON_LINE * explained_m);
}

/* The mean of the cuts of planes about a line through the point that agree with one, and how far off it they are, in rad;
 * the number of them. */
static uint32_t mean_cut(const struct feature_around *a, const float with[3], float on_m2,
	float ret[3], float *ret_off_rad)
{
	float sum[3] = { 0 }, all = 0;
	uint32_t count = 0;
	for (uint32_t i = 0; i < a->count; i++) {
		const float *c = a->cut[i];
		float cosine = c[0] * with[0] + c[1] * with[1] + c[2] * with[2];
		float along = a->x[i] * with[0] + a->y[i] * with[1] + a->z[i] * with[2];
		float off2 =
			a->x[i] * a->x[i] + a->y[i] * a->y[i] + a->z[i] * a->z[i] - along * along;
		if (fabsf(cosine) < SAME_CUT || off2 > on_m2)
			continue;
		float w = cosine > 0 ? a->weight[i] : -a->weight[i];
		for (int k = 0; k < 3; k++)
			sum[k] += w * c[k];
		all += a->weight[i];
		count++;
	}
	float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	if (!(length > 0))
		return 0;
	for (int k = 0; k < 3; k++)
		ret[k] = sum[k] / length;
	*ret_off_rad = sqrtf(fmaxf(2 * (1 - length / all), 0));
	return count;
}

/* At a crease: the line that the planes' cuts along it agree on; which it is, the faces tell. */
static bool fit_cuts(const struct feature_around *a, const float cut[3], float explained_m,
	struct feature_line *ret)
{
	const float on_m2 = ON_LINE * ON_LINE * explained_m * explained_m;
	float off_rad = 0, on;
	uint32_t count = mean_cut(a, cut, on_m2, ret->direction, &off_rad);
	for (int round = 0; round < 2 && count; round++) {
		float with[3] = { ret->direction[0], ret->direction[1], ret->direction[2] };
		count = mean_cut(a, with, on_m2, ret->direction, &off_rad);
	}
	memset(ret->middle, 0, sizeof ret->middle);
	return count >= CUTS_LEAST && off_rad < CUT_CERTAIN_RAD &&
	       measure_line(a, ret, on_m2, &on) > 0;
}

bool feature_fit_line(const struct feature_around *a, const float cut[3], const float ahead[3],
	float explained_m, float radius_m, struct feature_line *ret)
{
	*ret = (struct feature_line){ .error_m = NAN };
	if (a->count < POINTS_LEAST || (cut && fit_cuts(a, cut, explained_m, ret)))
		return false;
	*ret = (struct feature_line){ .error_m = NAN };
	if (!find_start(ret, a, radius_m, ON_LINE * explained_m))
		return false;
	for (int round = 0; round < ROUNDS; round++)
		fit_round(ret, a, explained_m * TUBE);
	return is_line(a, ret, ahead, explained_m, radius_m);
}

void feature_measure_line(const struct feature_around *a, float explained_m, struct feature_line *l)
{
	float on;
	measure_line(a, l, ON_LINE * ON_LINE * explained_m * explained_m, &on);
}

void feature_keep_line(features *f, size_t i, const struct feature_line *l, bool is_line)
{
	f->kind[i] = is_line ? FEATURE_DIRECTED : FEATURE_UNDIRECTED;
	if (!isfinite(l->error_m))
		return;
	f->line_error[i] = (uint16_t)fminf(lrintf(l->error_m * 1e4f), FEATURE_LINE_ERROR_NONE - 1);
	model_pack_normal(l->direction, f->direction[i]);
}
