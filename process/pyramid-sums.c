#include "process/pyramid-sums.h"
#include <string.h>

/* Columns that are worked on together: their sums stay in the first cache, and loops over them become vectors. */
#define CHUNK 64

#if defined(__x86_64__) && defined(__GNUC__)
#define WIDE        __attribute__((target("avx2,fma")))
#define HAVE_WIDE() (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
#else
#define WIDE
#define HAVE_WIDE() false
#endif
#define INLINE static inline __attribute__((always_inline))

static void sums_allocate(struct sums *s, uint32_t columns, uint32_t rows)
{
	s->columns = columns;
	s->rows = rows;
	s->stride = ((size_t)columns + 2 + 15) / 16 * 16;
	for (int k = 0; k < SUM_PLANES; k++)
		s->plane[k] =
			g_aligned_alloc0(s->stride * (rows + 2) + CHUNK + 16, sizeof(float), 64);
}

void sums_clear(struct sums *s)
{
	for (int k = 0; k < SUM_PLANES; k++)
		g_clear_pointer(&s->plane[k], g_aligned_free);
}

static void repeat_far_sides(struct sums *s)
{
	for (int k = 0; k < SUM_PLANES; k++)
		for (uint32_t r = 0; r < s->rows; r++) {
			float *row = s->plane[k] + (r + 1) * s->stride;
			row[0] = row[s->columns];
			row[s->columns + 1] = row[1];
		}
}

/* ---- blocks of points ---- */

/* CHUNK columns of a few rows of the grid. */
struct strip {
	const float *x, *y, *z, *range;
	size_t stride;
};

INLINE void add_neighbours(const float *restrict each, uint32_t across, float *restrict ret)
{
	for (uint32_t b = 0; b < CHUNK / across; b++) {
		float sum = 0;
		for (uint32_t k = 0; k < across; k++)
			sum += each[b * across + k];
		ret[b] = sum;
	}
}

/* Counts and means, per block and, repeated, per column. */
INLINE void sum_means(const struct strip *from, uint32_t across, uint32_t down,
	float ret_block[4][CHUNK], float ret_mean[3][CHUNK])
{
	float sum[4][CHUNK] = { 0 };
	for (uint32_t r = 0; r < down; r++) {
		size_t row = r * from->stride;
		const float *restrict x = from->x + row, *restrict y = from->y + row;
		const float *restrict z = from->z + row, *restrict range = from->range + row;
		for (int i = 0; i < CHUNK; i++) { /* where there is no point they are 0 */
			sum[0][i] += range[i] > 0 ? 1.0f : 0.0f;
			sum[1][i] += x[i];
			sum[2][i] += y[i];
			sum[3][i] += z[i];
		}
	}
	for (int k = 0; k < 4; k++)
		add_neighbours(sum[k], across, ret_block[k]);
	for (uint32_t b = 0; b < CHUNK / across; b++) {
		float share = ret_block[0][b] > 0 ? 1 / ret_block[0][b] : 0;
		for (int k = 0; k < 3; k++) {
			ret_block[k + 1][b] *= share;
			for (uint32_t i = 0; i < across; i++)
				ret_mean[k][b * across + i] = ret_block[k + 1][b];
		}
	}
}

INLINE void sum_products(const struct strip *from, uint32_t across, uint32_t down,
	const float mean[3][CHUNK], float ret[6][CHUNK])
{
	float sum[6][CHUNK] = { 0 };
	for (uint32_t r = 0; r < down; r++) {
		size_t row = r * from->stride;
		const float *restrict px = from->x + row, *restrict py = from->y + row;
		const float *restrict pz = from->z + row, *restrict range = from->range + row;
		for (int i = 0; i < CHUNK; i++) {
			float there = range[i] > 0 ? 1.0f : 0.0f;
			float x = (px[i] - mean[0][i]) * there, y = (py[i] - mean[1][i]) * there,
			      z = (pz[i] - mean[2][i]) * there;
			sum[0][i] += x * x;
			sum[1][i] += x * y;
			sum[2][i] += x * z;
			sum[3][i] += y * y;
			sum[4][i] += y * z;
			sum[5][i] += z * z;
		}
	}
	for (int k = 0; k < 6; k++)
		add_neighbours(sum[k], across, ret[k]);
}

