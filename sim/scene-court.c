/* A paved courtyard between four wings that differ: a grand front with a risalit to the north, an
 * arcade on one side, a brick front to the south, and a low wing with a gate, ivy and an old wall.
 */
#include "sim/scene-ground.h"
#include "sim/scene-props.h"
#include "sim/scene-roof.h"
#include "sim/scene-tree.h"
#include "sim/scene-wing.h"

struct court {
	struct site *s;
	struct palette m;
	float half_x, half_y;
	bool swapped; /* the arcade is to the west */
	uint32_t tuft, shrub;
};

/* Falls a little towards one corner, with dips as old paving has. */
static float court_relief(const struct site *s, float x, float y)
{
	return s->relief[0] * x + s->relief[1] * y +
	       0.035f * noise_2d(x * 0.16f + s->relief[2], y * 0.16f, 77);
}

static uint16_t court_paving(float x, float y, const void *data)
{
	const struct court *c = data;
	float edge = MIN(c->half_x - fabsf(x), c->half_y - fabsf(y)),
	      middle = MAX(fabsf(x), fabsf(y));
	if (edge < 1.8f || (middle > 3.2f && middle < 4.4f))
		return c->m.flags;
	if (fabsf(x) < 0.5f || fabsf(y) < 0.5f)
		return c->m.flags;
	return c->m.setts;
}

static void lay_ground(struct court *c)
{
	struct site *s = c->s;
	s->ground = court_relief;
	s->relief[0] = roll_in(&s->dice, -0.006f, 0.006f);
	s->relief[1] = roll_in(&s->dice, -0.006f, 0.006f);
	s->relief[2] = roll_in(&s->dice, 0, 100);
	struct pen p = site_pen(s, 0, 0, 0, 0);
	p.object = site_object(s, WORLD_TERRAIN);
	vec far = { c->half_x + 1, c->half_y + 1 };
	draw_ground(s, &p, -far, far, 0.5f, 0, court_paving, c);
	struct pen field = pen_with(&p, c->m.grass);
	pen_quad(&field, (vec){ -140, -140, -1.7f }, (vec){ 140, -140, -1.7f },
		(vec){ 140, 140, -1.7f }, (vec){ -140, 140, -1.7f });
}

/* A pen whose x runs along a side from its left end as seen from the court; 0 north, 1 east, 2
 * south, 3 west. */
static struct pen side_pen(const struct court *c, unsigned side, float z)
{
	float x = side == 0 || side == 3 ? -c->half_x : c->half_x;
	float y = side < 2 ? c->half_y : -c->half_y;
	struct pen p = site_pen(c->s, x, y, z, (float)side * (float)G_PI / 2);
	p.object = site_object(c->s, WORLD_BUILDING);
	return p;
}

static void walk_court(struct court *c)
{
	static const float walk[][2] = { { 2.8f, -6.4f }, { -6.6f, -1.1f }, { -1.6f, 6.6f },
		{ 7, 1.1f }, { 15.8f, -3 }, { 13.4f, -11.6f }, { 2.4f, -11.9f }, { -9, -11.7f },
		{ -16.5f, -7 }, { -16.8f, 3.5f }, { -12, 11.6f }, { -1, 11.5f }, { 10, 11.6f } };
	float flip = c->swapped ? -1 : 1; /* about the middle, as the two side wings do */
	for (unsigned i = 0; i < G_N_ELEMENTS(walk); i++)
		site_walk_to(c->s,
			flip * walk[i][0] * c->half_x / 20 + roll_in(&c->s->dice, -0.4f, 0.4f),
			flip * walk[i][1] * c->half_y / 15 + roll_in(&c->s->dice, -0.4f, 0.4f));
}

static void plant_beds(struct court *c)
{
	struct site *s = c->s;
	uint32_t trees[3] = { tree_model(s, TREE_ROUND),
		tree_model(s, roll(&s->dice) < 0.5f ? TREE_BIRCH : TREE_SPREADING),
		tree_model(s, roll(&s->dice) < 0.5f ? TREE_COLUMN : TREE_ROUND) };
	unsigned empty = (unsigned)roll_int(&s->dice, 0, 3);
	for (unsigned i = 0; i < 4; i++) {
		float x = (i & 1 ? 1 : -1) * c->half_x * 0.49f,
		      y = (i & 2 ? 1 : -1) * c->half_y * 0.4f;
		float w = 0.2f * c->half_x, h = 0.13f * c->half_y;
		draw_bed(s, &c->m, x - w, y - h, x + w, y + h, c->tuft);
		for (unsigned k = 0; k < 4; k++)
			plant(s, c->shrub, x + (k & 1 ? 1 : -1) * (w - 0.6f),
				y + (k & 2 ? 1 : -1) * (h - 0.6f), roll_in(&s->dice, 0.4f, 0.65f));
		float tx = x + roll_in(&s->dice, -0.4f, 0.4f) * w;
		if (i != empty)
			plant(s, trees[i % 3], tx, y, roll_in(&s->dice, 0.85f, 1.1f));
		else
			plant(s, c->shrub, tx, y, 1.2f);
	}
}

