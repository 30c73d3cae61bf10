#include "process/plan.h"
#include <stdlib.h>
#include <string.h>

#define UPRIGHT    0.35f /* |z| of a normal */
#define FACES_UP   0.92f
#define EDGE_M     0.4f
#define HEADINGS   24
#define EDGES_MAX  800
#define WEIGHT_MAX 3.0f
#define HALF_M     60.0f
#define NEAR_M     8.0f
#define RISE_BIN_M 0.1f

/* A patch of upright surface on its way into an edge. */
struct patch {
	uint64_t key;
	float point[3], normal[2];
};

static int by_key(const void *a, const void *b)
{
	uint64_t x = ((const struct patch *)a)->key, y = ((const struct patch *)b)->key;
	return (x > y) - (x < y);
}

static float heading_of(const float n[2])
{
	float h = atan2f(n[1], n[0]);
	return h < 0 ? h + (float)(2 * G_PI) : h;
}

static uint64_t patch_key(const struct patch *p)
{
	uint64_t x = (uint64_t)(int64_t)floorf(p->point[0] / EDGE_M + 32768),
		 y = (uint64_t)(int64_t)floorf(p->point[1] / EDGE_M + 32768);
	uint64_t heading = (uint64_t)(heading_of(p->normal) * (HEADINGS / (2 * G_PI)));
	return x << 32 | y << 8 | MIN(heading, HEADINGS - 1);
}

static bool edge_from(const struct patch *patch, size_t count, struct plan_edge *ret)
{
	float sum[4] = { 0 }, low = G_MAXFLOAT, high = -G_MAXFLOAT;
	for (size_t i = 0; i < count; i++) {
		sum[0] += patch[i].point[0];
		sum[1] += patch[i].point[1];
		sum[2] += patch[i].normal[0];
		sum[3] += patch[i].normal[1];
		low = fminf(low, patch[i].point[2]);
		high = fmaxf(high, patch[i].point[2]);
	}
	*ret = (struct plan_edge){ sum[0] / count, sum[1] / count, heading_of(sum + 2), low, high,
		fminf(high - low, WEIGHT_MAX) };
	return count > 1 && ret->weight > 0.3f;
}

static int by_weight(const void *a, const void *b)
{
	const struct plan_edge *x = a, *y = b;
	if (x->weight != y->weight)
		return x->weight < y->weight ? 1 : -1;
	return x->x_m != y->x_m ? (x->x_m > y->x_m) - (x->x_m < y->x_m)
				: (x->y_m > y->y_m) - (x->y_m < y->y_m);
}

static int by_heading(const void *a, const void *b)
{
	float x = ((const struct plan_edge *)a)->heading_rad,
	      y = ((const struct plan_edge *)b)->heading_rad;
	return x != y ? (x > y) - (x < y) : by_weight(a, b);
}

static void make_edges(struct plan *p, struct patch *patch, size_t count)
{
	qsort(patch, count, sizeof *patch, by_key);
	p->edge = g_new(struct plan_edge, count + 1);
	for (size_t from = 0, to; from < count; from = to) {
		for (to = from; to < count && patch[to].key == patch[from].key;)
			to++;
		p->edges += edge_from(patch + from, to - from, &p->edge[p->edges]);
	}
	qsort(p->edge, p->edges, sizeof *p->edge, by_weight);
	p->edges = MIN(p->edges, EDGES_MAX);
	qsort(p->edge, p->edges, sizeof *p->edge, by_heading);
}

static float *height_at(const struct plan *p, float x, float y)
{
	float column = (x + p->half_m) / PLAN_CELL_M, row = (y + p->half_m) / PLAN_CELL_M;
	if (!(column >= 0 && row >= 0 && column < p->columns && row < p->columns))
		return NULL;
	return &p->height_m[(size_t)row * p->columns + (size_t)column];
}

static void take_ground(struct plan *p, const float point[3])
{
	float *height = height_at(p, point[0], point[1]);
	if (height && !(*height <= point[2])) /* also when there is none yet */
		*height = point[2];
}

