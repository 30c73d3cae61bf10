#include "process/fine-pairs.h"
#include <string.h>

#define INLINE static inline __attribute__((always_inline))

struct motion {
	float r[3][3], t[3];
};

static struct motion motion_of(const struct pose *p)
{
	struct motion m;
	for (int i = 0; i < 3; i++) {
		m.t[i] = (float)p->translation_m[i];
		for (int j = 0; j < 3; j++)
			m.r[i][j] = (float)p->rotation[i][j];
	}
	return m;
}

INLINE void turn(const struct motion *m, const float v[3], float ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = m->r[i][0] * v[0] + m->r[i][1] * v[1] + m->r[i][2] * v[2];
}

INLINE void move(const struct motion *m, const float v[3], float ret[3])
{
	turn(m, v, ret);
	for (int i = 0; i < 3; i++)
		ret[i] += m->t[i];
}

INLINE float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* To 1e-5 rad, a hundredth of the finest cell: a polynomial for the eighth of a turn (fitted to minimise the largest error),
 * and symmetry. */
INLINE float angle_of(float y, float x)
{
	float ax = fabsf(x), ay = fabsf(y);
	float t = fminf(ax, ay) / fmaxf(fmaxf(ax, ay), 1e-30f), s = t * t;
	float a = t * (0.99997726f +
			      s * (-0.33262347f +
					  s * (0.19354346f +
						      s * (-0.11643287f +
								  s * (0.05265332f +
									      s * -0.01172120f)))));
	a = ay > ax ? (float)G_PI_2 - a : a;
	a = x < 0 ? (float)G_PI - a : a;
	return y < 0 ? -a : a;
}

/* Half-way between powers of two the wider cell begins. */
INLINE int level_of(float ratio)
{
	int level = 0;
	for (float limit = (float)G_SQRT2; level < PYRAMID_LEVELS - 1 && ratio > limit; limit *= 2)
		level++;
	return level;
}

int pairing_level(const pyramid *p, double pitch_m, float range_m)
{
	return level_of((float)(pitch_m / fmax(p->column_rad, p->row_rad)) / fmaxf(range_m, 1e-3f));
}

/* A pyramid as it is looked into. */
struct view {
	const pyramid *p;
	float ratio_m, columns_a_rad, rows_a_rad, azimuth_min, elevation_max;
};

static struct view view_into(const pyramid *p, double pitch_m)
{
	return (struct view){ p, (float)(pitch_m / fmax(p->column_rad, p->row_rad)),
		(float)(1 / p->column_rad), (float)(1 / p->row_rad), (float)p->azimuth_min_rad,
		(float)p->elevation_max_rad };
}

struct place {
	int level;
	int32_t column, row; /* at its level */
};

INLINE bool find(const struct view *v, const float q[3], struct place *ret)
{
	float level2 = q[0] * q[0] + q[1] * q[1];
	float range = sqrtf(level2 + q[2] * q[2]);
	int level = level_of(v->ratio_m / fmaxf(range, 1e-3f));
	float azimuth = angle_of(q[0], q[1]) - v->azimuth_min;
	azimuth = azimuth < 0 ? azimuth + (float)(2 * G_PI) : azimuth;
	float row = (v->elevation_max - angle_of(q[2], sqrtf(level2))) * v->rows_a_rad;
	int32_t column = (int32_t)(azimuth * v->columns_a_rad);
	if (!(row >= 0) || !(row < v->p->level[0].rows))
		return false;
	if (column >= (int32_t)v->p->level[0].columns) {
		if (!v->p->wraps)
			return false;
		column = 0;
	}
	*ret = (struct place){ level, column >> level, (int32_t)row >> level };
	return true;
}

/* By how much no surface is quite its plane, of the distance along it between the two cells' middles. It matters where cells
 * are long: lawn and road far away, met at a slant, which two scans see as planes of other parts of it. */
#define UNEVEN 0.008f

struct found {
	const struct surfel *surfel;
	float distance2;
};

