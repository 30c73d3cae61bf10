/* A stone bridge of three arches over a river, with trees on both banks and some houses beyond. The
 * river runs from west to east, the bridge from south to north. */
#include "sim/scene-facade.h"
#include "sim/scene-ground.h"
#include "sim/scene-props.h"
#include "sim/scene-tree.h"
#include "sim/scene-wing.h"

#define WATER_M  (-2.3f) /* level */
#define DECK_M   2.75f   /* half widths of the bridge, outside and between the parapets */
#define INSIDE_M 2.4f
#define HALF_M   14.0f /* half its length */

/* How far a place is from the middle of the river. */
static float from_river(const struct site *s, float x, float y)
{
	float off = MAX(0, fabsf(x) - 9);
	return fabsf(y - s->relief[1] * off * off * (x > 0 ? 1 : -1) / 90 * expf(-off / 60));
}

static float bank_relief(const struct site *s, float x, float y)
{
	float d = from_river(s, x, y) / s->relief[0];
	float wall = smooth_unit(clamp_unit((d - 0.78f) / 0.5f));
	float z = -3.7f + 3.6f * wall +
		  0.14f * wall * noise_2d(x * 0.12f, y * 0.12f, (uint32_t)s->seed);
	float far = clamp_unit((hypotf(x, y) - 28) / 110);
	return z + wall * far * far * (15 + 7 * noise_2d(x * 0.017f, y * 0.017f, 9));
}

static float deck_height(const struct site *s, float y)
{
	float end = bank_relief(s, 0, y > 0 ? HALF_M : -HALF_M), t = y / HALF_M;
	return end + 0.06f + s->relief[2] * (1 - t * t) * (1 - 0.25f * t * t);
}

static float bridge_relief(const struct site *s, float x, float y)
{
	return fabsf(x) < DECK_M && fabsf(y) < HALF_M ? deck_height(s, y) : bank_relief(s, x, y);
}

struct scenery {
	struct site *s;
	struct palette m;
};

static uint16_t bank_cover(float x, float y, const void *data)
{
	const struct scenery *b = data;
	float d = from_river(b->s, x, y) / b->s->relief[0], path = fabsf(fabsf(y) - HALF_M - 1.8f);
	if (path < 1.3f + 0.25f * noise_2d(x * 0.6f, y * 0.6f, 4) && fabsf(x) < 48)
		return b->m.gravel;
	if (fabsf(x) < 2 + 0.2f * noise_2d(x, y * 0.7f, 5) && fabsf(y) > HALF_M)
		return b->m.setts;
	return d < 0.97f + 0.06f * noise_2d(x * 0.5f, y * 0.5f, 6) ? b->m.soil : b->m.grass;
}

static void lay_banks(struct scenery *b)
{
	struct site *s = b->s;
	s->relief[0] = roll_in(&s->dice, 9.6f, 10.6f);
	s->relief[1] = roll_in(&s->dice, -1, 1);
	s->relief[2] = roll_in(&s->dice, 1.1f, 1.6f);
	s->ground = bank_relief;
	struct pen p = site_pen(s, 0, 0, 0, 0), water = pen_with(&p, b->m.water);
	p.object = site_object(s, WORLD_TERRAIN);
	draw_ground(s, &p, (vec){ -56, -36 }, (vec){ 56, 36 }, 0.7f, 0, bank_cover, b);
	struct pen far = pen_with(&p, b->m.grass);
	for (int k = -1; k <= 1; k += 2) {
		draw_ground(s, &far, (vec){ -160, k < 0 ? -160 : 36 },
			(vec){ 160, k < 0 ? -36 : 160 }, 4, 0, NULL, NULL);
		draw_ground(s, &far, (vec){ k < 0 ? -160 : 56, -36 },
			(vec){ k < 0 ? -56 : 160, 36 }, 2, 0, NULL, NULL);
	}
	water.object = site_object(s, WORLD_WATER);
	pen_quad(&water, (vec){ -160, -60, WATER_M }, (vec){ 160, -60, WATER_M },
		(vec){ 160, 60, WATER_M }, (vec){ -160, 60, WATER_M });
}

