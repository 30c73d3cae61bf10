/* The mean and the variance of each square are found once, and each pixel takes that of the least variance of the four squares that it
 * is a corner of. Squares are summed by columns, which only gain a row and lose one from row to row. */
#include "render/filter-kuwahara.h"
#include "render/project-lanes.h"

enum { RED, GREEN, BLUE, SQUARES, SUMS };

/* Of a band; each row begins radius columns before the picture. */
struct kuwahara_desk {
	uint32_t columns; /* of sums */
	int32_t *sum[SUMS];
	/* Of squares, by their left upper corner; the last radius + 1 rows. */
	uint32_t rows, pitch;
	int32_t *mean;
	float *variance;
};

INLINE size_t padded(uint32_t columns)
{
	return (columns + 2 * LANES + 7) / 8 * 8;
}

INLINE void set_up(struct kuwahara_desk *d, uint32_t width, uint32_t radius)
{
	d->columns = width + 2 * radius;
	d->rows = radius + 1;
	d->pitch = (uint32_t)padded(width + radius);
	size_t line = padded(d->columns + radius);
	int32_t *at = g_malloc0_n(SUMS * line + 2 * (size_t)d->pitch * d->rows, sizeof *at);
	for (int k = 0; k < SUMS; k++, at += line)
		d->sum[k] = at;
	d->mean = at;
	d->variance = (float *)(void *)(at + (size_t)d->pitch * d->rows);
}

/* The last row before the picture is its first, and so on. */
INLINE const uint8_t *row_at(const struct filter_image *i, int32_t y)
{
	return i->rgba[(size_t)CLAMP(y, 0, (int32_t)i->height - 1) * i->width];
}

INLINE vi pixels_at(const uint8_t *row, const struct filter_image *i, int32_t x)
{
	vi ret;
	if (x >= 0 && x + LANES <= (int32_t)i->width)
		return *(const vi_loose *)(const void *)(row + 4 * (size_t)x);
	for (int k = 0; k < LANES; k++) {
		int32_t at = CLAMP(x + k, 0, (int32_t)i->width - 1), pixel;
		memcpy(&pixel, row + 4 * (size_t)at, sizeof pixel);
		ret[k] = pixel;
	}
	return ret;
}

INLINE void add(struct kuwahara_desk *d, const struct filter_image *i, uint32_t radius, int32_t y,
	int32_t sign)
{
	const uint8_t *row = row_at(i, y);
	for (uint32_t n = 0; n < d->columns; n += LANES) {
		vi p = pixels_at(row, i, (int32_t)n - (int32_t)radius);
		vi of[SUMS] = { p & 255, p >> 8 & 255, p >> 16 & 255 };
		of[SQUARES] = of[RED] * of[RED] + of[GREEN] * of[GREEN] + of[BLUE] * of[BLUE];
		for (int k = 0; k < SUMS; k++)
			store_mask(d->sum[k] + n,
				load_mask(d->sum[k] + n) + (sign > 0 ? of[k] : -of[k]));
	}
}

INLINE void put_squares(struct kuwahara_desk *d, const vi sum[SUMS], float by_count, uint32_t to)
{
	vf mean[3], variance = __builtin_convertvector(sum[SQUARES], vf) * by_count;
	vi packed = { 0 };
	for (int k = 0; k < 3; k++) {
		mean[k] = __builtin_convertvector(sum[k], vf) * by_count;
		variance -= mean[k] * mean[k];
		packed |= __builtin_convertvector(mean[k] + 0.5f, vi) << 8 * k;
	}
	store_mask(d->mean + to, packed);
	store(d->variance + to, variance);
}

/* So few columns are added up anew for each square. */
#define FEW 9u

