/* Two rows of houses along a street from west to east, and a cross street in its middle. */
#include "sim/scene-ground.h"
#include "sim/scene-props.h"
#include "sim/scene-tree.h"
#include "sim/scene-wing.h"

#define ROAD_M   3.4f /* half widths, along the street and across */
#define FRONT_M  6.9f
#define CROSS_M  3.0f
#define SIDE_M   5.6f
#define END_M    52.0f
#define STEP_M   0.13f
#define PERIOD_M 8.5f /* of houses, trees and lamps where all are the same */

static float road_relief(const struct site *s, float x, float y)
{
	float crown = 0.05f * (1 - MIN(1, fabsf(y) / ROAD_M)) * MIN(1, fabsf(x) / 8);
	if (s->variant.repeated)
		return crown;
	return s->relief[0] * x + 0.06f * noise_2d(x * 0.05f + s->relief[1], y * 0.05f, 3) + crown;
}

static bool on_road(float x, float y)
{
	return fabsf(y) < ROAD_M || fabsf(x) < CROSS_M;
}

static float street_relief(const struct site *s, float x, float y)
{
	return road_relief(s, x, y) + (on_road(x, y) ? 0 : STEP_M);
}

static void lay_walks(struct site *s, const struct palette *m, const struct pen *p)
{
	struct pen flags = pen_with(p, m->flags), kerb = pen_with(p, m->kerb);
	for (int i = -1; i <= 1; i += 2)
		for (int k = -1; k <= 1; k += 2) {
			float x0 = i * CROSS_M, x1 = i * END_M, y0 = k * ROAD_M,
			      y1 = k * (FRONT_M + 0.3f), x2 = i * (SIDE_M + 0.3f);
			draw_ground(s, &flags, (vec){ MIN(x0, x1), MIN(y0, y1) },
				(vec){ MAX(x0, x1), MAX(y0, y1) }, 1, STEP_M, NULL, NULL);
			float y2 = k * END_M;
			draw_ground(s, &flags, (vec){ MIN(x0, x2), MIN(y1, y2) },
				(vec){ MAX(x0, x2), MAX(y1, y2) }, 1, STEP_M, NULL, NULL);
			draw_kerb(s, &kerb, (vec){ x0 - i * 0.1f, y0 }, (vec){ x1, y0 }, 0.2f,
				STEP_M + 0.004f);
			draw_kerb(
				s, &kerb, (vec){ x0, y0 }, (vec){ x0, y2 }, 0.2f, STEP_M + 0.004f);
		}
}

static void paint_road(struct site *s, const struct pen *p)
{
	for (float x = 7; x < END_M - 4; x += 6)
		for (int i = -1; i <= 1; i += 2) {
			float a = i * x, b = i * (x + 3);
			draw_ground(s, p, (vec){ MIN(a, b), -0.06f }, (vec){ MAX(a, b), 0.06f }, 1,
				0.006f, NULL, NULL);
		}
	for (int i = -1; i <= 1; i += 2)
		for (float y = -ROAD_M + 0.3f; y < ROAD_M - 0.3f;
			y += 0.95f) { /* zebra crossings */
			float a = i * 4, b = i * 6.4f;
			draw_ground(s, p, (vec){ MIN(a, b), y }, (vec){ MAX(a, b), y + 0.5f }, 1,
				0.006f, NULL, NULL);
		}
}

static void lay_street(struct site *s, const struct palette *m)
{
	s->relief[0] = roll_in(&s->dice, -0.012f, 0.012f);
	s->relief[1] = roll_in(&s->dice, 0, 100);
	s->ground = road_relief;
	struct pen p = site_pen(s, 0, 0, 0, 0);
	p.object = site_object(s, WORLD_TERRAIN);
	struct pen road = pen_with(&p, m->asphalt), paint = pen_with(&p, m->marking),
		   field = pen_with(&p, m->soil);
	draw_ground(
		s, &road, (vec){ -END_M, -ROAD_M }, (vec){ END_M, ROAD_M }, 0.85f, 0, NULL, NULL);
	for (int k = 0; k < 2; k++) {
		float y0 = k ? ROAD_M : -END_M, y1 = k ? END_M : -ROAD_M;
		draw_ground(
			s, &road, (vec){ -CROSS_M, y0 }, (vec){ CROSS_M, y1 }, 1, 0, NULL, NULL);
	}
	lay_walks(s, m, &p);
	paint_road(s, &paint);
	pen_quad(&field, (vec){ -160, -160, -1.6f }, (vec){ 160, -160, -1.6f },
		(vec){ 160, 160, -1.6f }, (vec){ -160, 160, -1.6f });
	s->ground = street_relief;
}

