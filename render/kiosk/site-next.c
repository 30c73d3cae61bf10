#include "render/kiosk/site-next.h"
#include <math.h>
#include <string.h>

/* Around the stations; further away no next one is looked for, and what it sees is not counted. */
#define AROUND_M 30.0
#define BELOW_M  4.0
#define ABOVE_M  12.0

static void bounds(const drawn_site *d, double low[3], double high[3])
{
	for (int k = 0; k < 3; k++) {
		low[k] = INFINITY;
		high[k] = -INFINITY;
	}
	for (guint i = 0; i < d->stations->len; i++) {
		const double *at =
			g_array_index(d->stations, struct view_station, i).pose.translation_m;
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], at[k] - (k < 2 ? AROUND_M : BELOW_M));
			high[k] = fmax(high[k], at[k] + (k < 2 ? AROUND_M : ABOVE_M));
		}
	}
}

bool site_next_find(const drawn_site *d, struct next_station *ret, bool *ret_searched)
{
	const scene *points = d->scene;
	double low[3], high[3];
	*ret_searched = d->stations->len > 0;
	if (!*ret_searched)
		return false;
	bounds(d, low, high);
	g_autoptr(station_plan) plan = station_plan_new(low, high);
	for (uint32_t c = 0; c < points->chunks; c++)
		for (uint32_t i = 0; i < points->chunk[c].count; i++) {
			double p[3];
			scene_position(points, &points->chunk[c], i, p);
			station_plan_add(plan, p);
		}
	g_autofree double *at_m = g_new(double, 3 * (gsize)d->stations->len);
	for (guint i = 0; i < d->stations->len; i++)
		memcpy(at_m + 3 * i,
			g_array_index(d->stations, struct view_station, i).pose.translation_m,
			3 * sizeof *at_m);
	return next_station_find(plan, at_m, d->stations->len, ret);
}
