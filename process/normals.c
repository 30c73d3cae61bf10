#include "process/normals-tile.h"

/* No tile with its reach looks wider than this: far from its middle the frame would be squeezed. */
#define TILE_WIDEST_RAD 1.4
#define NOISE_SAMPLES   4000u
#define NOISE_TILES     24
#define NOISE_TILE      16
#define NOISE_RADIUS_M  0.06f
#define NOISE_LEAST_M   5e-4f
#define NOISE_MOST_M    0.05f

static uint32_t columns_within(const range_grid *g, double angle_rad, uint32_t most)
{
	double columns = angle_rad / g->column_rad;
	return columns < most ? MAX((uint32_t)columns, 1) : most;
}

/* Rows first to end. */
static void fit_rows(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes, uint32_t first, uint32_t end)
{
	uint32_t reach = columns_within(g, TILE_WIDEST_RAD / 4, TILE_REACH);
	uint32_t width = columns_within(g, TILE_WIDEST_RAD / 2, TILE_COLUMNS);
	width = width > 16 ? width / 16 * 16 : width;
	uint32_t across = (g->columns + width - 1) / width;
#pragma omp parallel if (!options->single_thread)
	{
		tile *t = tile_new();
#pragma omp for schedule(dynamic, 1)
		for (uint32_t i = 0; i < across; i++) {
			struct tile_job job = { g, options, planes, .column = i * width,
				.row = first, .rows = end - first, .reach_columns = reach };
			job.columns = MIN(width, g->columns - job.column);
			job.first = (size_t)first * g->columns + job.column;
			job.pitch = g->columns;
			tile_fit(t, &job);
		}
		tile_free(t);
	}
}

void normals_fit(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes)
{
	for (uint32_t row = 0; row < g->rows; row += TILE_ROWS)
		fit_rows(g, options, planes, row, MIN(row + TILE_ROWS, g->rows));
}

void normals_mend(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes)
{
	sharpen_rows(g, options, planes, 0, g->rows);
	fill_rows(g, options, planes, 0, g->rows);
}

/* The three look at the same planes; a band of rows after the other, they find them in the cache. */
void normals_estimate(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes)
{
	uint32_t sharp = 0, full = 0;
	for (uint32_t row = 0, end; row < g->rows; row = end) {
		end = MIN(row + TILE_ROWS, g->rows);
		fit_rows(g, options, planes, row, end);
		uint32_t back = end < g->rows ? SHARPEN_REACH : 0;
		sharpen_rows(g, options, planes, sharp, end - back);
		fill_rows(g, options, planes, full, end - 2 * back);
		sharp = end - back;
		full = end - 2 * back;
	}
}

/* What would stand there if the values were sorted (Hoare's find: sorting them all takes longer than the fits). */
static float value_at(float *values, size_t count, size_t place)
{
	size_t first = 0, last = count - 1;
	while (first < last) {
		float pivot = values[first + (last - first) / 2];
		size_t i = first, j = last;
		for (;; i++, j--) {
			while (values[i] < pivot)
				i++;
			while (pivot < values[j])
				j--;
			if (i >= j)
				break;
			float swap = values[i];
			values[i] = values[j];
			values[j] = swap;
		}
		if (place <= j)
			last = j;
		else
			first = j + 1;
	}
	return values[place];
}

/* The value that one in `part` is below. */
static float low_quantile(float *values, size_t count, size_t part, float otherwise)
{
	return count ? value_at(values, count, count / part) : otherwise;
}

/* Second differences of ranges along a row have sqrt(6) times their noise, and whatever uneven beams on slanting surfaces add.
 * Most of a scan is smooth, but far from all: the lower quartile, 0.3186 sigma of a normal distribution, is not led astray. */
static float noise_at_most_m(const range_grid *g)
{
	size_t n = range_grid_cells(g), stride = n / NOISE_SAMPLES + 1, count = 0;
	g_autofree float *bend = g_new(float, NOISE_SAMPLES + 1);
	for (size_t i = 1; i + 1 < n && count < NOISE_SAMPLES; i += stride) {
		const float *r = g->range_m + i;
		size_t column = i % g->columns;
		if (column > 0 && column + 1 < g->columns && r[-1] > 0 && r[0] > 0 && r[1] > 0)
			bend[count++] = fabsf(r[-1] - 2 * r[0] + r[1]);
	}
	return CLAMP(low_quantile(bend, count, 4, 0) / (0.3186f * sqrtf(6)), NOISE_LEAST_M,
		NOISE_MOST_M);
}

/* What fits leave along the rays in a few small tiles. Windows on smooth surfaces leave noise and nothing else, all about the
 * same; curved and cluttered ones leave more. */
static float noise_left_m(const range_grid *g, const struct normals_options *o,
	const struct normals_planes *p, tile *t, uint32_t stride)
{
	g_autofree float *left_m = g_new(float, NOISE_TILES *NOISE_TILE *NOISE_TILE);
	size_t count = 0;
	for (uint32_t k = 0; k < NOISE_TILES; k += stride) {
		struct tile_job job = { g, o, p, .columns = MIN(NOISE_TILE, g->columns),
			.rows = MIN(NOISE_TILE, g->rows), .pitch = NOISE_TILE,
			.reach_columns = columns_within(g, TILE_WIDEST_RAD / 4, TILE_REACH) };
		/* The golden ratio spreads them evenly, whatever repeats in the scan. */
		job.column = (uint32_t)(fmod(k * 0.6180339887, 1) * (g->columns - job.columns));
		job.row = (uint32_t)((k + 0.5) / NOISE_TILES * (g->rows - job.rows));
		tile_fit(t, &job);
		for (uint32_t i = 0; i < job.columns * job.rows; i++) {
			uint32_t row = i / job.columns, column = i % job.columns,
				 at = row * NOISE_TILE + column;
			if (p->offset_m[at] != 0)
				left_m[count++] = p->error_m[at] / fabsf(p->offset_m[at]) *
						  g->range_m[(size_t)(job.row + row) * g->columns +
							     job.column + column];
		}
	}
	return low_quantile(left_m, count, 8, o->range_noise_m);
}

float normals_range_noise_m(const range_grid *g)
{
	float error_m[NOISE_TILE * NOISE_TILE], offset_m[NOISE_TILE * NOISE_TILE];
	struct normals_options options = { .radius_m = NOISE_RADIUS_M,
		.range_noise_m = noise_at_most_m(g) };
	struct normals_planes planes = { .error_m = error_m, .offset_m = offset_m };
	tile *t = tile_new();
	for (uint32_t stride = 2; stride;
		stride--) /* the first one's windows may be far too wide */
		options.range_noise_m = CLAMP(
			noise_left_m(g, &options, &planes, t, stride), NOISE_LEAST_M, NOISE_MOST_M);
	tile_free(t);
	return options.range_noise_m;
}