static void seat_people(struct court *c)
{
	struct site *s = c->s;
	for (unsigned i = 0; i < 4; i++) {
		float y = (i & 2 ? 1 : -1) * (c->half_y * 0.27f - 0.75f),
		      x = (i & 1 ? 1 : -1) * c->half_x * 0.47f;
		float turn = i & 2 ? 0 : (float)G_PI;
		struct pen p = site_stand(s, WORLD_STRUCTURE, x, y, turn);
		draw_bench(&p, &c->m);
		site_claim(s, x, y, 1.1f);
		if (i == 1)
			add_person(s, x + 0.4f, y, turn, POSE_SIT);
	}
	for (unsigned i = 0, tries = 0; i < 8 && tries < 300; tries++) {
		float x = roll_in(&s->dice, -0.9f, 0.9f) * c->half_x,
		      y = roll_in(&s->dice, -0.88f, 0.88f) * c->half_y;
		bool bed = fabsf(fabsf(x) - 0.49f * c->half_x) < 0.25f * c->half_x &&
			   fabsf(fabsf(y) - 0.4f * c->half_y) < 0.2f * c->half_y;
		if (bed || !site_claim(s, x, y, 0.45f))
			continue;
		add_person(s, x, y, roll_in(&s->dice, 0, 6.28f), i % 3 ? POSE_WALK : POSE_STAND);
		if (i % 3 == 0 && site_claim(s, x + 0.95f, y, 0.4f))
			add_person(s, x + 0.95f, y,
				(float)G_PI / 2 + roll_in(&s->dice, -0.3f, 0.3f), POSE_STAND);
		i++;
	}
}

static void furnish(struct court *c)
{
	struct site *s = c->s;
	struct pen p = site_stand(s, WORLD_STRUCTURE, 0, 0, 0);
	site_claim(s, 0, 0, 3);
	if (roll(&s->dice) < 0.65f)
		draw_fountain(&p, &c->m, roll_in(&s->dice, 1.9f, 2.3f));
	else
		draw_well(&p, &c->m);
	for (unsigned i = 0; i < 4; i++) {
		float x = (i & 1 ? 1 : -1) * c->half_x * 0.25f,
		      y = (i & 2 ? 1 : -1) * c->half_y * 0.26f;
		p = site_stand(s, WORLD_STRUCTURE, x, y, 0.3f);
		draw_lamp_post(&p, &c->m, 4.1f);
		site_claim(s, x, y, 0.4f);
	}
	float side = c->swapped ? 1 : -1, cy = -side * roll_in(&s->dice, 0.53f, 0.6f) * c->half_y;
	if (site_claim(s, side * (c->half_x - 1.9f), cy, 1.6f))
		add_car(s, &c->m, side * (c->half_x - 1.7f), cy,
			(float)G_PI / 2 * (roll(&s->dice) < 0.5f ? 1 : -1));
	for (unsigned i = 0; i < 6; i++) {
		float x = -4.5f + 1.8f * (float)i, y = -c->half_y + 2.1f;
		if (!site_claim(s, x, y, 0.2f))
			continue;
		p = site_stand(s, WORLD_STRUCTURE, x, y, 0);
		draw_bollard(&p, &c->m);
	}
}

/* Tables under a parasol, with chairs and guests, before the arcade. */
static void set_tables(struct court *c)
{
	struct site *s = c->s;
	float side = c->swapped ? -1 : 1;
	for (unsigned i = 0; i < 3; i++) {
		float x = side * (c->half_x - 2.9f) + site_nudge(s, 0.8f),
		      y = side * c->half_y * (0.12f + 0.21f * (float)i) + site_nudge(s, 0.8f);
		if (!site_claim(s, x, y, 1.35f))
			continue;
		struct pen p = site_stand(s, WORLD_FURNITURE, x, y, roll_in(&s->dice, 0, 1));
		draw_table(&p, &c->m, 0.42f);
		if (i != 1)
			draw_parasol(&p, &c->m, c->m.shop[i % 3]);
		for (unsigned k = 0; k < 3; k++) {
			float a = 2.1f * (float)k + roll(&s->dice);
			struct pen q = pen_turned(&p, 0.8f * sinf(a), 0.8f * cosf(a), 0, a);
			draw_chair(&q, &c->m);
			if (k == 0) {
				q.object = site_object(s, WORLD_PERSON);
				draw_person(s, &q, POSE_SIT);
			}
		}
	}
}

static void raise_wings(struct court *c)
{
	struct pen north = side_pen(c, 0, 0.9f), south = side_pen(c, 2, 0.12f);
	struct pen arcade = side_pen(c, c->swapped ? 3 : 1, 0.28f),
		   gate = side_pen(c, c->swapped ? 1 : 3, 0.2f);
	wing_grand(c->s, &north, &c->m, 2 * c->half_x);
	wing_brick(c->s, &south, &c->m, 2 * c->half_x);
	wing_arcade(c->s, &arcade, &c->m, 2 * c->half_y);
	wing_gate(c->s, &gate, &c->m, 2 * c->half_y);
	struct pen tower =
		site_pen(c->s, roll_in(&c->s->dice, -0.6f, 0.6f) * c->half_x, c->half_y + 24, 0, 0);
	tower.object = site_object(c->s, WORLD_BUILDING);
	draw_tower(c->s, &tower, &c->m);
}

void scene_court(struct site *s)
{
	struct court c = { .s = s,
		.half_x = roll_in(&s->dice, 19, 21.5f),
		.half_y = roll_in(&s->dice, 14.2f, 16) };
	c.swapped = roll(&s->dice) < 0.5f;
	palette_choose(s, &c.m);
	c.tuft = tuft_model(s);
	c.shrub = shrub_model(s);
	s->bounds = (struct bounds){ { -c.half_x - 5, -c.half_y - 2, -0.4f },
		{ c.half_x + 5, c.half_y + 2, 17 }, 1.4f };
	lay_ground(&c);
	walk_court(&c);
	raise_wings(&c);
	furnish(&c);
	plant_beds(&c);
	struct dice kept;
	site_begin_loose(s, &kept);
	set_tables(&c);
	seat_people(&c);
	site_end_loose(s, &kept);
}
