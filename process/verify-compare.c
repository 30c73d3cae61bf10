#include "process/verify-compare.h"
#include "process/vector3.h"
#include "process/verify-conflicts.h"

#define SAME_FACING 0.8f
#define SIGMAS      3.0f
/* Foliage and the like agree with anything: surfaces less even than this tell nothing when they fit. */
#define SIGMA_MAX_M     0.04f
#define TOLERANCE_MAX_M 0.12f
/* Distances are told of surfaces that are even to this, where they mean something. */
#define EVEN_M 0.010f
/* How far along the surface the other's point may lie. */
#define REACH_CELLS 3.0f
#define REACH_M     0.05f
/* A parallel surface nearer than this that is not the same is a miss, when so many cells see it as one plane: a wall, not the
 * relief of a front. */
#define MISS_M         0.30f
#define MISS_FACING    0.95f
#define MISS_CELLS_MIN 4
/* By how much something must be in front to contradict: on its own, and of its range. */
#define DEPTH_M     0.06f
#define DEPTH_SHARE 0.004f
#define COSINE_MIN  0.15f

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

static inline void turn(const struct motion *m, const float v[3], float ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = vector3_dot(m->r[i], v);
}

/* A surface of `from`, as `into` has to see it. */
struct seen {
	float point[3], normal[3], sigma_m, range_m;
	float slack_m;
};

static struct seen see(const struct surfel *s, const struct motion *m, const struct comparing *how)
{
	struct seen p = { .sigma_m = s->sigma_m };
	turn(m, s->point_m, p.point);
	for (int k = 0; k < 3; k++)
		p.point[k] += m->t[k];
	turn(m, s->normal, p.normal);
	p.range_m = sqrtf(vector3_dot(p.point, p.point));
	p.slack_m = how->slack_m + how->slack_rad * p.range_m;
	return p;
}

/* What the surfels around the direction say of it. */
struct partner {
	float distance_m; /* of the plane that it agrees with */
	float variance;
	const float *normal;
	bool agrees, even;
	/* Of the parallel planes that it does not agree with. */
	int beside;
	float beside_min_m, beside_max_m, tolerance_m;
};

static inline void look_at(
	const struct surfel *s, const struct seen *p, float reach, struct partner *ret)
{
	if (!(s->sigma_m > 0 && s->sigma_m < SIGMA_MAX_M))
		return;
	float off[3] = { p->point[0] - s->point_m[0], p->point[1] - s->point_m[1],
		p->point[2] - s->point_m[2] };
	float facing = vector3_dot(s->normal, p->normal), distance = vector3_dot(s->normal, off);
	if (facing < SAME_FACING || vector3_dot(off, off) > reach * reach + distance * distance)
		return;
	float variance =
		s->sigma_m * s->sigma_m + p->sigma_m * p->sigma_m + p->slack_m * p->slack_m;
	float tolerance = fminf(SIGMAS * sqrtf(variance), TOLERANCE_MAX_M);
	if (fabsf(distance) <= tolerance) {
		if (!ret->agrees || fabsf(distance) < fabsf(ret->distance_m)) {
			ret->distance_m = distance;
			ret->normal = s->normal;
			ret->variance = variance;
			ret->even = fmaxf(s->sigma_m, p->sigma_m) < EVEN_M;
		}
		ret->agrees = true;
	} else if (fabsf(distance) < MISS_M && facing > MISS_FACING) {
		ret->beside_min_m = ret->beside ? fminf(ret->beside_min_m, distance) : distance;
		ret->beside_max_m = ret->beside ? fmaxf(ret->beside_max_m, distance) : distance;
		ret->tolerance_m = fmaxf(ret->tolerance_m, tolerance);
		ret->beside++;
	}
}

static bool is_missed(const struct partner *p)
{
	float spread = p->beside_max_m - p->beside_min_m,
	      middle = 0.5f * fabsf(p->beside_max_m + p->beside_min_m);
	return p->beside >= MISS_CELLS_MIN && p->beside_min_m * p->beside_max_m > 0 &&
	       spread <= fmaxf(2 * p->tolerance_m, 0.5f * middle);
}

/* The cell itself tells; its neighbours are asked when it does not. */
static struct partner find_partner(
	const struct verify_view *v, const struct seen *p, int32_t row, int32_t column)
{
	struct partner partner = { 0 };
	float reach = REACH_CELLS * fmaxf(v->column_rad, v->row_rad) * p->range_m + REACH_M;
	look_at(&v->surfel[(size_t)row * v->columns + column], p, reach, &partner);
	for (int32_t dr = -1; dr <= 1 && !partner.agrees; dr++)
		for (int32_t dc = -1; dc <= 1; dc++) {
			int64_t at = verify_view_at(v, row + dr, column + dc);
			if (at >= 0 && (dr || dc))
				look_at(&v->surfel[at], p, reach, &partner);
		}
	return partner;
}

