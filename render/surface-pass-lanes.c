#include "render/disc-lanes.h"
#include "render/surface-pass.h"

struct surface_disc {
	struct disc_one disc;
	float normal[3], leaf;
	int32_t pipeline;
};

INLINE void draw_disc(const struct band *b, const visibility_mask *m, const struct surface_disc *s,
	const struct surface_desk *d)
{
	struct disc_reach r = disc_one_reach(&s->disc, b->from, b->from + b->rows, b->width);
	for (int y = r.top; y <= r.bottom; y++)
		for (int x = r.left; x <= r.right; x += LANES) {
			vf dx = (float)x + 0.5f - s->disc.x + lane_number;
			float dy = (float)y + 0.5f - s->disc.y;
			vi key = *(const vi_loose *)(m->key + (ptrdiff_t)y * m->pitch + x);
			vf w = disc_one_weight(&s->disc, dx, dy),
			   depth_m = disc_one_depth(&s->disc, dx, dy);
			vi is_there = (w > 0) & disc_one_shows(key, s->pipeline, depth_m);
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
			struct surface_disc s = { disc_lanes_one(&d, k),
				{ normal[0][k], normal[1][k], normal[2][k] }, (float)v->chunk->leaf,
				v->pipeline };
			draw_disc(b, m, &s, desk);
		}
	}
}
