#include "process/scribble-edges.h"
#include "process/normals.h"
#include <stdlib.h>
#include <string.h>

/* Holes up to twice as wide close. */
#define HOLE_REACH 4
/* A difference of one sigma is 1; where an edge of range begins to count, and where it cannot count more. */
#define RANGE_SIGMAS 8.0f
#define RANGE_FULL_M 10.0f
/* Curvature from which on normals tell nothing. */
#define CURVATURE_ROUGH 0.06f
/* Differences of intensity and colour that are usual count little. */
#define USUAL_SIGMAS 3.0f
#define SAMPLES      20000u
/* What each step costs anyway: the shorter of two ways over smooth ground is better. */
#define STEP_LEAST 0.004f

struct look {
	const range_grid *g;
	const geometry *normals;
	const uint16_t *leaf;
	const struct scribble_options *weight;
	const uint32_t *source;
	float noise_m, intensity_usual, colour_usual;
};

/* ---- what holes stand for ---- */

static void spread_row(const range_grid *g, uint32_t row, const uint32_t *from, uint32_t *to)
{
	for (uint32_t c = 0; c < g->columns; c++) {
		size_t i = (size_t)row * g->columns + c;
		to[i] = from[i];
		if (to[i] != RANGE_GRID_NONE)
			continue;
		uint32_t beside[4] = { RANGE_GRID_NONE, RANGE_GRID_NONE, RANGE_GRID_NONE,
			RANGE_GRID_NONE };
		if (c > 0 || g->wraps)
			beside[0] = from[c > 0 ? i - 1 : i + g->columns - 1];
		if (c + 1 < g->columns || g->wraps)
			beside[1] = from[c + 1 < g->columns ? i + 1 : i + 1 - g->columns];
		if (row > 0)
			beside[2] = from[i - g->columns];
		if (row + 1 < g->rows)
			beside[3] = from[i + g->columns];
		for (int k = 0; k < 4 && to[i] == RANGE_GRID_NONE; k++)
			to[i] = beside[k];
	}
}

static uint32_t *find_sources(const range_grid *g)
{
	size_t n = range_grid_cells(g);
	uint32_t *source = g_new(uint32_t, n), *next = g_new(uint32_t, n);
	for (size_t i = 0; i < n; i++)
		source[i] = g->range_m[i] > 0 ? (uint32_t)i : RANGE_GRID_NONE;
	for (int k = 0; k < HOLE_REACH; k++) {
#pragma omp parallel for
		for (uint32_t r = 0; r < g->rows; r++)
			spread_row(g, r, source, next);
		uint32_t *swap = source;
		source = next;
		next = swap;
	}
	g_free(next);
	return source;
}

/* ---- channels ---- */

static inline bool has_normal(const geometry *n, size_t i)
{
	return n->normal_x[i] != 0 || n->normal_y[i] != 0 || n->normal_z[i] != 0;
}

/* How far b lies off the plane of a, or a negative number. */
static float off_plane(const struct look *l, size_t a, size_t b)
{
	const range_grid *g = l->g;
	const geometry *n = l->normals;
	if (!has_normal(n, a))
		return -1;
	return fabsf(n->normal_x[a] * (g->x_m[b] - g->x_m[a]) +
		     n->normal_y[a] * (g->y_m[b] - g->y_m[a]) +
		     n->normal_z[a] * (g->z_m[b] - g->z_m[a]));
}

/* The same by what is beyond a as seen from b: inverse range goes on as it went. */
static float off_line(const struct look *l, size_t beyond, size_t a, size_t b)
{
	const float *range = l->g->range_m;
	if (!(range[beyond] > 0))
		return fabsf(range[b] - range[a]);
	float off = 2 / range[a] - 1 / range[beyond] - 1 / range[b];
	return fabsf(off) * range[a] * range[b];
}

static float range_edge(const struct look *l, size_t before, size_t a, size_t b, size_t after)
{
	float from_a = off_plane(l, a, b), from_b = off_plane(l, b, a);
	if (from_a < 0)
		from_a = off_line(l, before, a, b);
	if (from_b < 0)
		from_b = off_line(l, after, b, a);
	float off = fminf(fminf(from_a, from_b), fabsf(l->g->range_m[b] - l->g->range_m[a])),
	      unit = RANGE_SIGMAS * l->noise_m;
	return fminf(log1pf(off / unit) / log1pf(RANGE_FULL_M / unit), 1);
}

static float roughness(const struct look *l, size_t i)
{
	return fminf(l->normals->curvature[i] / CURVATURE_ROUGH, 1);
}

