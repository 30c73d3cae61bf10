#include "sim/scene-wing.h"
#include "sim/scene-props.h"
#include "sim/scene-roof.h"

static float room_m = 4.2f;

/* The rear and the ends, plain. */
static void close_block(const struct pen *p, float x0, float x1, float depth, float height)
{
	pen_quad(p, (vec){ x0, depth, -2 }, (vec){ x1, depth, -2 }, (vec){ x1, depth, height },
		(vec){ x0, depth, height });
	for (unsigned k = 0; k < 2; k++) {
		float x = k ? x1 : x0;
		pen_quad(p, (vec){ x, 0, -2 }, (vec){ x, depth, -2 }, (vec){ x, depth, height },
			(vec){ x, 0, height });
	}
}

static void roof_block(struct site *s, const struct pen *p, struct roof r, float x, float z,
	unsigned dormers, unsigned chimneys)
{
	struct pen q = pen_at(p, x, 0, z);
	draw_roof(&q, &r);
	furnish_roof(s, &q, &r, dormers, chimneys);
}

/* The projecting middle: quoins, sides, pediment. */
static void draw_risalit(struct site *s, const struct pen *p, struct facade f, float x, float out)
{
	struct pen q = pen_at(p, x, -out, 0), wall = pen_with(&q, f.wall),
		   trim = pen_with(&q, f.trim);
	float h = facade_height(&f);
	f.quoins = true;
	f.mitre = 1;
	f.flank = 0;
	draw_facade(s, &q, &f);
	for (unsigned k = 0; k < 2; k++) {
		float at = k ? f.length : 0;
		pen_quad(&wall, (vec){ at, 0, -1.6f }, (vec){ at, out + 0.1f, -1.6f },
			(vec){ at, out + 0.1f, h }, (vec){ at, 0, h });
	}
	float rise = 0.2f * f.length, l = f.length, e = 0.34f;
	vec gable[] = { { 0, 0, h }, { l, 0, h }, { 0.5f * l, 0, h + rise } };
	pen_prism(&wall, gable, 3, -0.02f, 2.5f);
	for (int k = 0; k < 2; k++) {
		float end = k ? l + e : -e;
		vec rake[] = { { end, 0, h + 0.02f }, { end, 0, h + 0.3f },
			{ 0.5f * l, 0, h + rise + 0.36f }, { 0.5f * l, 0, h + rise + 0.06f } };
		pen_prism(&trim, rake, 4, -e, 2.5f);
		vec lower[] = { { end, 0, h }, { end, 0, h + 0.04f },
			{ 0.5f * l, 0, h + rise + 0.1f }, { 0.5f * l, 0, h + rise - 0.2f } };
		pen_prism(&trim, lower, 4, -0.12f, 0);
	}
	struct pen round = pen_at(&trim, 0.5f * l, 0, h + 0.42f * rise);
	draw_arc(&round, 0, 0, 0.22f * rise, 0.3f * rise, -0.12f, 0, 0, 2 * (float)G_PI, 20);
	struct pen dark = pen_with(&round, f.palette->inside);
	draw_arc(&dark, 0, 0, 0, 0.22f * rise, -0.03f, 0, 0, 2 * (float)G_PI, 20);
}

/* Steps with a parapet at both sides, and urns on them. */
static void draw_perron(const struct pen *p, const struct palette *m, float x, float y, float width)
{
	struct pen q = pen_at(p, x, y, 0), stone = pen_with(&q, m->trim),
		   urn = pen_with(&q, m->trim_dark);
	struct pen slab = pen_at(&stone, 0, -0.9f, 0);
	pen_box(&stone, (vec){ -0.5f * width, -0.9f, -1.3f }, (vec){ 0.5f * width, 0, 0 });
	for (unsigned i = 1; i < 7; i++)
		pen_box(&slab, (vec){ -0.5f * width, -0.32f * i, -1.5f },
			(vec){ 0.5f * width, 0, -0.15f * i });
	for (int k = -1; k <= 1; k += 2) {
		float a = k * 0.5f * width, b = a + k * 0.4f;
		vec side[] = { { 0, 0, -1.5f }, { 2.9f, 0, -1.5f }, { 2.9f, 0, -0.45f },
			{ 0.9f, 0, 0.42f }, { 0, 0, 0.42f } };
		struct pen turned = pen_turned(&stone, 0, 0, 0, (float)G_PI / 2);
		pen_prism(&turned, side, 5, MIN(a, b), MAX(a, b));
		pen_box(&stone, (vec){ MIN(a, b) - 0.05f, -3.3f, -1.5f },
			(vec){ MAX(a, b) + 0.05f, -2.8f, -0.2f });
		pen_box(&stone, (vec){ MIN(a, b) - 0.1f, -3.35f, -0.2f },
			(vec){ MAX(a, b) + 0.1f, -2.75f, -0.1f });
		struct pen top = pen_at(&urn, 0.5f * (a + b), -3.05f, -0.1f);
		draw_urn(&top, 0.75f);
	}
}

