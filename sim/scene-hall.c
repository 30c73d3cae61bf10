/* A vaulted hall of three aisles: a library and assembly room with pews, tables, bookshelves and
 * chandeliers. Closed all round; light comes through tall windows. */
#include "sim/scene-facade.h"
#include "sim/scene-ground.h"
#include "sim/scene-props.h"
#include "sim/scene-tree.h"

struct hall {
	struct site *s;
	struct palette m;
	unsigned bays;
	float bay, half_x, nave, half_y; /* half widths: of the nave, and of all */
	float spring, rise;
	uint16_t books[7], wall, vault;
};

static void choose_hall(struct hall *h)
{
	struct dice *d = &h->s->dice;
	static const vec covers[] = { { 0.3f, 0.07f, 0.05f }, { 0.08f, 0.16f, 0.1f },
		{ 0.08f, 0.1f, 0.22f }, { 0.36f, 0.24f, 0.1f }, { 0.5f, 0.44f, 0.34f },
		{ 0.14f, 0.08f, 0.05f }, { 0.4f, 0.3f, 0.2f } };
	palette_choose(h->s, &h->m);
	for (unsigned i = 0; i < 7; i++)
		h->books[i] = palette_cloth(h->s, covers[i] * roll_in(d, 0.8f, 1.2f));
	h->bays = (unsigned)roll_int(d, 7, 8);
	h->bay = roll_in(d, 4.7f, 5.2f);
	h->half_x = 0.5f * h->bay * h->bays;
	h->nave = roll_in(d, 4.4f, 5);
	h->half_y = h->nave + roll_in(d, 4.3f, 4.8f);
	h->spring = roll_in(d, 5.6f, 6.3f);
	h->rise = roll_in(d, 3, 3.6f);
	h->wall = site_material(h->s, (struct material){ .colour = { 0.66f, 0.6f, 0.5f },
					      .joint_colour = { 0.5f, 0.45f, 0.37f },
					      .cell_u_m = 0.8f,
					      .cell_v_m = 0.4f,
					      .bond = 0.5f,
					      .joint_m = 0.008f,
					      .variety = 0.08f,
					      .warmth = 0.04f,
					      .grain_per_m = 18,
					      .grain = 0.06f,
					      .stain_per_m = 0.4f,
					      .stain = 0.06f });
	h->vault = site_material(h->s, (struct material){ .colour = { 0.74f, 0.7f, 0.62f },
					       .grain_per_m = 14,
					       .grain = 0.04f,
					       .stain_per_m = 0.5f,
					       .stain = 0.06f });
}

static uint16_t hall_floor(float x, float y, const void *data)
{
	const struct hall *h = data;
	if (fabsf(y) < 0.9f || fabsf(fabsf(y) - h->nave) < 0.6f || fabsf(x) > h->half_x - 0.6f)
		return h->m.trim_dark;
	return h->m.floor_tiles;
}

static void draw_vaults(const struct hall *h, const struct pen *p)
{
	struct pen vault = pen_with(p, h->vault), rib = pen_with(p, h->m.trim);
	float aisle = 0.5f * (h->half_y - h->nave);
	for (unsigned i = 0; i < h->bays; i++) {
		float x = -h->half_x + h->bay * (i + 0.5f);
		for (int k = -1; k <= 1; k++) {
			float half = k ? aisle : h->nave, y = k * (h->nave + aisle);
			struct pen q = pen_at(&vault, x, y, h->spring),
				   r = pen_at(&rib, x, y, h->spring - 0.03f);
			draw_groin(&q, 0.5f * h->bay, half, h->rise, true, 0);
			draw_groin_ribs(&r, 0.5f * h->bay, half, h->rise, true, 0.1f);
		}
	}
}

static void draw_pillars(const struct hall *h, const struct pen *p)
{
	struct pen stone = pen_with(p, h->m.trim);
	for (unsigned i = 0; i <= h->bays; i++)
		for (int k = -1; k <= 1; k += 2) {
			float x = -h->half_x + h->bay * i;
			struct pen wall = pen_at(&stone, x, k * h->half_y, 0);
			draw_column(&wall, h->spring, 0.24f);
			struct pen q = pen_at(&stone, x, k * h->nave, 0);
			draw_column(&q, h->spring, 0.36f);
		}
}

