#include "process/normals-tile.h"
#include <string.h>

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

/* A grid's planes are made band of rows by band, and each strip of columns by strip: what they need of each other is in the cache.
 * (Strips from top to bottom would need less of each other, but memory that is new would be out of the cache again.) */
struct band {
	const range_grid *grid;
	const struct normals_options *options;
	const struct normals_planes *planes;
	uint32_t width, count, reach_columns; /* of strips */
	uint32_t row, rows_end;
};

static struct band first_band(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes)
{
	uint32_t width = columns_within(g, TILE_WIDEST_RAD / 2, TILE_COLUMNS);
	width = width > 16 ? width / 16 * 16 : width;
	return (struct band){ g, options, planes, .width = width,
		.count = (g->columns + width - 1) / width,
		.reach_columns = columns_within(g, TILE_WIDEST_RAD / 4, TILE_REACH),
		.rows_end = MIN(TILE_ROWS, g->rows) };
}

static void to_next_band(struct band *b)
{
	b->row = b->rows_end;
	b->rows_end = MIN(b->row + TILE_ROWS, b->grid->rows);
}

static struct area strip_area(const struct band *b, uint32_t strip)
{
	return (struct area){ b->row, b->rows_end, strip * b->width,
		MIN((strip + 1) * b->width, b->grid->columns) };
}

/* Rows that can be sharpened when those before the given one are fitted. */
static uint32_t sharp_rows(const struct band *b, uint32_t fitted)
{
	return fitted == b->grid->rows ? fitted : MAX(fitted, SHARPEN_REACH) - SHARPEN_REACH;
}

/* The columns whose neighbours are all in the strip. */
static struct area inner_area(const struct band *b, uint32_t strip)
{
	struct area a = strip_area(b, strip);
	a.row = sharp_rows(b, b->row);
	a.rows_end = sharp_rows(b, b->rows_end);
	a.column = MIN(a.column + SHARPEN_REACH, a.columns_end);
	a.columns_end = MAX(a.column, a.columns_end - MIN(a.columns_end, SHARPEN_REACH));
	return a;
}

/* The fits; what is behind them is mended on the way, if it is to be. */
static void fit_strip(const struct band *b, uint32_t strip, tile *t, bool mend)
{
	const range_grid *g = b->grid;
	struct area all = strip_area(b, strip), sharp = inner_area(b, strip);
	struct tile_job job = { g, b->options, b->planes, .column = all.column, .row = all.row,
		.columns = all.columns_end - all.column, .rows = all.rows_end - all.row,
		.reach_columns = b->reach_columns,
		.first = (size_t)all.row * g->columns + all.column, .pitch = g->columns };
	tile_start(t, &job);
	for (uint32_t first = 0, end; first < job.rows; first = end) {
		end = MIN(first + TILE_STEP, job.rows);
		tile_fit(t, &job, first, end);
		if (!mend)
			continue;
		all.row = b->row + first;
		all.rows_end = b->row + end;
		fill_area(g, b->options, b->planes, all);
		sharp.rows_end = sharp_rows(b, all.rows_end);
		sharpen_area(g, b->options, b->planes, sharp);
		sharp.row = MAX(sharp.row, sharp.rows_end);
	}
}

void normals_fit(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes)
{
#pragma omp parallel if (!options->single_thread)
	{
		tile *t = tile_new();
		for (struct band b = first_band(g, options, planes); b.row < g->rows;
			to_next_band(&b)) {
#pragma omp for schedule(dynamic, 1)
			for (uint32_t i = 0; i < b.count; i++)
				fit_strip(&b, i, t, false);
		}
		tile_free(t);
	}
}

void normals_mend(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes)
{
	for (struct band b = first_band(g, options, planes); b.row < g->rows; to_next_band(&b)) {
#pragma omp parallel for schedule(dynamic, 1) if (!options->single_thread)
		for (uint32_t i = 0; i < b.count; i++) {
			sharpen_area(g, options, planes, strip_area(&b, i));
			fill_area(g, options, planes, strip_area(&b, i));
		}
	}
}

/* Around where the strip begins; and at the very end. */
static void sharpen_border(const struct band *b, uint32_t strip)
{
	struct area a = inner_area(b, strip), before = a;
	before.columns_end = a.column;
	before.column = strip ? inner_area(b, strip - 1).columns_end : 0;
	sharpen_area(b->grid, b->options, b->planes, before);
	if (strip + 1 == b->count) {
		a.column = a.columns_end;
		a.columns_end = b->grid->columns;
		sharpen_area(b->grid, b->options, b->planes, a);
	}
}

/* All threads come here. A border is sharpened at once where the strip before it is this thread's, for it is still near by; else
 * when all are fitted. */
