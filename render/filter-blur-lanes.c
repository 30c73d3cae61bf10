/* Rows first, into the last few that columns are made of. */
#include "render/filter-planes.h"
#include "render/project-lanes.h"

struct blur_desk {
	/* Colours of bytes lie apart, so that none is blurred that is 255 everywhere. */
	uint32_t planes, line; /* floats of a row of a plane, without what is beside it */
	uint32_t apart;        /* from one place of a plane to the next pixel's, in floats */
	size_t pitch;          /* of planes in rows */
	uint32_t rows;         /* in the ring */
	float *wide;           /* a row of a plane with what is beside it */
	float *ring;
	float *sums;                                       /* a row that is done */
	const float *row[2 * FILTER_BLUR_RADIUS_MOST + 1]; /* of the ring, from above to below */
};

/* So many vectors are summed up at a time, which hides how long each sum takes. */
#define BLOCK (4 * LANES)

INLINE void set_up(struct blur_desk *d, const struct filter_blur *b)
{
	d->planes = b->is_bytes ? 3 : 1;
	d->apart = b->is_bytes ? 1 : b->channels;
	d->line = b->width * d->apart;
	d->rows = 2 * b->radius + 1;
	d->pitch = (d->line + BLOCK - 1) / BLOCK * BLOCK;
	size_t row = d->pitch * d->planes,
	       wide = d->pitch + 2 * (size_t)b->radius * d->apart + BLOCK;
	d->wide = g_new(float, wide + row * (d->rows + 1));
	memset(d->wide, 0, wide * sizeof *d->wide);
	d->sums = d->wide + wide;
	d->ring = d->sums + row;
}

/* One colour of a row. */
INLINE void fetch_bytes(float *to, const uint8_t *rgba, uint32_t width, uint32_t plane)
{
	uint32_t x = 0;
	for (; x + LANES <= width; x += LANES) {
		vi p = *(const vi_loose *)(const void *)(rgba + 4 * (size_t)x);
		store(to + x, __builtin_convertvector(p >> (int)(8 * plane) & 255, vf));
	}
	for (; x < width; x++)
		to[x] = rgba[4 * (size_t)x + plane];
}

/* A row of a plane, and what is beside it; the return value is where it begins. */
INLINE const float *fetch(
	struct blur_desk *d, const struct filter_blur *b, int32_t y, uint32_t plane)
{
	size_t row = (size_t)CLAMP(y, 0, (int32_t)b->height - 1) * b->width,
	       margin = (size_t)b->radius * d->apart;
	float *middle = d->wide + margin;
	if (b->is_bytes)
		fetch_bytes(middle, (const uint8_t *)b->from + 4 * row, b->width, plane);
	else
		memcpy(middle, (const float *)b->from + row * d->apart, d->line * sizeof *middle);
	for (uint32_t n = 0; n < margin; n++) {
		d->wide[n] = middle[n % d->apart];
		middle[d->line + n] = middle[d->line - d->apart + n % d->apart];
	}
	return middle;
}

INLINE void blur_row(
	const struct blur_desk *d, const struct filter_blur *b, const float *middle, float *to)
{
	for (uint32_t n = 0; n < d->line; n += BLOCK) {
		vf sum[BLOCK / LANES];
		for (int c = 0; c < BLOCK / LANES; c++)
			sum[c] = load(middle + n + c * LANES) * b->weight[0];
		for (uint32_t k = 1; k <= b->radius; k++) {
			size_t away = (size_t)k * d->apart;
			for (int c = 0; c < BLOCK / LANES; c++)
				sum[c] += (load(middle + n + c * LANES - away) +
						  load(middle + n + c * LANES + away)) *
					  b->weight[k];
		}
		for (int c = 0; c < BLOCK / LANES; c++)
			store(to + n + c * LANES, sum[c]);
	}
}

INLINE float *ring_row(const struct blur_desk *d, int32_t number)
{
	return d->ring + (size_t)((uint32_t)number % d->rows) * d->pitch * d->planes;
}

/* Of the rows in d->row. */
INLINE void blur_columns(const struct blur_desk *d, const struct filter_blur *b)
{
	for (size_t n = 0; n < d->pitch * d->planes; n += BLOCK) {
		vf sum[BLOCK / LANES];
		for (int c = 0; c < BLOCK / LANES; c++)
			sum[c] = load(d->row[b->radius] + n + c * LANES) * b->weight[0];
		for (uint32_t k = 1; k <= b->radius; k++) {
			const float *above = d->row[b->radius - k] + n,
				    *below = d->row[b->radius + k] + n;
			for (int c = 0; c < BLOCK / LANES; c++)
				sum[c] += (load(above + c * LANES) + load(below + c * LANES)) *
					  b->weight[k];
		}
		for (int c = 0; c < BLOCK / LANES; c++)
			store(d->sums + n + c * LANES, sum[c]);
	}
}

INLINE void put(const struct blur_desk *d, const struct filter_blur *b, uint32_t y)
{
	size_t row = (size_t)y * b->width;
	if (!b->is_bytes) {
		memcpy((float *)b->to + row * d->apart, d->sums, d->line * sizeof(float));
		return;
	}
	uint8_t *to = (uint8_t *)b->to + 4 * row;
	const float *sums = d->sums;
	for (uint32_t x = 0; x < b->width; x += LANES) {
		vi p = (vi){ 0 } - (1 << 24); /* the last byte */
		for (uint32_t k = 0; k < 3; k++)
			p |= __builtin_convertvector(load(sums + k * d->pitch + x) + 0.5f, vi)
			     << (int)(8 * k);
		memcpy(to + 4 * (size_t)x, &p, 4 * (size_t)MIN(LANES, b->width - x));
	}
}

void LANES_NAME(filter_blur_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_blur *b = data;
	struct blur_desk d;
	int32_t radius = (int32_t)b->radius, first = (int32_t)from - radius;
	set_up(&d, b);
	for (int32_t y = first; y < (int32_t)end + radius; y++) {
		for (uint32_t plane = 0; plane < d.planes; plane++)
			blur_row(&d, b, fetch(&d, b, y, plane),
				ring_row(&d, y - first) + plane * d.pitch);
		if (y < (int32_t)from + radius)
			continue;
		for (uint32_t k = 0; k < d.rows; k++)
			d.row[k] = ring_row(&d, y - first - 2 * radius + (int32_t)k);
		blur_columns(&d, b);
		put(&d, b, (uint32_t)(y - radius));
	}
	g_free(d.wide);
}

/* ---- lightness ---- */

void LANES_NAME(filter_lightness_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_lightness_job *l = data;
	size_t at = (size_t)from * l->image->width, last = (size_t)end * l->image->width;
	for (; at + LANES <= last; at += LANES) {
		vi p = *(const vi_loose *)(const void *)l->image->rgba[at];
		vi sum = (p & 255) * 77 + (p >> 8 & 255) * 150 + (p >> 16 & 255) * 29;
		store(l->to + at, __builtin_convertvector(sum, vf) * (1.f / (256 * 255)));
	}
	for (; at < last; at++)
		l->to[at] = filter_lightness(l->image->rgba[at]);
}