static void set_grand_storeys(struct site *s, struct facade *f)
{
	f->storeys = (unsigned)roll_int(&s->dice, 3, 4);
	f->storey[0] = (struct storey){ roll_in(&s->dice, 3.9f, 4.3f), 1.15f, 2.1f, 0.9f, true,
		HEAD_PLAIN };
	f->storey[1] = (struct storey){ roll_in(&s->dice, 4, 4.5f), 1.2f, 2.35f, 0.8f, false,
		roll(&s->dice) < 0.5f ? HEAD_PEDIMENT : HEAD_HOOD };
	f->storey[2] = (struct storey){ 3.4f, 1.15f, 1.75f, 0.85f, false, HEAD_LINTEL };
	f->storey[3] = (struct storey){ 2.6f, 1.1f, 1.05f, 0.75f, false, HEAD_PLAIN };
}

void wing_grand(struct site *s, const struct pen *p, const struct palette *m, float length)
{
	float depth = 11, middle = roll_in(&s->dice, 9, 11), out = 0.7f,
	      side = 0.5f * (length - middle);
	struct facade f = { .palette = m,
		.wall = m->plaster[0],
		.ground_wall = m->rustic,
		.trim = m->trim,
		.frame = m->frame_light,
		.shutter = m->door[0],
		.room_m = room_m,
		.dentils = true };
	set_grand_storeys(s, &f);
	float top = facade_height(&f);
	f.length = side;
	f.bays = (unsigned)lroundf(side / 3.3f);
	f.flank = 0;
	draw_facade(s, p, &f);
	struct pen right = pen_at(p, side + middle, 0, 0), wall = pen_with(p, m->plaster[0]);
	draw_facade(s, &right, &f);
	f.length = middle;
	f.bays = 3;
	f.doors = 2;
	f.storey[1].arched = true;
	f.storey[1].balconies = 2;
	draw_risalit(s, p, f, side, out);
	draw_perron(p, m, 0.5f * length, -out, 3.4f);
	/* where the side wings abut the wall goes on, blank */
	draw_wall(&wall, -9, 0, -2, top, NULL, 0);
	draw_wall(&wall, length, length + 9, -2, top, NULL, 0);
	close_block(&wall, -9, length + 9, depth, top);
	struct roof r = { m, roll(&s->dice) < 0.5f ? m->slate : m->tiles, m->plaster[0],
		length + 18, depth, roll_in(&s->dice, 4, 5), 0.5f, { 5, 5 } };
	roof_block(s, p, r, -9, top + 0.2f, (unsigned)roll_int(&s->dice, 5, 8), 4);
}

