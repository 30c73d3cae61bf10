#include "process/features-private.h"
#include "process/vector3.h"
#include <string.h>

/* Points of a window are looked at with so many cells in between that about half of these remain. */
#define POINTS_MOST  320
#define WINDOW_LEAST 2 /* cells each way */
#define WINDOW_MOST  48
/* Faces reach as far from the line as this share of the radius, and so many cells at least. */
#define ACROSS_SHARE 0.7f
#define ACROSS_CELLS 4.0f
/* Next to the line beams hit both faces at once. */
#define BESIDE_CELLS 1.0f
/* Planes are tried until one in so many times a better one would have been missed, but at most so many. */
#define TRIPLES_MOST 64
#define MISSED       0.01f
#define TRIED_MOST   80 /* points */
/* The sine of the angle of three points, of a face with the line; the line is so many times what is explained off a face. */
#define TRIPLE_SINE 0.1f
#define TILT_MOST   0.3f
#define OFF_LINE    4.0f
/* Points are on a face by so many sigma of noise, or so many times the root mean square of those that are. */
#define ON_FACE_SIGMAS 3.0f
#define ON_FACE_LEAST  1.5f
#define ON_FACE        2.5f
#define ROUNDS         3
#define POINTS_LEAST   10
#define LONG_ENOUGH    0.2f /* standard deviation along the line, in the radius */
/* A face is no rougher than noise would make it, so many times; at grazing beams noise is at least this share of itself. */
#define EVEN    1.6f
#define GRAZING 0.3f
/* Sines: of faces that cut each other in a line that is known; of a face with the plane that its end is seen in. */
#define CUT_LEAST 0.25f
#define EDGEWISE  0.34f
/* The direction, 1 sigma in rad; and the cosine of what it may be off what it began with. */
#define CERTAIN_RAD 0.012f
#define SAME_CUT    0.95f
#define SAME_END    0.97f
/* The line, and what is looked at around it; in the scanner's frame. */
struct surroundings {
	const range_grid *grid;
	size_t cell;
	float noise_m, explained_m, radius_m, spacing_m;
	bool is_cut_only; /* nothing but faces that cut each other is asked for */
	float at[3], along[3];
	float aside[3]; /* across the plane that the line is seen in */
};

/* Points on one side of the line in the picture; relative to `at`. */
struct side {
	uint32_t count;
	float x[POINTS_MOST], y[POINTS_MOST], z[POINTS_MOST], weight[POINTS_MOST];
};

struct face {
	float normal[3], offset_m; /* the plane's */
	float error_m, tilt_rad;   /* root mean square; 1 sigma along the line */
};

static bool look_aside(struct surroundings *s)
{
	vector3_cross(s->along, s->at, s->aside);
	return vector3_unit(s->aside);
}

/* A window of the grid, of which every so many cells each way are looked at, its middle one of them. */
struct window {
	int down, right, stride;
};

static struct window window_of(const struct surroundings *s)
{
	const range_grid *g = s->grid;
	const float range_m = vector3_length(s->at);
	const float level = fmaxf(hypotf(s->at[0], s->at[1]) / range_m, 0.1f);
	const float row_m = range_m * (float)g->row_rad,
		    column_m = range_m * level * (float)g->column_rad;
	const int down = CLAMP((int)(s->radius_m / row_m), WINDOW_LEAST, WINDOW_MOST);
	const int right = CLAMP((int)(s->radius_m / column_m), WINDOW_LEAST,
		MIN(WINDOW_MOST, (int)(g->columns - 1) / 2));
	const int stride =
		1 + (int)sqrtf((float)((2 * down + 1) * (2 * right + 1)) / (1.6f * POINTS_MOST));
	return (struct window){ down / stride * stride, right / stride * stride, stride };
}

/* Windows have fewer cells that are looked at. */
#define SEEN_MOST 1024
struct seen {
	uint32_t count;
	float x[SEEN_MOST], y[SEEN_MOST], z[SEEN_MOST], weight[SEEN_MOST], side[SEEN_MOST];
};

/* Points of a window, as the scanner has them. */
static void see(const struct surroundings *s, struct seen *ret)
{
	const range_grid *g = s->grid;
	const struct window w = window_of(s);
	const int32_t row = (int32_t)(s->cell / g->columns), width = (int32_t)g->columns,
		      column = (int32_t)(s->cell % g->columns);
	uint32_t count = 0;
	for (int32_t y = row - w.down; y <= row + w.down; y += w.stride) {
		const size_t from = (size_t)y * g->columns;
		for (int32_t x = column - w.right; y >= 0 && y < (int32_t)g->rows &&
						   x <= column + w.right && count < SEEN_MOST;
			x += w.stride) {
			const int32_t c = x < 0 ? x + width : x >= width ? x - width : x;
			const size_t k = from + (size_t)c;
			if ((c != x && !g->wraps) || !(g->range_m[k] > 0))
				continue;
			ret->x[count] = g->x_m[k];
			ret->y[count] = g->y_m[k];
			ret->z[count++] = g->z_m[k];
		}
	}
	ret->count = count;
}

