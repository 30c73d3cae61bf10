/* Houses of a street: wing_house() of scene-wing.h. */
#include "sim/scene-props.h"
#include "sim/scene-roof.h"
#include "sim/scene-wing.h"

/* A slope of cloth in stripes over the shop window, with a valance. */
static void draw_awning(
	const struct pen *p, const struct palette *m, uint16_t cloth, float x0, float x1, float z)
{
	unsigned n = (unsigned)lroundf((x1 - x0) / 0.3f);
	for (unsigned i = 0; i < n; i++) {
		float a = x0 + (x1 - x0) * i / n, b = x0 + (x1 - x0) * (i + 1) / n;
		struct pen q = pen_with(p, i % 2 ? m->curtain : cloth);
		vec l0 = { a, 0, z }, r0 = { b, 0, z }, l1 = { a, -1.3f, z - 0.5f },
		    r1 = { b, -1.3f, z - 0.5f };
		pen_quad(&q, l0, r0, r1, l1);
		pen_quad(&q, l1, r1, r1 - (vec){ 0, 0, 0.2f }, l1 - (vec){ 0, 0, 0.2f });
	}
	struct pen iron = pen_with(p, m->iron);
	for (unsigned k = 0; k < 2; k++) {
		float x = k ? x1 : x0;
		pen_rod(&iron, (vec){ x, 0, z - 0.9f }, (vec){ x, -1.28f, z - 0.5f }, 0.015f,
			0.015f, 5);
	}
}

/* Goods behind the pane: shelves with boxes and balls. */
static void draw_wares(
	struct site *s, const struct pen *p, const struct palette *m, float x0, float x1)
{
	struct pen shelf = pen_with(p, m->wood);
	for (unsigned level = 0; level < 3; level++) {
		float z = 0.75f + 0.5f * level, y = 0.5f + 0.25f * level;
		pen_box(&shelf, (vec){ x0, y, z - 0.03f }, (vec){ x1, y + 0.25f, z });
		for (float x = x0 + 0.1f; x < x1 - 0.2f; x += roll_in(&s->dice, 0.18f, 0.4f)) {
			struct pen q = pen_with(p, m->door[roll_int(&s->dice, 0, 3)]);
			float h = roll_in(&s->dice, 0.1f, 0.3f),
			      w = roll_in(&s->dice, 0.05f, 0.12f);
			if (roll(&s->dice) < 0.5f)
				pen_box(&q, (vec){ x, y + 0.05f, z },
					(vec){ x + w, y + 0.2f, z + h });
			else
				pen_ball(&q, (vec){ x + w, y + 0.12f, z + w }, (vec){ w, w, w }, 8);
		}
	}
}

static void draw_shop(struct site *s, const struct pen *p, const struct facade *f)
{
	const struct palette *m = f->palette;
	unsigned style = (unsigned)roll_int(&s->dice, 0, 2);
	struct pen wood = pen_with(p, m->shop[style]), stone = pen_with(p, f->trim),
		   sign = pen_with(p, m->brass);
	float l = f->length, h = f->storey[0].height, top = h - 0.75f,
	      door = l * (roll(&s->dice) < 0.5f ? 0.25f : 0.5f);
	struct opening o[3] = { { 0.45f, 0.6f, door - 1.05f, top - 0.6f },
		{ door - 0.55f, 0, 1.1f, top, false, true },
		{ door + 0.6f, 0.6f, l - 0.45f - door - 0.6f, top - 0.6f } };
	draw_wall(&wood, 0, l, -0.6f, h, o, 3);
	struct facade inner = *f;
	inner.frame = inner.trim = m->shop[style];
	for (unsigned i = 0; i < 3; i++) {
		draw_opening(s, &wood, &inner, &o[i]);
		if (i != 1)
			draw_wares(s, p, m, o[i].x, o[i].x + o[i].width);
	}
	for (unsigned k = 0; k < 4; k++) { /* pilasters */
		float x = k == 0 ? 0.2f : k == 3 ? l - 0.2f : k == 1 ? door - 0.7f : door + 0.72f;
		pen_box(&wood, (vec){ x - 0.12f, -0.1f, -0.6f },
			(vec){ x + 0.12f, 0, top + 0.05f });
		pen_box(&wood, (vec){ x - 0.16f, -0.14f, -0.6f }, (vec){ x + 0.16f, 0, 0.3f });
		pen_box(&wood, (vec){ x - 0.16f, -0.15f, top - 0.1f },
			(vec){ x + 0.16f, 0, top + 0.08f });
	}
	pen_box(&wood, (vec){ 0.05f, -0.12f, top + 0.1f }, (vec){ l - 0.05f, 0, top + 0.55f });
	draw_course(&wood, 0.02f, l - 0.02f, top + 0.6f, 0);
	for (float x = 0.25f * l; x < 0.75f * l; x += 0.3f) /* raised letters */
		pen_box(&sign, (vec){ x, -0.15f, top + 0.2f },
			(vec){ x + roll_in(&s->dice, 0.08f, 0.2f), -0.12f, top + 0.45f });
	if (roll(&s->dice) < 0.6f)
		draw_awning(&wood, m, m->shop[(style + 1) % 3], 0.4f, l - 0.4f, top + 0.05f);
	struct pen back = pen_with(p, m->inside), floor = pen_with(p, m->inside_floor);
	pen_quad(&back, (vec){ 0, f->room_m, 0 }, (vec){ l, f->room_m, 0 },
		(vec){ l, f->room_m, h }, (vec){ 0, f->room_m, h });
	pen_quad(&floor, (vec){ 0, 0.05f, 0.01f }, (vec){ l, 0.05f, 0.01f },
		(vec){ l, f->room_m, 0.01f }, (vec){ 0, f->room_m, 0.01f });
	pen_box(&stone, (vec){ 0, -0.03f, -0.6f }, (vec){ l, 0.03f, 0.1f });
}

