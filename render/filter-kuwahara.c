#include "render/filter-kuwahara.h"
#include "render/filter-tables.h"
#include <math.h>

int kuwahara_radius(const struct kuwahara_step *s, float px)
{
	return (int)CLAMP(rintf(s->radius_px * px), 1, KUWAHARA_RADIUS_MOST);
}

void filter_kuwahara(struct filter_job *j, const struct step *s)
{
	const struct kuwahara_step *k = &s->kuwahara;
	struct kuwahara_pass p = { &j->image, (uint32_t)kuwahara_radius(k, j->px), k->softness };
	int passes = (int)k->passes;
	for (int n = 0; n < passes && !frame_is_stopped(j->f); n++) {
		filter_each_rows(j, LANES_OF(j->lanes, filter_kuwahara_rows), &p, j->image.height,
			MAX(48, 2 * p.radius));
		/* Away from the focus all passes act, nearer to it fewer of them. */
		filter_finish_part(j, k->where, (float)passes, (float)n);
	}
}