/* What is near the line, but not next to it: how much each point counts, 0 and less: not at all; and on which side it is. */
static void weigh(const struct surroundings *s, struct seen *p)
{
	const float beside_m = BESIDE_CELLS * s->spacing_m;
	const float across_m = fmaxf(ACROSS_SHARE * s->radius_m, ACROSS_CELLS * s->spacing_m);
	const float per_along = 1 / (s->radius_m * s->radius_m),
		    per_across = 1 / (across_m * across_m), beside2 = beside_m * beside_m;
	const float *at = s->at, *u = s->along, *v = s->aside;
#pragma omp simd
	for (uint32_t i = 0; i < p->count; i++) {
		const float x = p->x[i] - at[0], y = p->y[i] - at[1], z = p->z[i] - at[2];
		const float along = x * u[0] + y * u[1] + z * u[2],
			    across2 = x * x + y * y + z * z - along * along;
		float near = 1 - along * along * per_along, close = 1 - across2 * per_across;
		near = near > 0 ? near : 0;
		close = close > 0 ? close : 0;
		p->side[i] = p->x[i] * v[0] + p->y[i] * v[1] + p->z[i] * v[2];
		p->weight[i] = across2 > beside2 ? near * close : 0;
		p->x[i] = x;
		p->y[i] = y;
		p->z[i] = z;
	}
}

static void gather(const struct surroundings *s, struct side sides[2])
{
	struct seen seen;
	see(s, &seen);
	weigh(s, &seen);
	sides[0].count = sides[1].count = 0;
	for (uint32_t i = 0; i < seen.count; i++) {
		struct side *to = &sides[seen.side[i] > 0];
		if (!(seen.weight[i] > 0) || to->count == POINTS_MOST)
			continue;
		to->x[to->count] = seen.x[i];
		to->y[to->count] = seen.y[i];
		to->z[to->count] = seen.z[i];
		to->weight[to->count++] = seen.weight[i];
	}
}

/* ---- a face ---- */

/* How well the plane explains the points: less by those further off it. */
static float explain(const struct side *s, const struct face *f, float most_m)
{
	const float nx = f->normal[0], ny = f->normal[1], nz = f->normal[2], offset_m = f->offset_m,
		    per = 1 / (most_m * most_m);
	float ret = 0;
#pragma omp simd reduction(+ : ret)
	for (uint32_t i = 0; i < s->count; i++) {
		float h = nx * s->x[i] + ny * s->y[i] + nz * s->z[i] - offset_m;
		float share = 1 - h * h * per, weight = s->weight[i] * share;
		ret += share > 0 ? weight : 0;
	}
	return ret;
}

/* Through three points; false: they do not tell it, or it is not a face at the line. */
static bool face_through(
	const struct surroundings *s, const struct side *p, const uint32_t at[3], struct face *ret)
{
	const float a[3] = { p->x[at[0]], p->y[at[0]], p->z[at[0]] };
	const float b[3] = { p->x[at[1]] - a[0], p->y[at[1]] - a[1], p->z[at[1]] - a[2] };
	const float c[3] = { p->x[at[2]] - a[0], p->y[at[2]] - a[1], p->z[at[2]] - a[2] };
	vector3_cross(b, c, ret->normal);
	if (!(vector3_dot(ret->normal, ret->normal) >
		    TRIPLE_SINE * TRIPLE_SINE * vector3_dot(b, b) * vector3_dot(c, c)) ||
		!vector3_unit(ret->normal))
		return false;
	ret->offset_m = vector3_dot(ret->normal, a);
	return fabsf(ret->offset_m) < OFF_LINE * s->explained_m &&
	       fabsf(vector3_dot(ret->normal, s->along)) < TILT_MOST;
}

/* So many of the points tell planes apart as well as all. */
static void thin_out(const struct side *p, struct side *ret)
{
	const uint32_t stride = (p->count + TRIED_MOST - 1) / TRIED_MOST;
	ret->count = 0;
	for (uint32_t i = 0; i < p->count; i += stride) {
		const uint32_t to = ret->count++;
		ret->x[to] = p->x[i];
		ret->y[to] = p->y[i];
		ret->z[to] = p->z[i];
		ret->weight[to] = p->weight[i];
	}
}