/* One side wall with a tall window in each bay; pen as for a facade. */
static void draw_long_wall(const struct hall *h, const struct pen *p)
{
	struct facade f = { .palette = &h->m, .trim = h->m.trim, .frame = h->m.frame_dark };
	struct opening o[12];
	struct pen wall = pen_with(p, h->wall), trim = pen_with(p, h->m.trim);
	float l = 2 * h->half_x;
	for (unsigned i = 0; i < h->bays; i++)
		o[i] = (struct opening){ h->bay * (i + 0.5f) - 0.95f, 2.7f, 1.9f,
			h->spring + 0.62f * h->rise - 2.7f, true, false };
	draw_wall(&wall, 0, l, -0.5f, h->spring + h->rise + 0.5f, o, h->bays);
	for (unsigned i = 0; i < h->bays; i++)
		draw_window(&wall, &f, &o[i]);
	draw_course(&trim, 0, l, 2.45f, 0);
	pen_box(&trim, (vec){ 0, -0.06f, -0.2f }, (vec){ l, 0, 0.3f });
}

/* West and east: a great door, a round window and two tall ones. */
static void draw_end_wall(const struct hall *h, const struct pen *p)
{
	struct facade f = { .palette = &h->m, .trim = h->m.trim, .frame = h->m.frame_dark };
	float l = 2 * h->half_y, m = h->half_y, a = 0.5f * (h->half_y - h->nave);
	struct opening o[3] = { { a - 0.8f, 2.7f, 1.6f, h->spring - 1.2f, true, false },
		{ m - 1.3f, 0, 2.6f, 4.2f, true, true },
		{ l - a - 0.8f, 2.7f, 1.6f, h->spring - 1.2f, true, false } };
	struct pen wall = pen_with(p, h->wall), trim = pen_with(p, h->m.trim);
	draw_wall(&wall, 0, l, -0.5f, h->spring + h->rise + 0.5f, o, 3);
	for (unsigned i = 0; i < 3; i++)
		draw_opening(h->s, &wall, &f, &o[i]);
	draw_voussoirs(&trim, m, 4.2f - 1.3f, 1.3f, 1.75f, -0.16f, 0, 13);
	/* a gallery clock above the door */
	struct pen clock = pen_with(p, h->m.frame_light), iron = pen_with(p, h->m.iron);
	draw_arc(&clock, m, 6.3f, 0, 0.75f, -0.06f, 0, 0, 2 * (float)G_PI, 32);
	draw_arc(&trim, m, 6.3f, 0.72f, 0.95f, -0.14f, 0, 0, 2 * (float)G_PI, 32);
	for (unsigned i = 0; i < 12; i++) {
		float t = i * (float)G_PI / 6;
		draw_arc(&iron, m, 6.3f, 0.55f, 0.68f, -0.075f, -0.06f, t - 0.03f, t + 0.03f, 1);
	}
	pen_rod(&iron, (vec){ m, -0.09f, 6.3f }, (vec){ m + 0.3f, -0.09f, 6.6f }, 0.02f, 0.015f, 5);
	pen_rod(&iron, (vec){ m, -0.09f, 6.3f }, (vec){ m - 0.1f, -0.09f, 6.85f }, 0.015f, 0.01f,
		5);
}

static void build_hall(struct hall *h)
{
	struct pen p = site_pen(h->s, 0, 0, 0, 0);
	p.object = site_object(h->s, WORLD_TERRAIN);
	vec corner = { h->half_x + 0.4f, h->half_y + 0.4f };
	draw_ground(h->s, &p, -corner, corner, 0.6f, 0, hall_floor, h);
	struct pen field = pen_with(&p, h->m.grass);
	pen_quad(&field, (vec){ -150, -150, -0.6f }, (vec){ 150, -150, -0.6f },
		(vec){ 150, 150, -0.6f }, (vec){ -150, 150, -0.6f });
	p.object = site_object(h->s, WORLD_BUILDING);
	draw_vaults(h, &p);
	draw_pillars(h, &p);
	const float turn[4] = { 0, (float)G_PI / 2, (float)G_PI, -(float)G_PI / 2 };
	for (unsigned k = 0; k < 4; k++) {
		bool end = k % 2;
		float x = k == 0 || k == 3 ? -h->half_x : h->half_x,
		      y = k < 2 ? h->half_y : -h->half_y;
		struct pen q = site_pen(h->s, x, y, 0, turn[k]);
		q.object = p.object;
		if (end)
			draw_end_wall(h, &q);
		else
			draw_long_wall(h, &q);
	}
	struct pen roof = pen_with(&p, h->m.plank);
	float top = h->spring + h->rise;
	pen_box(&roof, (vec){ -corner[0], -corner[1], top + 0.3f },
		(vec){ corner[0], corner[1], top + 0.6f });
	/* buttresses shut the corners where the walls meet */
	for (unsigned k = 0; k < 4; k++) {
		float x = (k & 1 ? 1 : -1) * (h->half_x + 0.45f),
		      y = (k & 2 ? 1 : -1) * (h->half_y + 0.45f);
		struct pen b = pen_with(&p, h->wall);
		pen_box(&b, (vec){ x - 0.45f, y - 0.45f, -0.6f },
			(vec){ x + 0.45f, y + 0.45f, top + 0.4f });
	}
}