INLINE void sum_strip(const struct strip *from, uint32_t across, uint32_t down, struct sums *s,
	size_t at, uint32_t blocks)
{
	float block[4][CHUNK], mean[3][CHUNK], products[6][CHUNK];
	sum_means(from, across, down, block, mean);
	sum_products(from, across, down, mean, products);
	size_t bytes = blocks * sizeof(float);
	memcpy(s->plane[SUM_COUNT] + at, block[0], bytes);
	for (int k = 0; k < 3; k++)
		memcpy(s->plane[SUM_X + k] + at, block[k + 1], bytes);
	for (int k = 0; k < 6; k++)
		memcpy(s->plane[SUM_XX + k] + at, products[k], bytes);
	for (uint32_t b = 0; b < blocks; b++)
		s->plane[SUM_RANGE][at + b] =
			sqrtf(block[1][b] * block[1][b] + block[2][b] * block[2][b] +
				block[3][b] * block[3][b]);
}

typedef void strip_func(const struct strip *from, uint32_t across, uint32_t down, struct sums *s,
	size_t at, uint32_t blocks);

/* The numbers are spelt out so that each case becomes its own unrolled code. */
#define SUM_STRIP(name, attributes)                                                                \
	attributes static void name(const struct strip *from, uint32_t across, uint32_t down,      \
		struct sums *s, size_t at, uint32_t blocks)                                        \
	{                                                                                          \
		switch (across) {                                                                  \
		case 1: sum_strip(from, 1, down, s, at, blocks); break;                            \
		case 2: sum_strip(from, 2, down, s, at, blocks); break;                            \
		case 4: sum_strip(from, 4, down, s, at, blocks); break;                            \
		default: sum_strip(from, 8, down, s, at, blocks); break;                           \
		}                                                                                  \
	}
SUM_STRIP(sum_strip_wide, WIDE)
SUM_STRIP(sum_strip_portable, )

/* Rows of a lattice as planes: of cells that it takes from elsewhere, or the last ones of a row. */
struct copied {
	float *plane[4];
	uint32_t width;
};

static void copy_cells(const range_grid *g, uint32_t row, uint32_t rows, uint32_t first,
	uint32_t count, const struct copied *to)
{
	const struct range_lattice *l = &g->lattice;
	const float *from[4] = { g->x_m, g->y_m, g->z_m, g->range_m };
	for (uint32_t r = 0; r < rows; r++)
		for (uint32_t i = 0; i < to->width; i++) {
			size_t at = (size_t)(row + r) * l->columns + first + i;
			uint32_t cell = row + r >= l->rows || i >= count ? RANGE_GRID_NONE
					: l->cell                        ? l->cell[at]
									 : (uint32_t)at;
			for (int k = 0; k < 4; k++)
				to->plane[k][r * to->width + i] =
					cell == RANGE_GRID_NONE ? 0 : from[k][cell];
		}
}

static struct strip strip_at(const range_grid *g, uint32_t row, uint32_t rows, uint32_t first,
	uint32_t count, const struct copied *spare)
{
	const struct range_lattice *l = &g->lattice;
	if (l->cell || count < CHUNK || row + rows > l->rows) {
		copy_cells(g, row, rows, first, count, spare);
		return (struct strip){ spare->plane[0], spare->plane[1], spare->plane[2],
			spare->plane[3], spare->width };
	}
	size_t at = (size_t)row * l->columns + first;
	return (struct strip){ g->x_m + at, g->y_m + at, g->z_m + at, g->range_m + at, l->columns };
}

void sums_of_grid(
	const range_grid *g, uint32_t across, uint32_t down, bool portable, struct sums *ret)
{
	const struct range_lattice *l = &g->lattice;
	strip_func *sum = !portable && HAVE_WIDE() ? sum_strip_wide : sum_strip_portable;
	sums_allocate(ret, (l->columns + across - 1) / across, (l->rows + down - 1) / down);
	g_autofree float *room = g_new(float, (size_t)4 * CHUNK * down);
	struct copied spare = { .width = CHUNK };
	for (int k = 0; k < 4; k++)
		spare.plane[k] = room + (size_t)k * CHUNK * down;
	for (uint32_t r = 0; r < ret->rows; r++)
		for (uint32_t first = 0; first < l->columns; first += CHUNK) {
			uint32_t count = MIN(CHUNK, l->columns - first);
			struct strip from = strip_at(g, r * down, down, first, count, &spare);
			sum(&from, across, down, ret, sums_at(ret, r, first / across),
				(count + across - 1) / across);
		}
	if (l->wraps)
		repeat_far_sides(ret);
}