/* The surfel of a cell, if it may be the same surface as a point with a normal. */
INLINE void consider(const struct surfel *s, const float q[3], const float n[3],
	const struct pairing *how, struct found *best)
{
	if (!(s->sigma_m > 0 && s->sigma_m < how->sigma_max_m) ||
		dot(s->normal, n) < how->cosine_min)
		return;
	float d[3] = { q[0] - s->point_m[0], q[1] - s->point_m[1], q[2] - s->point_m[2] };
	float distance2 = dot(d, d);
	if (distance2 < best->distance2)
		*best = (struct found){ s, distance2 };
}

static void consider_around(const pyramid *p, const struct place *at, const float q[3],
	const float n[3], const struct pairing *how, struct found *best)
{
	const struct pyramid_level *l = &p->level[at->level];
	int32_t columns = (int32_t)l->columns, rows = (int32_t)l->rows;
	for (int32_t r = MAX(at->row - 1, 0); r <= MIN(at->row + 1, rows - 1); r++)
		for (int32_t k = at->column - 1; k <= at->column + 1; k++) {
			int32_t c = k;
			if (k < 0 || k >= columns) {
				if (!p->wraps)
					continue;
				c = k < 0 ? columns - 1 : 0;
			}
			consider(&l->surfel[(size_t)r * l->columns + c], q, n, how, best);
		}
}

/* One row of the normal equations: distance between two planes, along the mean of their normals. That mean, not one of the
 * normals, makes the distance exact to second order on curved surfaces (Rusinkiewicz 2019, "A symmetric objective function
 * for ICP"), and treats both scans alike. All in a's frame. */
struct row {
	float j[6], e, sigma2;
	const float *q;
};

INLINE void make_row(
	const float pa[3], const float na[3], const float pb[3], const float nb[3], struct row *ret)
{
	float n[3] = { na[0] + nb[0], na[1] + nb[1], na[2] + nb[2] };
	float unit = 1 / sqrtf(fmaxf(dot(n, n), 1e-6f));
	for (int k = 0; k < 3; k++)
		n[k] *= unit;
	float d[3] = { pb[0] - pa[0], pb[1] - pa[1], pb[2] - pa[2] };
	ret->e = dot(n, d);
	ret->j[0] = pb[1] * n[2] - pb[2] * n[1];
	ret->j[1] = pb[2] * n[0] - pb[0] * n[2];
	ret->j[2] = pb[0] * n[1] - pb[1] * n[0];
	memcpy(ret->j + 3, n, sizeof n);
	ret->q = pb;
}

/* How the right side changes with the pose: less than the matrix says, since the kernel lets go of what moves away. */
INLINE void add_slope(const struct row *row, float kernel, float share, struct equations *e)
{
	float slope = kernel * (1 - 4 * (1 - share)) / row->sigma2;
	for (int i = 0; i < 6; i++)
		for (int k = i; k < 6; k++)
			e->slope[i][k] += (double)(slope * row->j[i]) * row->j[k];
}

INLINE void add_row(const struct row *row, float scale2, struct equations *e, double *tile)
{
	float z2 = row->e * row->e / row->sigma2;
	float share = scale2 / (scale2 + z2), kernel = share * share; /* Geman-McClure */
	float w = kernel / row->sigma2;
	for (int i = 0; i < 6; i++) {
		float wj = w * row->j[i];
		double g = -(double)wj * row->e;
		e->right[i] += g;
		if (tile)
			tile[i] += g;
		for (int k = i; k < 6; k++)
			e->matrix[i][k] += (double)wj * row->j[k];
	}
	if (tile)
		add_slope(row, kernel, share, e);
	e->weight += w;
	for (int k = 0; k < 3; k++)
		e->point_m[k] += (double)w * row->q[k];
	e->square_m2 += (double)w * dot(row->q, row->q);
	e->distance2_m2 += (double)w * row->e * row->e;
	e->pairs++;
}

