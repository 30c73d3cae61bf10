#include "render/stipple-plane.h"
#include "process/lanes.h"
#include <math.h>
#include <string.h>

static int32_t bits_of(float x)
{
	int32_t bits;
	memcpy(&bits, &x, sizeof bits);
	return bits;
}

/* A pass is at least one step, and all of them fit above the depths of points. */
static int32_t step_of(const struct stipple_plane *p, float middle_m, float behind_px)
{
	float part = behind_px / (p->is_parallel ? p->scale * middle_m : p->scale);
	float bits = fminf(part, 1) * (float)(1 << 23) * (float)G_SQRT2;
	int32_t steps = (int32_t)bits >> p->shift;
	return CLAMP(steps, 1, STIPPLE_DEPTH_MOST / 16) << STIPPLE_TIE_BITS;
}

void stipple_plane_set_depths(struct stipple_plane *p, float near_m, float far_m, float behind_px)
{
	p->near_m = near_m;
	p->far_m = INFINITY;
	p->low = bits_of(near_m);
	p->shift = 0;
	while ((bits_of(fmaxf(far_m, near_m)) - p->low) >> p->shift > STIPPLE_DEPTH_MOST)
		p->shift++;
	p->step = step_of(p, (near_m + far_m) / 2, behind_px);
}

void stipple_plane_set_size(struct stipple_plane *p, int32_t columns, int32_t rows)
{
	p->columns = columns + 2 * STIPPLE_BORDER;
	p->rows = rows + 2 * STIPPLE_BORDER;
	p->pitch = (p->columns + LANES + 15) / 16 * 16;
}

void stipple_plane_view(const struct camera *c, const scene *s, const struct scene_chunk *chunk,
	struct chunk_view *ret)
{
	const double *row[3] = { c->right, c->down, c->forward };
	double reach = 0, away[3];
	*ret = (struct chunk_view){ .chunk = chunk };
	for (int k = 0; k < 3; k++)
		away[k] = s->origin_m[k] + chunk->centre_m[k] - c->eye_m[k];
	for (int k = 0; k < 3; k++) {
		double at = 0;
		for (int q = 0; q < 3; q++) {
			at += row[k][q] * (away[q] - chunk->half_m[q]);
			ret->axis[q][k] = (float)(row[k][q] * chunk->half_m[q] * 2 / 65535);
			reach += k == 2 ? fabs(row[k][q]) * chunk->half_m[q] : 0;
		}
		ret->base[k] = (float)at;
	}
	double middle = 0;
	for (int q = 0; q < 3; q++)
		middle += row[2][q] * away[q];
	ret->near_m = (float)(middle - reach);
	ret->far_m = (float)(middle + reach);
}
