/* Rows first, into the last few that columns are made of. */
#include "render/filter-planes.h"
#include "render/project-lanes.h"

struct blur_desk {
	uint32_t line; /* floats of a row, without what is beside it */
	uint32_t rows; /* in the ring */
	size_t pitch;  /* of these */
	float *wide;   /* a row with what is beside it */
	float *ring;
	const float *row[2 * FILTER_BLUR_RADIUS_MOST + 1]; /* of the ring, from above to below */
};

/* So many vectors are summed up at a time, which hides how long each sum takes. */
#define BLOCK (4 * LANES)

INLINE void set_up(struct blur_desk *d, const struct filter_blur *b)
{
	d->line = b->width * b->channels;
	d->rows = 2 * b->radius + 1;
	d->pitch = (d->line + BLOCK + 7) / 8 * 8;
	size_t wide = d->line + 2 * (size_t)b->radius * b->channels + 2 * BLOCK;
	d->wide = g_new(float, wide + d->pitch * d->rows);
	memset(d->wide + wide - 2 * BLOCK, 0, 2 * BLOCK * sizeof *d->wide);
	d->ring = d->wide + wide;
}

INLINE void fetch(struct blur_desk *d, const struct filter_blur *b, int32_t y)
{
	size_t row = (size_t)CLAMP(y, 0, (int32_t)b->height - 1) * d->line,
	       margin = (size_t)b->radius * b->channels;
	float *middle = d->wide + margin;
	if (b->is_bytes) {
		const uint8_t *from = (const uint8_t *)b->from + row;
		for (uint32_t n = 0; n < d->line; n++)
			middle[n] = from[n];
	} else {
		memcpy(middle, (const float *)b->from + row, d->line * sizeof *middle);
	}
	for (uint32_t n = 0; n < margin; n++) {
		d->wide[n] = middle[n % b->channels];
		middle[d->line + n] = middle[d->line - b->channels + n % b->channels];
	}
}

INLINE void blur_row(struct blur_desk *d, const struct filter_blur *b, int32_t y, float *to)
{
	fetch(d, b, y);
	const float *middle = d->wide + (size_t)b->radius * b->channels;
	for (uint32_t n = 0; n < d->line; n += BLOCK) {
		vf sum[BLOCK / LANES];
		for (int c = 0; c < BLOCK / LANES; c++)
			sum[c] = load(middle + n + c * LANES) * b->weight[0];
		for (uint32_t k = 1; k <= b->radius; k++) {
			size_t away = (size_t)k * b->channels;
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
	return d->ring + (size_t)((uint32_t)number % d->rows) * d->pitch;
}

typedef uint8_t vb8 __attribute__((vector_size(8)));

INLINE void put(const struct filter_blur *b, size_t at, uint32_t count, vf sum)
{
	if (!b->is_bytes) {
		memcpy((float *)b->to + at, &sum, count * sizeof(float));
		return;
	}
	vb8 bytes = __builtin_convertvector(__builtin_convertvector(sum + 0.5f, vi), vb8);
	memcpy((uint8_t *)b->to + at, &bytes, count);
}

/* Of the rows in d->row. */
INLINE void blur_columns(const struct blur_desk *d, const struct filter_blur *b, uint32_t y)
{
	size_t row = (size_t)y * d->line;
	uint32_t radius = b->radius;
	for (uint32_t n = 0; n < d->line; n += BLOCK) {
		vf sum[BLOCK / LANES];
		for (int c = 0; c < BLOCK / LANES; c++)
			sum[c] = load(d->row[radius] + n + c * LANES) * b->weight[0];
		for (uint32_t k = 1; k <= radius; k++) {
			const float *above = d->row[radius - k] + n,
				    *below = d->row[radius + k] + n;
			for (int c = 0; c < BLOCK / LANES; c++)
				sum[c] += (load(above + c * LANES) + load(below + c * LANES)) *
					  b->weight[k];
		}
		for (uint32_t c = 0; c < BLOCK / LANES && n + c * LANES < d->line; c++)
			put(b, row + n + c * LANES, MIN(LANES, d->line - n - c * LANES), sum[c]);
	}
}

void LANES_NAME(filter_blur_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_blur *b = data;
	struct blur_desk d;
	int32_t radius = (int32_t)b->radius, first = (int32_t)from - radius;
	set_up(&d, b);
	for (int32_t y = first; y < (int32_t)end + radius; y++) {
		blur_row(&d, b, y, ring_row(&d, y - first));
		if (y < (int32_t)from + radius)
			continue;
		for (uint32_t k = 0; k < d.rows; k++)
			d.row[k] = ring_row(&d, y - first - 2 * radius + (int32_t)k);
		blur_columns(&d, b, (uint32_t)(y - radius));
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