static int by_float(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static void list_ground(struct plan *p)
{
	p->ground = g_new(struct plan_ground, (size_t)p->columns * p->columns);
	g_autofree float *near = g_new(float, (size_t)p->columns * p->columns);
	size_t nears = 0;
	for (uint32_t r = 0; r < p->columns; r++)
		for (uint32_t c = 0; c < p->columns; c++) {
			float z = p->height_m[(size_t)r * p->columns + c];
			if (isnan(z))
				continue;
			struct plan_ground g = { (c + 0.5f) * PLAN_CELL_M - p->half_m,
				(r + 0.5f) * PLAN_CELL_M - p->half_m, z };
			p->ground[p->grounds++] = g;
			if (hypotf(g.x_m, g.y_m) < NEAR_M)
				near[nears++] = z;
		}
	qsort(near, nears, sizeof *near, by_float);
	p->ground_m = nears ? near[nears / 2] : 0;
	p->ground = g_renew(struct plan_ground, p->ground, p->grounds + 1);
}

static void rotate(const struct pose *level, const float v[3], float ret[3])
{
	double d[3] = { v[0], v[1], v[2] };
	pose_rotate(level, d, d);
	for (int i = 0; i < 3; i++)
		ret[i] = (float)d[i];
}

struct plan *plan_new(const struct coarse_view *v, const struct pose *level)
{
	struct plan *p = g_new0(struct plan, 1);
	p->level = *level;
	p->half_m = HALF_M;
	p->columns = (uint32_t)(2 * HALF_M / PLAN_CELL_M);
	size_t heights = (size_t)p->columns * p->columns, cells = (size_t)v->columns * v->rows;
	p->height_m = g_new(float, heights);
	for (size_t i = 0; i < heights; i++)
		p->height_m[i] = NAN;
	g_autofree struct patch *patch = g_new(struct patch, cells + 1);
	size_t patches = 0;
	for (size_t i = 0; i < cells; i++) {
		const struct coarse_cell *c = &v->cell[i];
		if (!(c->near_m > 0) || (!c->normal[0] && !c->normal[1] && !c->normal[2]))
			continue;
		float normal[3], point[3];
		rotate(level, c->normal, normal);
		rotate(level, c->point_m, point);
		if (normal[2] > FACES_UP)
			take_ground(p, point);
		if (fabsf(normal[2]) > UPRIGHT || hypotf(point[0], point[1]) > HALF_M)
			continue;
		struct patch *at = &patch[patches++];
		*at = (struct patch){ 0, { point[0], point[1], point[2] },
			{ normal[0], normal[1] } };
		at->key = patch_key(at);
	}
	make_edges(p, patch, patches);
	list_ground(p);
	return p;
}

void plan_free(struct plan *p)
{
	if (!p)
		return;
	g_free(p->edge);
	g_free(p->ground);
	g_free(p->height_m);
	g_free(p);
}

#define RISE_BINS  120
#define RISE_TRIES 300
float plan_rise(const struct plan *a, const struct plan *b, const struct plan_shift *s)
{
	float cosine = cosf(s->turn_rad), sine = sinf(s->turn_rad);
	int bin[RISE_BINS + 2] = { 0 }, total = 0, best = 0, most = 0;
	float expected = a->ground_m - b->ground_m;
	size_t step = b->grounds / RISE_TRIES + 1;
	for (size_t i = 0; i < b->grounds; i += step) {
		const struct plan_ground *g = &b->ground[i];
		const float *z = height_at(a, cosine * g->x_m - sine * g->y_m + s->x_m,
			sine * g->x_m + cosine * g->y_m + s->y_m);
		if (!z || isnan(*z))
			continue;
		float at = (*z - g->z_m) / RISE_BIN_M + RISE_BINS / 2;
		if (!(at >= 1 && at < RISE_BINS))
			continue;
		bin[(int)at]++;
		total++;
	}
	for (int i = 1; i < RISE_BINS; i++) {
		int votes = bin[i - 1] + 2 * bin[i] + bin[i + 1];
		if (votes > most) {
			most = votes;
			best = i;
		}
	}
	return total < 5 ? expected : (best + 0.5f - RISE_BINS / 2) * RISE_BIN_M;
}

/* a.level^-1 * turn and shift * b.level */
struct pose plan_shift_pose(const struct plan *a, const struct plan *b, const struct plan_shift *s)
{
	double c = cos(s->turn_rad), n = sin(s->turn_rad);
	struct pose flat = { { { c, -n, 0 }, { n, c, 0 }, { 0, 0, 1 } },
		{ s->x_m, s->y_m, s->z_m } };
	struct pose back = pose_inverse(&a->level), turned = pose_compose(&flat, &b->level);
	return pose_compose(&back, &turned);
}
