#include "process/features-private.h"
#include <string.h>

/* Surface met at a lower cosine counts as met at this one. */
#define COSINE_LEAST 0.03f
/* Thresholds vary by so much, or the points of even tone stand in rows. */
#define JITTER 0.5f

/* Intensity falls with the square of the range, and depends on the device: it is set against the brightest of its range. */
#define INTENSITY_BANDS 64
struct levels {
	float white[INTENSITY_BANDS];
};

static int band_of(float range_m)
{
	return CLAMP((int)(8 * log2f(fmaxf(range_m, 0.25f) * 4)), 0, INTENSITY_BANDS - 1);
}

static void find_levels(const range_grid *g, struct levels *l)
{
	g_autofree float *sum = g_new0(float, 2 * INTENSITY_BANDS);
	for (size_t i = 0; i < range_grid_cells(g); i += 7)
		if (g->range_m[i] > 0) {
			sum[2 * band_of(g->range_m[i])] += g->intensity[i];
			sum[2 * band_of(g->range_m[i]) + 1]++;
		}
	for (int b = 0; b < INTENSITY_BANDS; b++)
		l->white[b] = sum[2 * b + 1] > 0 ? 2 * sum[2 * b] / sum[2 * b + 1] : 1;
}

/* 0 black .. 1 white. */
static float tone_of(const range_grid *g, const struct levels *l, size_t i)
{
	if (g->rgb) {
		const uint8_t *c = g->rgb + 3 * i;
		return (0.299f * c[0] + 0.587f * c[1] + 0.114f * c[2]) * (1 / 255.f);
	}
	return g->intensity ? g->intensity[i] / fmaxf(l->white[band_of(g->range_m[i])], 1) : 0.5f;
}

/* Surface that the cell's beam stands for. */
static float area_m2(const range_grid *g, const float *const normal[3], size_t i)
{
	float range_m = g->range_m[i], cosine = 1;
	float level = hypotf(g->x_m[i], g->y_m[i]) / range_m;
	if (normal[0][i] != 0 || normal[1][i] != 0 || normal[2][i] != 0)
		cosine = fabsf(normal[0][i] * g->x_m[i] + normal[1][i] * g->y_m[i] +
				 normal[2][i] * g->z_m[i]) /
			 range_m;
	return range_m * range_m * (float)(g->column_rad * g->row_rad) * level /
	       fmaxf(cosine, COSINE_LEAST);
}

/* The blended image: how much of a dithering point each cell should have. */
static void blend_row(const range_grid *g, const float *const normal[3], const struct levels *l,
	const struct features_options *o, uint32_t row, float *ret)
{
	for (uint32_t column = 0; column < g->columns; column++) {
		size_t i = (size_t)row * g->columns + column;
		ret[column] = 0;
		if (g->range_m[i] > 0)
			ret[column] = fminf(feature_darkness(tone_of(g, l, i), o->tone_exponent) *
						    area_m2(g, normal, i) * o->dither_per_m2,
				1);
	}
}

/* Floyd and Steinberg's, there and back. A feature point hands on what comes to it. */
static void diffuse_row(features *f, const range_grid *g, const float *wanted, uint32_t row,
	float *here, float *below)
{
	int32_t width = (int32_t)g->columns, way = row % 2 ? -1 : 1;
	for (int32_t n = 0; n < width; n++) {
		int32_t c = way > 0 ? n : width - 1 - n;
		size_t i = (size_t)row * g->columns + (size_t)c;
		if (!(g->range_m[i] > 0))
			continue;
		bool is_feature = f->kind[i] >= FEATURE_UNDIRECTED;
		float value = (is_feature ? 0 : wanted[c]) + here[c];
		bool dot = !is_feature &&
			   value > 0.5f + JITTER * (feature_noise((uint32_t)i) - 0.5f) &&
			   wanted[c] > 0;
		float rest = CLAMP(value - (float)dot, -1.5f, 1.5f);
		if (!is_feature)
			f->kind[i] = dot ? FEATURE_DITHER : FEATURE_NONE;
		int32_t ahead = c + way, behind = c - way;
		if (ahead >= 0 && ahead < width) {
			here[ahead] += rest * (7 / 16.f);
			below[ahead] += rest * (1 / 16.f);
		}
		if (behind >= 0 && behind < width)
			below[behind] += rest * (3 / 16.f);
		below[c] += rest * (5 / 16.f);
	}
}

void feature_dither(const range_grid *g, const float *const normal[3],
	const struct features_options *o, features *f)
{
	struct levels levels = { { 0 } };
	g_autofree float *wanted = g_new(float, range_grid_cells(g) + 1);
	float *here = g_new0(float, g->columns + 1), *below = g_new0(float, g->columns + 1);
	if (!g->rgb && g->intensity)
		find_levels(g, &levels);
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		blend_row(g, normal, &levels, o, row, wanted + (size_t)row * g->columns);
	for (uint32_t row = 0; row < g->rows; row++) {
		diffuse_row(f, g, wanted + (size_t)row * g->columns, row, here, below);
		float *swap = here;
		here = below;
		below = swap;
		memset(below, 0, g->columns * sizeof *below);
	}
	g_free(here);
	g_free(below);
}