static void draw_pilasters(const struct pen *p, const struct facade *f)
{
	struct pen q = pen_with(p, f->trim);
	float z0 = f->storey[0].height + 0.2f, z1 = facade_height(f) - 0.5f;
	for (unsigned i = 0; i <= f->bays; i++) {
		float x = CLAMP(f->length * i / f->bays, 0.25f, f->length - 0.25f);
		pen_box(&q, (vec){ x - 0.2f, -0.09f, z0 }, (vec){ x + 0.2f, 0, z1 });
		pen_box(&q, (vec){ x - 0.25f, -0.13f, z0 }, (vec){ x + 0.25f, 0, z0 + 0.3f });
		pen_box(&q, (vec){ x - 0.25f, -0.13f, z1 - 0.12f }, (vec){ x + 0.25f, 0, z1 });
		pen_box(&q, (vec){ x - 0.22f, -0.11f, z1 - 0.3f },
			(vec){ x + 0.22f, 0, z1 - 0.24f });
	}
}

static void choose_style(struct site *s, const struct palette *m, struct facade *f)
{
	struct dice *d = &s->dice;
	const uint16_t walls[] = { m->plaster[0], m->plaster[1], m->plaster[2], m->plaster[3],
		m->plaster[4], m->brick[0], m->brick[1], m->ashlar };
	f->wall = walls[roll_int(d, 0, 7)];
	f->ground_wall = roll(d) < 0.4f ? m->rustic : f->wall;
	f->trim = roll(d) < 0.75f ? m->trim : m->trim_dark;
	f->frame = roll(d) < 0.7f ? m->frame_light : m->frame_dark;
	f->shutter = m->door[roll_int(d, 0, 3)];
	f->storeys = (unsigned)roll_int(d, 2, 4);
	enum head head = (enum head)roll_int(d, 0, 4);
	bool arched = roll(d) < 0.2f;
	unsigned balcony = roll(d) < 0.35f ? (unsigned)roll_int(d, 2, 3) : 0,
		 shutter = roll(d) < 0.35f;
	f->storey[0] =
		(struct storey){ roll_in(d, 3.5f, 4), 1.1f, 1.8f, 0.9f, arched, HEAD_LINTEL };
	f->storey[1] = (struct storey){ roll_in(d, 3.2f, 3.7f), 1.1f, 1.85f, 0.8f, arched, head,
		balcony, shutter };
	f->storey[2] = (struct storey){ roll_in(d, 3, 3.3f), 1.05f, 1.65f, 0.8f, false, HEAD_LINTEL,
		0, shutter };
	f->storey[3] = (struct storey){ 2.8f, 1, 1.3f, 0.8f, false, HEAD_PLAIN, 0, 0 };
	f->quoins = roll(d) < 0.4f;
	f->dentils = roll(d) < 0.5f;
}

/* The end walls: with windows where seen, plain where a neighbour stands. */
static void draw_ends(
	struct site *s, const struct pen *p, struct facade f, float depth, bool left, bool right)
{
	float top = facade_height(&f), l = f.length;
	struct pen wall = pen_with(p, f.wall);
	f.length = depth;
	f.bays = 3;
	f.doors = f.gates = 0;
	f.open_ground = false;
	f.storey[1].balconies = 0;
	for (unsigned k = 0; k < 2; k++) {
		float x = k ? l : 0;
		if (k ? right : left) {
			struct pen q = k ? pen_turned(p, l, 0, 0, -(float)G_PI / 2)
					 : pen_turned(p, 0, depth, 0, (float)G_PI / 2);
			f.room_m = 2.5f;
			draw_facade(s, &q, &f);
			continue;
		}
		pen_quad(&wall, (vec){ x, 0, -1 }, (vec){ x, depth, -1 }, (vec){ x, depth, top },
			(vec){ x, 0, top });
	}
	pen_quad(&wall, (vec){ 0, depth, -1 }, (vec){ l, depth, -1 }, (vec){ l, depth, top },
		(vec){ 0, depth, top });
}

void wing_house(struct site *s, const struct pen *p, const struct palette *m, float length,
	bool open_left, bool open_right)
{
	struct facade f = { .palette = m, .room_m = 4, .length = length };
	float depth = 9.5f;
	choose_style(s, m, &f);
	f.bays = (unsigned)MAX(2, lroundf(length / roll_in(&s->dice, 2.6f, 3.1f)));
	bool shop = roll(&s->dice) < 0.5f && length > 5.5f;
	f.open_ground = shop;
	f.doors = 1U << roll_int(&s->dice, 0, (int)f.bays - 1);
	draw_facade(s, p, &f);
	if (shop)
		draw_shop(s, p, &f);
	if (roll(&s->dice) < 0.3f && !f.storey[1].shutters)
		draw_pilasters(p, &f);
	draw_ends(s, p, f, depth, open_left, open_right);
	struct roof r = { m, roll(&s->dice) < 0.6f ? m->tiles : m->slate, f.wall, length, depth,
		roll_in(&s->dice, 2.8f, 4.6f), 0.12f, { open_left ? 3 : 0, open_right ? 3 : 0 } };
	struct pen roof = pen_at(p, 0, 0, facade_height(&f) + 0.15f);
	draw_roof(&roof, &r);
	furnish_roof(s, &roof, &r, (unsigned)roll_int(&s->dice, 0, length > 8 ? 3 : 2), 1);
}