/* ---- the level above ---- */

static void merge_cells(const struct sums *b, const size_t from[4], struct sums *to, size_t at)
{
	float count = 0, mean[3] = { 0 }, products[6] = { 0 };
	for (int i = 0; i < 4; i++) {
		float n = b->plane[SUM_COUNT][from[i]];
		count += n;
		for (int k = 0; k < 3; k++)
			mean[k] += n * b->plane[SUM_X + k][from[i]];
	}
	if (!(count > 0))
		return;
	for (int k = 0; k < 3; k++)
		mean[k] /= count;
	for (int i = 0; i < 4; i++) {
		float n = b->plane[SUM_COUNT][from[i]], d[3];
		for (int k = 0; k < 3; k++)
			d[k] = b->plane[SUM_X + k][from[i]] - mean[k];
		for (int k = 0, j = 0; j < 3; j++)
			for (int m = j; m < 3; m++, k++)
				products[k] +=
					n > 0 ? b->plane[SUM_XX + k][from[i]] + n * d[j] * d[m] : 0;
	}
	to->plane[SUM_COUNT][at] = count;
	to->plane[SUM_RANGE][at] = sqrtf(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
	for (int k = 0; k < 3; k++)
		to->plane[SUM_X + k][at] = mean[k];
	for (int k = 0; k < 6; k++)
		to->plane[SUM_XX + k][at] = products[k];
}

void sums_of_level_below(const struct sums *below, bool wraps, struct sums *ret)
{
	sums_allocate(ret, (below->columns + 1) / 2, (below->rows + 1) / 2);
	for (uint32_t r = 0; r < ret->rows; r++)
		for (uint32_t c = 0; c < ret->columns; c++) {
			size_t from[4] = { sums_at(below, 2 * r, 2 * c) };
			/* Beyond the last column or row lies an empty cell, or one that was counted. */
			size_t empty = 0;
			bool right = 2 * c + 1 < below->columns, down = 2 * r + 1 < below->rows;
			from[1] = right ? from[0] + 1 : empty;
			from[2] = down ? from[0] + below->stride : empty;
			from[3] = right && down ? from[0] + below->stride + 1 : empty;
			merge_cells(below, from, ret, sums_at(ret, r, c));
		}
	if (wraps)
		repeat_far_sides(ret);
}

/* ---- planes ---- */

/* Sums over the window, about the mean of its middle cell. */
struct window {
	float count[CHUNK], d[3][CHUNK], q[6][CHUNK];
};

INLINE void add_cells(const struct sums *s, size_t middle, ptrdiff_t step, float slack_m,
	float slope, struct window *w)
{
	const float *restrict n = s->plane[SUM_COUNT] + middle + step;
	const float *restrict r = s->plane[SUM_RANGE] + middle + step;
	const float *restrict r0 = s->plane[SUM_RANGE] + middle;
	const float *restrict x = s->plane[SUM_X] + middle, *restrict y = s->plane[SUM_Y] + middle,
			      *restrict z = s->plane[SUM_Z] + middle;
	const float *restrict qxx = s->plane[SUM_XX] + middle + step,
			      *restrict qxy = s->plane[SUM_XY] + middle + step,
			      *restrict qxz = s->plane[SUM_XZ] + middle + step,
			      *restrict qyy = s->plane[SUM_YY] + middle + step,
			      *restrict qyz = s->plane[SUM_YZ] + middle + step,
			      *restrict qzz = s->plane[SUM_ZZ] + middle + step;
	for (int i = 0; i < CHUNK; i++) {
		float in = fabsf(r[i] - r0[i]) <= slack_m + slope * r0[i] ? 1.0f : 0.0f;
		in *= n[i] > 0 ? 1.0f : 0.0f;
		float m = in * n[i];
		float dx = x[i + step] - x[i], dy = y[i + step] - y[i], dz = z[i + step] - z[i];
		w->count[i] += m;
		w->d[0][i] += m * dx;
		w->d[1][i] += m * dy;
		w->d[2][i] += m * dz;
		w->q[0][i] += in * qxx[i] + m * dx * dx;
		w->q[1][i] += in * qxy[i] + m * dx * dy;
		w->q[2][i] += in * qxz[i] + m * dx * dz;
		w->q[3][i] += in * qyy[i] + m * dy * dy;
		w->q[4][i] += in * qyz[i] + m * dy * dz;
		w->q[5][i] += in * qzz[i] + m * dz * dz;
	}
}

/* Fewer points than this, or a middle cell without one, make no plane. */
#define PLANE_POINTS_MIN 5

INLINE void fit_windows(const struct sums *s, size_t middle, const struct window *w, uint32_t first,
	float *ret[FIT_PLANES])
{
	const float *restrict x0 = s->plane[SUM_X] + middle,
			      *restrict y0 = s->plane[SUM_Y] + middle,
			      *restrict z0 = s->plane[SUM_Z] + middle;
	const float *restrict r0 = s->plane[SUM_RANGE] + middle;
	float out[FIT_PLANES][CHUNK];
	for (int i = 0; i < CHUNK; i++) {
		float n = w->count[i], share = 1 / fmaxf(n, 1), r = 1 / fmaxf(r0[i], 1e-6f);
		float mx = w->d[0][i] * share, my = w->d[1][i] * share, mz = w->d[2][i] * share;
		float xx = w->q[0][i] - n * mx * mx, xy = w->q[1][i] - n * mx * my,
		      xz = w->q[2][i] - n * mx * mz, yy = w->q[3][i] - n * my * my,
		      yz = w->q[4][i] - n * my * mz, zz = w->q[5][i] - n * mz * mz;
		float vx = x0[i] * r, vy = y0[i] * r, vz = z0[i] * r;
		/* The adjugate of the products, times the view. */
		float axx = yy * zz - yz * yz, axy = xz * yz - xy * zz, axz = xy * yz - xz * yy,
		      ayy = xx * zz - xz * xz, ayz = xy * xz - xx * yz, azz = xx * yy - xy * xy;
		float nx = axx * vx + axy * vy + axz * vz, ny = axy * vx + ayy * vy + ayz * vz,
		      nz = axz * vx + ayz * vy + azz * vz;
		float det = fmaxf(xx * axx + xy * axy + xz * axz, 0);
		float along = nx * vx + ny * vy + nz * vz,
		      length = sqrtf(nx * nx + ny * ny + nz * nz);
		bool good = n >= PLANE_POINTS_MIN && r0[i] > 0 && along > 0 && length > 0;
		float back = -1 / fmaxf(length, 1e-30f);
		out[FIT_COUNT][i] = good ? n : 0;
		out[FIT_NX][i] = nx * back;
		out[FIT_NY][i] = ny * back;
		out[FIT_NZ][i] = nz * back;
		out[FIT_VARIANCE][i] = det / (fmaxf(along, 1e-30f) * fmaxf(n - 3, 1));
		out[FIT_COSINE][i] = -along * back;
	}
	for (int k = 0; k < FIT_PLANES; k++)
		memcpy(ret[k] + first, out[k], MIN(CHUNK, s->columns - first) * sizeof(float));
}

INLINE void fit_chunk(const struct sums *s, uint32_t row, uint32_t first, float slack_m,
	float slope, float *ret[FIT_PLANES])
{
	struct window w = { 0 };
	size_t middle = sums_at(s, row, first);
	for (ptrdiff_t down = -1; down <= 1; down++)
		for (ptrdiff_t across = -1; across <= 1; across++)
			add_cells(s, middle, down * (ptrdiff_t)s->stride + across, slack_m, slope,
				&w);
	fit_windows(s, middle, &w, first, ret);
}

#define FIT_ROW(name, attributes)                                                                  \
	attributes static void name(const struct sums *s, uint32_t row, float slack_m,             \
		float slope, float *ret[FIT_PLANES])                                               \
	{                                                                                          \
		for (uint32_t first = 0; first < s->columns; first += CHUNK)                       \
			fit_chunk(s, row, first, slack_m, slope, ret);                             \
	}
FIT_ROW(fit_row_wide, WIDE)
FIT_ROW(fit_row_portable, )

void sums_fit_row(const struct sums *s, uint32_t row, float slack_m, float slope, bool portable,
	float *ret[FIT_PLANES])
{
	if (!portable && HAVE_WIDE())
		fit_row_wide(s, row, slack_m, slope, ret);
	else
		fit_row_portable(s, row, slack_m, slope, ret);
}