/* Of planes through three points each, the one that explains most: others may stand on the same side. */
static bool find_face(const struct surroundings *s, const struct side *p, struct face *ret)
{
	float best = 0, all = 0, enough = TRIPLES_MOST;
	uint32_t random = 1;
	struct side thin;
	thin_out(p, &thin);
	p = &thin;
	for (uint32_t i = 0; i < p->count; i++)
		all += p->weight[i];
	for (int n = 0; (float)n < enough; n++) {
		uint32_t at[3];
		struct face f;
		for (int k = 0; k < 3; k++) {
			random = random * 1664525 + 1013904223;
			at[k] = (uint32_t)((uint64_t)(random >> 8) * p->count >> 24);
		}
		if (!face_through(s, p, at, &f))
			continue;
		float weight = explain(p, &f, ON_FACE_SIGMAS * s->noise_m);
		if (!(weight > best))
			continue;
		best = weight;
		*ret = f;
		float share = best / all, missed = 1 - share * share * share;
		enough = fminf(TRIPLES_MOST, logf(MISSED) / logf(fmaxf(missed, 1e-6f)));
	}
	return best > 0;
}

/* Weighted means, of heights over a plane (h) and places on it along the line (a) and across (t). */
struct sums {
	float count, weight, weight2, a, t, h, aa, at, tt, ah, th, hh;
};

static struct sums sum_up(const struct side *p, const struct face *f, const float along[3],
	const float across[3], float most_m)
{
	float count = 0, weight = 0, weight2 = 0, sa = 0, st = 0, sh = 0, saa = 0, sat = 0, stt = 0,
	      sah = 0, sth = 0, shh = 0;
	const float *n = f->normal;
#pragma omp simd reduction(+ : count, weight, weight2, sa, st, sh, saa, sat, stt, sah, sth, shh)
	for (uint32_t i = 0; i < p->count; i++) {
		float x = p->x[i], y = p->y[i], z = p->z[i];
		float h = n[0] * x + n[1] * y + n[2] * z - f->offset_m;
		float a = along[0] * x + along[1] * y + along[2] * z,
		      t = across[0] * x + across[1] * y + across[2] * z;
		float w = p->weight[i];
		w = fabsf(h) < most_m ? w : 0;
		count += fabsf(h) < most_m ? 1 : 0;
		weight += w;
		weight2 += w * w;
		sa += w * a;
		st += w * t;
		sh += w * h;
		saa += w * a * a;
		sat += w * a * t;
		stt += w * t * t;
		sah += w * a * h;
		sth += w * t * h;
		shh += w * h * h;
	}
	const float per = 1 / weight, a = sa * per, t = st * per, h = sh * per;
	return (struct sums){ count, weight, weight2, a, t, h, saa * per - a * a, sat * per - a * t,
		stt * per - t * t, sah * per - a * h, sth * per - t * h, shh * per - h * h };
}

/* The least squares plane of the points near it; false: they are too few, or too close together. */
static bool fit_round(
	const struct surroundings *s, const struct side *p, float most_m, struct face *f)
{
	float along[3] = { s->along[0], s->along[1], s->along[2] }, across[3];
	vector3_add(along, -vector3_dot(along, f->normal), f->normal);
	if (!vector3_unit(along))
		return false;
	vector3_cross(f->normal, along, across);
	const struct sums m = sum_up(p, f, along, across, most_m);
	const float det = m.aa * m.tt - m.at * m.at;
	if (m.count < POINTS_LEAST || !(det > 1e-3f * m.aa * m.tt) ||
		!(m.aa > LONG_ENOUGH * LONG_ENOUGH * s->radius_m * s->radius_m))
		return false;
	const float tilt = (m.ah * m.tt - m.th * m.at) / det,
		    slope = (m.th * m.aa - m.ah * m.at) / det;
	const float error2 = fmaxf(m.hh - tilt * m.ah - slope * m.th, 0);
	f->error_m = sqrtf(error2);
	f->tilt_rad = sqrtf(error2 * m.tt * m.weight2 / (det * m.weight * m.weight));
	f->offset_m += m.h - tilt * m.a - slope * m.t;
	vector3_add(f->normal, -tilt, along);
	vector3_add(f->normal, -slope, across);
	f->offset_m /= vector3_length(f->normal);
	return vector3_unit(f->normal);
}