/* One arch in the bridge's section: y along it. */
struct arch {
	float y, radius, centre_z, half; /* circle, and half the span at the springing */
};

static float arch_height(const struct arch *a, float y)
{
	float off = y - a->y, r = a->radius;
	return fabsf(off) < a->half ? a->centre_z + sqrtf(MAX(0, r * r - off * off)) : -9;
}

/* Wedge stones round an arch, in both faces. */
static void draw_ring_stones(const struct pen *p, const struct arch *a)
{
	float from = acosf(a->half / a->radius), span = (float)G_PI - 2 * from;
	unsigned n = (unsigned)(span * a->radius / 0.42f) | 1;
	for (unsigned i = 0; i < n; i++) {
		float u = from + span * i / n + 0.004f, v = from + span * (i + 1) / n - 0.004f;
		bool key = i == n / 2;
		for (unsigned side = 0; side < 2; side++) {
			struct pen q = pen_turned(p, side ? DECK_M : -DECK_M, 0, 0,
				side ? -(float)G_PI / 2 : (float)G_PI / 2);
			draw_arc(&q, side ? a->y : -a->y, a->centre_z, a->radius - 0.02f,
				a->radius + (key ? 0.72f : 0.52f),
				key     ? -0.12f
				: i % 2 ? -0.05f
					: -0.065f,
				0.3f, u, v, 2);
		}
	}
}

static void draw_spandrels(
	const struct site *s, const struct pen *p, const struct arch *arches, unsigned n)
{
	enum { N = 160 };
	for (unsigned i = 0; i < N; i++) {
		float y[2], top[2], low[2];
		for (unsigned k = 0; k < 2; k++) {
			y[k] = -HALF_M - 1 + (2 * HALF_M + 2) * (i + k) / N;
			top[k] = deck_height(s, CLAMP(y[k], -HALF_M, HALF_M));
			low[k] = -5;
			for (unsigned a = 0; a < n; a++) {
				float mid = -HALF_M - 1 + (2 * HALF_M + 2) * (i + 0.5f) / N;
				if (fabsf(mid - arches[a].y) < arches[a].half)
					low[k] = MAX(arch_height(&arches[a],
							     CLAMP(y[k],
								     arches[a].y - arches[a].half +
									     0.001f,
								     arches[a].y + arches[a].half -
									     0.001f)),
						low[k]);
			}
		}
		for (int k = -1; k <= 1; k += 2) {
			float x = k * DECK_M;
			pen_quad(p, (vec){ x, y[0], low[0] }, (vec){ x, y[1], low[1] },
				(vec){ x, y[1], top[1] }, (vec){ x, y[0], top[0] });
		}
		if (low[0] > -4)
			pen_quad(p, (vec){ -DECK_M, y[0], low[0] }, (vec){ DECK_M, y[0], low[0] },
				(vec){ DECK_M, y[1], low[1] }, (vec){ -DECK_M, y[1], low[1] });
	}
}

/* Between the arches, with pointed cutwaters and caps. */
static void draw_pier(const struct pen *p, float y0, float y1, float top)
{
	float m = 0.5f * (y0 + y1);
	for (unsigned k = 0; k < 2; k++) {
		float y = k ? y1 : y0;
		pen_quad(p, (vec){ -DECK_M, y, -5 }, (vec){ DECK_M, y, -5 },
			(vec){ DECK_M, y, top }, (vec){ -DECK_M, y, top });
	}
	for (int k = -1; k <= 1; k += 2) {
		vec a = { k * DECK_M, y0, -5 }, b = { k * DECK_M, y1, -5 },
		    c = { k * (DECK_M + 1.5f), m, -5 };
		vec up = { 0, 0, top + 5 }, tip = { k * DECK_M, m, top + 1.2f },
		    out = { k * 0.1f, 0, 0 };
		pen_quad(p, a, c, c + up, a + up);
		pen_quad(p, b, c, c + up, b + up);
		pen_triangle(p, a + up - out, c + up + out, tip);
		pen_triangle(p, b + up - out, c + up + out, tip);
	}
}

