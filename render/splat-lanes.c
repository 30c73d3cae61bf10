#include "render/splat-lanes.h"
#include "render/disc-lanes.h"
#include "render/light.h"

struct splat {
	struct disc_one disc;
	float weight, light[3];
	int32_t pipeline;
};

INLINE void add(float *plane, ptrdiff_t at, vf x)
{
	store(plane + at, load(plane + at) + x);
}

INLINE void draw_splat(const struct band *b, const visibility_mask *m, const struct splat *s,
	float *const light[3], float *weight)
{
	struct disc_reach r = disc_one_reach(&s->disc, b->from, b->from + b->rows, b->width);
	for (int y = r.top; y <= r.bottom; y++)
		for (int x = r.left; x <= r.right; x += LANES) {
			vf dx = (float)x + 0.5f - s->disc.x + lane_number;
			float dy = (float)y + 0.5f - s->disc.y;
			vi key = *(const vi_loose *)(m->key + (ptrdiff_t)y * m->pitch + x);
			vf w = where(
				disc_one_shows(key, s->pipeline, disc_one_depth(&s->disc, dx, dy)),
				disc_one_weight(&s->disc, dx, dy) * s->weight);
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
			struct splat s = { disc_lanes_one(&d, k),
				fminf(4 * (1 - d.rank[k]) + 1e-3f, 1),
				{ linear[(int)(rgba[0] * lit[k])], linear[(int)(rgba[1] * lit[k])],
					linear[(int)(rgba[2] * lit[k])] },
				v->pipeline };
			draw_splat(b, m, &s, light, weight);
		}
	}
}
