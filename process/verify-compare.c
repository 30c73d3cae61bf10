#include "process/verify-compare.h"

#define SAME_FACING 0.8f
#define SIGMAS      3.0f
#define REACH_CELLS 3.0f /* how far along the surface the other's point may lie */
#define REACH_M     0.05f
#define MISS_M      0.30f /* parallel surfaces nearer than this and not the same are a miss */
#define MISS_FACING 0.95f
#define DEPTH_M     0.06f  /* depth by which something must be in front to contradict ... */
#define DEPTH_SHARE 0.004f /* ... and of the range */
#define COSINE_MIN  0.15f
#define VOID_SHARE  230 /* of 255 */

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

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void turn(const struct motion *m, const float v[3], float ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = dot(m->r[i], v);
}

/* A surface of `from`, as `into` has to see it. */
struct seen {
	float point[3], normal[3], sigma_m, range_m;
};

/* What stands around the direction of a surface. */
struct around {
	float near_m, far_m, distance_m; /* of the plane that fits best */
	float tolerance_m, miss_m;
	bool agrees, missed;
	int looked, empty;
};

static void look_at_surfel(const struct surfel *s, const struct seen *p, float cell_rad,
	float slack_m, struct around *w)
{
	float off[3] = { p->point[0] - s->point_m[0], p->point[1] - s->point_m[1],
		p->point[2] - s->point_m[2] };
	float facing = dot(s->normal, p->normal), distance = dot(s->normal, off);
	float reach = REACH_CELLS * cell_rad * p->range_m + REACH_M;
	if (facing < SAME_FACING || dot(off, off) > reach * reach + distance * distance)
		return;
	float tolerance = SIGMAS * sqrtf(s->sigma_m * s->sigma_m + p->sigma_m * p->sigma_m +
					   slack_m * slack_m);
	if (fabsf(distance) <= tolerance) {
		if (!w->agrees || fabsf(distance) < fabsf(w->distance_m))
			w->distance_m = distance;
		w->agrees = true;
	} else if (fabsf(distance) < MISS_M && facing > MISS_FACING)
		w->missed = true;
}

static struct around look_around(const struct verify_view *v, const struct seen *p, int32_t row,
	int32_t column, float slack_m)
{
	struct around w = { .near_m = INFINITY };
	float cell_rad = fmaxf(v->column_rad, v->row_rad);
	for (int dr = -1; dr <= 1; dr++)
		for (int dc = -1; dc <= 1; dc++) {
			int64_t at = verify_view_at(v, row + dr, column + dc);
			if (at < 0 || !v->block[at].looked)
				continue;
			w.looked++;
			w.empty += v->block[at].nothing >= VOID_SHARE;
			if (v->block[at].far_m > 0) {
				w.near_m = fminf(w.near_m, v->block[at].near_m);
				w.far_m = fmaxf(w.far_m, v->block[at].far_m);
			}
			if (v->surfel[at].sigma_m > 0)
				look_at_surfel(&v->surfel[at], p, cell_rad, slack_m, &w);
		}
	return w;
}

static enum compared judge(
	const struct verify_view *v, const struct seen *p, const struct around *w, float slack_m)
{
	float cosine = fmaxf(-dot(p->point, p->normal) / p->range_m, COSINE_MIN);
	float depth = DEPTH_M + DEPTH_SHARE * p->range_m + SIGMAS * (p->sigma_m + slack_m) / cosine;
	if (w->looked < 9)
		return w->looked ? COMPARED_NONE : COMPARED_OUTSIDE;
	if (w->agrees)
		return COMPARED_AGREE;
	if (w->empty == 9)
		return p->range_m < v->range_max_m ? COMPARED_VOID : COMPARED_OUTSIDE;
	if (w->missed)
		return COMPARED_MISSED;
	if (w->empty)
		return COMPARED_NONE;
	if (p->range_m > w->far_m + depth)
		return COMPARED_HIDDEN;
	return p->range_m < w->near_m - depth ? COMPARED_THROUGH : COMPARED_NONE;
}

static void add_agreement(struct comparison *c, const struct seen *p, float distance_m, double sr)
{
	c->squares += sr * distance_m * distance_m;
	c->weights += sr;
	c->under_6mm += sr * (fabsf(distance_m) < 0.006f);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			c->facing[i][j] += sr * p->normal[i] * p->normal[j];
}

void verify_compare(const struct verify_view *from, const struct verify_view *into,
	const struct pose *pose, float slack_m, struct comparison *ret, uint8_t *ret_kind,
	float *ret_distance_m)
{
	struct motion m = motion_of(pose);
	for (uint32_t r = 0; r < from->rows; r++) {
		double up = from->elevation_max_rad - (r + 0.5) * from->row_rad,
		       sr = from->column_rad * from->row_rad * cos(up);
		for (uint32_t c = 0; c < from->columns; c++) {
			size_t i = (size_t)r * from->columns + c;
			const struct surfel *s = &from->surfel[i];
			int32_t row, column;
			enum compared kind = COMPARED_NONE;
			struct around w = { 0 };
			if (s->sigma_m > 0) {
				struct seen p = { .sigma_m = s->sigma_m };
				turn(&m, s->point_m, p.point);
				for (int k = 0; k < 3; k++)
					p.point[k] += m.t[k];
				turn(&m, s->normal, p.normal);
				p.range_m = sqrtf(dot(p.point, p.point));
				kind = COMPARED_OUTSIDE;
				if (verify_view_find(into, p.point, &row, &column)) {
					w = look_around(into, &p, row, column, slack_m);
					kind = judge(into, &p, &w, slack_m);
				}
				if (kind == COMPARED_AGREE)
					add_agreement(ret, &p, w.distance_m, sr);
				ret->sr[kind] += sr;
			}
			if (ret_kind)
				ret_kind[i] = (uint8_t)kind;
			if (ret_distance_m)
				ret_distance_m[i] = kind == COMPARED_AGREE ? w.distance_m : 0;
		}
	}
}
