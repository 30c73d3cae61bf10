#include "process/features-private.h"

/* A step in colour that is seen at once, of 0..1 of the picture's own scale. */
#define COLOUR_STEP 0.11f
/* Relative step of intensity. */
#define INTENSITY_STEP 0.35f
/* Among edges everywhere, an edge must stand out so much. */
#define AMONG       1.6f
#define AMONG_REACH 8
#define ANSWER_MOST 4.0f

/* Across the three rows or columns around, of the middle of each three; neighbours without a point count as the cell itself. */
static float gradient(const range_grid *g, const float *value, uint32_t row, uint32_t column)
{
	size_t i = (size_t)row * g->columns + column, k;
	float at[3][3];
	for (int y = -1; y <= 1; y++)
		for (int x = -1; x <= 1; x++)
			at[y + 1][x + 1] =
				range_grid_step(g, row, column, y, x, &k) && g->range_m[k] > 0
					? value[k]
					: value[i];
	float right = 0, down = 0;
	for (int n = 0; n < 3; n++) {
		float weight = n == 1 ? 0.5f : 0.25f;
		right += weight * (at[n][2] - at[n][0]);
		down += weight * (at[2][n] - at[0][n]);
	}
	return sqrtf(right * right + down * down);
}

/* The mean of those around, of cells that have a point: sums along rows, then columns. */
static void mean_around(
	const range_grid *g, const float *value, float *row_mean, float *ret, bool single_thread)
{
#pragma omp parallel for schedule(static) if (!single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			uint32_t from = column > AMONG_REACH ? column - AMONG_REACH : 0;
			uint32_t to = MIN(column + AMONG_REACH + 1, g->columns);
			float sum = 0;
			for (uint32_t c = from; c < to; c++)
				sum += value[i - column + c];
			row_mean[i] = sum / (float)(to - from);
		}
#pragma omp parallel for schedule(static) if (!single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			uint32_t from = row > AMONG_REACH ? row - AMONG_REACH : 0,
				 to = MIN(row + AMONG_REACH + 1, g->rows);
			float sum = 0;
			for (uint32_t r = from; r < to; r++)
				sum += row_mean[(size_t)r * g->columns + column];
			ret[(size_t)row * g->columns + column] = sum / (float)(to - from);
		}
}

/* Gradients into answers. */
static void stand_out(const range_grid *g, const struct features_options *o, float step,
	float *gradients, float *answer)
{
	size_t cells = range_grid_cells(g);
	g_autofree float *rows = g_new(float, cells + 1);
	g_autofree float *around = g_new(float, cells + 1);
	mean_around(g, gradients, rows, around, o->single_thread);
	for (size_t i = 0; i < cells; i++)
		answer[i] = fminf(gradients[i] / (step + AMONG * around[i]), ANSWER_MOST);
}

static void find_gradients(const range_grid *g, const struct features_options *o,
	const float *value, float *into, bool add)
{
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			float here = g->range_m[i] > 0 ? gradient(g, value, row, column) : 0;
			into[i] = add ? fmaxf(into[i], here) : here;
		}
}

void feature_colour_edges(const range_grid *g, const struct features_options *o, float *answer)
{
	size_t cells = range_grid_cells(g);
	g_autofree float *value = g_new(float, cells + 1);
	g_autofree float *gradients = g_new(float, cells + 1);
	for (int channel = 0; channel < 3; channel++) {
		for (size_t i = 0; i < cells; i++)
			value[i] = g->rgb[3 * i + channel] * (1 / 255.f);
		find_gradients(g, o, value, gradients, channel > 0);
	}
	stand_out(g, o, COLOUR_STEP, gradients, answer);
}

void feature_intensity_edges(const range_grid *g, const struct features_options *o, float *answer)
{
	size_t cells = range_grid_cells(g);
	g_autofree float *value = g_new(float, cells + 1);
	g_autofree float *gradients = g_new(float, cells + 1);
	for (size_t i = 0; i < cells; i++)
		value[i] = logf(1 + g->intensity[i]);
	find_gradients(g, o, value, gradients, false);
	stand_out(g, o, INTENSITY_STEP, gradients, answer);
}
