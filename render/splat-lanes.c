#include "render/splat-lanes.h"
#include "render/disc-lanes.h"
#include "render/light.h"

struct splat {
	float x, y, radius, half[2], squash[2], tilt[2], depth_m, weight;
	float light[3];
	int32_t pipeline;
};

INLINE void add(float *plane, ptrdiff_t at, vf x)
{
	store(plane + at, load(plane + at) + x);
}

INLINE void draw_splat(const struct band *b, const visibility_mask *m, const struct splat *s,
	float *const light[3], float *weight)
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
			vf w = most(1 - (dx * dx + dy * dy + across * across) * steep, all(0)) *
			       s->weight;
			vf depth_m = s->depth_m + s->tilt[0] * dx + s->tilt[1] * dy;
			w = where(((key & ((1 << MASK_PIPELINE_BITS) - 1)) == s->pipeline) &
					  ((vf)key >= depth_m),
				w);
			ptrdiff_t at =
				(ptrdiff_t)((uint32_t)y - b->from) * b->pitch + BAND_MARGIN + x;
			for (int k = 0; k < 3; k++)
				add(light[k], at, w * s->light[k]);
			add(weight, at, w);
		}
}

/* Of points from here on: what is left of their colours in the style's light. */
INLINE vf lit_of(const frame *f, const struct disc_pass *p, const int16_t (*packed)[2])
{
	const struct frame_light *light = &f->light;
	vf site[3], along = all(0);
	unpack_lanes(*(const vi_loose *)packed, site);
	vf length2 = site[0] * site[0] + site[1] * site[1] + site[2] * site[2];
	for (int k = 0; k < 3; k++)
		along += (p->turn[k][0] * site[0] + p->turn[k][1] * site[1] +
				 p->turn[k][2] * site[2]) *
			 light->from[k];
	vf diffuse = 0.5f + 0.5f * where(length2 > 0, along / root(length2));
	return 1 - light->amount * (1 - diffuse);
}

void LANES_NAME(splat_chunk)(const struct band *b, const frame *f, const visibility_mask *m,
	const struct chunk_view *v, const struct points_step *step, float *const light[3],
	float *weight)
{
	struct disc_pass p = disc_pass_of(
		f, v, step->size, fmaxf(step->least_px * f->px / 2, DISC_RADIUS_LEAST));
	const float *linear = light_of_bytes();
	for (uint32_t i = 0; i < p.end; i += LANES) {
		struct disc_lanes d;
		disc_lanes_find(f->scene, &p, v, i, 0, &d);
		if (!any(d.drawn))
			continue;
		vf lit = all(1);
		if (f->light.amount > 0)
			lit = lit_of(f, &p, f->scene->normal + v->chunk->first + i);
		vi here = (d.y + d.half[1] >= (float)b->from) &
			  (d.y - d.half[1] <= (float)(b->from + b->rows));
		for (unsigned left = bits(d.drawn & here); left; left &= left - 1) {
			int k = __builtin_ctz(left);
			const uint8_t *rgba = f->scene->rgba[v->chunk->first + i + (uint32_t)k];
			/* Those of the last ranks come and go softly. */
			float squash = sqrtf(d.bend[k]), slope = d.slope[k],
			      aside[2] = { d.aside[0][k], d.aside[1][k] };
			struct splat s = { d.x[k], d.y[k], d.radius[k],
				{ d.half[0][k], d.half[1][k] },
				{ squash * aside[0], squash * aside[1] },
				{ slope * aside[0], slope * aside[1] }, d.depth_m[k],
				fminf(4 * (1 - d.rank[k]) + 1e-3f, 1),
				{ linear[(int)(rgba[0] * lit[k])], linear[(int)(rgba[1] * lit[k])],
					linear[(int)(rgba[2] * lit[k])] },
				v->pipeline };
			draw_splat(b, m, &s, light, weight);
		}
	}
}