/* All squares of a row. */
INLINE void look(struct kuwahara_desk *d, uint32_t width, uint32_t radius, uint32_t row)
{
	float by_count = 1 / (float)((radius + 1) * (radius + 1));
	uint32_t count = width + radius, base = row * d->pitch;
	if (radius < FEW) {
		for (uint32_t n = 0; n < count; n += LANES) {
			vi sum[SUMS];
			for (int k = 0; k < SUMS; k++) {
				sum[k] = load_mask(d->sum[k] + n);
				for (uint32_t c = 1; c <= radius; c++)
					sum[k] += load_mask(d->sum[k] + n + c);
			}
			put_squares(d, sum, by_count, base + n);
		}
		return;
	}
	int32_t running[SUMS] = { 0 }, eight[SUMS][LANES];
	for (int k = 0; k < SUMS; k++)
		for (uint32_t c = 0; c < radius; c++)
			running[k] += d->sum[k][c];
	for (uint32_t n = 0; n < count; n += LANES) {
		vi sum[SUMS];
		for (int k = 0; k < SUMS; k++) {
			for (uint32_t c = n; c < n + LANES; c++) {
				running[k] += d->sum[k][c + radius];
				eight[k][c - n] = running[k];
				running[k] -= d->sum[k][c];
			}
			sum[k] = load_mask(eight[k]);
		}
		put_squares(d, sum, by_count, base + n);
	}
}

INLINE void take_less(const struct kuwahara_desk *d, uint32_t at, vi *mean, vf *variance)
{
	vf other = load(d->variance + at);
	vi less = other < *variance;
	*mean = (load_mask(d->mean + at) & less) | (*mean & ~less);
	*variance = least(other, *variance);
}

/* The mean of all four, weighted by how even they are, mixed with that of the most even one. */
INLINE vi soften(const struct kuwahara_desk *d, const uint32_t corner[4], uint32_t x, vi best,
	float softness)
{
	vf sum[3] = { { 0 } }, weights = { 0 };
	for (int k = 0; k < 4; k++) {
		vf w = 1 / (most(load(d->variance + corner[k] + x), all(0)) + KUWAHARA_EVEN);
		vi mean = load_mask(d->mean + corner[k] + x);
		w *= w;
		w *= w;
		weights += w;
		for (int c = 0; c < 3; c++)
			sum[c] += w * __builtin_convertvector(mean >> 8 * c & 255, vf);
	}
	vi packed = { 0 };
	vf by = softness / weights;
	for (int c = 0; c < 3; c++) {
		vf hard = __builtin_convertvector(best >> 8 * c & 255, vf);
		packed |= __builtin_convertvector(sum[c] * by + (1 - softness) * hard + 0.5f, vi)
			  << 8 * c;
	}
	return packed;
}

INLINE void write_row(const struct kuwahara_desk *d, const struct filter_image *i, uint32_t radius,
	float softness, uint32_t above, uint32_t below, uint32_t y)
{
	uint8_t *to = i->spare[(size_t)y * i->width];
	const uint32_t corner[4] = { above * d->pitch, above * d->pitch + radius, below * d->pitch,
		below * d->pitch + radius };
	for (uint32_t x = 0; x < i->width; x += LANES) {
		vf variance = load(d->variance + corner[0] + x);
		vi mean = load_mask(d->mean + corner[0] + x);
		for (int k = 1; k < 4; k++)
			take_less(d, corner[k] + x, &mean, &variance);
		if (softness > 0)
			mean = soften(d, corner, x, mean, softness);
		mean |= (int32_t)0xff000000;
		memcpy(to + 4 * (size_t)x, &mean, 4 * MIN(LANES, i->width - x));
	}
}

void LANES_NAME(filter_kuwahara_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct kuwahara_pass *p = data;
	const struct filter_image *i = p->image;
	int32_t radius = (int32_t)p->radius, first = (int32_t)from - radius;
	struct kuwahara_desk d;
	set_up(&d, i->width, p->radius);
	for (int32_t y = first; y < first + radius; y++)
		add(&d, i, p->radius, y, 1);
	for (int32_t y = first; y < (int32_t)end; y++) {
		uint32_t row = (uint32_t)(y - first) % d.rows;
		add(&d, i, p->radius, y + radius, 1);
		look(&d, i->width, p->radius, row);
		add(&d, i, p->radius, y, -1);
		if (y >= (int32_t)from) /* the next row of the ring is the oldest: radius above */
			write_row(&d, i, p->radius, p->softness, (row + 1) % d.rows, row,
				(uint32_t)y);
	}
	g_free(d.sum[0]);
}