static void estimate_band(const struct band *b, tile *t, bool *late)
{
	uint32_t last = b->count;
#pragma omp for schedule(dynamic, 2)
	for (uint32_t i = 0; i < b->count; i++) {
		fit_strip(b, i, t, true);
		late[i] = last + 1 != i || i + 1 == b->count;
		if (!late[i])
			sharpen_border(b, i);
		last = i;
	}
#pragma omp for schedule(dynamic, 1)
	for (uint32_t i = 0; i < b->count; i++)
		if (late[i])
			sharpen_border(b, i);
}

/* The offsets are only looked at near by: kept are those of a band and of as many rows before it as are. */
static size_t offset_rows(const range_grid *g)
{
	return MIN(TILE_ROWS + 2 * SHARPEN_REACH, g->rows);
}

/* One thread does it, the others wait. */
static void keep_offsets(const struct band *b, struct normals_planes *planes)
{
	size_t columns = b->grid->columns,
	       first = b->row > 2 * SHARPEN_REACH ? b->row - 2 * SHARPEN_REACH : 0,
	       gone = first * columns - planes->offset_from;
	memmove(planes->offset_m, planes->offset_m + gone,
		(b->row - first) * columns * sizeof(float));
	planes->offset_from += gone;
}

void normals_estimate(const range_grid *g, const struct normals_options *options,
	const struct normals_planes *planes)
{
	struct normals_planes p = *planes;
	const struct band first = first_band(g, options, &p);
	const bool narrow = first.width < 2 * SHARPEN_REACH; /* strips have no inner columns */
	p.offset_m =
		g_aligned_alloc((narrow ? range_grid_cells(g) : offset_rows(g) * g->columns) + 64,
			sizeof(float), 64); /* vectors may read past the end */
	p.offset_from = 0;
	g_autofree bool *late = g_new(bool, first.count);
	if (narrow) {
		normals_fit(g, options, &p);
		normals_mend(g, options, &p);
		g_aligned_free(p.offset_m);
		return;
	}
#pragma omp parallel if (!options->single_thread)
	{
		tile *t = tile_new();
		for (struct band b = first; b.row < g->rows; to_next_band(&b)) {
#pragma omp single
			keep_offsets(&b, &p);
			estimate_band(&b, t, late);
		}
		tile_free(t);
	}
	g_aligned_free(p.offset_m);
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

/* A camera of depth tells it in steps, far apart where it is far away: neighbours are equal, or differ by a step, and hardly by less. Bends
 * along rows are nothing, steps, or between these, as shares of the range. */
#define STEP_NOTHING 1e-4f
#define STEP_LEAST   2e-3f
#define STEP_MOST    5e-2f
/* Where so many are nothing and steps, and no more between. */
#define STEPS_SHARE   0.2f
#define BETWEEN_SHARE 0.15f
/* 1 sigma of what is told in steps, which waver by one themselves. */
#define STEP_SIGMA 1.f

/* 0: ranges do not come in steps. *ret_at_m: how far away it is so much. */
static float step_noise_m(const range_grid *g, float *ret_at_m)
{
	size_t n = range_grid_cells(g), stride = n / NOISE_SAMPLES + 1, steps = 0, all = 0,
	       nothing = 0;
	g_autofree float *step = g_new(float, NOISE_SAMPLES + 1),
			 *growth = g_new(float, NOISE_SAMPLES + 1);
	for (size_t i = 1; i + 1 < n && steps < NOISE_SAMPLES; i += stride) {
		const float *r = g->range_m + i;
		size_t column = i % g->columns;
		if (column == 0 || column + 1 == g->columns || !(r[-1] > 0 && r[0] > 0 && r[1] > 0))
			continue;
		float bend = fabsf(r[-1] - 2 * r[0] + r[1]);
		nothing += bend < STEP_NOTHING * r[0];
		if (bend >= STEP_LEAST * r[0] && bend < STEP_MOST * r[0]) {
			growth[steps] = bend / (r[0] * r[0]);
			step[steps++] = bend;
		}
		all += bend < STEP_MOST * r[0];
	}
	float some = STEPS_SHARE * (float)all, between = (float)(all - nothing - steps);
	if (!steps || (float)nothing < some || (float)steps < some ||
		between > BETWEEN_SHARE * (float)all)
		return 0;
	float farther = value_at(step, steps, steps * 3 / 4);
	*ret_at_m = sqrtf(farther / value_at(growth, steps, steps / 2));
	return STEP_SIGMA * farther;
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
		tile_start(t, &job);
		tile_fit(t, &job, 0, job.rows);
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

float normals_range_noise_m(const range_grid *g, float *ret_at_m)
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
	float at_m = 0, steps_m = step_noise_m(g, &at_m);
	if (ret_at_m)
		*ret_at_m = at_m;
	return fminf(fmaxf(options.range_noise_m, steps_m), NOISE_MOST_M);
}
