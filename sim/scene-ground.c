#include "sim/scene-ground.h"

struct sheet {
	const struct site *site;
	const struct pen *pen;
	uint16_t (*choose)(float x, float y, const void *data);
	const void *data;
};

static uint16_t chosen(const struct sheet *s, vec at)
{
	return s->choose ? s->choose(at[0], at[1], s->data) : s->pen->material;
}

/* Smooth over the cells, as the relief is. */
static void draw_piece(const struct sheet *s, uint16_t material, vec a, vec b, vec c)
{
	const float e = 0.3f;
	const vec corners[3] = { a, b, c };
	vec normals[3];
	for (unsigned i = 0; i < 3; i++) {
		float x = corners[i][0], y = corners[i][1];
		normals[i] = unit((vec){
			site_ground(s->site, x - e, y) - site_ground(s->site, x + e, y),
			site_ground(s->site, x, y - e) - site_ground(s->site, x, y + e), 2 * e });
	}
	struct pen p = pen_with(s->pen, material);
	pen_shaded(&p, corners, normals);
}

/* Where the material changes between two places that differ. */
static vec find_edge(const struct sheet *s, vec a, vec b)
{
	uint16_t here = chosen(s, a);
	for (unsigned i = 0; i < 8; i++) {
		vec m = (a + b) * 0.5f;
		if (chosen(s, m) == here)
			a = m;
		else
			b = m;
	}
	return (a + b) * 0.5f;
}

/* Cuts a small triangle along the edge of its materials: a differs from b and c. */
static void cut_corner(const struct sheet *s, vec a, vec b, vec c)
{
	vec ab = find_edge(s, a, b), ac = find_edge(s, a, c);
	draw_piece(s, chosen(s, a), a, ab, ac);
	draw_piece(s, chosen(s, b), ab, b, c);
	draw_piece(s, chosen(s, b), ab, c, ac);
}

static void lay_small(const struct sheet *s, vec a, vec b, vec c)
{
	uint16_t ma = chosen(s, a), mb = chosen(s, b), mc = chosen(s, c);
	if (mb == mc)
		cut_corner(s, a, b, c);
	else if (ma == mc)
		cut_corner(s, b, c, a);
	else
		cut_corner(s, c, a, b);
}

static bool is_even(const struct sheet *s, const vec *places, unsigned n)
{
	uint16_t first = chosen(s, places[0]);
	for (unsigned i = 1; i < n; i++)
		if (chosen(s, places[i]) != first)
			return false;
	return true;
}

/* Triangles that hold more than one material are quartered, in their own plane so that no gap
 * opens, and the small ones cut. */
static void lay_triangle(const struct sheet *s, vec a, vec b, vec c, unsigned depth)
{
	const vec p[6] = { a, b, c, (a + b) * 0.5f, (b + c) * 0.5f, (c + a) * 0.5f };
	if (is_even(s, p, depth ? 6 : 3)) {
		draw_piece(s, chosen(s, a), a, b, c);
	} else if (depth) {
		lay_triangle(s, a, p[3], p[5], depth - 1);
		lay_triangle(s, p[3], b, p[4], depth - 1);
		lay_triangle(s, p[5], p[4], c, depth - 1);
		lay_triangle(s, p[3], p[4], p[5], depth - 1);
	} else {
		lay_small(s, a, b, c);
	}
}

/* Where a sheet ends something hangs from it, or one could look below the next one, whose cells are
 * others. */
static void hang_hem(const struct sheet *s, const vec corner[4], const bool ends[4])
{
	for (unsigned i = 0; i < 4; i++) {
		vec a = corner[i], b = corner[(i + 1) % 4], down = { 0, 0, 0.5f };
		struct pen p = pen_with(s->pen, chosen(s, a));
		if (ends[i])
			pen_quad(&p, a, b, b - down, a - down);
	}
}

void draw_ground(const struct site *s, const struct pen *p, vec low, vec high, float cell_m,
	float above, uint16_t (*choose)(float x, float y, const void *data), const void *data)
{
	struct sheet sheet = { s, p, choose, data };
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
			lay_triangle(&sheet, c[0], c[1], c[2], 2);
			lay_triangle(&sheet, c[0], c[2], c[3], 2);
			bool ends[4] = { j == 0, i + 1 == nx, j + 1 == ny, i == 0 };
			hang_hem(&sheet, c, ends);
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
