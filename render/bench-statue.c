#include "render/bench-statue.h"
#include "process/model-write.h"
#include "render/stroke.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#define TUBE_M 0.24
#define BUMP_M 0.04
#define BUMPS  9
/* For tangents: so far along, in radians. */
#define NEARBY 1e-4

struct place {
	double at[3], normal[3], around[3];
	double area, radius_m; /* of a square radian of both angles */
};

static void cross(const double a[3], const double b[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* What its length was. */
static double to_unit(double v[3])
{
	double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int k = 0; k < 3; k++)
		v[k] /= length;
	return length;
}

static void on_knot(double u, double ret[3])
{
	double out = 1 + 0.45 * cos(3 * u);
	ret[0] = out * cos(2 * u);
	ret[1] = out * sin(2 * u);
	ret[2] = 0.5 * sin(3 * u);
}

static double radius_at(double u)
{
	return TUBE_M + BUMP_M * sin(BUMPS * u);
}

static void on_tube(double u, double v, double ret[3])
{
	static const double up[3] = { 0, 0, 1 };
	double at[3], next[3], side[3], above[3];
	on_knot(u, at);
	on_knot(u + NEARBY, next);
	for (int k = 0; k < 3; k++)
		next[k] -= at[k];
	to_unit(next);
	cross(next, up, side);
	to_unit(side);
	cross(side, next, above);
	for (int k = 0; k < 3; k++)
		ret[k] = at[k] + radius_at(u) * (cos(v) * side[k] + sin(v) * above[k]);
}

static struct place place_at(double u, double v)
{
	struct place p = { .radius_m = radius_at(u) };
	double along[3];
	on_tube(u, v, p.at);
	on_tube(u + NEARBY, v, along);
	on_tube(u, v + NEARBY, p.around);
	for (int k = 0; k < 3; k++) {
		along[k] = (along[k] - p.at[k]) / NEARBY;
		p.around[k] = (p.around[k] - p.at[k]) / NEARBY;
	}
	cross(along, p.around, p.normal);
	p.area = to_unit(p.normal);
	to_unit(p.around);
	return p;
}

static struct part_point point_of(const struct place *p, double share)
{
	struct part_point q = { .plane_error = 1, .k2 = model_pack_half(0) };
	struct morton_place at;
	float normal[3], around[3];
	for (int k = 0; k < 3; k++) {
		normal[k] = (float)p->normal[k];
		around[k] = (float)p->around[k];
	}
	morton_from_point(p->at, morton_cell_m(0), &at);
	q.code = at.code;
	memcpy(q.within, at.within, sizeof q.within);
	model_pack_normal(normal, q.normal);
	model_pack_normal(around, q.principal);
	q.direction[0] = q.direction[1] = MODEL_NORMAL_NONE;
	q.k1 = model_pack_half((float)(1 / p->radius_m));
	q.size = q.spacing = (uint16_t)CLAMP(sqrt(p->area * share) * 1e4 + 0.5, 1, 65535);
	return q;
}

/* Around the tube in rings of cells that are about as wide as high, a point by chance in each. */
static struct part_point *make(uint64_t wanted, uint64_t *ret_count)
{
	uint64_t rings = (uint64_t)sqrt((double)wanted * 9), across = wanted / rings;
	double share = 4 * G_PI * G_PI / (double)(rings * across);
	struct part_point *made = g_new(struct part_point, rings * across);
#pragma omp parallel for schedule(static)
	for (uint64_t n = 0; n < rings * across; n++) {
		double u = (double)(n / across) + (double)stroke_chance((uint32_t)n, 1),
		       v = (double)(n % across) + (double)stroke_chance((uint32_t)n, 2);
		struct place p =
			place_at(2 * G_PI * u / (double)rings, 2 * G_PI * v / (double)across);
		made[n] = point_of(&p, share);
	}
	*ret_count = rings * across;
	return made;
}

static int by_place(const void *a, const void *b)
{
	return part_point_compare(a, b);
}

static void merge(const struct part_point *a, uint64_t count_a, const struct part_point *b,
	uint64_t count_b, struct part_point *to)
{
	const struct part_point *end_a = a + count_a, *end_b = b + count_b;
	while (a < end_a && b < end_b)
		*to++ = part_point_compare(a, b) <= 0 ? *a++ : *b++;
	memcpy(to, a, (size_t)(end_a - a) * sizeof *a);
	memcpy(to + (end_a - a), b, (size_t)(end_b - b) * sizeof *b);
}

/* Pieces by all threads, then two of them at a time. Takes the points, gives them back sorted. */
static struct part_point *sorted(struct part_point *p, uint64_t count)
{
	uint64_t piece = MAX(count / 64 + 1, 4096);
	struct part_point *spare = g_new(struct part_point, count);
#pragma omp parallel for schedule(dynamic)
	for (uint64_t from = 0; from < count; from += piece)
		qsort(p + from, MIN(piece, count - from), sizeof *p, by_place);
	for (; piece < count; piece *= 2) {
#pragma omp parallel for schedule(dynamic)
		for (uint64_t from = 0; from < count; from += 2 * piece) {
			uint64_t left = MIN(piece, count - from),
				 right = MIN(piece, count - from - left);
			merge(p + from, left, p + from + left, right, spare + from);
		}
		struct part_point *was = p;
		p = spare;
		spare = was;
	}
	g_free(spare);
	return p;
}

bool bench_statue_write(const char *path, uint64_t wanted, GError **error)
{
	uint64_t count;
	struct part_point *made = make(MAX(wanted, 64), &count);
	g_autofree struct part_point *p = sorted(made, count);
	g_autoptr(model_writer) w = model_writer_new(path, 0, error);
	for (uint64_t n = 0; w && n < count; n++)
		if (!model_writer_add(w, &p[n], 1, error))
			return false;
	return w && model_writer_finish(w, NULL, 0, json_object_new(), error);
}
