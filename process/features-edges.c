#include "process/features-private.h"
#include <string.h>

/* A jump beyond what slope and noise explain, in sigma. */
#define JUMP_SIGMAS 4.0f
/* 1 sigma of the difference of two ranges, each of its own noise. */
#define DIFFERENCE 1.5f
/* Fitted planes are tilted by about so much. */
#define TILT_RAD 0.03f
/* Of a surface that leads away, so much more noise at most counts as its own. */
#define NOISIER 3.0f
/* Or so much of the spacing of beams: a plane that lies over a crease is off the points on both sides. */
#define CREASED 0.5f
/* So many of the nine cells around a cell without a point must have none: else it was missed by chance. */
#define VOID_CELLS  6
#define VOID_ANSWER 2.0f
#define ANSWER_MOST 8.0f

/* Where the plane of cell i is met by the ray of cell k; 0: nowhere. */
static inline float range_on(
	const range_grid *g, const struct feature_planes *p, size_t i, size_t k)
{
	float ahead = p->normal[0][i] * g->x_m[k] + p->normal[1][i] * g->y_m[k] +
		      p->normal[2][i] * g->z_m[k];
	return ahead < -1e-3f * g->range_m[k] ? -fabsf(p->offset_m[i]) / ahead * g->range_m[k] : 0;
}

/* How far cell k is off the plane of cell i, in sigma. */
static float off_plane(const range_grid *g, const struct feature_planes *p,
	const struct features_options *o, size_t i, size_t k)
{
	float there_m = p->offset_m[i] != 0 ? range_on(g, p, i, k) : 0;
	if (!(there_m > 0))
		return INFINITY;
	float cosine = fabsf(p->offset_m[i]) / there_m, spacing_m = there_m * (float)g->row_rad;
	float least_m = feature_range_noise_m(o, g->range_m[k]);
	float noisy_m = fmaxf(NOISIER * least_m, CREASED * spacing_m);
	float noise_m = DIFFERENCE * CLAMP(p->error_m[i] / fmaxf(cosine, 0.05f), least_m, noisy_m);
	float slope_m = TILT_RAD * spacing_m / fmaxf(cosine * cosine, 1e-4f);
	return fabsf(g->range_m[k] - there_m) / sqrtf(noise_m * noise_m + slope_m * slope_m);
}

static float jump_between(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, size_t i, size_t k)
{
	const range_grid *g = of->grid;
	if (of->leaf && of->leaf[i] && of->leaf[k] && of->leaf[i] != of->leaf[k])
		return fabsf(g->range_m[i] - g->range_m[k]) /
		       (JUMP_SIGMAS * DIFFERENCE * feature_range_noise_m(o, g->range_m[i]));
	float off = fminf(off_plane(g, p, o, i, k), off_plane(g, p, o, k, i));
	if (isinf(off))
		off = fabsf(g->range_m[i] - g->range_m[k]) /
		      (DIFFERENCE * feature_range_noise_m(o, g->range_m[i]));
	return fminf(off / JUMP_SIGMAS, ANSWER_MOST);
}

static bool is_void(const range_grid *g, uint32_t row, uint32_t column, int down, int right)
{
	unsigned none = 0;
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++) {
			size_t k;
			none += !range_grid_step(g, row, column, down + y, right + x, &k) ||
				!(g->range_m[k] > 0);
		}
	return none >= VOID_CELLS;
}

/* From each cell of a row to the next that way; 0 where one has no point. */
static void measure_jumps(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, uint32_t row, const int8_t way[2], float *ret)
{
	const range_grid *g = of->grid;
	for (uint32_t column = 0; column < g->columns; column++) {
		const size_t i = (size_t)row * g->columns + column;
		size_t k;
		ret[column] = g->range_m[i] > 0 &&
					      range_grid_step(g, row, column, way[0], way[1], &k) &&
					      g->range_m[k] > 0
				      ? jump_between(of, p, o, i, k)
				      : 0;
	}
}

/* jump: to the next that way, if that has a point. */
static void mark_way(const range_grid *g, uint32_t row, uint32_t column, const int8_t way[2],
	float jump, float *most, uint8_t *found)
{
	const size_t i = (size_t)row * g->columns + column;
	size_t k;
	if (!range_grid_step(g, row, column, way[0], way[1], &k))
		return;
	const bool none = !(g->range_m[k] > 0);
	if (none)
		jump = VOID_ANSWER * is_void(g, row, column, way[0], way[1]);
	const bool near = none || g->range_m[i] <= g->range_m[k];
	if (jump >= 1)
		*found |= near ? FEATURE_SILHOUETTE : FEATURE_BEHIND;
	if (near)
		*most = fmaxf(*most, jump);
}

static const int8_t right[2] = { 0, 1 }, left[2] = { 0, -1 }, down[2] = { 1, 0 }, up[2] = { -1, 0 };

/* Rows from..to, the last not included. Two cells see the same jump between them, which is measured once. */
static void mark_rows(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, uint32_t from, uint32_t to, float *answer, uint8_t *flags)
{
	const range_grid *g = of->grid;
	g_autofree float *aside = g_new(float, g->columns);
	g_autofree float *above = g_new0(float, g->columns);
	g_autofree float *below = g_new(float, g->columns);
	if (from > 0)
		measure_jumps(of, p, o, from - 1, down, above);
	for (uint32_t row = from; row < to; row++) {
		measure_jumps(of, p, o, row, right, aside);
		measure_jumps(of, p, o, row, down, below);
		for (uint32_t column = 0; column < g->columns; column++) {
			const size_t i = (size_t)row * g->columns + column;
			answer[i] = 0;
			if (!(g->range_m[i] > 0))
				continue;
			mark_way(g, row, column, right, aside[column], &answer[i], &flags[i]);
			mark_way(g, row, column, left,
				aside[column > 0 ? column - 1 : g->columns - 1], &answer[i],
				&flags[i]);
			mark_way(g, row, column, down, below[column], &answer[i], &flags[i]);
			mark_way(g, row, column, up, above[column], &answer[i], &flags[i]);
		}
		float *swap = above;
		above = below;
		below = swap;
	}
}

#define ROWS_AT_ONCE 16

void feature_depth_edges(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, float *answer, uint8_t *flags)
{
	const uint32_t rows = of->grid->rows;
#pragma omp parallel for schedule(dynamic) if (!o->single_thread)
	for (uint32_t row = 0; row < rows; row += ROWS_AT_ONCE)
		mark_rows(of, p, o, row, MIN(row + ROWS_AT_ONCE, rows), answer, flags);
}