static bool fit_face(const struct surroundings *s, const struct side *p, struct face *ret)
{
	float most_m = ON_FACE_SIGMAS * s->noise_m;
	if (p->count < POINTS_LEAST || !find_face(s, p, ret))
		return false;
	for (int round = 0; round < ROUNDS; round++) {
		if (!fit_round(s, p, most_m, ret))
			return false;
		most_m = CLAMP(ON_FACE * ret->error_m, ON_FACE_LEAST * s->noise_m,
			ON_FACE_SIGMAS * s->noise_m);
	}
	const float ahead = fabsf(vector3_dot(ret->normal, s->at)) / vector3_length(s->at);
	return fabsf(ret->offset_m) < OFF_LINE * s->explained_m &&
	       ret->error_m < EVEN * s->noise_m * fmaxf(ahead, GRAZING);
}

/* ---- the line ---- */

/* false: they are one plane. */
static bool cut_faces(const struct face f[2], float ret[3], float *ret_rad)
{
	vector3_cross(f[0].normal, f[1].normal, ret);
	float sine = vector3_length(ret);
	*ret_rad = hypotf(f[0].tilt_rad, f[1].tilt_rad) / sine;
	return sine > CUT_LEAST && vector3_unit(ret);
}

/* The line in the one plane of both. */
static bool lay_into(
	const struct surroundings *s, const struct face f[2], float ret[3], float *ret_rad)
{
	float normal[3] = { f[0].normal[0], f[0].normal[1], f[0].normal[2] };
	vector3_add(normal, vector3_dot(f[0].normal, f[1].normal) > 0 ? 1 : -1, f[1].normal);
	memcpy(ret, s->along, sizeof s->along);
	*ret_rad = hypotf(f[0].tilt_rad, f[1].tilt_rad);
	if (!vector3_unit(normal))
		return false;
	vector3_add(ret, -vector3_dot(normal, ret), normal);
	return vector3_unit(ret);
}

/* Where the one face ends: in it, and in the plane that the end is seen in. */
static bool end_face(
	const struct surroundings *s, const struct face *f, float ret[3], float *ret_rad)
{
	vector3_cross(f->normal, s->aside, ret);
	float sine = vector3_length(ret);
	*ret_rad = f->tilt_rad / sine;
	return sine > EDGEWISE && vector3_unit(ret);
}

/* ret: the direction, ret_rad: 1 sigma of it. */
static enum feature_faces tell(const struct surroundings *s, float ret[3], float *ret_rad)
{
	struct side sides[2];
	struct face f[2];
	gather(s, sides);
	const bool is_first = fit_face(s, &sides[0], &f[0]);
	if (s->is_cut_only && !is_first)
		return FEATURE_FACES_UNKNOWN;
	const bool is_second = fit_face(s, &sides[1], &f[1]);
	if (is_first && is_second && cut_faces(f, ret, ret_rad))
		return FEATURE_FACES_CUT;
	if (is_first && is_second && lay_into(s, f, ret, ret_rad))
		return FEATURE_FACES_ONE;
	if (is_first != is_second && end_face(s, &f[is_second], ret, ret_rad))
		return FEATURE_FACES_END;
	return FEATURE_FACES_UNKNOWN;
}

#if defined __x86_64__
__attribute__((flatten, target("avx2,fma"))) static enum feature_faces tell_avx2(
	const struct surroundings *s, float ret[3], float *ret_rad)
{
	return tell(s, ret, ret_rad);
}
#endif

enum feature_faces feature_faces_at(const range_grid *g, size_t cell, const float here[3],
	const struct features_options *o, float explained_m, float radius_m, bool is_cut_only,
	struct feature_line *l)
{
	struct surroundings s = { .grid = g,
		.cell = cell,
		.noise_m = feature_range_noise_m(o, g->range_m[cell]),
		.explained_m = explained_m,
		.radius_m = radius_m,
		.is_cut_only = is_cut_only,
		.spacing_m = range_grid_point_size_m(g, cell) };
	enum feature_faces (*tell_all)(const struct surroundings *, float *, float *) = tell;
#if defined __x86_64__
	if (!o->portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		tell_all = tell_avx2;
#endif
	float direction[3], uncertain_rad;
	memcpy(s.along, l->direction, sizeof s.along);
	for (int k = 0; k < 3; k++)
		s.at[k] = here[k] + l->middle[k];
	vector3_add(s.at, -vector3_dot(l->middle, l->direction), l->direction);
	if (!look_aside(&s))
		return FEATURE_FACES_UNKNOWN;
	enum feature_faces ret = tell_all(&s, direction, &uncertain_rad);
	if (ret == FEATURE_FACES_UNKNOWN)
		return ret;
	float cosine = fabsf(vector3_dot(direction, l->direction));
	if (!(uncertain_rad < CERTAIN_RAD) ||
		cosine < (ret == FEATURE_FACES_CUT ? SAME_CUT : SAME_END))
		return FEATURE_FACES_DISAGREE;
	memcpy(l->direction, direction, sizeof direction);
	return ret;
}