static float crease_edge(const struct look *l, size_t a, size_t b)
{
	const range_grid *g = l->g;
	const geometry *n = l->normals;
	if (!has_normal(n, a) || !has_normal(n, b))
		return 0;
	float x = n->normal_x[b] - n->normal_x[a], y = n->normal_y[b] - n->normal_y[a],
	      z = n->normal_z[b] - n->normal_z[a];
	float chord = sqrtf(x * x + y * y + z * z);
	bool hollow = x * (g->x_m[b] - g->x_m[a]) + y * (g->y_m[b] - g->y_m[a]) +
			      z * (g->z_m[b] - g->z_m[a]) <
		      0;
	float smooth = 1 - fmaxf(roughness(l, a), roughness(l, b));
	return fminf(chord, 1) * smooth * (hollow ? 1 : 0.5f);
}

static float intensity_difference(const range_grid *g, size_t a, size_t b)
{
	return fabsf(logf((g->intensity[a] + 1.0f) / (g->intensity[b] + 1.0f)));
}

static float colour_difference(const range_grid *g, size_t a, size_t b)
{
	const uint8_t *p = g->rgb + 3 * a, *q = g->rgb + 3 * b;
	return sqrtf((float)((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
			     (p[2] - q[2]) * (p[2] - q[2])));
}

static float beside_usual(float difference, float usual)
{
	float t = difference / (USUAL_SIGMAS * usual);
	return t * t / (1 + t * t);
}

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* One sigma of a difference between neighbours in a row, where most are on one surface. */
static float usual_difference(
	const range_grid *g, float (*difference)(const range_grid *, size_t, size_t), float least)
{
	size_t n = range_grid_cells(g), stride = n / SAMPLES + 1, count = 0;
	g_autofree float *sample = g_new(float, SAMPLES + 1);
	for (size_t i = 0; i + 1 < n && count < SAMPLES; i += stride)
		if (g->range_m[i] > 0 && g->range_m[i + 1] > 0)
			sample[count++] = difference(g, i, i + 1);
	if (!count)
		return least;
	qsort(sample, count, sizeof *sample, by_value);
	return fmaxf(sample[count / 2] / 0.6745f, least);
}

/* ---- all of them ---- */

static float edge(const struct look *l, size_t before, size_t a, size_t b, size_t after)
{
	a = l->source[a];
	b = l->source[b];
	if (a == RANGE_GRID_NONE || b == RANGE_GRID_NONE)
		return INFINITY;
	if (a == b)
		return STEP_LEAST;
	const struct scribble_options *w = l->weight;
	float sum = STEP_LEAST + w->range_weight * range_edge(l, before, a, b, after) +
		    w->crease_weight * crease_edge(l, a, b);
	if (l->g->intensity)
		sum += w->intensity_weight *
		       beside_usual(intensity_difference(l->g, a, b), l->intensity_usual);
	if (l->g->rgb)
		sum += w->colour_weight *
		       beside_usual(colour_difference(l->g, a, b), l->colour_usual);
	if (l->leaf && l->leaf[a] != l->leaf[b])
		sum += w->leaf_weight;
	return sum;
}

static void find_row(const struct look *l, uint32_t row, struct scribble_edges *ret)
{
	const range_grid *g = l->g;
	size_t from = (size_t)row * g->columns, columns = g->columns, n = range_grid_cells(g);
	for (size_t c = 0; c < columns; c++) {
		size_t i = from + c, right = from + (c + 1) % columns,
		       left = from + (c + columns - 1) % columns, second = from + (c + 2) % columns;
		bool seam = c + 1 == columns && !g->wraps;
		ret->step_right[i] = seam ? INFINITY : edge(l, left, i, right, second);
		size_t above = row > 0 ? i - columns : i, below = i + columns,
		       next = i + 2 * columns < n ? i + 2 * columns : below;
		ret->step_down[i] = below < n ? edge(l, above, i, below, next) : INFINITY;
	}
}

void scribble_edges_find(const range_grid *g, const geometry *normals, const uint16_t *leaf,
	const struct scribble_options *options, struct scribble_edges *ret)
{
	size_t n = range_grid_cells(g);
	*ret = (struct scribble_edges){ .source = find_sources(g),
		.step_right = g_new(float, n),
		.step_down = g_new(float, n) };
	struct look l = { .g = g,
		.normals = normals,
		.leaf = leaf,
		.weight = options,
		.source = ret->source,
		.noise_m = normals_range_noise_m(g, NULL) };
	if (g->intensity)
		l.intensity_usual = usual_difference(g, intensity_difference, 0.01f);
	if (g->rgb)
		l.colour_usual = usual_difference(g, colour_difference, 1);
#pragma omp parallel for schedule(dynamic, 8)
	for (uint32_t r = 0; r < g->rows; r++)
		find_row(&l, r, ret);
}

void scribble_edges_clear(struct scribble_edges *e)
{
	g_free(e->source);
	g_free(e->step_right);
	g_free(e->step_down);
}