/* A part of a's view, whichever way the pair was found: both ways find the same pairs. */
INLINE size_t tile_of(const float point[3])
{
	float turn = angle_of(point[0], point[1]) * (float)(0.5 / G_PI) + 0.5f;
	float rise = angle_of(point[2], sqrtf(point[0] * point[0] + point[1] * point[1])) *
			     (float)(1 / G_PI) +
		     0.5f;
	size_t column = MIN((size_t)(turn * PAIRS_TILES_ACROSS), PAIRS_TILES_ACROSS - 1);
	size_t row = MIN((size_t)(rise * PAIRS_TILES_DOWN), PAIRS_TILES_DOWN - 1);
	return row * PAIRS_TILES_ACROSS + column;
}

/* Seen through: what stands at this range is nearer than all that the cells around saw. */
#define THROUGH_M     0.3f
#define THROUGH_SHARE 0.1f

INLINE void look_at(const struct pyramid_level *l, const struct place *at, float range_m,
	struct pairs_look *look)
{
	const struct surfel *middle = &l->surfel[(size_t)at->row * l->columns + at->column];
	if (!(middle->range_m > 0))
		return;
	look->seen++;
	float beyond = range_m * (1 + THROUGH_SHARE) + THROUGH_M;
	if (!(middle->range_m > beyond))
		return;
	for (int32_t r = at->row - 1; r <= at->row + 1; r++)
		for (int32_t c = at->column - 1; c <= at->column + 1; c++) {
			if (r < 0 || c < 0 || r >= (int32_t)l->rows || c >= (int32_t)l->columns)
				continue;
			float range = l->surfel[(size_t)r * l->columns + c].range_m;
			if (range > 0 && range <= beyond)
				return;
		}
	look->seen_through++;
}

void pairs_sum(const struct pairing *how, const struct sample *samples, size_t count,
	const pyramid *into, const struct pose *pose, bool samples_are_b, struct equations *ret,
	float *ret_residual, struct pairs_look *ret_look, double (*ret_tile)[6])
{
	struct pose inverse = pose_inverse(pose);
	struct motion forth = motion_of(pose), there = samples_are_b ? forth : motion_of(&inverse);
	struct view view = view_into(into, how->pitch_m);
	float slack2 = (float)(how->slack_m * how->slack_m),
	      scale2 = (float)(how->scale * how->scale);
	float cell = (float)fmax(into->column_rad, into->row_rad),
	      reach = (float)(3 * how->slack_m);
	struct pairs_look look = { 0 };
	for (size_t i = 0; i < count; i++) {
		const struct sample *s = &samples[i];
		float q[3], n[3];
		struct place at;
		if (ret_residual)
			ret_residual[i] = NAN;
		move(&there, s->point_m, q);
		if (!find(&view, q, &at))
			continue;
		const struct pyramid_level *l = &into->level[at.level];
		const struct surfel *middle = &l->surfel[(size_t)at.row * l->columns + at.column];
		look_at(l, &at, sqrtf(dot(q, q)), &look);
		turn(&there, s->normal, n);
		float apart = reach + 2.5f * cell * (float)(1 << at.level) * sqrtf(dot(q, q));
		struct found best = { NULL, apart * apart };
		if (how->around)
			consider_around(into, &at, q, n, how, &best);
		else
			consider(middle, q, n, how, &best);
		if (!best.surfel)
			continue;
		struct row row;
		if (samples_are_b) {
			make_row(best.surfel->point_m, best.surfel->normal, q, n, &row);
		} else {
			float moved[3], turned[3];
			move(&forth, best.surfel->point_m, moved);
			turn(&forth, best.surfel->normal, turned);
			make_row(s->point_m, s->normal, moved, turned, &row);
			row.q = s->point_m;
		}
		row.sigma2 = best.surfel->sigma_m * best.surfel->sigma_m + s->sigma_m * s->sigma_m +
			     slack2 + UNEVEN * UNEVEN * best.distance2;
		if (ret_residual)
			ret_residual[i] = row.e / sqrtf(row.sigma2);
		add_row(&row, scale2, ret, ret_tile ? ret_tile[tile_of(row.q)] : NULL);
	}
	if (ret_look) {
		ret_look->seen += look.seen;
		ret_look->seen_through += look.seen_through;
	}
}