static void draw_parapet(const struct site *s, const struct pen *wall, const struct pen *coping)
{
	enum { N = 28 };
	for (unsigned i = 0; i < N; i++) {
		float y0 = -HALF_M + 2 * HALF_M * i / N, y1 = -HALF_M + 2 * HALF_M * (i + 1) / N,
		      gap = 0.008f;
		float z0 = deck_height(s, y0), z1 = deck_height(s, y1);
		for (int k = -1; k <= 1; k += 2) {
			float in = k * INSIDE_M, out = k * DECK_M, lip = k * 0.07f;
			pen_quad(wall, (vec){ in, y0, z0 - 0.1f }, (vec){ in, y1, z1 - 0.1f },
				(vec){ in, y1, z1 + 0.9f }, (vec){ in, y0, z0 + 0.9f });
			pen_quad(wall, (vec){ out, y0, z0 }, (vec){ out, y1, z1 },
				(vec){ out, y1, z1 + 0.9f }, (vec){ out, y0, z0 + 0.9f });
			struct pen q = pen_turned(coping, 0, 0, 0, 0);
			vec section[] = { { in - lip, 0, 0.9f }, { out + lip, 0, 0.9f },
				{ out + lip, 0, 1.03f }, { 0.5f * (in + out), 0, 1.1f },
				{ in - lip, 0, 1.03f } };
			q.at.o[2] += z0;
			q.at.y[2] = (z1 - z0) / (y1 - y0);
			q.at.o[2] -= q.at.y[2] * y0;
			pen_prism(&q, section, 5, y0 + gap, y1 - gap);
			vec band[] = { { out, 0, -0.22f }, { out + 2 * lip, 0, -0.16f },
				{ out + 2 * lip, 0, 0 }, { out, 0, 0.04f } };
			pen_prism(&q, band, 4, y0, y1);
		}
	}
}

static void draw_bridge(struct scenery *b)
{
	struct site *s = b->s;
	struct pen p = site_pen(s, 0, 0, 0, 0);
	p.object = site_object(s, WORLD_STRUCTURE);
	struct pen stone = pen_with(&p, b->m.rubble), trim = pen_with(&p, b->m.trim),
		   ashlar = pen_with(&p, b->m.ashlar);
	float crown = deck_height(s, 0) - 0.85f, half = 5, rise = crown - WATER_M - 0.35f;
	float r = (half * half + rise * rise) / (2 * rise);
	struct arch arches[3] = { { 0, r, crown - r, half } };
	for (unsigned k = 1; k < 3; k++) {
		float h = 2.3f, y = (k == 1 ? -1 : 1) * (half + 1.3f + h),
		      top = deck_height(s, y) - 0.75f;
		arches[k] = (struct arch){ y, h + 0.15f, top - h - 0.15f, h };
	}
	draw_spandrels(s, &stone, arches, 3);
	for (unsigned k = 0; k < 3; k++)
		draw_ring_stones(&trim, &arches[k]);
	for (int k = -1; k <= 1; k += 2) {
		float near = k * half, far = k * (half + 1.3f);
		draw_pier(&ashlar, MIN(near, far), MAX(near, far), WATER_M + 1.2f);
		draw_pier(&ashlar, MIN(k * 10.9f, k * 12.4f), MAX(k * 10.9f, k * 12.4f), -0.6f);
	}
	draw_parapet(s, &ashlar, &trim);
	struct pen deck = p;
	deck.object = site_object(s, WORLD_TERRAIN);
	deck.material = b->m.setts;
	s->ground = bridge_relief;
	draw_ground(s, &deck, (vec){ -INSIDE_M, -HALF_M + 0.001f },
		(vec){ INSIDE_M, HALF_M - 0.001f }, 0.7f, 0, NULL, NULL);
	for (unsigned k = 0; k < 4; k++) {
		float x = (k & 1 ? 1 : -1) * 0.5f * (INSIDE_M + DECK_M),
		      y = (k & 2 ? 1 : -1) * HALF_M;
		float z = deck_height(s, y);
		pen_box(&ashlar, (vec){ x - 0.32f, y - 0.32f, -2 },
			(vec){ x + 0.32f, y + 0.32f, z + 1.25f });
		pen_box(&trim, (vec){ x - 0.4f, y - 0.4f, z + 1.25f },
			(vec){ x + 0.4f, y + 0.4f, z + 1.4f });
		struct pen lamp = site_pen(s, x, y, z + 1.4f, 0);
		lamp.object = site_object(s, WORLD_STRUCTURE);
		draw_lamp_post(&lamp, &b->m, 2.5f);
	}
}