static enum compared judge(const struct verify_view *v, const struct verify_around *around,
	const struct seen *p, const struct partner *partner)
{
	float cosine = fmaxf(-vector3_dot(p->point, p->normal) / p->range_m, COSINE_MIN);
	float depth = DEPTH_M + DEPTH_SHARE * p->range_m +
		      SIGMAS * (fminf(p->sigma_m, SIGMA_MAX_M) + p->slack_m) / cosine;
	if (partner->agrees)
		return COMPARED_AGREE;
	if (around->empty == 9)
		return p->range_m < v->range_max_m ? COMPARED_VOID : COMPARED_OUTSIDE;
	if (is_missed(partner))
		return COMPARED_MISSED;
	if (around->empty)
		return COMPARED_NONE;
	if (p->range_m > around->far_m + depth)
		return COMPARED_HIDDEN;
	return p->range_m < around->near_m - depth ? COMPARED_THROUGH : COMPARED_NONE;
}

static enum compared compare_one(
	const struct verify_view *into, const struct seen *p, struct partner *ret_partner)
{
	int32_t row, column;
	*ret_partner = (struct partner){ 0 };
	if (!verify_view_find(into, p->point, &row, &column))
		return COMPARED_OUTSIDE;
	const struct verify_around *around = &into->around[(size_t)row * into->columns + column];
	if (around->looked < 9)
		return around->looked ? COMPARED_NONE : COMPARED_OUTSIDE;
	if (p->sigma_m < SIGMA_MAX_M)
		*ret_partner = find_partner(into, p, row, column);
	return judge(into, around, p, ret_partner);
}

static void add_agreement(
	struct comparison *c, const struct seen *p, const struct partner *partner, double sr)
{
	float distance_m = partner->distance_m;
	if (partner->even) {
		c->even_sr += sr;
		c->squares += sr * distance_m * distance_m;
		c->under_6mm += fabsf(distance_m) < 0.006f ? sr : 0;
	}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			c->facing[i][j] += sr * p->normal[i] * p->normal[j];
}

static void add_pull(
	struct pull *pull, const struct seen *p, const struct partner *partner, double sr)
{
	const float *q = p->point, *n = partner->normal;
	double j[6] = { q[1] * n[2] - q[2] * n[1], q[2] * n[0] - q[0] * n[2],
		q[0] * n[1] - q[1] * n[0], n[0], n[1], n[2] };
	double weight = sr / partner->variance;
	for (int i = 0; i < 6; i++) {
		pull->right[i] -= weight * j[i] * partner->distance_m;
		for (int k = i; k < 6; k++)
			pull->matrix[i][k] += weight * j[i] * j[k];
	}
}

void verify_compare(const struct verify_view *from, const struct verify_view *into,
	const struct pose *pose, const struct comparing *how, struct comparison *ret)
{
	struct motion m = motion_of(pose);
	uint32_t stride = MAX(how->stride, 1);
	struct conflicts_view l = { from, (from->rows + stride - 1) / stride,
		(from->columns + stride - 1) / stride, stride, NULL };
	g_autofree uint8_t *kinds = l.kind = g_malloc0((size_t)l.rows * l.columns);
	for (uint32_t r = 0; r < from->rows; r += stride) {
		double sr = conflicts_cell_sr(&l, r / stride);
		for (uint32_t c = r / stride % stride; c < from->columns; c += stride) {
			size_t i = (size_t)r * from->columns + c;
			if (!(from->surfel[i].sigma_m > 0))
				continue;
			struct seen p = see(&from->surfel[i], &m, how);
			struct partner partner;
			enum compared kind = compare_one(into, &p, &partner);
			kinds[(size_t)(r / stride) * l.columns + c / stride] = (uint8_t)kind;
			ret->sr[kind] += sr;
			if (kind == COMPARED_AGREE)
				add_agreement(ret, &p, &partner, sr);
			if (kind == COMPARED_AGREE && how->ret_pull)
				add_pull(how->ret_pull, &p, &partner, sr);
			if (how->ret_kind) {
				how->ret_kind[i] = (uint8_t)kind;
				how->ret_distance_m[i] = partner.distance_m;
			}
		}
	}
	conflicts_add(&l, ret);
}