void wing_brick(struct site *s, const struct pen *p, const struct palette *m, float length)
{
	float depth = 10;
	unsigned bays = (unsigned)lroundf(length / roll_in(&s->dice, 2.9f, 3.3f));
	struct facade f = { .palette = m,
		.wall = m->brick[roll_int(&s->dice, 0, 1)],
		.trim = m->trim,
		.frame = m->frame_light,
		.shutter = m->door[roll_int(&s->dice, 0, 2)],
		.room_m = room_m,
		.length = length,
		.bays = bays,
		.storeys = 3,
		.flank = 0 };
	f.ground_wall = roll(&s->dice) < 0.5f ? m->ashlar : f.wall;
	f.storey[0] =
		(struct storey){ 3.6f, 1.1f, 1.9f, 0.85f, roll(&s->dice) < 0.4f, HEAD_KEYSTONE };
	f.storey[1] = (struct storey){ 3.4f, 1.1f, 1.85f, 0.8f, false, HEAD_KEYSTONE, 4, 0 };
	f.storey[2] = (struct storey){ 3.0f, 1.05f, 1.5f, 0.8f, false, HEAD_LINTEL, 0, 1 };
	f.doors = 1U << 2 | 1U << (bays / 2) | 1U << (bays - 3);
	float top = facade_height(&f);
	draw_facade(s, p, &f);
	struct pen step = pen_with(p, m->trim), wall = pen_with(p, f.wall);
	for (unsigned i = 0; i < bays; i++) {
		struct pen q = pen_at(&step, length * (i + 0.5f) / bays, 0, 0);
		if (f.doors >> i & 1)
			draw_steps(&q, 1.9f, 2, 0.12f, 0.34f);
	}
	draw_wall(&wall, -9, 0, -2, top, NULL, 0);
	draw_wall(&wall, length, length + 9, -2, top, NULL, 0);
	close_block(&wall, -9, length + 9, depth, top);
	struct roof r = { m, m->tiles, f.wall, length + 18, depth, roll_in(&s->dice, 3.8f, 4.6f),
		0.45f, { 0, 0 } };
	roof_block(s, p, r, -9, top + 0.15f, (unsigned)roll_int(&s->dice, 4, 7), 5);
}

static void draw_arch_bay(
	const struct pen *p, const struct palette *m, float x, float bay, float spring, float depth)
{
	float r = 0.5f * bay - 0.36f;
	struct pen stone = pen_with(p, m->trim), vault = pen_with(p, m->plaster[1]),
		   wall = pen_with(p, m->ashlar);
	draw_arc(&wall, x + 0.5f * bay, spring, r, r + 0.005f, 0.01f, 0.55f, 0, (float)G_PI, 20);
	draw_voussoirs(&stone, x + 0.5f * bay, spring, r, r + 0.3f, -0.04f, 0.02f, 13);
	struct pen q = pen_at(&vault, x + 0.5f * bay, 0.5f * (0.55f + depth), spring);
	draw_groin(&q, 0.5f * bay, 0.5f * (depth - 0.55f), r + 0.1f, false, 0.05f);
}

static void draw_piers(
	const struct pen *p, const struct palette *m, float length, unsigned bays, float spring)
{
	struct pen stone = pen_with(p, m->trim), wall = pen_with(p, m->ashlar);
	float bay = length / bays;
	for (unsigned i = 0; i <= bays; i++) {
		float x = bay * i;
		if (i == 0 || i == bays) {
			float a = i ? x - 0.36f : x, b = i ? x : x + 0.36f;
			pen_box(&wall, (vec){ a, 0, -0.6f }, (vec){ b, 0.55f, spring });
		} else {
			struct pen q = pen_at(&stone, x, 0.28f, 0);
			draw_column(&q, spring - 0.12f, 0.22f);
			pen_box(&stone, (vec){ x - 0.38f, -0.06f, spring - 0.14f },
				(vec){ x + 0.38f, 0.6f, spring });
		}
	}
}