/* Five shelves of single books; back at y = 0, front towards -y. */
static void draw_bookcase(const struct hall *h, const struct pen *p, float width)
{
	struct dice *d = &h->s->dice;
	struct pen wood = pen_with(p, h->m.wood);
	float deep = 0.36f, top = 2.2f, x = 0.5f * width;
	pen_box(&wood, (vec){ -x, -0.03f, 0 }, (vec){ x, 0, top });
	pen_box(&wood, (vec){ -x - 0.04f, -deep, 0 }, (vec){ -x, 0, top });
	pen_box(&wood, (vec){ x, -deep, 0 }, (vec){ x + 0.04f, 0, top });
	pen_box(&wood, (vec){ -x - 0.08f, -deep - 0.06f, top - 0.06f },
		(vec){ x + 0.08f, 0, top + 0.04f });
	pen_box(&wood, (vec){ -x - 0.04f, -deep, 0 }, (vec){ x + 0.04f, 0, 0.14f });
	for (unsigned level = 0; level < 5; level++) {
		float z = 0.14f + 0.4f * level, at = -x + 0.02f;
		pen_box(&wood, (vec){ -x, -deep + 0.02f, z - 0.03f }, (vec){ x, 0, z });
		while (at < x - 0.1f) {
			float thick = roll_in(d, 0.03f, 0.075f), high = roll_in(d, 0.22f, 0.34f),
			      in = roll_in(d, 0.03f, 0.08f);
			struct pen book = pen_with(p, h->books[roll_int(d, 0, 6)]);
			if (roll(d) < 0.94f)
				pen_box(&book, (vec){ at, -deep + in, z },
					(vec){ at + thick, -0.05f, z + high });
			at += thick + 0.004f;
		}
	}
}

static void draw_pew(const struct pen *p, const struct palette *m, float width)
{
	struct pen wood = pen_with(p, m->wood);
	float x = 0.5f * width;
	pen_box(&wood, (vec){ -x, -0.25f, 0.42f }, (vec){ x, 0.2f, 0.46f });
	vec back[] = { { 0.2f, 0, 0.3f }, { 0.24f, 0, 0.3f }, { 0.33f, 0, 0.95f },
		{ 0.29f, 0, 0.95f } };
	struct pen turned = pen_turned(&wood, 0, 0, 0, -(float)G_PI / 2);
	pen_prism(&turned, back, 4, -x, x);
	pen_box(&wood, (vec){ -x, 0.26f, 0.93f }, (vec){ x, 0.38f, 0.97f });
	for (int k = -1; k <= 1; k += 2) {
		vec end[] = { { -0.28f, 0, 0 }, { 0.3f, 0, 0 }, { 0.4f, 0, 1.02f },
			{ 0.25f, 0, 1.02f }, { 0.1f, 0, 0.62f }, { -0.28f, 0, 0.58f } };
		pen_prism(&turned, end, 6, k * x - 0.03f, k * x + 0.03f);
	}
}

