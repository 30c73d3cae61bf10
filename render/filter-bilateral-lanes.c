#include "render/filter-bilateral.h"
#include "render/project-lanes.h"

/* e^-x as (1 - x/256)^256, x not below 0. */
INLINE vf fall(vf x)
{
	vf e = most(1 - x * (1.f / 256), all(0));
	for (int n = 0; n < 8; n++)
		e *= e;
	return e;
}

/* The planes of a row apart, with what is beside it. */
struct bilateral_desk {
	float *plane[3];
	size_t pitch;
};

INLINE void fetch(
	const struct bilateral_pass *p, uint32_t y, uint32_t margin, float *const plane[3])
{
	const float(*row)[3] = p->from + (size_t)y * p->width;
	for (uint32_t n = 0; n < p->width + 2 * margin; n++) {
		uint32_t x = n < margin ? 0 : MIN(n - margin, p->width - 1);
		for (int k = 0; k < 3; k++)
			plane[k][n] = row[x][k];
	}
}

INLINE void add(const struct bilateral_pass *p, const float *const at[3], size_t x, float weight,
	const vf middle[3], vf sum[4])
{
	vf here[3], away2 = all(0);
	for (int k = 0; k < 3; k++) {
		here[k] = load(at[k] + x);
		away2 += (here[k] - middle[k]) * (here[k] - middle[k]);
	}
	vf w = fall(away2 * p->per_tone) * weight;
	for (int k = 0; k < 3; k++)
		sum[k] += here[k] * w;
	sum[3] += w;
}

INLINE void put(const struct bilateral_pass *p, uint32_t y, uint32_t x, const vf sum[4])
{
	float(*to)[3] = p->to + (size_t)y * p->width + x;
	for (uint32_t n = 0; n < MIN(LANES, p->width - x); n++)
		for (int k = 0; k < 3; k++)
			to[n][k] = sum[k][n] / sum[3][n];
}

INLINE void across(const struct bilateral_pass *p, uint32_t y, float *const plane[3])
{
	const float *at[3] = { plane[0], plane[1], plane[2] };
	fetch(p, y, p->radius, plane);
	for (uint32_t x = 0; x < p->width; x += LANES) {
		vf middle[3], sum[4];
		size_t here = x + p->radius;
		for (int k = 0; k < 3; k++)
			sum[k] = middle[k] = load(at[k] + here);
		sum[3] = all(1);
		for (uint32_t n = 1; n <= p->radius; n++) {
			add(p, at, here - n, p->weight[n], middle, sum);
			add(p, at, here + n, p->weight[n], middle, sum);
		}
		put(p, y, x, sum);
	}
}

/* Rows of a ring, of which row y is at y % rows. */
INLINE void down(const struct bilateral_pass *p, uint32_t y, float *const ring[3], size_t pitch,
	uint32_t rows)
{
	for (uint32_t x = 0; x < p->width; x += LANES) {
		vf middle[3], sum[4];
		const float *at[3] = { ring[0], ring[1], ring[2] };
		for (int k = 0; k < 3; k++)
			sum[k] = middle[k] = load(ring[k] + (y % rows) * pitch + x);
		sum[3] = all(1);
		for (uint32_t n = 1; n <= p->radius; n++) {
			uint32_t above = y < n ? 0 : y - n, below = MIN(y + n, p->height - 1);
			add(p, at, (above % rows) * pitch + x, p->weight[n], middle, sum);
			add(p, at, (below % rows) * pitch + x, p->weight[n], middle, sum);
		}
		put(p, y, x, sum);
	}
}

void LANES_NAME(filter_bilateral_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct bilateral_pass *p = data;
	uint32_t rows = p->is_down ? 2 * p->radius + 1 : 1;
	size_t pitch = p->width + 2 * (size_t)p->radius + 2 * LANES;
	g_autofree float *memory = g_new0(float, 3 * pitch * rows);
	float *plane[3] = { memory, memory + pitch * rows, memory + 2 * pitch * rows };
	uint32_t next = from < p->radius ? 0 : from - p->radius; /* to be fetched */
	for (uint32_t y = from; y < end; y++) {
		if (!p->is_down) {
			across(p, y, plane);
			continue;
		}
		for (; next <= MIN(y + p->radius, p->height - 1); next++) {
			float *row[3];
			for (int k = 0; k < 3; k++)
				row[k] = plane[k] + (next % rows) * pitch;
			fetch(p, next, 0, row);
		}
		down(p, y, plane, pitch, rows);
	}
}
