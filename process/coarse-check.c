#include "process/coarse-check.h"
#include "process/vector3.h"
#include <stdlib.h>
#include <string.h>

#define VOXEL_M       0.6f
#define RANGE_MAX_M   60.0f
#define GROUND_EVERY  4 /* of the ground's samples one in so many is taken */
#define FACES_UP      0.9f
#define SAMPLES_MAX   1500
#define SAME_FACING   0.8f
#define ALONG_M       1.5f /* an agreeing sample lies no further from the cell's point */
#define NOTHING_SHARE 0.3f /* a conflict with no return counts less: glass, water, black */
#define PAIRS_MIN     15

struct picked {
	uint32_t key[3];
	uint32_t order;
	uint32_t cell;
};

static uint32_t mix(uint32_t h)
{
	h ^= h >> 16;
	h *= 0x7feb352du;
	h ^= h >> 15;
	h *= 0x846ca68bu;
	return h ^ h >> 16;
}

static int by_voxel(const void *a, const void *b)
{
	const struct picked *x = a, *y = b;
	for (int i = 0; i < 3; i++)
		if (x->key[i] != y->key[i])
			return x->key[i] < y->key[i] ? -1 : 1;
	return (x->order > y->order) - (x->order < y->order);
}

static int by_order(const void *a, const void *b)
{
	const struct picked *x = a, *y = b;
	return x->order != y->order ? (x->order > y->order) - (x->order < y->order)
				    : by_voxel(a, b);
}

static size_t thin_voxels(struct picked *p, size_t count)
{
	size_t kept = 0;
	qsort(p, count, sizeof *p, by_voxel);
	for (size_t i = 0; i < count; i++)
		if (!kept || memcmp(p[i].key, p[kept - 1].key, sizeof p->key) != 0)
			p[kept++] = p[i];
	qsort(p, kept, sizeof *p, by_order);
	return MIN(kept, SAMPLES_MAX);
}

static float along(const float v[3], const double up[3])
{
	return v[0] * (float)up[0] + v[1] * (float)up[1] + v[2] * (float)up[2];
}

static bool has_normal(const struct coarse_cell *c)
{
	return c->near_m > 0 && (c->normal[0] || c->normal[1] || c->normal[2]);
}

struct coarse_sample *coarse_samples_new(
	const struct coarse_view *v, const double up[3], size_t *ret_count)
{
	uint32_t cells = v->columns * v->rows;
	g_autofree struct picked *picked = g_new(struct picked, cells + 1);
	size_t count = 0;
	for (uint32_t i = 0; i < cells; i++) {
		const struct coarse_cell *c = &v->cell[i];
		uint32_t order = mix(i + 1);
		if (!has_normal(c) || c->near_m > RANGE_MAX_M)
			continue;
		if (along(c->normal, up) > FACES_UP && order % GROUND_EVERY)
			continue;
		struct picked *p = &picked[count++];
		*p = (struct picked){ .order = order, .cell = i };
		for (int k = 0; k < 3; k++)
			p->key[k] = (uint32_t)(int32_t)floorf(c->point_m[k] / VOXEL_M);
	}
	count = thin_voxels(picked, count);
	struct coarse_sample *s = g_new(struct coarse_sample, count + 1);
	for (size_t i = 0; i < count; i++) {
		const struct coarse_cell *c = &v->cell[picked[i].cell];
		memcpy(s[i].point_m, c->point_m, sizeof s->point_m);
		memcpy(s[i].normal, c->normal, sizeof s->normal);
		s[i].weight = along(c->normal, up) > FACES_UP ? 0.3f : 1;
	}
	*ret_count = count;
	return s;
}

/* Single precision: it runs some million times a pair. */
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

static void turn(const struct motion *m, const float v[3], float ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = m->r[i][0] * v[0] + m->r[i][1] * v[1] + m->r[i][2] * v[2];
}

static void move(const struct motion *m, const float v[3], float ret[3])
{
	turn(m, v, ret);
	for (int i = 0; i < 3; i++)
		ret[i] += m->t[i];
}

static void check_one(const struct coarse_cell *c, const struct coarse_sample *s, const float p[3],
	const float normal[3], float tolerance, struct coarse_fit *ret)
{
	float range = sqrtf(vector3_dot(p, p));
	if (c->near_m == COARSE_VIEW_NOTHING) {
		ret->conflict += NOTHING_SHARE * s->weight;
		return;
	}
	float off[3] = { p[0] - c->point_m[0], p[1] - c->point_m[1], p[2] - c->point_m[2] };
	float before =
		vector3_dot(c->normal, off); /* positive: nearer to the scanner than the plane */
	bool planar = has_normal(c);
	if (planar && fabsf(before) < tolerance && vector3_dot(off, off) < ALONG_M * ALONG_M) {
		if (vector3_dot(c->normal, normal) > SAME_FACING)
			ret->agree += s->weight;
		return;
	}
	if (range > c->far_m + tolerance)
		ret->hidden += s->weight;
	else if (range < c->near_m - tolerance && (!planar || before > tolerance))
		ret->conflict += s->weight;
}