void wing_arcade(struct site *s, const struct pen *p, const struct palette *m, float length)
{
	float depth = roll_in(&s->dice, 3.4f, 4), height = roll_in(&s->dice, 4.4f, 4.8f);
	unsigned bays = (unsigned)lroundf(length / 3.4f);
	float bay = length / bays, r = 0.5f * bay - 0.36f, spring = height - r - 0.55f;
	struct facade f = { .palette = m,
		.wall = m->plaster[2],
		.ground_wall = m->ashlar,
		.trim = m->trim,
		.frame = m->frame_dark,
		.shutter = m->door[1],
		.room_m = room_m,
		.length = length,
		.bays = bays,
		.storeys = (unsigned)roll_int(&s->dice, 2, 3),
		.open_ground = true,
		.dentils = true };
	f.storey[0] = (struct storey){ height, 1.1f, 1.7f, 1, false, HEAD_LINTEL };
	f.storey[1] = (struct storey){ 3.5f, 1.1f, 1.9f, 0.9f, roll(&s->dice) < 0.5f, HEAD_HOOD };
	f.storey[2] = (struct storey){ 2.6f, 1, 1.15f, 0.8f, false, HEAD_PLAIN };
	float top = facade_height(&f);
	draw_facade(s, p, &f);
	struct opening o[24];
	struct pen wall = pen_with(p, m->ashlar), back = pen_at(&wall, 0, 0.55f, 0),
		   floor = pen_with(p, m->flags);
	for (unsigned i = 0; i < bays; i++) {
		o[i] = (struct opening){ bay * i + 0.36f, spring, 2 * r, r, true, false };
		draw_arch_bay(p, m, bay * i, bay, spring, depth);
	}
	draw_wall(&wall, 0, length, spring, height, o, bays);
	draw_wall(&back, 0, length, spring, height, o, bays);
	draw_piers(p, m, length, bays, spring);
	floor.object = site_object(s, WORLD_TERRAIN);
	pen_box(&floor, (vec){ 0, -0.35f, -1 }, (vec){ length, depth + 0.2f, 0 });
	pen_box(&floor, (vec){ 0, -0.7f, -1 }, (vec){ length, 0, -0.14f });
	struct facade inner = f;
	struct pen q = pen_at(p, 0, depth, 0);
	inner.storeys = 1;
	inner.open_ground = inner.dentils = false;
	inner.ground_wall = m->plaster[1];
	inner.doors = 1U << 1 | 1U << (bays / 2) | 1U << (bays - 2);
	draw_facade(s, &q, &inner);
	struct pen plain = pen_with(p, m->plaster[2]);
	close_block(&plain, 0, length, 9, top);
	struct roof roof = { m, m->tiles, m->plaster[2], length + 6, 9,
		roll_in(&s->dice, 2.8f, 3.3f), 0.45f, { 0, 0 } };
	roof_block(s, p, roof, -3, top + 0.15f, (unsigned)roll_int(&s->dice, 0, 3), 2);
}

void draw_ivy(struct site *s, const struct pen *p, uint16_t leaf, float x0, float x1, float height)
{
	struct pen q = pen_with(p, leaf);
	q.object = site_object(s, WORLD_VEGETATION);
	unsigned n = (unsigned)(700 * (x1 - x0));
	for (unsigned i = 0; i < n; i++) {
		float x = roll_in(&s->dice, x0, x1), z = height * powf(roll(&s->dice), 0.8f);
		float edge =
			noise_2d(x * 0.9f, z * 0.6f, 31) + 0.5f * noise_2d(x * 2.6f, z * 2.1f, 32);
		float side = MIN(x - x0, x1 - x) / (0.4f * (x1 - x0));
		if (edge + 1.1f * MIN(side, 1) < -0.15f + 1.1f * z / height)
			continue;
		float size = roll_in(&s->dice, 0.09f, 0.17f), a = roll_in(&s->dice, -0.9f, 0.9f);
		vec along = { size * sinf(a), -0.05f - 0.3f * size * roll(&s->dice),
			-size * cosf(a) };
		vec across = { 0.42f * size * cosf(a), roll_in(&s->dice, -0.3f, 0.3f) * size,
			0.42f * size * sinf(a) };
		pen_leaf(&q,
			(vec){ x, roll_in(&s->dice, -0.2f, -0.1f) * (0.4f + roll(&s->dice)),
				z - 0.2f },
			along, across, (vec){ 0, -0.6f, 0.3f });
	}
	uint16_t bark = site_material(
		s, (struct material){
			   .colour = { 0.2f, 0.15f, 0.1f }, .grain_per_m = 20, .grain = 0.3f });
	for (unsigned i = 0; i < 7; i++) {
		float x = x0 + (x1 - x0) * (i + 0.5f) / 7;
		vec stem[] = { { x, -0.05f, -0.4f }, { x + 0.2f, -0.06f, 0.3f * height },
			{ x - 0.1f, -0.04f, 0.6f * height } };
		float radii[] = { 0.03f, 0.02f, 0.01f };
		struct pen wood = pen_with(&q, bark);
		pen_tube(&wood, stem, radii, 3, 6);
	}
}