/* Houses side by side along x of the pen, whose viewers are at -y, from x = 0 to length. */
static void build_row(struct site *s, const struct palette *m, const struct pen *p, float length,
	bool left, bool right)
{
	float x = 0;
	const struct dice first = dice_of(s->seed, 77);
	while (x < length - 1) {
		float wide = s->variant.repeated ? PERIOD_M : roll_in(&s->dice, 6.2f, 11.5f);
		if (!s->variant.repeated && length - x - wide < 6)
			wide = length - x;
		if (s->variant.repeated)
			s->dice = first;
		struct pen q = pen_at(p, x, 0, 0);
		q.at.o[2] = site_ground(s, q.at.o[0] + q.at.x[0] * wide * 0.5f - q.at.y[0],
				    q.at.o[1] + q.at.x[1] * wide * 0.5f - q.at.y[1]) +
			    0.06f;
		q.object = site_object(s, WORLD_BUILDING);
		wing_house(s, &q, m, wide, left && x <= 0, right && x + wide >= length);
		x += wide;
	}
}

static void build_rows(struct site *s, const struct palette *m)
{
	float long_m = END_M - SIDE_M, side_m = END_M - FRONT_M - 9.6f;
	struct pen rows[] = { site_pen(s, -END_M, FRONT_M, 0, 0),
		site_pen(s, SIDE_M, FRONT_M, 0, 0), site_pen(s, END_M, -FRONT_M, 0, (float)G_PI),
		site_pen(s, -SIDE_M, -FRONT_M, 0, (float)G_PI) };
	for (unsigned i = 0; i < 4; i++)
		build_row(s, m, &rows[i], long_m, i % 2 == 1, i % 2 == 0);
	struct pen cross[] = { site_pen(s, SIDE_M, END_M, 0, (float)G_PI / 2),
		site_pen(s, -SIDE_M, FRONT_M + 9.6f, 0, -(float)G_PI / 2),
		site_pen(s, SIDE_M, -FRONT_M - 9.6f, 0, (float)G_PI / 2),
		site_pen(s, -SIDE_M, -END_M, 0, -(float)G_PI / 2) };
	for (unsigned i = 0; i < 4; i++)
		build_row(s, m, &cross[i], side_m, false, false);
	/* and one that closes the view at each end */
	struct pen ends[] = { site_pen(s, END_M + 4, 14, 0, (float)G_PI / 2),
		site_pen(s, -END_M - 4, -14, 0, -(float)G_PI / 2),
		site_pen(s, -14, END_M + 3, 0, 0), site_pen(s, 14, -END_M - 3, 0, (float)G_PI) };
	for (unsigned i = 0; i < 4; i++)
		build_row(s, m, &ends[i], 28, false, false);
	struct pen tower = site_pen(s, END_M + 22, 8, 0, 0);
	tower.object = site_object(s, WORLD_BUILDING);
	draw_tower(s, &tower, m);
}