void coarse_check(const struct coarse_view *a, const struct coarse_sample *b, size_t count,
	const struct pose *pose, float tolerance_m, struct coarse_fit *ret)
{
	struct motion m = motion_of(pose);
	for (size_t i = 0; i < count; i++) {
		float p[3], normal[3];
		move(&m, b[i].point_m, p);
		ret->total += b[i].weight;
		const struct coarse_cell *c = coarse_view_find(a, p);
		if (!c)
			continue;
		turn(&m, b[i].normal, normal);
		check_one(c, &b[i], p, normal, tolerance_m, ret);
	}
}

/* ---- refining ---- */

struct equations {
	double h[6][6], g[6];
	uint32_t pairs;
};

static void add_row(struct equations *e, const double j[6], double residual, double weight)
{
	for (int i = 0; i < 6; i++) {
		for (int k = 0; k <= i; k++)
			e->h[i][k] += weight * j[i] * j[k];
		e->g[i] -= weight * j[i] * residual;
	}
}

static void add_pair(const struct coarse_view *a, const struct motion *m,
	const struct coarse_sample *s, float gate, struct equations *e)
{
	float p[3], normal[3];
	move(m, s->point_m, p);
	const struct coarse_cell *c = coarse_view_find(a, p);
	if (!c || !has_normal(c))
		return;
	float off[3] = { p[0] - c->point_m[0], p[1] - c->point_m[1], p[2] - c->point_m[2] };
	float reach = gate + 1, residual = vector3_dot(c->normal, off);
	turn(m, s->normal, normal);
	if (!(fabsf(residual) < gate && vector3_dot(off, off) < reach * reach) ||
		vector3_dot(c->normal, normal) < 0.7f)
		return;
	const float *n = c->normal;
	double row[6] = { p[1] * n[2] - p[2] * n[1], p[2] * n[0] - p[0] * n[2],
		p[0] * n[1] - p[1] * n[0], n[0], n[1], n[2] };
	float scale = gate * gate / 9, w = scale / (scale + residual * residual);
	add_row(e, row, residual, (double)w * w * s->weight);
	e->pairs++;
}

/* b's up is to stay where the start had it. */
static void hold_upright(struct equations *e, const struct pose *start, const struct pose *now,
	const struct coarse_refining *how)
{
	if (!(how->tilt_sigma_rad > 0))
		return;
	double weight = e->pairs * pow(0.05 / how->tilt_sigma_rad, 2) / 4, was[3], is[3];
	for (int i = 0; i < 3; i++) {
		was[i] = start->rotation[i][2];
		is[i] = now->rotation[i][2];
	}
	for (int i = 0; i < 3; i++) { /* d(is) = rotation x is */
		double row[6] = { 0 };
		row[(i + 1) % 3] = is[(i + 2) % 3];
		row[(i + 2) % 3] = -is[(i + 1) % 3];
		add_row(e, row, is[i] - was[i], weight);
	}
}

static bool solve(struct equations *e, double ret[6])
{
	double trace = 0;
	for (int i = 0; i < 6; i++)
		trace += e->h[i][i];
	for (int i = 0; i < 6; i++)
		e->h[i][i] += 1e-5 * trace;
	for (int i = 0; i < 6; i++) /* Cholesky, in place */
		for (int j = 0; j <= i; j++) {
			double sum = e->h[i][j];
			for (int k = 0; k < j; k++)
				sum -= e->h[i][k] * e->h[j][k];
			if (i == j && !(sum > 0))
				return false;
			e->h[i][j] = i == j ? sqrt(sum) : sum / e->h[j][j];
		}
	for (int i = 0; i < 6; i++) {
		ret[i] = e->g[i];
		for (int k = 0; k < i; k++)
			ret[i] -= e->h[i][k] * ret[k];
		ret[i] /= e->h[i][i];
	}
	for (int i = 5; i >= 0; i--) {
		for (int k = i + 1; k < 6; k++)
			ret[i] -= e->h[k][i] * ret[k];
		ret[i] /= e->h[i][i];
	}
	return true;
}

bool coarse_refine(const struct coarse_view *a, const struct coarse_sample *b, size_t count,
	const struct coarse_refining *how, struct pose *pose)
{
	struct pose start = *pose;
	for (uint32_t i = 0; i < how->steps; i++) {
		float share = how->steps > 1 ? (float)i / (how->steps - 1) : 1;
		float gate = how->gate_from_m * powf(how->gate_to_m / how->gate_from_m, share);
		struct motion m = motion_of(pose);
		struct equations e = { 0 };
		double twist[6];
		for (size_t k = 0; k < count; k++)
			add_pair(a, &m, &b[k], gate, &e);
		if (e.pairs < PAIRS_MIN)
			return false;
		hold_upright(&e, &start, pose, how);
		if (!solve(&e, twist))
			return false;
		*pose = pose_perturb(pose, twist);
	}
	return true;
}