static void plant_banks(struct scenery *b)
{
	struct site *s = b->s;
	static const enum tree_kind kinds[] = { TREE_ROUND, TREE_SPREADING, TREE_WILLOW,
		TREE_COLUMN, TREE_CONIFER, TREE_BIRCH };
	uint32_t models[6], shrub = shrub_model(s), tuft = tuft_model(s);
	for (unsigned i = 0; i < 6; i++)
		models[i] = tree_model(s, kinds[i]);
	for (unsigned i = 0, tries = 0; i < 110 && tries < 4000; tries++) {
		bool near = i < 16;
		float x = roll_in(&s->dice, -1, 1) * (near ? 32 : 85),
		      y = roll_in(&s->dice, -1, 1) * (near ? 24 : 80);
		float d = from_river(s, x, y) / s->relief[0];
		bool path = fabsf(fabsf(y) - HALF_M - 1.8f) < 2.2f && fabsf(x) < 48;
		unsigned kind =
			d < 1.25f && roll(&s->dice) < 0.6f ? 2 : (unsigned)roll_int(&s->dice, 0, 5);
		/* willows and conifers hang low */
		float wide = kinds[kind] == TREE_WILLOW    ? 7
			     : kinds[kind] == TREE_CONIFER ? 5.2f
							   : 3;
		if (d < 1.05f || path || fabsf(x) < 5.5f || (near && hypotf(x, y) < 13) ||
			site_from_walk(s, x, y) < wide || !site_claim(s, x, y, near ? 2.6f : 2))
			continue;
		plant(s, models[kind], x, y, roll_in(&s->dice, 0.85f, 1.25f));
		i++;
	}
	for (unsigned i = 0; i < 60; i++) {
		float x = roll_in(&s->dice, -40, 40), y = roll_in(&s->dice, -24, 24),
		      d = from_river(s, x, y) / s->relief[0];
		if (d > 1.02f && fabsf(x) > 4 && fabsf(fabsf(y) - HALF_M - 1.8f) > 2 &&
			site_claim(s, x, y, 0.7f))
			plant(s, shrub, x, y, roll_in(&s->dice, 0.5f, 1.1f));
	}
	uint16_t reeds = site_object(s, WORLD_VEGETATION);
	for (unsigned i = 0; i < 520; i++) {
		float x = roll_in(&s->dice, -45, 45),
		      y = roll_in(&s->dice, 7.2f, 10) * (i % 2 ? 1 : -1);
		bool shore = i < 300;
		if (!shore)
			y = roll_in(&s->dice, 10, 24) * (i % 2 ? 1 : -1);
		float z = site_ground(s, x, y);
		if (fabsf(x) < 4 || z < WATER_M - 0.3f || (shore && z > WATER_M + 0.5f) ||
			bank_cover(x, y, b) == b->m.gravel)
			continue;
		struct pen at = site_pen(s, x, y, z, roll_in(&s->dice, 0, 6));
		at.object = reeds;
		at = pen_scaled(
			&at, shore ? roll_in(&s->dice, 1.6f, 3) : roll_in(&s->dice, 0.5f, 1));
		site_place(s, tuft, &at);
	}
}