static void draw_long_table(const struct pen *p, const struct palette *m, float width)
{
	struct pen wood = pen_with(p, m->wood), brass = pen_with(p, m->brass),
		   shade = pen_with(p, m->door[0]);
	static const float leg[][2] = { { 0.05f, 0 }, { 0.06f, 0.1f }, { 0.04f, 0.2f },
		{ 0.06f, 0.45f }, { 0.045f, 0.6f }, { 0.06f, 0.7f } };
	static const float lamp[][2] = { { 0.09f, 0.76f }, { 0.08f, 0.79f }, { 0.015f, 0.82f },
		{ 0.012f, 1.12f } };
	static const float hood[][2] = { { 0.17f, 1.06f }, { 0.06f, 1.2f }, { 0, 1.21f } };
	float x = 0.5f * width;
	pen_box(&wood, (vec){ -x, -0.5f, 0.71f }, (vec){ x, 0.5f, 0.76f });
	pen_box(&wood, (vec){ -x + 0.1f, -0.4f, 0.62f }, (vec){ x - 0.1f, 0.4f, 0.71f });
	for (unsigned i = 0; i < 4; i++) {
		struct pen q =
			pen_at(&wood, (i & 1 ? 1 : -1) * (x - 0.12f), (i & 2 ? 1 : -1) * 0.38f, 0);
		pen_lathe(&q, leg, 6, 12);
	}
	for (int k = -1; k <= 1; k += 2) {
		struct pen q = pen_at(&brass, k * 0.5f * x, 0, 0),
			   top = pen_at(&shade, k * 0.5f * x, 0, 0);
		pen_lathe(&q, lamp, 4, 12);
		pen_lathe(&top, hood, 3, 16);
	}
}

static void hang_chandelier(const struct hall *h, float x)
{
	struct pen p = site_pen(h->s, x, 0, 4.3f, 0);
	p.object = site_object(h->s, WORLD_FURNITURE);
	struct pen brass = pen_with(&p, h->m.brass), lamp = pen_with(&p, h->m.lamp);
	float up = h->spring + 0.8f * h->rise - 4.3f;
	static const float body[][2] = { { 0, -0.3f }, { 0.06f, -0.22f }, { 0.03f, -0.14f },
		{ 0.12f, 0 }, { 0.04f, 0.15f }, { 0.07f, 0.4f }, { 0.015f, 0.5f } };
	pen_lathe(&brass, body, 7, 14);
	pen_rod(&brass, (vec){ 0, 0, 0.45f }, (vec){ 0, 0, up }, 0.012f, 0.012f, 5);
	for (unsigned i = 0; i < 10; i++) {
		float a = i * (float)G_PI / 5;
		vec out = { cosf(a), sinf(a), 0 };
		vec arm[] = { { 0, 0, 0 }, out * 0.3f - (vec){ 0, 0, 0.14f },
			out * 0.65f - (vec){ 0, 0, 0.05f }, out * 0.72f + (vec){ 0, 0, 0.1f } };
		float radii[] = { 0.018f, 0.016f, 0.014f, 0.014f };
		pen_tube(&brass, arm, radii, 4, 6);
		pen_rod(&lamp, arm[3], arm[3] + (vec){ 0, 0, 0.13f }, 0.016f, 0.016f, 6);
		pen_ball(&lamp, arm[3] + (vec){ 0, 0, 0.17f }, (vec){ 0.02f, 0.02f, 0.04f }, 6);
	}
}

