#include "acquire/panorama-means.h"
#include <math.h>

/* Beams of one cell whose ranges differ by less met one surface: three times what the noise of a
 * usual scanner makes of a difference. */
#define SAME_SURFACE_M 0.05f

void panorama_add_and_keep(panorama *p, const double *azimuth_rad, const float *elevation_rad,
	const float *range_m, const uint16_t *intensity, size_t count, GArray *beams)
{
	struct panorama_beam beam;
	for (size_t i = 0; i < count; i++) {
		if (!panorama_find_beam(
			    p, azimuth_rad[i], elevation_rad[i], range_m[i], intensity[i], &beam))
			continue;
		panorama_add_beam(p, &beam);
		if (beam.range_m > 0)
			g_array_append_val(beams, beam);
	}
}

/* The beams in the order of their cells: those of cell i begin at first[i], and end at
 * first[i + 1]. Caller frees both. */
static uint32_t *order_by_cell(const GArray *beams, size_t cells, uint32_t **ret_first)
{
	uint32_t *first = g_new0(uint32_t, cells + 2), *order = g_new(uint32_t, beams->len + 1);
	for (guint k = 0; k < beams->len; k++)
		first[g_array_index(beams, struct panorama_beam, k).cell + 2]++;
	for (size_t i = 1; i < cells + 2; i++)
		first[i] += first[i - 1];
	for (guint k = 0; k < beams->len; k++)
		order[first[g_array_index(beams, struct panorama_beam, k).cell + 1]++] = k;
	*ret_first = first;
	return order;
}

/* Whole numbers, whose sums do not depend on the order. */
struct sums {
	int64_t inverse; /* of ranges: along a plane it is the inverse that changes evenly */
	int64_t across, up, intensity, count;
};
#define INVERSE_ONE 1e9
/* Nearer than this nothing is seen; sums of the inverse stay within their numbers. */
#define NEAREST_M 1e-4

static void add_beam(struct sums *s, const struct panorama_beam *b)
{
	s->inverse += llrint(INVERSE_ONE / fmax((double)b->range_m, NEAREST_M));
	s->across += b->across;
	s->up += b->up;
	s->intensity += b->intensity;
	s->count++;
}

static void set_mean(panorama *p, size_t i, const struct sums *s)
{
	double share = 1.0 / (double)s->count;
	p->range_m[i] = (float)(INVERSE_ONE * (double)s->count / (double)s->inverse);
	p->azimuth_offset[i] = (int16_t)lrint((double)s->across * share);
	p->elevation_offset[i] = (int16_t)lrint((double)s->up * share);
	p->intensity[i] = (uint16_t)lrint((double)s->intensity * share);
}

void panorama_set_means(panorama *p, const GArray *beams)
{
	size_t cells = (size_t)p->desc.columns * p->desc.rows;
	g_autofree uint32_t *first = NULL, *order = order_by_cell(beams, cells, &first);
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < cells; i++) {
		struct sums sums = { 0 };
		for (uint32_t k = first[i]; k < first[i + 1] && p->cell[i] == CELL_MEASURED; k++) {
			const struct panorama_beam *b =
				&g_array_index(beams, struct panorama_beam, order[k]);
			if (fabsf(b->range_m - p->range_m[i]) <= SAME_SURFACE_M)
				add_beam(&sums, b);
		}
		if (sums.count > 1)
			set_mean(p, i, &sums);
	}
}