static void people_banks(struct scenery *b)
{
	struct site *s = b->s;
	for (unsigned i = 0; i < 10; i++) {
		float side = i % 2 ? 1 : -1, x = -32 + 7.1f * (float)i, y = side * (HALF_M + 3.4f);
		if (!site_claim(s, x, y, 0.9f))
			continue;
		struct pen p = site_stand(s, WORLD_STRUCTURE, x, y, side > 0 ? 0 : (float)G_PI);
		if (i % 3) {
			draw_lamp_post(&p, &b->m, 4);
			continue;
		}
		p = pen_at(&p, site_nudge(s, 1), 0, 0);
		draw_bench(&p, &b->m);
		add_person(
			s, x + 0.4f + site_nudge(s, 0.5f), y, side > 0 ? 0 : (float)G_PI, POSE_SIT);
	}
	for (unsigned i = 0, tries = 0; i < 7 && tries < 200; tries++) {
		float x = i < 2 ? roll_in(&s->dice, -1.8f, 1.8f) : roll_in(&s->dice, -25, 25);
		float y = i < 2 ? roll_in(&s->dice, -9, 9)
				: (i % 2 ? 1 : -1) * (HALF_M + roll_in(&s->dice, 0.9f, 2.6f));
		if (!site_claim(s, x, y, 0.45f))
			continue;
		/* where the plants find room must not hang on who walks here */
		add_person(s, x + site_nudge(s, 2), y + site_nudge(s, 0.4f),
			roll_in(&s->dice, 0, 6.28f), i % 2 ? POSE_WALK : POSE_STAND);
		i++;
	}
	/* a rail above the bank near the bridge */
	for (int k = -1; k <= 1; k += 2)
		for (int e = -1; e <= 1; e += 2) {
			struct pen p = site_pen(s, 0, 0, 0, 0);
			p.object = site_object(s, WORLD_STRUCTURE);
			p.material = b->m.iron;
			for (unsigned i = 0; i < 5; i++) {
				float y = k * (HALF_M - 0.2f), x0 = e * (3.2f + 2 * i),
				      x1 = e * (5.2f + 2 * i);
				draw_railing(&p, (vec){ x0, y, site_ground(s, x0, y) - 0.02f },
					(vec){ x1, y, site_ground(s, x1, y) - 0.02f }, 1, 0.13f);
			}
		}
}

static void build_beyond(struct scenery *b)
{
	struct site *s = b->s;
	for (unsigned i = 0; i < 6; i++) {
		float side = i % 2 ? 1 : -1, x = -36 + 14 * (float)i + roll_in(&s->dice, -3, 3),
		      y = side * roll_in(&s->dice, 33, 40);
		if (!site_claim(s, x, y, 8))
			continue;
		float turn = side > 0 ? 0 : (float)G_PI, half = roll_in(&s->dice, 4, 5.5f);
		struct pen p = site_stand(s, WORLD_BUILDING, x, y, turn);
		p = pen_at(&p, -half, 0, 0.3f);
		wing_house(s, &p, &b->m, 2 * half, true, true);
	}
	struct pen tower = site_stand(s, WORLD_BUILDING, roll_in(&s->dice, 14, 22), 50, 0.3f);
	draw_tower(s, &tower, &b->m);
	site_claim(s, tower.at.o[0], 50, 5);
	add_car(s, &b->m, roll_in(&s->dice, 1, 3), 27, 1.4f);
	site_claim(s, 2, 27, 3);
}

void scene_bridge(struct site *s)
{
	static const float walk[][2] = { { -11, -13.6f }, { -2.6f, -17.5f }, { 0.1f, -6.5f },
		{ 0.1f, 3.5f }, { 0, 16 }, { 9, 15.6f }, { 18.5f, 15.8f }, { 27, 15.6f },
		{ 14, 19.5f }, { 1, 21.5f }, { -9, 15.6f }, { -19, 15.7f }, { -27.5f, 15.8f } };
	struct scenery b = { .s = s };
	palette_choose(s, &b.m);
	s->bounds = (struct bounds){ { -55, -42, -4 }, { 55, 42, 14 }, 2.8f };
	s->light.haze_m = 600;
	lay_banks(&b);
	for (unsigned i = 0; i < G_N_ELEMENTS(walk); i++)
		site_walk_to(s, walk[i][0], walk[i][1]);
	draw_bridge(&b);
	build_beyond(&b);
	people_banks(&b);
	plant_banks(&b);
}