void wing_gate(struct site *s, const struct pen *p, const struct palette *m, float length)
{
	float depth = 8.5f;
	unsigned bays = (unsigned)lroundf(length / 3.9f), gate = bays / 2;
	struct facade f = { .palette = m,
		.wall = m->plaster[3],
		.ground_wall = m->rubble,
		.trim = m->trim_dark,
		.frame = m->frame_dark,
		.shutter = m->door[2],
		.room_m = room_m,
		.length = length,
		.bays = bays,
		.storeys = 2 };
	f.storey[0] = (struct storey){ roll_in(&s->dice, 4.1f, 4.5f), 1.1f, 1.7f, 1.1f, false,
		HEAD_LINTEL };
	f.storey[1] = (struct storey){ 3.2f, 1.1f, 1.6f, 0.85f, false, HEAD_PLAIN, 0, 1 };
	f.gates = 1U << gate;
	f.doors = 1U << (bays - 1);
	f.blank = 3U | 1U << (gate + 2);
	f.upper_doors = 1;
	float top = facade_height(&f), bay = length / bays;
	draw_facade(s, p, &f);
	struct pen trim = pen_with(p, m->trim), plain = pen_with(p, m->plaster[3]),
		   step = pen_at(&trim, length - 0.5f * bay, 0, 0);
	draw_voussoirs(&trim, bay * (gate + 0.5f), 4.1f - 0.25f - 1.5f, 1.5f, 1.95f, -0.12f, 0, 15);
	draw_steps(&step, 1.8f, 2, 0.13f, 0.34f);
	for (unsigned k = 0; k < 2; k++) {
		struct pen lamp = pen_at(p, bay * (gate + 0.5f) + (k ? 2.3f : -2.3f), 0, 2.5f);
		lamp.object = site_object(s, WORLD_STRUCTURE);
		draw_lantern(&lamp, m);
	}
	uint16_t leaf = site_material(s, (struct material){ .colour = { 0.1f, 0.21f, 0.05f },
						 .kind = MATERIAL_LEAF,
						 .variety = 0.35f,
						 .warmth = 0.15f,
						 .reflectivity = 0.55f });
	draw_ivy(s, p, leaf, bay * (gate + 2) - 0.2f, bay * (gate + 3) + 0.2f, top * 0.72f);
	draw_outside_stair(s, p, m, 0.5f * bay - 1, 2, f.storey[0].height + UPPER_DOOR_M, 1.5f);
	close_block(&plain, 0, length, depth, top);
	struct roof r = { m, m->tiles, m->plaster[3], length + 6, depth,
		roll_in(&s->dice, 2.8f, 3.3f), 0.5f, { 0, 0 } };
	roof_block(s, p, r, -3, top + 0.15f, 3, 2);
}

void draw_tower(struct site *s, const struct pen *p, const struct palette *m)
{
	float half = 2.8f, h = roll_in(&s->dice, 24, 28);
	struct facade f = { .palette = m, .trim = m->trim, .frame = m->frame_dark };
	struct opening o = { half - 0.7f, h - 5.2f, 1.4f, 3.4f, true, false };
	for (unsigned i = 0; i < 4; i++) {
		struct pen q = pen_turned(p, 0, 0, 0, i * (float)G_PI / 2);
		q = pen_at(&q, -half, -half, 0);
		q.material = m->ashlar;
		draw_wall(&q, 0, 2 * half, -2, h, &o, 1);
		draw_opening(s, &q, &f, &o);
		q.material = m->trim;
		draw_course(&q, 0, 2 * half, h - 6.2f, 1);
		draw_cornice(&q, 0, 2 * half, h - 0.5f, 1, 1, true);
		draw_arc(&q, half, h - 7.6f, 0.7f, 0.85f, -0.06f, 0, 0, 2 * (float)G_PI, 28);
	}
	struct pen roof = pen_at(p, 0, 0, h), ball = pen_with(p, m->brass);
	roof.material = m->copper;
	draw_spire(&roof, half, 9);
	pen_ball(&ball, (vec){ 0, 0, h + 9.2f }, (vec){ 0.3f, 0.3f, 0.3f }, 12);
	pen_rod(&ball, (vec){ 0, 0, h + 9 }, (vec){ 0, 0, h + 11 }, 0.04f, 0.03f, 6);
}
