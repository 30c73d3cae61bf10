#include "render/disc-lanes.h"
#include "render/surface-pass.h"

struct surface_disc {
	float x, y, radius, half[2], squash[2], tilt[2], depth_m;
	float normal[3], leaf;
	int32_t pipeline;
};

INLINE void draw_disc(const struct band *b, const visibility_mask *m, const struct surface_disc *s,
	const struct surface_desk *d)
{
	int from = MAX((int)floorf(s->y - s->half[1]), (int)b->from),
	    to = MIN((int)floorf(s->y + s->half[1]), (int)(b->from + b->rows) - 1);
	int left = MAX((int)floorf(s->x - s->half[0]), 0),
	    right = MIN((int)floorf(s->x + s->half[0]), (int)b->width - 1);
	float steep = 1 / (s->radius * s->radius);
	for (int y = from; y <= to; y++)
		for (int x = left; x <= right; x += LANES) {
			vf dx = (float)x + 0.5f - s->x + lane_number;
			float dy = (float)y + 0.5f - s->y;
			vi key = *(const vi_loose *)(m->key + (ptrdiff_t)y * m->pitch + x);
			vf across = s->squash[0] * dx + s->squash[1] * dy;
			vf w = most(1 - (dx * dx + dy * dy + across * across) * steep, all(0));
			vf depth_m = s->depth_m + s->tilt[0] * dx + s->tilt[1] * dy;
			vi is_there = (w > 0) &
				      ((key & ((1 << MASK_PIPELINE_BITS) - 1)) == s->pipeline) &
				      ((vf)key >= depth_m);
			if (!any(is_there))
				continue;
			w = where(is_there, w);
			ptrdiff_t at =
				(ptrdiff_t)((uint32_t)y - b->from) * b->pitch + BAND_MARGIN + x;
			for (int k = 0; k < 3; k++)
				store(d->normal[k] + at,
					load(d->normal[k] + at) + w * s->normal[k]);
			vi nearer = is_there & (depth_m < load(d->nearest_m + at));
			store(d->nearest_m + at, choose(nearer, depth_m, load(d->nearest_m + at)));
			store(d->leaf + at, choose(nearer, all(s->leaf), load(d->leaf + at)));
		}
}

void LANES_NAME(surface_chunk)(const struct band *b, const frame *f, const visibility_mask *m,
	const struct chunk_view *v, const struct surface_desk *desk)
{
	struct disc_pass p =
		disc_pass_of(f, v, frame_pipeline(f, v->pipeline)->mask.disc, DISC_RADIUS_LEAST);
	for (uint32_t i = 0; i < p.end; i += LANES) {
		struct disc_lanes d;
		disc_lanes_find(f->scene, &p, v, i, 0, &d);
		if (!any(d.drawn))
			continue;
		vf site[3], normal[3];
		unpack_lanes(*(const vi_loose *)(f->scene->normal + v->chunk->first + i), site);
		vf length = root(site[0] * site[0] + site[1] * site[1] + site[2] * site[2]);
		vf by_length = where(length > 0, 1 / length);
		for (int k = 0; k < 3; k++)
			normal[k] = (p.turn[k][0] * site[0] + p.turn[k][1] * site[1] +
					    p.turn[k][2] * site[2]) *
				    by_length;
		vi here = (d.y + d.half[1] >= (float)b->from) &
			  (d.y - d.half[1] <= (float)(b->from + b->rows));
		for (unsigned left = bits(d.drawn & here); left; left &= left - 1) {
			int k = __builtin_ctz(left);
			float squash = sqrtf(d.bend[k]), slope = d.slope[k],
			      aside[2] = { d.aside[0][k], d.aside[1][k] };
			struct surface_disc s = { d.x[k], d.y[k], d.radius[k],
				{ d.half[0][k], d.half[1][k] },
				{ squash * aside[0], squash * aside[1] },
				{ slope * aside[0], slope * aside[1] }, d.depth_m[k],
				{ normal[0][k], normal[1][k], normal[2][k] }, (float)v->chunk->leaf,
				v->pipeline };
			draw_disc(b, m, &s, desk);
		}
	}
}
