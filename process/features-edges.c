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
	float noisy_m = fmaxf(NOISIER * o->range_noise_m, CREASED * spacing_m);
	float noise_m =
		DIFFERENCE * CLAMP(p->error_m[i] / fmaxf(cosine, 0.05f), o->range_noise_m, noisy_m);
	float slope_m = TILT_RAD * spacing_m / fmaxf(cosine * cosine, 1e-4f);
	return fabsf(g->range_m[k] - there_m) / sqrtf(noise_m * noise_m + slope_m * slope_m);
}

static float jump_between(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, size_t i, size_t k)
{
	const range_grid *g = of->grid;
	if (of->leaf && of->leaf[i] && of->leaf[k] && of->leaf[i] != of->leaf[k])
		return fabsf(g->range_m[i] - g->range_m[k]) /
		       (JUMP_SIGMAS * DIFFERENCE * o->range_noise_m);
	float off = fminf(off_plane(g, p, o, i, k), off_plane(g, p, o, k, i));
	if (isinf(off))
		off = fabsf(g->range_m[i] - g->range_m[k]) / (DIFFERENCE * o->range_noise_m);
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

static void mark_cell(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, uint32_t row, uint32_t column, float *answer,
	uint8_t *flags)
{
	static const int8_t way[4][2] = { { 0, 1 }, { 0, -1 }, { 1, 0 }, { -1, 0 } };
	const range_grid *g = of->grid;
	size_t i = (size_t)row * g->columns + column, k;
	float most = 0;
	uint8_t found = 0;
	for (int w = 0; w < 4; w++) {
		if (!range_grid_step(g, row, column, way[w][0], way[w][1], &k))
			continue;
		bool none = !(g->range_m[k] > 0);
		float jump = none ? VOID_ANSWER * is_void(g, row, column, way[w][0], way[w][1])
				  : jump_between(of, p, o, i, k);
		bool near = none || g->range_m[i] <= g->range_m[k];
		if (jump >= 1)
			found |= near ? FEATURE_SILHOUETTE : FEATURE_BEHIND;
		if (near)
			most = fmaxf(most, jump);
	}
	answer[i] = most;
	flags[i] |= found;
}

void feature_depth_edges(const struct features_input *of, const struct feature_planes *p,
	const struct features_options *o, float *answer, uint8_t *flags)
{
	const range_grid *g = of->grid;
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			answer[i] = 0;
			if (g->range_m[i] > 0)
				mark_cell(of, p, o, row, column, answer, flags);
		}
}
