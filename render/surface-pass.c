#include "render/surface-pass.h"
#include "render/filter.h"
#include "render/large.h"
#include "render/plane-lanes.h"
#include <math.h>

#define PLANES 5

static void clear(const struct band *b, float *memory)
{
	size_t plane = (size_t)b->pitch * BAND_ROWS;
	memset(memory, 0, PLANES * plane * sizeof *memory);
	for (size_t n = 0; n < plane; n++)
		memory[3 * plane + n] = FILTER_FAR;
}

static void put(const struct band *b, const visibility_mask *m, const struct surface_desk *d,
	const struct surface_planes *to)
{
	for (uint32_t y = b->from; y < b->from + b->rows; y++)
		for (uint32_t x = 0; x < b->width; x++) {
			size_t from = (size_t)(y - b->from) * b->pitch + BAND_MARGIN + x,
			       at = (size_t)y * b->width + x;
			if (d->nearest_m[from] < FILTER_FAR &&
				mask_key(m, (int32_t)x, (int32_t)y) < MASK_EMPTY)
				to->depth_m[at] = d->nearest_m[from];
			if (!to->normal)
				continue;
			float n[3] = { d->normal[0][from], d->normal[1][from], d->normal[2][from] };
			float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
			for (int k = 0; k < 3; k++)
				to->normal[at][k] = length > 1e-6f ? n[k] / length : 0;
			to->leaf[at] = (uint16_t)d->leaf[from];
		}
}

static void do_band(const frame *f, const visibility_mask *m, const struct chunk_view *views,
	uint32_t count, const struct band *b, float *memory, const struct surface_planes *to)
{
	size_t plane = (size_t)b->pitch * BAND_ROWS;
	struct surface_desk d = { { memory, memory + plane, memory + 2 * plane },
		memory + 3 * plane, memory + 4 * plane };
	clear(b, memory);
	for (uint32_t n = 0; m->planes && n < m->planes->count; n++)
		LANES_OF(f->lanes, plane_surface)(b, m, m->planes, n, &d);
	for (uint32_t n = 0; n < count; n++) {
		if (mask_may_show(m, &views[n], b->from, b->from + b->rows))
			LANES_OF(f->lanes, surface_chunk)(b, f, m, &views[n], &d);
	}
	put(b, m, &d, to);
}

void surface_pass(const frame *f, const visibility_mask *m, const struct chunk_view *views,
	uint32_t count, const struct surface_planes *to)
{
	uint32_t pitch = (m->width + 2 * BAND_MARGIN + 7) / 8 * 8;
#pragma omp parallel num_threads((int)frame_threads(f))
	{
		float *memory = large_new(PLANES * (size_t)pitch * BAND_ROWS * sizeof *memory + 64);
#pragma omp for schedule(dynamic, 1)
		for (uint32_t from = 0; from < m->height; from += BAND_ROWS) {
			struct band b = { m->width, from, MIN(BAND_ROWS, m->height - from), pitch };
			if (!frame_is_stopped(f))
				do_band(f, m, views, count, &b, memory, to);
		}
		large_free(memory);
	}
}