static void line_street(struct site *s, const struct palette *m)
{
	uint32_t trees[3] = { tree_model(s, TREE_ROUND), tree_model(s, TREE_BIRCH),
		tree_model(s, TREE_ROUND) };
	unsigned n = 0;
	for (float x = 9; x < END_M - 3; x += PERIOD_M)
		for (int i = -1; i <= 1; i += 2)
			for (int k = -1; k <= 1; k += 2, n++) {
				float aside = s->variant.repeated ? 0 : roll_in(&s->dice, -1, 1),
				      at = i * (x + aside), y = k * (ROAD_M + 0.75f);
				if (s->variant.repeated)
					n = 2; /* a lamp before each house */
				if (!site_claim(s, at, y, 0.6f))
					continue;
				if (n % 5 < 2) {
					plant(s, trees[n % 3], at, y,
						roll_in(&s->dice, 0.62f, 0.8f));
					continue;
				}
				struct pen p = site_stand(
					s, WORLD_STRUCTURE, at, y, k > 0 ? 0 : (float)G_PI);
				if (n % 5 == 2)
					draw_lamp_post(&p, m, 4.6f);
				else if (n % 5 == 3)
					draw_sign(&p, m, m->shop[n % 3], n % 2);
				else
					draw_bollard(&p, m);
			}
	for (int i = -1; i <= 1; i += 2) {
		struct pen p = site_stand(
			s, WORLD_STRUCTURE, i * (SIDE_M - 1.6f), -i * (ROAD_M + 0.6f), 0.2f);
		if (site_claim(s, p.at.o[0], p.at.o[1], 0.4f))
			draw_lamp_post(&p, m, 4.8f);
	}
}

static void park_cars(struct site *s, const struct palette *m)
{
	for (float x = 10; x < END_M - 6; x += 6.2f)
		for (int i = -1; i <= 1; i += 2)
			for (int k = -1; k <= 1; k += 2) {
				float at = i * (x + roll_in(&s->dice, -0.4f, 0.4f)),
				      y = k * (ROAD_M - 1.1f);
				if (roll(&s->dice) < 0.45f || !site_claim(s, at - 1.1f, y, 1.2f))
					continue;
				site_claim(s, at + 1.1f, y, 0.9f);
				add_car(s, m, at, y, k > 0 ? 0 : (float)G_PI);
			}
}

static void people_street(struct site *s, const struct palette *m)
{
	for (unsigned i = 0, tries = 0; i < 12 && tries < 300; tries++) {
		float x = roll_in(&s->dice, -30, 30),
		      y = (roll(&s->dice) < 0.5f ? -1 : 1) *
			  roll_in(&s->dice, ROAD_M + 0.9f, FRONT_M - 1.5f);
		if (fabsf(x) < SIDE_M || !site_claim(s, x, y, 0.45f))
			continue;
		float turn = (roll(&s->dice) < 0.5f ? 1 : -1) * (float)G_PI / 2;
		add_person(s, x, y, turn, i % 4 ? POSE_WALK : POSE_STAND);
		i++;
	}
	for (unsigned i = 0; i < 4; i++) {
		float x = roll_in(&s->dice, 8, 30) * (i % 2 ? 1 : -1),
		      y = (i & 2 ? 1 : -1) * (FRONT_M - 0.7f);
		if (!site_claim(s, x, y, 1))
			continue;
		struct pen p = site_stand(s, WORLD_STRUCTURE, x, y, i & 2 ? 0 : (float)G_PI);
		if (i % 2)
			draw_bench(&p, m);
		else
			draw_bicycle(&p, m);
	}
}

void scene_street(struct site *s)
{
	static const float walk[][2] = { { -1.2f, -1.5f }, { -10, 0.6f }, { 7.5f, 0.2f },
		{ 3.5f, -5 }, { 13, -5.2f }, { 22, 0.3f }, { 30, 5.2f }, { 20.5f, 5.2f },
		{ 9.5f, 5.3f }, { 1, 9.5f }, { -4.5f, 1.8f }, { -17, 5.2f }, { -26, 0.2f },
		{ -33, -5.2f }, { -19, -5.2f } };
	struct palette m;
	palette_choose(s, &m);
	s->bounds = (struct bounds){ { -END_M - 5, -24, -0.6f }, { END_M + 5, 24, 15 }, 1.9f };
	for (unsigned i = 0; i < G_N_ELEMENTS(walk); i++)
		site_walk_to(s, walk[i][0], walk[i][1]);
	lay_street(s, &m);
	build_rows(s, &m);
	line_street(s, &m);
	struct dice kept;
	site_begin_loose(s, &kept);
	park_cars(s, &m);
	people_street(s, &m);
	site_end_loose(s, &kept);
}
