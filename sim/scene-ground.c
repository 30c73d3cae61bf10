#include "sim/scene-ground.h"

void draw_ground(const struct site *s, const struct pen *p, vec low, vec high, float cell_m,
	float above, uint16_t (*choose)(float x, float y, const void *data), const void *data)
{
	unsigned nx = (unsigned)ceilf((high[0] - low[0]) / cell_m),
		 ny = (unsigned)ceilf((high[1] - low[1]) / cell_m);
	for (unsigned j = 0; j < ny; j++)
		for (unsigned i = 0; i < nx; i++) {
			vec c[4];
			for (unsigned k = 0; k < 4; k++) {
				float x = MIN(low[0] + cell_m * (i + (k == 1 || k == 2)), high[0]);
				float y = MIN(low[1] + cell_m * (j + (k >= 2)), high[1]);
				c[k] = (vec){ x, y, site_ground(s, x, y) + above };
			}
			vec m = (c[0] + c[2]) * 0.5f;
			struct pen q = pen_with(p, choose ? choose(m[0], m[1], data) : p->material);
			pen_quad(&q, c[0], c[1], c[2], c[3]);
		}
}

void draw_kerb(const struct site *s, const struct pen *p, vec a, vec b, float width, float height)
{
	unsigned n = (unsigned)MAX(1, lroundf(length(b - a)));
	vec side = unit(cross(b - a, (vec){ 0, 0, 1 })) * (0.5f * width);
	for (unsigned i = 0; i < n; i++) {
		vec l = mix(a, b, (float)i / n), r = mix(a, b, (i + 1.0f) / n);
		l[2] = site_ground(s, l[0], l[1]) + height;
		r[2] = site_ground(s, r[0], r[1]) + height;
		vec down = { 0, 0, height + 0.15f };
		pen_quad(p, l - side, r - side, r + side, l + side);
		pen_quad(p, l - side, r - side, r - side - down, l - side - down);
		pen_quad(p, l + side, r + side, r + side - down, l + side - down);
		if (i == 0)
			pen_quad(p, l - side, l + side, l + side - down, l - side - down);
		if (i + 1 == n)
			pen_quad(p, r - side, r + side, r + side - down, r - side - down);
	}
}

void draw_bed(struct site *s, const struct palette *m, float x0, float y0, float x1, float y1,
	uint32_t tuft)
{
	struct pen p = site_pen(s, 0, 0, 0, 0);
	p.object = site_object(s, WORLD_TERRAIN);
	p.material = m->grass;
	draw_ground(s, &p, (vec){ x0, y0 }, (vec){ x1, y1 }, 0.5f, 0.08f, NULL, NULL);
	struct pen kerb = pen_with(&p, m->kerb);
	float e = 0.09f;
	draw_kerb(s, &kerb, (vec){ x0 - 2 * e, y0 - e }, (vec){ x1 + 2 * e, y0 - e }, 0.18f, 0.14f);
	draw_kerb(s, &kerb, (vec){ x0 - 2 * e, y1 + e }, (vec){ x1 + 2 * e, y1 + e }, 0.18f, 0.14f);
	draw_kerb(s, &kerb, (vec){ x0 - e, y0 }, (vec){ x0 - e, y1 }, 0.18f, 0.14f);
	draw_kerb(s, &kerb, (vec){ x1 + e, y0 }, (vec){ x1 + e, y1 }, 0.18f, 0.14f);
	uint16_t object = site_object(s, WORLD_VEGETATION);
	unsigned n = (unsigned)((x1 - x0) * (y1 - y0) * 1.6f);
	for (unsigned i = 0; i < n; i++) {
		float x = roll_in(&s->dice, x0 + 0.2f, x1 - 0.2f),
		      y = roll_in(&s->dice, y0 + 0.2f, y1 - 0.2f);
		struct pen at =
			site_pen(s, x, y, site_ground(s, x, y) + 0.07f, roll_in(&s->dice, 0, 6));
		at.object = object;
		struct pen sized = pen_scaled(&at, roll_in(&s->dice, 0.4f, 1.0f));
		site_place(s, tuft, &sized);
	}
}