static void furnish_hall(struct hall *h)
{
	struct site *s = h->s;
	for (unsigned i = 0; i < h->bays; i++)
		for (int k = -1; k <= 1; k += 2) {
			float x = -h->half_x + h->bay * (i + 0.5f), y = k * (h->half_y - 0.08f);
			struct pen p =
				site_stand(s, WORLD_FURNITURE, x, y, k > 0 ? 0 : (float)G_PI);
			draw_bookcase(h, &p, h->bay - 1.5f);
			if (i % 2)
				hang_chandelier(h, x);
		}
	float wide = h->nave - 1.9f; /* pews on both sides of the middle, facing east */
	for (unsigned i = 0; i < 7; i++)
		for (int k = -1; k <= 1; k += 2) {
			float x = 1.5f + 1.15f * i + site_nudge(s, 0.4f),
			      y = k * (1.25f + 0.5f * wide) + site_nudge(s, 0.5f);
			if (x > h->half_x - 5)
				continue;
			struct pen p = site_stand(s, WORLD_FURNITURE, x, y, -(float)G_PI / 2);
			draw_pew(&p, &h->m, wide);
			site_claim(s, x, y, 0.5f * wide);
			if (roll(&s->dice) < 0.35f)
				add_person(s, x, y + roll_in(&s->dice, -0.3f, 0.3f) * wide,
					-(float)G_PI / 2, POSE_SIT);
		}
	for (unsigned i = 0; i < 3; i++)
		for (int k = -1; k <= 1; k += 2) {
			float x = -4.5f - 4.2f * i + site_nudge(s, 0.9f),
			      y = k * 0.56f * h->nave + site_nudge(s, 0.6f);
			if (x < -h->half_x + 3 || !site_claim(s, x, y, 1.3f))
				continue;
			struct pen p = site_stand(s, WORLD_FURNITURE, x, y, 0);
			draw_long_table(&p, &h->m, 2.4f);
			for (unsigned c = 0; c < 4; c++) {
				float side = c & 2 ? 1 : -1,
				      cx = x + (c & 1 ? 0.6f : -0.6f) +
					   roll_in(&s->dice, -0.15f, 0.15f),
				      cy = y + side * 0.72f;
				struct pen q = site_stand(
					s, WORLD_FURNITURE, cx, cy, side > 0 ? 0 : (float)G_PI);
				draw_chair(&q, &h->m);
				if (roll(&s->dice) < 0.3f)
					add_person(s, cx, cy, side > 0 ? 0 : (float)G_PI, POSE_SIT);
			}
		}
}

static void people_hall(struct hall *h)
{
	struct site *s = h->s;
	uint32_t shrub = shrub_model(s), tree = tree_model(s, TREE_ROUND);
	for (int k = -1; k <= 1; k += 2) {
		float x = h->half_x - 1.2f, y = k * (h->nave - 1.2f);
		struct pen p = site_stand(s, WORLD_STRUCTURE, x, y, 0);
		p.material = h->m.terracotta;
		draw_urn(&p, 0.8f);
		p.object = site_object(s, WORLD_VEGETATION);
		struct pen q = pen_at(&p, 0, 0, 0.65f);
		q = pen_scaled(&q, 0.6f);
		site_place(s, shrub, &q);
	}
	for (unsigned i = 0; i < 14; i++) /* seen through the panes */
		plant(s, tree, -h->half_x + 2 * h->half_x * (i / 2) / 6,
			(i % 2 ? 1 : -1) * (h->half_y + roll_in(&s->dice, 12, 18)), 1.1f);
	for (unsigned i = 0, tries = 0; i < 8 && tries < 300; tries++) {
		float x = roll_in(&s->dice, -0.9f, 0.9f) * h->half_x,
		      y = roll_in(&s->dice, -1, 1) * (h->half_y - 1.2f);
		if (fabsf(fabsf(y) - h->nave) < 0.9f || !site_claim(s, x, y, 0.5f))
			continue;
		add_person(s, x, y, roll_in(&s->dice, 0, 6.28f), i % 3 ? POSE_STAND : POSE_WALK);
		i++;
	}
}

void scene_hall(struct site *s)
{
	struct hall h = { .s = s };
	choose_hall(&h);
	float a = 0.5f * (h.nave + h.half_y) - 0.25f, x = h.half_x;
	const float walk[][2] = { { -0.9f, 0 }, { -0.55f * x, a }, { -0.12f * x, -a },
		{ 0.76f * x, 0 }, { 0.5f * x, a }, { 0.1f * x, a }, { -0.3f * x, a },
		{ -0.78f * x, 0.3f * a }, { -0.62f * x, -a }, { -0.36f * x, -a }, { 0.2f * x, -a },
		{ 0.52f * x, -a } };
	s->bounds = (struct bounds){ { -x - 1, -h.half_y - 1, -0.4f },
		{ x + 1, h.half_y + 1, h.spring + h.rise + 0.4f }, 1.1f };
	/* exposed for the inside: the day outside is brighter than white */
	s->light.sun *= 1.7f;
	s->light.zenith *= 1.9f;
	s->light.horizon *= 1.6f;
	s->light.fill = (vec){ 0.15f, 0.134f, 0.11f };
	for (unsigned i = 0; i < G_N_ELEMENTS(walk); i++)
		site_walk_to(s, walk[i][0], walk[i][1]);
	build_hall(&h);
	struct dice kept;
	site_begin_loose(s, &kept);
	furnish_hall(&h);
	people_hall(&h);
	site_end_loose(s, &kept);
}
